//! Study: time of recovery.
use surfometry::embedding::*;
use surfometry::phantoms::*;
use surfometry::validation::ZOO;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let r: f64 = args[2].parse().unwrap();
    let z = ZOO.iter().find(|z| z.name == args[1]).unwrap();
    let unit = Phantom::new((z.make)(1.0), Pose::new([0.0; 3], [0.0; 3]), [1.0; 3]).unwrap();
    let scale = r * unit.rms_curvature();
    let p = Phantom::new((z.make)(scale), Pose::new([33.0, 21.0, 57.0], [0.2, 0.3, 0.1]), [1.0; 3]).unwrap();
    let mask = p.labels().unwrap().mask(1);
    for s in args[3].split(',') {
        let s: f64 = s.parse().unwrap();
        let t = std::time::Instant::now();
        let f = Recovery { sigma: s, truncation: 5.0, price: Price::FromEvidence, margin: 0.0 }.corrections(&mask);
        let t2 = std::time::Instant::now();
        let g = Recovery { sigma: s, truncation: 5.0, price: Price::FromEvidence, margin: 0.0 }.corrections_of_wide_blur(&mask);
        let el = t2.elapsed().as_secs_f64();
        println!("  spread: amounts {} left {} rounds {} {:.2} s", g.amounts.len(), g.left, g.rounds, el);
        println!("{} R={r} s={s}: beside {} violated {} amounts {} left {} clusters {} rounds {} {:.2} s", args[1], f.beside, f.violated, f.amounts.len(), f.left, f.clusters, f.rounds, t.elapsed().as_secs_f64());
    }
}
