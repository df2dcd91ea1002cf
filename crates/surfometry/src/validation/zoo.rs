//! The shapes.

use crate::phantoms::{
    Ball, Capsule, Ellipsoid, Genus, MinimalSurface, Periodic, RoundedBox, Shape, Shell, Torus, TwoBalls,
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
}

const fn shape(name: &'static str, make: fn(f64) -> Box<dyn Shape>) -> ZooShape {
    ZooShape { name, make, tuned: false, smooth: true, spherical: false }
}

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
