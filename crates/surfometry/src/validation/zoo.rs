//! The shapes.

use crate::choice::choices;
use crate::phantoms::{
    Ball, Capsule, Ellipsoid, Genus, Helix, MinimalSurface, Periodic, RoundedBox, Shape, Shell, Struts,
    Torus, TwoBalls,
};

/// A shape that can be had in any size.
#[derive(Debug, Clone, Copy)]
pub struct ZooShape {
    /// What it is called.
    pub name: &'static str,
    /// The shape, as many times as large as its unit.
    pub make: fn(f64) -> Box<dyn Shape>,
    /// Whether constants of this crate were fitted on shapes of this kind.
    pub tuned: bool,
    /// Whether curvature is continuous: where it jumps, as at a capsule's seam, no blur tells it exactly.
    pub smooth: bool,
    /// Whether the surface is a ball's, or balls', whose curvature is the same everywhere.
    pub spherical: bool,
    /// Half the thickness of its unit, where it is thin: R is that of the shape then.
    pub half_thickness: Option<f64>,
}

/// Which shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Zoo {
    /// Those that a blur of two voxels keeps at R = 10.
    #[default]
    Bodies,
    /// Tubes, plates, shells, networks, lesions: R is half their thickness.
    Thin,
}

choices!(Zoo, "zoo": {
    Bodies = "bodies": "bodies and surfaces of which R is a radius of curvature",
    Thin = "thin": "tubes, plates, shells, networks and lesions, of which R is half the thickness",
});

impl Zoo {
    /// R in voxels at which they are looked at where nothing else is said.
    pub fn resolutions(self) -> &'static [f64] {
        match self {
            Self::Bodies => &[10.0, 20.0],
            Self::Thin => &[1.5, 2.0, 2.5, 3.0],
        }
    }

    /// Its shapes.
    pub fn shapes(self) -> &'static [ZooShape] {
        match self {
            Self::Bodies => &ZOO,
            Self::Thin => &THIN_ZOO,
        }
    }
}

const fn shape(name: &'static str, make: fn(f64) -> Box<dyn Shape>) -> ZooShape {
    ZooShape { name, make, tuned: false, smooth: true, spherical: false, half_thickness: None }
}

const fn thin(name: &'static str, make: fn(f64) -> Box<dyn Shape>) -> ZooShape {
    ZooShape { half_thickness: Some(1.0), ..shape(name, make) }
}

/// What is thin, in units of half its thickness.
pub const THIN_ZOO: [ZooShape; 9] = [
    thin("lesion", |s| Box::new(Ball { radius: s })),
    thin("tube", |s| Box::new(Capsule { radius: s, length: 14.0 * s })),
    thin("ring", |s| Box::new(Torus { major: 5.0 * s, minor: s })),
    thin("coil", |s| Box::new(Helix { radius: s, coil: 4.0 * s, pitch: 6.0 * s, turns: 1.5 })),
    thin("tree", |s| Box::new(Struts::tree(s))),
    thin("lattice", |s| Box::new(Struts::lattice(s, 7.0 * s, 2))),
    thin("plate", |s| Box::new(Genus { genus: 0, major: 6.0 * s, minor: s })),
    thin("flat ellipsoid", |s| Box::new(Ellipsoid { radii: [5.0 * s, 4.0 * s, s] })),
    thin("thin shell", |s| Box::new(Shell { radius: 9.0 * s, inner: 7.0 * s })),
];

/// The zoo. Sizes are such that shapes keep their kind, not their volume.
pub const ZOO: [ZooShape; 13] = [
    ZooShape { spherical: true, tuned: true, ..shape("ball", |s| Box::new(Ball { radius: 10.0 * s })) },
    ZooShape {
        tuned: true,
        ..shape("ellipsoid 3:2:1.5", |s| Box::new(Ellipsoid { radii: [3.0, 2.0, 1.5].map(|r| 5.0 * r * s) }))
    },
    ZooShape {
        tuned: true,
        ..shape("ellipsoid 2:2:1", |s| Box::new(Ellipsoid { radii: [2.0, 2.0, 1.0].map(|r| 7.0 * r * s) }))
    },
    shape("ellipsoid 4:3:2", |s| Box::new(Ellipsoid { radii: [4.0, 3.0, 2.0].map(|r| 4.0 * r * s) })),
    ZooShape { tuned: true, ..shape("torus 3:1", |s| Box::new(Torus { major: 30.0 * s, minor: 10.0 * s })) },
    shape("torus 2:1", |s| Box::new(Torus { major: 20.0 * s, minor: 10.0 * s })),
    ZooShape {
        tuned: true,
        ..shape("gyroid", |s| {
            Box::new(Periodic { surface: MinimalSurface::Gyroid, period: 40.0 * s, size: 60.0 * s })
        })
    },
    shape("schwarz-p", |s| {
        Box::new(Periodic { surface: MinimalSurface::SchwarzP, period: 40.0 * s, size: 60.0 * s })
    }),
    ZooShape {
        smooth: false,
        ..shape("genus 2", |s| Box::new(Genus { genus: 2, major: 12.0 * s, minor: 10.0 * s }))
    },
    ZooShape {
        smooth: false,
        ..shape("capsule", |s| Box::new(Capsule { radius: 10.0 * s, length: 30.0 * s }))
    },
    ZooShape {
        smooth: false,
        ..shape("rounded box", |s| {
            Box::new(RoundedBox { radii: [25.0, 20.0, 16.0].map(|r| r * s), radius: 10.0 * s })
        })
    },
    ZooShape { spherical: true, ..shape("shell", |s| Box::new(Shell { radius: 24.0 * s, inner: 10.0 * s })) },
    ZooShape {
        spherical: true,
        ..shape("two balls", |s| Box::new(TwoBalls { radius: 10.0 * s, length: 31.0 * s }))
    },
];
