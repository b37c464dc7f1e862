use roberval_mechanism::Mechanism;
use roberval_regressor::*;
use roberval_scalar::*;
use std::time::Instant;
fn best(mut f: impl FnMut()) -> f64 {
    let mut best = f64::MAX;
    for _ in 0..400 {
        let t = Instant::now();
        f();
        best = best.min(t.elapsed().as_secs_f64() * 1e9);
    }
    best
}
struct Peak;
impl Task for Peak {
    type Output = f64;
    #[inline(always)]
    fn run<V: Lanes>(self) -> f64 {
        let (a, b) = (V::lift(1.0 + 1e-9), V::lift(1e-9));
        let mut best = 0.0_f64;
        for _ in 0..5 {
            let t = Instant::now();
            let mut x = [V::lift(1.0); 20];
            for _ in 0..20000 {
                for x in &mut x {
                    *x = x.mul_add(a, b);
                }
            }
            let mut out = [0.0; 8];
            for x in x {
                x.store(&mut out);
                std::hint::black_box(&out);
            }
            best =
                best.max(2.0 * 20.0 * 20000.0 * V::COUNT as f64 / t.elapsed().as_secs_f64() * 1e-9);
        }
        best
    }
}
fn main() {
    println!("peak {:.0} GF/s", dispatch(Width::Eight, Peak));
    for (name, robot) in roberval_benches::robots() {
        let n: usize = std::env::args().nth(1).map_or(512, |x| x.parse().unwrap());
        let r0 = Regressor::new(&robot);
        let mut random = SplitMix64::new(1);
        let a: [Vec<f64>; 3] = std::array::from_fn(|_| {
            (0..n * robot.dof())
                .map(|_| random.uniform(-3.0, 3.0))
                .collect()
        });
        let s = States {
            q: &a[0],
            qd: &a[1],
            qdd: &a[2],
        };
        let c = r0.parameters().len();
        print!("{name}: ");
        for w in [Width::Eight, Width::Four, Width::One, Width::Plain] {
            let r = r0.clone().with_width(w);
            let size = r.packed_layout(Model::D).len(n, r.lanes());
            let mut out = vec![0.0; size + 8];
            let skip = out.as_ptr().align_offset(64);
            let t = best(|| {
                r.fill_packed(Model::D, s, &mut out[skip..skip + size])
                    .unwrap()
            }) / n as f64;
            let mut out = vec![0.0; n * robot.dof() * c];
            let t2 = best(|| r.fill(Model::D, s, &mut out).unwrap()) / n as f64;
            let mut out = vec![0.0; r.packed_layout(Model::H).len(n, r.lanes())];
            let t3 = best(|| r.fill_packed(Model::H, s, &mut out).unwrap()) / n as f64;
            let x = vec![1.0; c];
            let mut out = vec![0.0; n * robot.dof()];
            let t4 = best(|| r.torques(&x, s, &mut out).unwrap()) / n as f64;
            print!(" torque {t4:.1}");
            print!(" {w:?} packed {t:.1} dense {t2:.1} h {t3:.1};");
        }
        let r = r0.clone();
        let mut out = vec![0.0; robot.dof() * c];
        let d = robot.dof();
        let one = States {
            q: &a[0][..d],
            qd: &a[1][..d],
            qdd: &a[2][..d],
        };
        let t = best(|| {
            for _ in 0..100 {
                r.fill(Model::D, one, &mut out).unwrap()
            }
        }) / 100.0;
        println!(" one sample {t:.0}");
    }
}
