//! Each flag: a case that raises it and one that does not.

mod common;

use common::{codes, measure, phantom, poses};
use surfometry::Measurement;
use surfometry::inputs::OpenOptions;
use surfometry::measurement::{DescribedSurface, EmbeddingKind, Measured};
use surfometry::phantoms::{Ball, Phantom, Pose, RoundedBox, Torus, TwoBalls};
use surfometry::volume::{FieldImage, FieldValues, Grid, Mask};

fn ball(radius: f64, spacing: [f64; 3], m: &Measurement) -> Measured {
    measure(&phantom(Ball { radius }, poses()[0], spacing), m)
}

fn raised(m: &Measured, code: &str) -> bool {
    codes(m).contains(&code.to_owned())
}

/// A good measurement carries no warning, and every number of the contract.
#[test]
fn a_good_measurement_is_not_flagged() {
    let m = ball(20.0, [1.0, 0.9, 0.8], &Measurement::default());
    assert!(codes(&m).is_empty(), "{:?}", codes(&m));
    assert!(m.blurred.grid_noise.volume_mm3.is_some() && m.blurred.grid_noise.euler_characteristic.is_some());
    assert!(m.standard_error.volume_mm3.is_some());
}

/// Where errors were not studied they are null, and it is said.
#[test]
fn errors_that_are_not_modelled() {
    let unmodelled = [
        Measurement::paper(),
        Measurement::default().sigma_mm(1.1),
        Measurement::default().level(0.4),
        Measurement::default().embedding(EmbeddingKind::Distance),
    ];
    for measurement in unmodelled {
        let m = ball(20.0, [1.0; 3], &measurement);
        assert!(raised(&m, "not-computed"), "{measurement:?}");
        assert!(m.blurred.grid_noise.volume_mm3.is_none() && m.standard_error.volume_mm3.is_none());
    }
}

/// A band that covers more of the object than its surface: the mesh, which knows no band, tells.
#[test]
fn the_band_against_the_mesh() {
    let m = Measurement::default();
    let (small, large) = (ball(4.0, [1.0; 3], &m), ball(20.0, [1.0; 3], &m));
    let excess = |m: &Measured| m.blurred.surface_area_mm2.unwrap() / m.mesh.surface_area_mm2.unwrap() - 1.0;
    assert!(raised(&small, "band-differs-from-mesh") && excess(&small) > 0.05, "{}", excess(&small));
    assert!(!raised(&large, "band-differs-from-mesh") && excess(&large).abs() < 2e-3, "{}", excess(&large));
    // One cause, one flag: a band too thin for the slices is that, and not a matter of thin parts.
    let undersampled = ball(20.0, [0.5, 0.5, 5.0], &m);
    assert!(
        raised(&undersampled, "thickness-below-spacing") && !raised(&undersampled, "band-differs-from-mesh")
    );
}

#[test]
fn lengths_against_the_grid() {
    let m = Measurement::default();
    for (code, raising, quiet) in [
        ("sigma-below-spacing", m.sigma_mm(0.9), m.sigma_mm(1.0)),
        ("thickness-below-spacing", m.thickness_mm(2.4), m.thickness_mm(2.5)),
        ("thickness-above-blur", m.sigma_mm(1.0).thickness_mm(8.0), m.sigma_mm(2.0).thickness_mm(5.0)),
    ] {
        assert!(raised(&ball(15.0, [1.0; 3], &raising), code), "{code}");
        assert!(!raised(&ball(15.0, [1.0; 3], &quiet), code), "{code}");
    }
    assert!(raised(&ball(15.0, [0.5, 0.5, 1.0], &m), "thick-slices"));
    assert!(!raised(&ball(15.0, [0.7, 0.7, 1.0], &m), "thick-slices"));
}

