//! From one surface to another: how far, and how curvature changes.

use super::closest_point::{ClosestPoint, ClosestPoints};
use super::spread_mean::SpreadMean;
use super::{Distribution, LocalQuantity, Mesh, Moments, QUANTILES, Surface, VertexGeometry};
use crate::accuracy::PositionNoise;
use crate::space::{dot, length, minus};
use crate::volume::FieldOfView;
use rayon::prelude::*;
use serde::Serialize;

/// Edge of the lattice over which variances of places are averaged, in sigma: where a surface is curved, a blur averages over
/// normals.
const VARIANCES_OVER: f64 = 2.5;

/// What a later surface is like where it is closest to a vertex: not a number where that is not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VertexChange {
    /// Distance to it, mm: positive where it lies outside, negative inside.
    pub distance: f32,
    /// Standard error of that, mm, by where the voxels of both masks happen to lie; `None` where no model of it holds
    /// ([`Object::position_noise`](crate::measurement::Object::position_noise)).
    pub distance_error: Option<f32>,
    /// Change of H, 1/mm.
    pub mean_curvature: f32,
    /// Standard error of that, 1/mm; `None` where one of the two has none.
    pub mean_curvature_error: Option<f32>,
}

/// A surface, and how far it may be off.
#[derive(Clone, Copy)]
pub struct Placed<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// Of its object: [`Object::position_noise`](crate::measurement::Object::position_noise).
    pub noise: Option<&'a PositionNoise>,
    /// Where it is known: [`Object::field_of_view`](crate::measurement::Object::field_of_view); everywhere where `None`.
    pub known: Option<FieldOfView>,
}

/// The change from one surface to a later one as a whole, by area of the first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SurfaceChange {
    /// Share of the area of the first surface on which it is not known, and which is in none of these numbers.
    pub share_without_distance: f64,
    /// Of the later surface, outward positive, mm.
    pub distance_mm: ChangeMoments,
    /// Of H, 1/mm.
    pub mean_curvature_change_per_mm: ChangeMoments,
    /// Distance, mm, that 95 % of the area of each are within of the other: the larger of both.
    pub hausdorff_95_mm: f64,
    /// The same of all of the area.
    pub hausdorff_mm: f64,
}

/// How a change is distributed over a surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChangeMoments {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
    /// Root mean square.
    pub rms: f64,
    /// Values below which the shares [`QUANTILES`] of the area lie.
    pub quantiles: [f64; QUANTILES.len()],
    /// Rms that two masks of one object would have; `None` where no model of it holds.
    pub noise_rms: Option<f64>,
    /// Share of the area on which the change is larger than two standard errors: of two masks of one object 0.05, about.
    pub share_beyond_noise: Option<f64>,
}

impl Surface {
    /// What a later surface is like where it is closest to each vertex. `None` where it is empty.
    ///
    /// Distances are those to the nearest of all its triangles, with what the curved surface over it rises by, and from
    /// surfaces whose shift by a blur is taken off. The nearest point need not be the one that a vertex has moved to. Nothing is
    /// known at a vertex where either surface is not, and where the nearest point is one that an image's edge made.
    pub fn changes_to(first: Placed, later: Placed) -> Option<Vec<VertexChange>> {
        if later.surface.is_empty() {
            return None;
        }
        let closest = ClosestPoints::new(&later.surface.mesh);
        let variances = first.variances().zip(later.variances());
        let change = |number: usize| {
            let place = first.surface.mesh.vertices[number];
            let point = closest.to(place)?;
            let distance_error = variances.as_ref().map(|(here, there)| {
                (here[number][0] + point.between(|corner| there[corner][0])).sqrt() as f32
            });
            let change =
                VertexChange { distance_error, ..changed(first.surface, number, later.surface, &point) };
            let there = point.vector_between(|corner| later.surface.mesh.vertices[corner]);
            let is_known = first.is_known(place) && later.is_known(place) && later.is_known(there);
            Some(if is_known { change } else { change.unknown() })
        };
        (0..first.surface.vertices.len()).into_par_iter().map(change).collect()
    }

    /// Keeps a change at each vertex, so that it is among the arrays, distributions and what pictures show.
    pub fn set_changes(&mut self, changes: &[VertexChange]) {
        for (vertex, change) in self.vertices.iter_mut().zip(changes) {
            vertex.change = Some(*change);
        }
        self.forget_distributions();
    }

    /// The change as a whole, of a surface that has it at its vertices, and of what the later one has from it; `None` where
    /// there is none.
    pub fn change(&self, later: &Self, from_later: &[VertexChange]) -> Option<SurfaceChange> {
        let distances = |surface: &Self, of: &dyn Fn(usize) -> Option<f64>| {
            let areas = surface.weights();
            let far: Option<Vec<f64>> = (0..areas.len()).map(|n| of(n).map(f64::abs)).collect();
            let known = far?.into_iter().zip(areas).filter(|(far, _)| !far.is_nan());
            let (far, areas): (Vec<f64>, Vec<f64>) = known.unzip();
            Some(Distribution::of(LocalQuantity::Distance.name(), &far, &areas)?.by_area)
        };
        let there = distances(self, &|n| self.vertices[n].change.map(|c| f64::from(c.distance)))?;
        let back = distances(later, &|n| from_later.get(n).map(|c| f64::from(c.distance)))?;
        let within = QUANTILES.iter().position(|&share| share == 0.95)?;
        Some(SurfaceChange {
            share_without_distance: self.share_without_distance(),
            distance_mm: self.moments_of_change(LocalQuantity::Distance)?,
            mean_curvature_change_per_mm: self.moments_of_change(LocalQuantity::MeanCurvatureChange)?,
            hausdorff_95_mm: there.quantiles[within].max(back.quantiles[within]),
            hausdorff_mm: there.maximum.max(back.maximum),
        })
    }

