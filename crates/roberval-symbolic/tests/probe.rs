use roberval_symbolic::*;
use roberval_mechanism::*;
use roberval_testkit::*;
#[test]
fn probe() {
    let mut all = vec![];
    for e in roberval_formats::catalogue() { all.push(roberval_formats::load(e.name).unwrap()); }
    for seed in 0..12 { for (angles, format) in [(Angles::Right, SourceFormat::Mdh), (Angles::Mixed, SourceFormat::Mdh), (Angles::Right, SourceFormat::Urdf), (Angles::Mixed, SourceFormat::Urdf)] {
        let f = Family { links: (3, 7), angles, format, ..Family::default() };
        let mut r = f.robot(seed); r.name = format!("{angles:?} {format:?} {seed}"); all.push(r); } }
    for d in all {
        let m = Mechanism::new(&d).unwrap();
        let t = std::time::Instant::now();
        let r = match symbolic_relations(&m, &SymbolicOptions { naming: Naming::All, ..Default::default()}) { Ok(r) => r, Err(e) => { println!("{}: {e}", m.name); continue; } };
        let n: usize = r.beta.iter().flatten().flatten().count();
        let open: usize = r.beta.iter().flatten().flatten().filter(|c| matches!(c, Coefficient::Open(_))).count();
        let quot: usize = r.beta.iter().flatten().flatten().filter(|c| matches!(c, Coefficient::Quotient{denominator, ..} if denominator.iter().any(|x| *x>0))).count();
        println!("{} b {} symbols {} entries {n} open {open} quot {quot} {:?} {:?} {:?} {:e}", m.name, r.base.len(), r.named.symbols.len(), t.elapsed(), r.special, r.named.notes, r.verification.failure_probability);
    }
}