#[test]
fn touching_the_border() {
    let grid = Grid::axis_aligned([20; 3], [1.0; 3]).unwrap();
    let cube =
        |from: usize| Mask::from_predicate(grid, move |i| i.iter().all(|&v| (from..from + 15).contains(&v)));
    let m = Measurement::default();
    assert!(raised(&m.run(cube(0)).unwrap(), "touches-border"));
    assert!(raised(&m.run(cube(5)).unwrap(), "touches-border"));
    assert!(!raised(&m.run(cube(2)).unwrap(), "touches-border"));
    let grid = Grid::axis_aligned([20; 3], [1.0, 2.0, 3.0]).unwrap();
    let low = Mask::from_predicate(grid, |i| i[0] < 15 && (3..9).contains(&i[1]) && i[2] >= 8);
    let cut = m.run(&low).unwrap();
    // 6 x 12 faces of 2 x 3 mm in the first slice across x, 15 x 6 of 1 x 2 in the last across z.
    assert_eq!(cut.voxels.cut_area_mm2, 6.0 * 12.0 * 6.0 + 15.0 * 6.0 * 2.0);
    let message = &cut.flags.iter().find(|f| f.code.to_string() == "touches-border").unwrap().message;
    assert!(message.contains("first x (432.0 mm2), last z (180.0 mm2)"), "{message}");
    // The border is harmless: the cap closes the object, so the cube is the same wherever it lies.
    let (edge, middle) = (m.run(cube(0)).unwrap(), m.run(cube(2)).unwrap());
    assert!(
        (edge.blurred.surface_area_mm2.unwrap() / middle.blurred.surface_area_mm2.unwrap() - 1.0).abs()
            < 1e-6
    );
    assert!((edge.blurred.euler_characteristic.unwrap() - 2.0).abs() < 0.05);
}

/// A box along the grid has flat faces, the same box turned has none; a ball's poles are no faces.
#[test]
fn faces_along_the_grid() {
    let shape = || RoundedBox { radii: [20.0, 16.0, 12.0], radius: 4.0 };
    let m = Measurement::default();
    let straight = measure(&phantom(shape(), Pose::new([0.0; 3], [0.2, 0.3, 0.1]), [1.0; 3]), &m);
    assert!(raised(&straight, "flat-faces"));
    let turned = measure(&phantom(shape(), poses()[0], [1.0; 3]), &m);
    assert!(!raised(&turned, "flat-faces"));
    for radius in [10.0, 20.0, 40.0] {
        // Centred, so that its terraces are widest.
        let centred = phantom(Ball { radius }, Pose::new([0.0; 3], [0.0; 3]), [1.0; 3]);
        for embedding in [EmbeddingKind::Gaussian, EmbeddingKind::Corrected] {
            let share = measure(&centred, &m.embedding(embedding));
            assert!(!raised(&share, "flat-faces"), "{radius} {embedding:?} {:?}", share.flags);
        }
    }
    // What the faces do to V is in its error.
    let [wide, narrow] = [&straight, &turned].map(|m| m.standard_error.volume_mm3.unwrap());
    assert!(wide > 5.0 * narrow, "{wide} {narrow}");
}

/// On thick slices the band is thicker than the corrected field is steep.
#[test]
fn bands_of_the_corrected_embedding() {
    let m = Measurement::default().embedding(EmbeddingKind::Corrected);
    assert!(!raised(&ball(15.0, [1.0; 3], &m), "corrected-band"));
    assert!(raised(&ball(15.0, [0.6, 0.6, 1.5], &m), "corrected-band"));
}

#[test]
fn an_object_that_the_blur_removes_is_null_and_no_error() {
    let m = Measurement::default();
    for sigma in [4.0, 30.0, 1e6] {
        let gone = ball(4.0, [1.0; 3], &m.sigma_mm(sigma).thickness_mm(2.5));
        assert!(raised(&gone, "surface-vanished"), "sigma {sigma}");
        assert!(gone.blurred.volume_mm3.is_none() && gone.blurred.euler_characteristic.is_none());
        assert!(gone.surface_area_mm2.is_none() && gone.volume_mm3 == Some(gone.voxels.volume_mm3));
        assert!(gone.voxels.count > 200 && gone.topology.components == 1);
    }
    assert!(!raised(&ball(4.0, [1.0; 3], &m.sigma_mm(1.5).thickness_mm(2.5)), "surface-vanished"));
}

