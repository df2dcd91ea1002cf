//! What an object's numbers are, part by part.

use super::regions::{PartSums, WIDER};
use super::{DescribedSurface, Measured, Object, SurfaceValues};
use crate::accuracy::{IntegralErrors, SHARED, of_average};
use crate::integrals::{Integrals, Partial};
use crate::volume::Spacing;

/// An object and its numbers.
pub(super) struct Whole<'a> {
    pub(super) object: &'a Object,
    pub(super) measured: &'a Measured,
    /// Of the image of regions.
    pub(super) region_spacing: Spacing,
}

/// What a part has by itself.
struct Part<'a> {
    sums: &'a PartSums,
    integrals: Integrals,
    /// V, A, M and the integral of K, before what the whole has beside them is shared out.
    own: [f64; 4],
}

/// V, A, M and the integrals of K and H^2 of a result.
fn numbers(values: &SurfaceValues) -> [Option<f64>; 5] {
    [
        values.volume_mm3,
        values.surface_area_mm2,
        values.total_mean_curvature_mm,
        values.total_gaussian_curvature,
        values.total_squared_mean_curvature,
    ]
}

fn values_of([volume, area, mean, gaussian, squared]: [Option<f64>; 5]) -> SurfaceValues {
    let average = |(mean, area): (f64, f64)| (area > 0.0).then_some(mean / area);
    SurfaceValues {
        volume_mm3: volume,
        surface_area_mm2: area,
        total_mean_curvature_mm: mean,
        average_mean_curvature_per_mm: mean.zip(area).and_then(average),
        total_gaussian_curvature: gaussian,
        euler_characteristic: None,
        total_squared_mean_curvature: squared,
    }
}

/// Values, standard errors and blurred values of each part.
///
/// A part has its own voxels and integrals, compensated as the whole is, which is linear in them. What the whole has beside
/// that (corrections, edges, the exact Euler characteristic) is shared out by area, and by curvature; so the parts add up.
pub(super) fn shared(whole: &Whole, sums: &[&PartSums]) -> Vec<[SurfaceValues; 3]> {
    let parts: Vec<Part> = sums.iter().map(|&sums| whole.part(sums)).collect();
    let weights: Vec<[f64; 4]> = parts.iter().map(Part::weights).collect();
    let of_whole = numbers(&whole.measured.values);
    let merged = sums.iter().fold(Partial::default(), |all, part| all.merged(&part.integrals));
    let merged = Integrals::of(&merged, whole.object.grid().spacing());
    let of_model = (whole.modelled(&merged), merged.surface.area);
    let total = |of: &dyn Fn(usize) -> f64| (0..parts.len()).map(of).sum::<f64>();
    let rest: [Option<f64>; 4] =
        std::array::from_fn(|n| of_whole[n].map(|all| all - total(&|p| parts[p].own[n])));
    let all: [f64; 4] = std::array::from_fn(|n| total(&|p| weights[p][n]));
    let share = |p: usize, n: usize| {
        rest[n]
            .map(|rest| if all[n] > 0.0 { rest * weights[p][n] / all[n] } else { rest / parts.len() as f64 })
    };
    let of_part = |p: usize| {
        let part = &parts[p];
        let shares: [Option<f64>; 4] = std::array::from_fn(|n| share(p, n));
        let value = |n: usize| shares[n].map(|share| part.own[n] + share);
        let blurred = SurfaceValues { euler_characteristic: None, ..SurfaceValues::of(&part.integrals) };
        let squared = of_whole[4].and(blurred.total_squared_mean_curvature);
        let values = values_of([value(0), value(1), value(2), value(3), squared]);
        let errors =
            whole.errors(part, of_model, &values, shares.map(|share| share.unwrap_or_default().abs()));
        [values, errors, blurred]
    };
    (0..parts.len()).map(of_part).collect()
}

impl Part<'_> {
    /// By what V, A, M and the integral of K of the whole are shared out.
    fn weights(&self) -> [f64; 4] {
        let surface = &self.integrals.surface;
        let curvature = (surface.area * surface.larger_squared).max(0.0).sqrt();
        [surface.area, surface.area, curvature, surface.larger_squared]
    }
}

