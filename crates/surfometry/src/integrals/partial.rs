//! What one tile adds to the integrals, and how tiles add up.

use super::{Band, Quadrature};
use crate::embedding::Precision;
use crate::local_geometry::{BAND_CAPACITY, BandVoxels, Curvature, Differentiation, Jet, TileField};
use crate::tiling::{Block, ExactSum, IndexBox};
use crate::vectors;
use fearless_simd::dispatch;
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Voxels that are computed together. Sums run over every eighth voxel, then over the eight.
const LANES: usize = 8;
type Lanes = [f64; LANES];

/// Declares the surface integrals: one line each, a name and the integrand as a function of the curvature.
macro_rules! surface_integrals {
    ($($(#[$doc:meta])* $name:ident = |$c:ident| $integrand:expr;)*) => {
        /// Integrals over a surface.
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct SurfaceIntegrals {
            $($(#[$doc])* pub $name: f64,)*
        }

        impl SurfaceIntegrals {
            /// The sums with another factor.
            fn map(&self, f: impl Fn(f64) -> f64) -> Self {
                Self { $($name: f(self.$name),)* }
            }
        }

        /// The same of every eighth voxel.
        #[derive(Default)]
        struct LaneSums {
            $($name: Lanes,)*
        }

        impl LaneSums {
            /// Adds pieces of surface of the given areas and curvatures.
            #[inline(always)]
            fn add(&mut self, areas: &Lanes, curvatures: &[Curvature; LANES]) {
                $(for lane in 0..LANES {
                    let $c = &curvatures[lane];
                    self.$name[lane] += areas[lane] * $integrand;
                })*
            }

            fn total(&self) -> SurfaceIntegrals {
                SurfaceIntegrals { $($name: self.$name.iter().sum(),)* }
            }
        }

        /// The same, exact.
        #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
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
    total_mean_curvature = |c| c.mean_curvature;
    /// Integral of K, which is 2 pi chi.
    total_gaussian_curvature = |c| c.gaussian_curvature;
    /// Integral of H^2, the bending energy.
    total_squared_mean_curvature = |c| c.mean_curvature * c.mean_curvature;
    /// Integral of H K, 1/mm: how total mean curvature changes along the normal.
    mean_times_gaussian = |c| c.mean_curvature * c.gaussian_curvature;
    /// Integral of the square of the larger principal curvature: over the area, 1 / R^2 of the radius of
    /// curvature that a blur has to respect.
    larger_squared = |c| c.larger() * c.larger();
    /// Integral of its fourth power, 1/mm^2: what the blur leaves after compensation goes with it.
    larger_fourth = |c| c.larger().powi(4);
    /// Integral of its sixth power, 1/mm^4: as that, where the surface turns within a few sigma.
    larger_sixth = |c| c.larger().powi(6);
}

/// A part of an object's integrals, in units of voxels, that can be merged with any other part in any order.
///
/// A tile is summed in one fixed order in f64; tiles are then added exactly. So the result depends neither on
/// the number of threads nor on how the tiles were dealt out.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Partial {
    volume: ExactSum,
    surface: SurfaceSums,
    faces: [ExactSum; 3],
    tilted: ExactSum,
    /// Voxels with phi < 0.
    pub inside_voxels: u64,
    /// Voxels that the delta weighs.
    pub band_voxels: u64,
    /// Band voxels whose gradient has collapsed.
    pub voxels_without_normal: u64,
    /// Band voxels within narrow parts, and within narrow gaps.
    pub narrow: [NarrowVoxels; 2],
}

/// Band voxels whose gradient shows that another surface is near.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct NarrowVoxels {
    /// How many.
    pub voxels: u64,
    /// The one with the least gradient, as a share of a flat edge's, and that share.
    pub narrowest: Option<([i64; 3], f64)>,
}

impl NarrowVoxels {
    fn add(&mut self, index: [i64; 3], share: f64) {
        self.merge(&Self { voxels: 1, narrowest: Some((index, share)) });
    }

    fn merge(&mut self, other: &Self) {
        self.voxels += other.voxels;
        let [here, there] = [self.narrowest, other.narrowest];
        let order = |a: &([i64; 3], f64), b: &([i64; 3], f64)| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0));
        self.narrowest = here.into_iter().chain(there).min_by(order);
    }
}

/// Who looks on while a tile is summed.
pub struct Observer<'a> {
    /// Sees the voxels of the band, and what is known of the surface through each.
    pub look: &'a mut dyn FnMut(&BandVoxels, &BandGeometry),
    /// The time that summing and looking take, not differentiating, is added to it.
    pub summing: &'a mut Duration,
}