#[test]
fn thin_objects() {
    let plate = |half: f64| {
        let shape = RoundedBox { radii: [25.0, 25.0, half], radius: half * 0.9 };
        measure(&phantom(shape, poses()[0], [1.0; 3]), &Measurement::default().sigma_mm(2.0))
    };
    assert!(raised(&plate(2.5), "thin-for-sigma"), "5 mm thick at sigma 2");
    assert!(!raised(&plate(6.0), "thin-for-sigma"), "12 mm thick at sigma 2");
    // Thick on the whole, with a thin part that the blur takes: seen by the volume.
    let grid = Grid::axis_aligned([70, 60, 60], [1.0; 3]).unwrap();
    let lollipop = Mask::from_predicate(grid, |[x, y, z]| {
        let body = (5..30).contains(&x) && (15..45).contains(&y) && (15..45).contains(&z);
        let fins = (30..65).contains(&x) && (5..55).contains(&y) && (29..32).contains(&z);
        body || fins
    });
    assert!(raised(&Measurement::default().sigma_mm(2.0).run(&lollipop).unwrap(), "thin-for-sigma"));
}

/// A band without voxels, and one thicker than the object.
#[test]
fn bands_that_do_not_fit() {
    let m = Measurement::default();
    let empty = ball(12.0, [1.0; 3], &m.epsilon(1e-9));
    assert!(raised(&empty, "empty-band") && !raised(&empty, "surface-vanished"), "{:?}", codes(&empty));
    assert!(empty.blurred.volume_mm3.unwrap() > 6000.0 && empty.blurred.surface_area_mm2.is_none());
    assert!(!raised(&ball(12.0, [1.0; 3], &m), "empty-band"));
    // A half-width counts as the thickness that it stands for.
    assert!(raised(&ball(12.0, [1.0; 3], &m.epsilon(0.05)), "thickness-below-spacing"));
    let distance = m.embedding(EmbeddingKind::Distance);
    assert!(raised(&ball(8.0, [1.0; 3], &distance.thickness_mm(20.0)), "thickness-above-object"));
    assert!(!raised(&ball(12.0, [1.0; 3], &distance), "thickness-above-object"));
}

/// A plate of three voxels at sigma 2: gradients collapse half-way, curvature stays finite, compensation is
/// refused or plausible, never absurd.
#[test]
fn plates_too_thin_to_compensate() {
    let plate = |voxels: usize| {
        let grid = Grid::axis_aligned([60, 60, 30], [1.0; 3]).unwrap();
        let mask = Mask::from_predicate(grid, move |[x, y, z]| {
            (10..50).contains(&x) && (10..50).contains(&y) && (8..8 + voxels).contains(&z)
        });
        Measurement::default().sigma_mm(2.0).run(&mask).unwrap()
    };
    let thin = plate(3);
    assert!(raised(&thin, "thin-for-sigma") && raised(&thin, "vanishing-gradient"), "{:?}", codes(&thin));
    assert!(
        thin.blurred.total_squared_mean_curvature.unwrap() < 1e4,
        "{:?}",
        thin.blurred.total_squared_mean_curvature
    );
    match thin.volume_mm3 {
        Some(volume) => assert!((volume / 4800.0 - 1.0).abs() < 0.25, "{volume}"),
        None => assert!(raised(&thin, "compensation-failed")),
    }
    let thick = plate(12);
    assert!(
        !raised(&thick, "vanishing-gradient") && !raised(&thick, "compensation-failed"),
        "{:?}",
        codes(&thick)
    );
}