    /// Share of the area at whose vertices no change is known.
    fn share_without_distance(&self) -> f64 {
        let areas = self.weights();
        let known = self.vertices.iter().zip(&areas).filter(|(vertex, _)| vertex.has_known_change());
        1.0 - known.map(|(_, area)| area).sum::<f64>() / areas.iter().sum::<f64>()
    }

    /// How a quantity of the change is distributed, of a surface that has it at its vertices.
    pub(crate) fn moments_of_change(&self, quantity: LocalQuantity) -> Option<ChangeMoments> {
        let error: fn(&VertexChange) -> Option<f32> = match quantity {
            LocalQuantity::Distance => |change| change.distance_error,
            LocalQuantity::MeanCurvatureChange => |change| change.mean_curvature_error,
            _ => return None,
        };
        let Moments { mean, standard_deviation, quantiles, .. } = self.distribution(quantity)?.by_area;
        let known: Vec<(&VertexGeometry, f64)> = self
            .vertices
            .iter()
            .zip(self.weights())
            .filter(|(vertex, _)| vertex.has_known_change())
            .collect();
        let whole: f64 = known.iter().map(|(_, area)| area).sum();
        let by_area = |of: &dyn Fn(f64, f64) -> f64| {
            let weighed = known.iter().map(|(vertex, area)| {
                let error = f64::from(error(vertex.change.as_ref()?)?);
                Some(area * of(quantity.at(vertex)?, error))
            });
            Some(weighed.sum::<Option<f64>>()? / whole)
        };
        let is_beyond = |change: f64, error: f64| f64::from(u8::from(change.abs() > 2.0 * error));
        Some(ChangeMoments {
            mean,
            standard_deviation,
            rms: libm::hypot(mean, standard_deviation),
            quantiles,
            noise_rms: by_area(&|_, error| error * error).map(f64::sqrt),
            share_beyond_noise: by_area(&is_beyond),
        })
    }
}

impl VertexChange {
    /// The same where nothing is known.
    fn unknown(self) -> Self {
        let unknown = |error: Option<f32>| error.map(|_| f32::NAN);
        Self {
            distance: f32::NAN,
            distance_error: unknown(self.distance_error),
            mean_curvature: f32::NAN,
            mean_curvature_error: unknown(self.mean_curvature_error),
        }
    }
}

impl VertexGeometry {
    fn has_known_change(&self) -> bool {
        self.change.is_some_and(|change| !change.distance.is_nan())
    }
}

impl Placed<'_> {
    fn is_known(&self, place: [f64; 3]) -> bool {
        self.known.is_none_or(|known| known.contains(place))
    }

    /// Variance of each vertex' place along the normal, mm^2; `None` where no model of it holds.
    fn variances(&self) -> Option<Vec<[f64; 1]>> {
        let (noise, Mesh { vertices: places, .. }) = (self.noise?, &self.surface.mesh);
        let vertices = self.surface.vertices.par_iter();
        let own = vertices
            .map(|v| [noise.variance(v.normal, v.curvature_sigma.map(f64::from))])
            .collect::<Vec<_>>();
        let around = SpreadMean::new(places, VARIANCES_OVER * noise.sigma());
        Some(around.of(&own, &self.surface.mesh.vertex_areas()))
    }
}

/// What a later surface is like at its point closest to a vertex, by its number.
fn changed(first: &Surface, number: usize, later: &Surface, point: &ClosestPoint) -> VertexChange {
    let (vertex, place) = (&first.vertices[number], first.mesh.vertices[number]);
    let (vertices, places) = (&later.vertices, &later.mesh.vertices);
    let there = point.vector_between(|corner| places[corner]);
    let normal = point.vector_between(|corner| vertices[corner].normal);
    let apart = minus(there, place);
    let flat = length(apart).copysign(dot(apart, normal));
    // The curved surface over the triangle lies half-way to the tangent planes at its corners: exact to second order.
    let rise = -0.5 * point.between(|corner| dot(minus(there, places[corner]), vertices[corner].normal));
    let shifted = |vertex: &VertexGeometry| vertex.displacement.unwrap_or_default();
    let shift = shifted(vertex) - point.between(|corner| shifted(&vertices[corner]));
    let of_curvature = |vertex: &VertexGeometry| vertex.errors.map(|errors| f64::from(errors.mean_curvature));
    let mean_curvature_error = of_curvature(vertex)
        .zip(of_curvature(&vertices[point.nearest_corner()]))
        .map(|(error, later_error)| libm::hypot(error, later_error) as f32);
    let mean_curvature = point.between(|corner| vertices[corner].curvature.mean_curvature);
    VertexChange {
        distance: (flat + rise + shift) as f32,
        distance_error: None,
        mean_curvature: (mean_curvature - vertex.curvature.mean_curvature) as f32,
        mean_curvature_error,
    }
}