/// What is known of the surfaces of constant value through some voxels of a band.
#[derive(Debug, Clone)]
pub struct BandGeometry {
    /// |grad phi|; what follows the last voxel's is of no meaning.
    pub gradients: [f64; BAND_CAPACITY],
    /// H, 1/mm; not a number where there is no normal.
    pub mean_curvatures: [f64; BAND_CAPACITY],
}

impl Default for BandGeometry {
    fn default() -> Self {
        Self { gradients: [0.0; BAND_CAPACITY], mean_curvatures: [f64::NAN; BAND_CAPACITY] }
    }
}

impl Partial {
    /// The part of one tile, from its field. The voxels of its band are shown to an observer as well.
    pub fn of_tile<D: Differentiation + ?Sized>(
        scheme: &D,
        field: &TileField<D>,
        tile: &IndexBox,
        band: &Band,
        quadrature: &Quadrature,
        Observer { look, summing }: Observer,
    ) -> Self {
        let start = Instant::now();
        let weights = Weights::new(quadrature, *tile);
        let mut partial = Self::default();
        match field {
            TileField::Constant(phi) if *phi >= 0.0 => {}
            TileField::Constant(_) => {
                partial.inside_voxels = tile.voxels() as u64;
                partial.volume.add(weights.total());
            }
            TileField::Varying(field) => {
                let half_width = band.delta().half_width();
                let beyond = dispatch!(vectors::level(), _simd => partial.add_inside(field, tile, half_width, &weights));
                *summing += start.elapsed();
                let mut sums = BandSums::default();
                scheme.visit_band(field, tile, half_width, &mut |voxels| {
                    let start = Instant::now();
                    dispatch!(vectors::level(), _simd => sums.add(voxels, band, &weights));
                    look(voxels, &sums.geometry);
                    *summing += start.elapsed();
                });
                partial.add_sums(beyond, &sums);
            }
        }
        partial
    }

    /// Adds what the voxels of a band add up to, and the weight of those inside that it does not reach.
    pub(super) fn add_sums(&mut self, beyond: f64, sums: &BandSums) {
        self.volume.add(beyond + sums.volume.iter().sum::<f64>());
        self.surface.add(&sums.surface.total());
        for (face, lanes) in self.faces.iter_mut().zip(&sums.faces) {
            face.add(lanes.iter().sum());
        }
        self.tilted.add(sums.tilted.iter().sum());
        self.band_voxels += sums.voxels;
        self.voxels_without_normal += sums.without_normal;
        self.narrow.iter_mut().zip(&sums.narrow).for_each(|(narrow, more)| narrow.merge(more));
    }

    /// Counts the voxels inside; the weight of those that the band does not reach, whose Heaviside is 1.
    #[inline(always)]
    fn add_inside<T: Precision>(
        &mut self,
        field: &Block<T>,
        tile: &IndexBox,
        half_width: f64,
        weights: &Weights,
    ) -> f64 {
        let (surface, band) = (T::at_most(0.0), -T::at_most(half_width));
        let mut beyond = 0.0;
        for (y, z) in tile.rows() {
            let start = field.offset([tile.lower[0], y, z]);
            let row = &field.values()[start..][..tile.extent()[0]];
            self.inside_voxels += u64::from(count_below(row, surface));
            beyond += weights.row(y, z)
                * if weights.uniform {
                    f64::from(count_below(row, band))
                } else {
                    weights.x.iter().zip(row).filter(|&(_, &p)| p < band).map(|(w, _)| w).sum()
                };
        }
        beyond
    }