/// A rod that the blur all but removes: the compensated volume contradicts the voxels, so there is none.
#[test]
fn compensation_that_fails_is_null() {
    let grid = Grid::axis_aligned([30, 30, 80], [1.0; 3]).unwrap();
    let rod = |half: usize, sigma: f64| {
        let mask = Mask::from_predicate(grid, |[x, y, z]| {
            x.abs_diff(15) <= half && y.abs_diff(15) <= half && (10..70).contains(&z)
        });
        Measurement::default().sigma_mm(sigma).run(&mask).unwrap()
    };
    let failed = rod(1, 1.4);
    assert!(raised(&failed, "compensation-failed"), "{:?} {:?}", failed.voxels, failed.values);
    assert!(failed.surface_area_mm2.is_none() && failed.volume_mm3 == Some(failed.voxels.volume_mm3));
    assert!(failed.blurred.volume_mm3.is_some());
    // The rod is thin, and there is no gap beside it.
    assert!(raised(&failed, "thin-for-sigma") && !raised(&failed, "narrow-gap"));
    let told = failed.flags.iter().find(|flag| flag.code.to_string() == "compensation-failed");
    assert!(told.unwrap().message.contains("sigma is too large for this object"), "{told:?}");
    let fine = rod(5, 1.4);
    assert!(!raised(&fine, "compensation-failed") && fine.surface_area_mm2.is_some());
}

/// Slices so thick that 2.5 of them do not fit the blur: the automatic band stays within it and says that it
/// is thin.
#[test]
fn automatic_bands_fit_the_blur() {
    for thick in [8.0, 30.0] {
        let measured = ball(20.0, [1.0, 1.0, thick], &Measurement::default());
        assert!(raised(&measured, "thickness-below-spacing") && !raised(&measured, "thickness-above-blur"));
        let message =
            &measured.flags.iter().find(|f| f.code.to_string() == "thickness-below-spacing").unwrap().message;
        assert!(message.contains("sigma"), "{message}");
    }
}

#[test]
fn euler_characteristics() {
    let torus = |sigma, thickness| {
        let phantom = Phantom::new(Torus { major: 12.0, minor: 5.0 }, poses()[0], [1.0; 3]).unwrap();
        measure(&phantom, &Measurement::default().sigma_mm(sigma).thickness_mm(thickness))
    };
    // Undersampled blur and band: grid noise.
    assert!(raised(&torus(0.5, 1.0), "euler-not-integer"));
    assert!(!raised(&torus(2.0, 2.5), "euler-not-integer"));
    // A pinhole that the blur closes: chi 0 for the voxels, 2 for the surface.
    let grid = Grid::axis_aligned([30; 3], [1.0; 3]).unwrap();
    let block = |hole: bool| {
        Mask::from_predicate(grid, move |[x, y, z]| {
            let inside = [x, y, z].iter().all(|v| (5..25).contains(v));
            inside && !(hole && x == 15 && y == 15)
        })
    };
    let m = Measurement::default();
    let pierced = m.run(block(true)).unwrap();
    assert_eq!(pierced.topology.handles, 1);
    assert!(raised(&pierced, "euler-differs-from-voxels"), "{:?}", pierced.blurred.euler_characteristic);
    assert!(!raised(&m.run(block(false)).unwrap(), "euler-differs-from-voxels"));
}

#[test]
fn choices_without_compensation() {
    let m = Measurement::default();
    let level = ball(12.0, [1.0; 3], &m.level(0.4).thickness_mm(2.5));
    assert!(raised(&level, "compensation-undefined") && level.standard_error.volume_mm3.is_none());
    assert_eq!((level.surface, level.values), (DescribedSurface::Blurred, level.blurred.values));
    let distance = ball(12.0, [1.0; 3], &m.embedding(EmbeddingKind::Distance));
    assert!(raised(&distance, "distance-quantised") && raised(&distance, "compensation-undefined"));
    assert!(!raised(&ball(12.0, [1.0; 3], &m), "compensation-undefined"));
}

