//! Study: validation of local curvature alone. `val R ratio poses first shapes...`
use surfometry::validation::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let v = Validation { resolutions: vec![a[1].parse().unwrap()], ratios: vec![a[2].parse().unwrap()], poses: a[3].parse().unwrap(), first_pose: a[4].parse().unwrap(), shapes: a[5..].to_vec(), local: true };
    let t = std::time::Instant::now();
    let r = v.run(|| {}).unwrap();
    for s in summarise(&r) {
        let c = s.local_coverage.unwrap();
        println!("{:18} R {:2} H {:5.1} K {:5.1} place {:.3} cover {:3.0} {:3.0}", s.shape, s.resolution, s.mean_curvature.unwrap(), s.gaussian_curvature.unwrap(), s.position_voxels.unwrap(), c[0], c[1]);
    }
    eprintln!("{:.1} s", t.elapsed().as_secs_f64());
}