    /// Two parts as one.
    #[must_use]
    pub fn merged(mut self, other: &Self) -> Self {
        self.volume.merge(&other.volume);
        self.surface.merge(&other.surface);
        self.faces.iter_mut().zip(&other.faces).for_each(|(face, more)| face.merge(more));
        self.tilted.merge(&other.tilted);
        self.inside_voxels += other.inside_voxels;
        self.band_voxels += other.band_voxels;
        self.voxels_without_normal += other.voxels_without_normal;
        self.narrow.iter_mut().zip(&other.narrow).for_each(|(narrow, more)| narrow.merge(more));
        self
    }

    /// Volume in voxels.
    pub fn volume(&self) -> f64 {
        self.volume.value()
    }

    /// Area of the surface along the slices across each axis, for voxels of the given volume.
    pub fn faces(&self, cell_volume: f64) -> [f64; 3] {
        self.faces.each_ref().map(|face| face.value() * cell_volume)
    }

    /// Area of the surface near the slices across an axis, but not along them, for voxels of the given volume.
    pub fn tilted(&self, cell_volume: f64) -> f64 {
        self.tilted.value() * cell_volume
    }

    /// Surface integrals for voxels of the given volume.
    pub fn surface(&self, cell_volume: f64) -> SurfaceIntegrals {
        self.surface.value().map(|sum| sum * cell_volume)
    }
}

#[inline(always)]
fn count_below<T: Precision>(row: &[T], bound: T) -> u32 {
    row.iter().map(|&p| u32::from(p < bound)).sum()
}

/// Cosine of one degree.
const ALONG_AXIS: f64 = 0.999_847_7;
/// Cosine of 13 degrees: beyond it, a blur of two voxels leaves nothing of a flat face's terraces.
const NEAR_AXIS: f64 = 0.974_37;

/// Sums over the band of one tile.
#[derive(Default)]
pub(super) struct BandSums {
    /// Of theta(-phi).
    volume: Lanes,
    surface: LaneSums,
    /// Area whose normal is an axis of the grid, within a degree.
    faces: [Lanes; 3],
    /// Area whose normal is nearly one.
    tilted: Lanes,
    voxels: u64,
    without_normal: u64,
    narrow: [NarrowVoxels; 2],
    /// Of the voxels that were added last.
    geometry: BandGeometry,
}

impl BandSums {
    #[inline(always)]
    pub(super) fn add(&mut self, voxels: &BandVoxels, band: &Band, weights: &Weights) {
        self.voxels += voxels.len() as u64;
        let mut indices = voxels.indices();
        for start in (0..voxels.len()).step_by(LANES) {
            let count = (voxels.len() - start).min(LANES);
            let column = |n: usize| -> &Lanes {
                voxels.column(n)[start..][..LANES]
                    .try_into()
                    .expect("columns are a multiple of the lanes long")
            };
            let columns: [&Lanes; 10] = std::array::from_fn(column);
            // 0 in the lanes that no voxel fills.
            let mut weight: Lanes = std::array::from_fn(|lane| f64::from(u8::from(lane < count)));
            if !weights.uniform {
                weight.iter_mut().zip(&mut indices).for_each(|(w, index)| *w = weights.at(index));
            }
            let [gradients, mean_curvatures] = self.add_lanes(columns, &weight, band);
            self.geometry.gradients[start..][..LANES].copy_from_slice(&gradients);
            self.geometry.mean_curvatures[start..][..LANES].copy_from_slice(&mean_curvatures);
            let is_narrow = |lane: usize| band.is_narrow(columns[0][lane], gradients[lane]);
            if (0..count).any(is_narrow) {
                let lanes = voxels.indices().skip(start).take(count).enumerate();
                for (lane, index) in lanes.filter(|&(lane, _)| is_narrow(lane)) {
                    let share = gradients[lane] / band.slope_of_edge(columns[0][lane]);
                    // Half-way through a part phi is least, half-way across a gap it is largest, whether or
                    // not either is still there.
                    let laplacian = columns[4][lane] + columns[5][lane] + columns[6][lane];
                    self.narrow[usize::from(laplacian < 0.0)].add(index, share);
                }
            }
        }
    }