#[test]
fn fields_with_flat_spots() {
    let grid = Grid::axis_aligned([24; 3], [1.0; 3]).unwrap();
    // A plateau of exactly zero gradient inside the band and the object. (One outside is refused: all of the
    // background would count.)
    let value = |[x, y, z]: [usize; 3]| {
        let d =
            ((x as f64 - 11.5).powi(2) + (y as f64 - 11.5).powi(2) + (z as f64 - 11.5).powi(2)).sqrt() - 8.0;
        if d < -1.0 { -1.0 } else { d }
    };
    let values = (0..grid.voxel_count()).map(|o| value(grid.index_of(o))).collect();
    let field = FieldImage::new(grid, FieldValues::F64(values)).unwrap();
    assert!(raised(&Measurement::default().epsilon(1.5).run_field(&field).unwrap(), "vanishing-gradient"));
    assert!(!raised(&Measurement::default().epsilon(0.9).run_field(&field).unwrap(), "vanishing-gradient"));
}

#[test]
fn truth_that_cannot_be_had() {
    let open = |name: &str| surfometry::inputs::open(name, &OpenOptions::default()).unwrap();
    let known = open("phantom:schwarz-p");
    assert!(known.truth().is_some() && known.flags().is_empty());
    // Ten periods: a lattice fine enough for the quadrature would take minutes, so it is not tried.
    let fine = open("phantom:gyroid?period=6&size=60");
    assert!(fine.truth().is_none());
    assert_eq!(fine.flags()[0].code.to_string(), "truth-not-converged");
}

/// Two balls with a gap of 1.5 sigma, and of 3 sigma, which the band does not reach; a block with a fin of 2
/// sigma, and one of 5.
#[test]
fn narrow_places() {
    let told = |measured: &Measured, code: &str| {
        measured.flags.iter().find(|flag| flag.code.to_string() == code).map(|flag| flag.message.clone())
    };
    for spacing in [[1.0; 3], [0.8, 1.0, 0.7]] {
        let apart = |gap: f64| {
            let balls = TwoBalls { radius: 12.0, length: 24.0 + gap };
            let phantom = Phantom::new(balls, poses()[0], spacing).unwrap();
            measure(&phantom, &Measurement::default().sigma_mm(2.0))
        };
        let near = told(&apart(3.0), "narrow-gap").expect("raised");
        // At the world's origin, within two voxels.
        let place = near.split("narrowest at (").nth(1).and_then(|rest| rest.split(')').next()).unwrap();
        let off = |v: &str| (v.trim().parse::<f64>().unwrap() - 0.3).abs() < 2.0;
        assert!(place.split(',').all(off), "{near}");
        assert!(told(&apart(6.0), "narrow-gap").is_none());

        let grid = Grid::axis_aligned([60, 60, 60], spacing).unwrap();
        let fin = |width: f64| {
            let mask = Mask::from_predicate(grid, |index| {
                let [x, y, z]: [f64; 3] = std::array::from_fn(|a| index[a] as f64 * spacing[a]);
                let block = (4.0..24.0).contains(&x) && (4.0..36.0).contains(&y) && (4.0..34.0).contains(&z);
                block
                    || (24.0..40.0).contains(&x)
                        && (20.0..20.0 + width).contains(&y)
                        && (8.0..30.0).contains(&z)
            });
            Measurement::default().sigma_mm(2.0).run(&mask).unwrap()
        };
        let thin = told(&fin(4.0), "thin-for-sigma").expect("raised");
        assert!(thin.contains("narrowest at (") || thin.contains("off the voxels"), "{thin}");
        assert!(told(&fin(10.0), "thin-for-sigma").is_none(), "{:?}", fin(10.0).flags);
    }
}
