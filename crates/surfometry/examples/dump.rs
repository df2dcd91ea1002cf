//! Study: what each scale says at each vertex. `dump SHAPE R ratio seed outfile` or `dump file.nii.gz 0 0 0 outfile`.
use std::io::Write;
use surfometry::embedding::*;
use surfometry::local_geometry::*;
use surfometry::phantoms::*;
use surfometry::surface::extract;
use surfometry::validation::ZOO;
use surfometry::volume::Mask;

fn jets(indicator: &dyn Indicator, s: f64, corrected: bool, points: &[[f64; 3]]) -> Vec<Jet> {
    let e = if corrected { GaussianEmbedding::corrected(indicator, s, 5.0) } else { GaussianEmbedding::new(indicator, s, 0.5, 5.0) };
    GaussianDerivatives::new(e).jets(points)
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let (name, r, ratio, seed): (&str, f64, f64, u64) = (&args[1], args[2].parse().unwrap(), args[3].parse().unwrap(), args[4].parse().unwrap());
    let (mask, phantom, curv): (Mask, Option<Phantom>, f64) = if name.ends_with(".nii.gz") {
        (surfometry::io::read_labels(std::path::Path::new(name)).unwrap().mask(1), None, 0.0)
    } else {
        let u = |n: u64| { let x = ((seed * 7919 + n * 104729 + 12345) as f64 * 0.6180339887498949 * (1.0 + 0.1 * n as f64)).fract(); x };
        let spacing = [1.0, 1.0 / ratio.sqrt(), 1.0 / ratio];
        let pose = Pose::new([360.0 * u(0), (2.0 * u(1) - 1.0).asin().to_degrees(), 360.0 * u(2)], [spacing[0] * (u(3) - 0.5), spacing[1] * (u(4) - 0.5), spacing[2] * (u(5) - 0.5)]);
        let make: Box<dyn Fn(f64) -> Box<dyn Shape>> = match name {
            "tube" => Box::new(|s| Box::new(Capsule { radius: s, length: 24.0 })),
            _ => { let z = ZOO.iter().find(|z| z.name == name).unwrap(); Box::new(move |s| (z.make)(s)) }
        };
        let unit = Phantom::new(make(1.0), Pose::new([0.0; 3], [0.0; 3]), [1.0; 3]).unwrap();
        let scale = if name == "tube" { r } else { (0.95 + 0.1 * u(6)) * r * unit.rms_curvature() };
        let p = Phantom::new(make(scale), pose, spacing).unwrap();
        let c = p.rms_curvature();
        (p.labels().unwrap().mask(1), Some(p), c)
    };
    let grid = *mask.grid();
    let sp = grid.spacing().mm();
    let h = (sp.iter().map(|h| h * h).sum::<f64>() / 3.0).sqrt();
    let base_sigma = 1.5 * h;
    let base = GaussianEmbedding::corrected(&mask, base_sigma, 5.0);
    let mesh = extract(&base, &grid);
    let areas = mesh.vertex_areas();
    let origin = grid.affine().apply([0.0; 3]);
    let linear = grid.affine().linear;
    let most = std::env::var("MOST").map_or(2500, |m| m.parse().unwrap());
    let stride = mesh.vertices.len().div_ceil(most);
    let world: Vec<[f64; 3]> = mesh.vertices.iter().copied().step_by(stride).collect();
    let areas: Vec<f64> = areas.into_iter().step_by(stride).collect();
    let index: Vec<[f64; 3]> = world.iter().map(|&w| std::array::from_fn(|a| (w[a] - origin[a]) / linear[a][a])).collect();
    let mut out = std::io::BufWriter::new(std::fs::File::create(&args[5]).unwrap());
    writeln!(out, "# {} {} {}", name, h, curv).unwrap();
    let ladder: Vec<f64> = (0..).map(|k| 1.25 * 2f64.powf(k as f64 / 2.0)).take_while(|s| *s < 7.5 && (*s < 5.5 || r > 12.0)).map(|s| s * h).collect();
    let mut columns: Vec<Vec<f64>> = vec![];
    let mut names: Vec<String> = vec![];
    for a in 0..3 { columns.push(world.iter().map(|w| w[a]).collect()); names.push(format!("p{a}")); }
    columns.push(areas); names.push("area".into());
    let truth: Vec<Option<SurfacePoint>> = world.iter().map(|&w| phantom.as_ref().and_then(|p| p.surface_point(w))).collect();
    columns.push(truth.iter().map(|t| t.as_ref().map_or(f64::NAN, |t| t.curvature.mean_curvature)).collect()); names.push("H".into());
    columns.push(truth.iter().map(|t| t.as_ref().map_or(f64::NAN, |t| t.curvature.gaussian_curvature)).collect()); names.push("K".into());
    columns.push(truth.iter().map(|t| t.as_ref().map_or(f64::NAN, |t| t.distance)).collect()); names.push("dist".into());
    for &s in &ladder {
        for recover in [false, true] {
            let corrected_mask;
            let indicator: &dyn Indicator = if recover {
                let found = Recovery { sigma: s, truncation: 5.0, price: Price::FromEvidence, margin: 0.0 }.corrections(&mask);
                corrected_mask = CorrectedMask::new(mask.clone(), found.amounts);
                eprintln!("{name} s={s:.2} beside {} violated {} left {} refused {} noisy {}", found.beside, found.violated, found.left, found.refused, found.noisy);
                &corrected_mask
            } else { &mask };
            let mut points = index.clone();
            let mut moved = vec![0.0; points.len()];
            let mut last = vec![];
            for step in 0..3 {
                last = jets(indicator, s, true, &points);
                if step == 2 { break; }
                for ((p, j), m) in points.iter_mut().zip(&last).zip(&mut moved) {
                    let g = j.gradient_magnitude();
                    let d = (-j.value / g).clamp(-h, h);
                    *m += d;
                    for a in 0..3 { p[a] += d * j.gradient[a] / g / sp[a]; }
                }
            }
            let tag = format!("{}{:.3}", if recover { "r" } else { "c" }, s / h);
            let cs: Vec<Curvature> = last.iter().map(|j| Curvature::of(j).unwrap_or(Curvature { mean_curvature: 0.0, gaussian_curvature: 0.0 })).collect();
            let ex: Vec<f64> = points.iter().map(|&p| phantom.as_ref().and_then(|ph| ph.surface_point(grid.affine().apply(p))).map_or(f64::NAN, |t| t.distance)).collect();
            columns.push(cs.iter().map(|c| c.mean_curvature).collect()); names.push(format!("{tag}H"));
            columns.push(cs.iter().map(|c| c.gaussian_curvature).collect()); names.push(format!("{tag}K"));
            columns.push(moved); names.push(format!("{tag}m"));
            columns.push(ex); names.push(format!("{tag}d"));
            let slope = EdgeProfile::corrected(s).slope(0.0);
            columns.push(last.iter().map(|j| j.gradient_magnitude() / slope).collect()); names.push(format!("{tag}g"));
            columns.push(last.iter().map(|j| { let g = j.gradient_magnitude(); j.gradient.iter().fold(0.0f64, |m, c| m.max(c.abs() / g)) }).collect()); names.push(format!("{tag}x"));
            let pl: Vec<Curvature> = jets(indicator, s, false, &points).iter().map(|j| Curvature::of(j).unwrap_or(Curvature { mean_curvature: 0.0, gaussian_curvature: 0.0 })).collect();
            columns.push(pl.iter().map(|c| c.mean_curvature).collect()); names.push(format!("{tag}pH"));
            columns.push(pl.iter().map(|c| c.gaussian_curvature).collect()); names.push(format!("{tag}pK"));
        }
    }
    writeln!(out, "{}", names.join(",")).unwrap();
    for row in 0..world.len() {
        writeln!(out, "{}", columns.iter().map(|c| format!("{:.6e}", c[row])).collect::<Vec<_>>().join(",")).unwrap();
    }
}