    /// Adds voxels; their [`BandGeometry`].
    #[inline(always)]
    fn add_lanes(&mut self, columns: [&Lanes; 10], weight: &Lanes, band: &Band) -> [Lanes; 2] {
        let [mut gradients, mut mean_curvatures] = [[0.0; LANES]; 2];
        let (delta, heaviside) = band.delta().lanes(columns[0]);
        let mut curvatures = [Curvature { mean_curvature: 0.0, gaussian_curvature: 0.0 }; LANES];
        let (mut areas, mut without) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let jet = Jet {
                value: columns[0][lane],
                gradient: [columns[1][lane], columns[2][lane], columns[3][lane]],
                hessian: std::array::from_fn(|n| columns[4 + n][lane]),
            };
            let gradient = jet.gradient_magnitude();
            gradients[lane] = gradient;
            let along_axis = ALONG_AXIS * gradient;
            let curvature = Curvature::formula(&jet);
            let stands = band.stands(gradient) & curvature.is_finite();
            areas[lane] = if stands { weight[lane] * delta[lane] * gradient } else { 0.0 };
            for axis in 0..3 {
                let along = jet.gradient[axis].abs() >= along_axis;
                self.faces[axis][lane] += if along { areas[lane] } else { 0.0 };
            }
            let most = jet.gradient.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
            let tilted = (NEAR_AXIS * gradient..along_axis).contains(&most);
            self.tilted[lane] += if tilted { areas[lane] } else { 0.0 };
            without[lane] = if stands { 0.0 } else { 1.0 };
            mean_curvatures[lane] = if stands { curvature.mean_curvature } else { f64::NAN };
            curvatures[lane] = Curvature {
                mean_curvature: if stands { curvature.mean_curvature } else { 0.0 },
                gaussian_curvature: if stands { curvature.gaussian_curvature } else { 0.0 },
            };
        }
        self.surface.add(&areas, &curvatures);
        for lane in 0..LANES {
            self.volume[lane] += weight[lane] * heaviside[lane];
            // A quadrature's weights are never 0.
            self.without_normal += u64::from(without[lane] > 0.0 && weight[lane] > 0.0);
        }
        [gradients, mean_curvatures]
    }
}

/// Quadrature weights of a tile.
pub(super) struct Weights {
    /// Whether all are 1.
    uniform: bool,
    lower: [i64; 3],
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

impl Weights {
    pub(super) fn new(quadrature: &Quadrature, IndexBox { lower, upper }: IndexBox) -> Self {
        let axis = |a: usize| quadrature.weights(a, lower[a]..upper[a]);
        Self { uniform: quadrature.is_uniform(), lower, x: axis(0), y: axis(1), z: axis(2) }
    }

    fn row(&self, y: i64, z: i64) -> f64 {
        self.y[(y - self.lower[1]) as usize] * self.z[(z - self.lower[2]) as usize]
    }

    pub(super) fn at(&self, [x, y, z]: [i64; 3]) -> f64 {
        self.x[(x - self.lower[0]) as usize] * self.row(y, z)
    }

    fn total(&self) -> f64 {
        [&self.x, &self.y, &self.z].iter().map(|axis| axis.iter().sum::<f64>()).product()
    }
}
