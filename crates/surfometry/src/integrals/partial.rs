//! What one tile adds to the integrals, and how tiles add up.

use super::{Band, Quadrature, SmearedDelta};
use crate::local_geometry::{Curvature, TileSample};
use crate::tiling::{ExactSum, IndexBox};

/// Declares the surface integrals: one line each, a name and the integrand as a function of the curvature.
macro_rules! surface_integrals {
    ($($(#[$doc:meta])* $name:ident = |$c:ident| $integrand:expr;)*) => {
        /// Integrals over a surface.
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct SurfaceIntegrals {
            $($(#[$doc])* pub $name: f64,)*
        }

        impl SurfaceIntegrals {
            /// Adds a piece of surface of the given area and curvature.
            fn add(&mut self, area: f64, curvature: &Curvature) {
                $(self.$name += area * { let $c = curvature; $integrand };)*
            }

            /// The sums with another factor.
            fn map(&self, f: impl Fn(f64) -> f64) -> Self {
                Self { $($name: f(self.$name),)* }
            }
        }

        /// The same, exact.
        #[derive(Debug, Clone, Default)]
        struct SurfaceSums {
            $($name: ExactSum,)*
        }

        impl SurfaceSums {
            fn add(&mut self, tile: &SurfaceIntegrals) {
                $(self.$name.add(tile.$name);)*
            }

            fn merge(&mut self, other: &Self) {
                $(self.$name.merge(&other.$name);)*
            }

            fn value(&self) -> SurfaceIntegrals {
                SurfaceIntegrals { $($name: self.$name.value(),)* }
            }
        }
    };
}

surface_integrals! {
    /// A, mm^2.
    area = |_c| 1.0;
    /// Integral of H, mm.
    mean = |c| c.mean;
    /// Integral of K, which is 2 pi chi.
    gaussian = |c| c.gaussian;
    /// Integral of H^2, the bending energy.
    mean_squared = |c| c.mean * c.mean;
    /// Integral of H K, 1/mm: how total mean curvature changes along the normal.
    mean_times_gaussian = |c| c.mean * c.gaussian;
}

/// A part of an object's integrals, in units of voxels, that can be merged with any other part in any order.
///
/// A tile is summed in one fixed order in f64; tiles are then added exactly. So the result depends neither on the
/// number of threads nor on how the tiles were dealt out.
#[derive(Debug, Clone, Default)]
pub struct Partial {
    volume: ExactSum,
    surface: SurfaceSums,
    /// Voxels with phi < 0.
    pub inside_voxels: u64,
    /// Voxels that the delta weighs.
    pub band_voxels: u64,
    /// Band voxels whose gradient has collapsed.
    pub voxels_without_normal: u64,
}

impl Partial {
    /// The part of one tile.
    pub fn of_tile(tile: &TileSample, band: &Band, quadrature: &Quadrature) -> Self {
        let weights = Weights::new(quadrature, tile.region());
        let mut partial = Self::default();
        let volume = partial.add_volume(tile, band.delta(), &weights);
        partial.volume.add(volume);
        let surface = partial.add_surface(tile, band, &weights);
        partial.surface.add(&surface);
        partial
    }

    fn add_volume(&mut self, tile: &TileSample, delta: &SmearedDelta, weights: &Weights) -> f64 {
        match tile {
            TileSample::Constant { phi, .. } if *phi >= 0.0 => 0.0,
            TileSample::Constant { region, .. } => {
                self.inside_voxels += region.voxels() as u64;
                weights.total()
            }
            TileSample::Varying { phi, .. } => {
                let mut sum = 0.0;
                for (y, z) in phi.region().rows() {
                    let row = phi.row(y, z);
                    self.inside_voxels += row.iter().filter(|&&p| p < 0.0).count() as u64;
                    sum += weights.row(y, z)
                        * weights.x.iter().zip(row).map(|(w, p)| w * delta.heaviside(-p)).sum::<f64>();
                }
                sum
            }
        }
    }

    fn add_surface(&mut self, tile: &TileSample, band: &Band, weights: &Weights) -> SurfaceIntegrals {
        let mut sums = SurfaceIntegrals::default();
        let TileSample::Varying { band: voxels, .. } = tile else { return sums };
        self.band_voxels = voxels.len() as u64;
        for voxel in voxels {
            match band.element(&voxel.jet) {
                Some((density, curvature)) => sums.add(density * weights.at(voxel.index), &curvature),
                None => self.voxels_without_normal += 1,
            }
        }
        sums
    }

    /// Two parts as one.
    #[must_use]
    pub fn merged(mut self, other: &Self) -> Self {
        self.volume.merge(&other.volume);
        self.surface.merge(&other.surface);
        self.inside_voxels += other.inside_voxels;
        self.band_voxels += other.band_voxels;
        self.voxels_without_normal += other.voxels_without_normal;
        self
    }

    /// Volume in voxels.
    pub fn volume(&self) -> f64 {
        self.volume.value()
    }

    /// Surface integrals for voxels of the given volume.
    pub fn surface(&self, cell_volume: f64) -> SurfaceIntegrals {
        self.surface.value().map(|sum| sum * cell_volume)
    }
}

/// Quadrature weights of a tile.
struct Weights {
    lower: [i64; 3],
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

impl Weights {
    fn new(quadrature: &Quadrature, IndexBox { lower, upper }: IndexBox) -> Self {
        let axis = |a: usize| quadrature.weights(a, lower[a]..upper[a]);
        Self { lower, x: axis(0), y: axis(1), z: axis(2) }
    }

    fn row(&self, y: i64, z: i64) -> f64 {
        self.y[(y - self.lower[1]) as usize] * self.z[(z - self.lower[2]) as usize]
    }

    fn at(&self, [x, y, z]: [i64; 3]) -> f64 {
        self.x[(x - self.lower[0]) as usize] * self.row(y, z)
    }

    fn total(&self) -> f64 {
        [&self.x, &self.y, &self.z].iter().map(|axis| axis.iter().sum::<f64>()).product()
    }
}