impl Whole<'_> {
    fn part<'a>(&self, sums: &'a PartSums) -> Part<'a> {
        let setup = &self.object.setup;
        let spacing = setup.grid.spacing();
        let integrals = Integrals::of(&sums.integrals, spacing);
        let blurred = integrals.globals();
        let own = match self.measured.surface {
            DescribedSurface::Original => {
                let terms = setup.compensation(Some(integrals), None);
                let own = terms.map_or(blurred, |terms| terms.added_to(&integrals));
                let counted = sums.voxels as f64 * spacing.cell_volume();
                let volume = if setup.soft.is_none() { counted } else { own.volume };
                [volume, own.area, own.total_mean_curvature]
            }
            DescribedSurface::Blurred | DescribedSurface::Given => {
                [blurred.volume, blurred.area, blurred.total_mean_curvature]
            }
        };
        let [volume, area, mean] = own;
        Part { sums, integrals, own: [volume, area, mean, integrals.surface.total_gaussian_curvature] }
    }

    /// Standard errors of a part: of its own integrals by the model, as much longer as the whole's are than the model has them, or
    /// as much shorter, but no less than the whole's times the root of the share of its area, as of errors that places have for
    /// themselves; what was shared out, as far as it may be another part's; where the border lies; and what of K the blur carried across
    /// it. Null where the whole's are.
    fn errors(
        &self,
        part: &Part,
        (whole, area): ([f64; 4], f64),
        values: &SurfaceValues,
        shares: [f64; 4],
    ) -> SurfaceValues {
        let of_whole = numbers(&self.measured.standard_error);
        let own = self.modelled(&part.integrals);
        let border = self.border(part);
        let carried = [0.0, 0.0, 0.0, self.carried(part)];
        let share = if area > 0.0 { (part.integrals.surface.area / area).min(1.0) } else { 1.0 };
        let error = |n: usize| {
            let known = of_whole[n]?;
            let longer = if whole[n] > 0.0 { known / whole[n] } else { 1.0 };
            let own =
                if longer < 1.0 { (own[n] * longer).max(known * share.sqrt()) } else { own[n] * longer };
            let shared_out = shares[n] * (1.0 - share);
            Some([shared_out, border[n], carried[n]].into_iter().fold(own, libm::hypot))
        };
        let [volume, area, mean, gaussian] = std::array::from_fn(error);
        let average = || {
            let known =
                [values.surface_area_mm2.filter(|area| *area > 0.0)?, values.total_mean_curvature_mm?];
            // The border takes as much of one as of the other.
            Some(of_average(known, [area?, mean?], SHARED))
        };
        let errors = values_of([volume, area, mean, gaussian, None]);
        SurfaceValues { average_mean_curvature_per_mm: average(), ..errors }
    }

    /// How much of the integral of K the blur carried across the part's border: where K jumps there, as from a capsule's tube to
    /// its caps, sigma / sqrt(2 pi) of the jump a unit of length. In proportion to sigma, so a wider blur tells it. (Of V and A it
    /// carries nothing to first order, and of M less than the border's place is worth.)
    fn carried(&self, part: &Part) -> f64 {
        let wider = part.sums.at_wider_blur.as_ref();
        let wider = wider.map(|sums| Integrals::of(sums, self.object.grid().spacing()));
        wider.filter(Integrals::has_surface).map_or(0.0, |wider| {
            let here = part.integrals.surface.total_gaussian_curvature;
            (wider.surface.total_gaussian_curvature - here).abs() / (WIDER - 1.0)
        })
    }

    /// Standard errors of V, A, M and the integral of K by the model; 0 where there is none.
    fn modelled(&self, integrals: &Integrals) -> [f64; 4] {
        let model = self.object.setup.error_model(integrals).filter(|_| integrals.has_surface());
        model.map_or([0.0; 4], |model| four(&model.compensated(integrals, [0.0; 2])))
    }

    /// What V, A, M and the integral of K hang on where the border of a part lies, which is known to a voxel of the object and
    /// one of the regions alone.
    fn border(&self, part: &Part) -> [f64; 4] {
        let (spacing, regions) = (self.object.grid().spacing(), self.region_spacing.largest());
        let off = spacing.mm().map(|h| libm::hypot(h, regions) / libm::sqrt(12.0));
        let border = &part.sums.border;
        let face = |a: usize| border.faces[a] as f64 * spacing.cell_volume() / spacing.mm()[a] * off[a];
        let line = |a: usize, n: usize| border.lengths[a][n] * off[a];
        // As of a plane, whose faces by axis are a vector's parts.
        let all = |of: &dyn Fn(usize) -> f64| (0..3).map(of).fold(0.0, libm::hypot);
        [all(&face), all(&|a| line(a, 0)), all(&|a| line(a, 1)), all(&|a| line(a, 2))]
    }
}

fn four(errors: &IntegralErrors) -> [f64; 4] {
    [errors.volume, errors.area, errors.total_mean_curvature, errors.total_gaussian_curvature]
}
