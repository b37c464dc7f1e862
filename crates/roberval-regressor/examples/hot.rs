use roberval_regressor::*;
use roberval_scalar::*;
fn main() {
    let (name, robot) = roberval_benches::robots().swap_remove(1);
    let n: usize = std::env::args().nth(1).map_or(512, |x| x.parse().unwrap());
    let r = Regressor::new(&robot).with_width(if std::env::args().nth(2).is_some() {
        Width::Four
    } else {
        Width::Eight
    });
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
    let size = r.packed_layout(Model::D).len(n, r.lanes());
    let mut out = vec![0.0; size + 8];
    let skip = out.as_ptr().align_offset(64);
    let out = &mut out[skip..skip + size];
    for _ in 0..std::env::args()
        .nth(2)
        .map_or(51200000, |x| x.parse::<usize>().unwrap())
        / n
    {
        r.fill_packed(Model::D, s, out).unwrap();
    }
    println!("{name} {}", out[5]);
}
