//! What the viewer of one object shows: its surface with what is known at its vertices, and the places that are told of.

use super::display_mesh::DisplayMesh;
use super::nearest::Nearest;
use super::packed::{Packed, Packer, Quantised};
use super::page_share::PageShare;
use super::slices::{SliceStack, phi_of, slice_stacks};
use crate::accuracy::CurvatureErrors;
use crate::measurement::Object;
use crate::space::{dot, minus};
use crate::surface::{LocalQuantity, Surface, VertexGeometry};
use crate::tiling::IndexBox;
use crate::volume::Affine;
use serde::Serialize;
use std::io;

/// A surface and what it describes.
pub(super) struct NamedSurface<'a> {
    /// `original` or `blurred`, or `given` where there is no blur.
    pub(super) name: &'static str,
    pub(super) surface: &'a Surface,
}

/// Where all of a scene is in its packer.
#[derive(Debug, Serialize)]
struct Head {
    /// Triangles and vertices of the surface, of which fewer may be shown.
    of_triangles: usize,
    of_vertices: usize,
    #[serde(flatten)]
    shape: Shape,
    layers: Vec<Layer>,
    /// From the vertices to the other surface, mm, positive outward.
    distance: Option<Distance>,
    /// How far the blur moved the surface, mm.
    displacement: Option<Quantised>,
    /// Blur at which curvature was taken, mm, where each vertex has its own.
    curvature_sigma: Option<Quantised>,
    clouds: Vec<Cloud>,
    slices: Vec<SliceStack>,
    /// The smeared delta at each whole number that a slice has for phi, and the phi of the largest.
    delta: Vec<f64>,
    phi_reach: f64,
    /// From voxels to the world.
    linear: [[f64; 3]; 3],
    origin: [f64; 3],
}

#[derive(Debug, Serialize)]
struct Shape {
    /// World coordinates of the vertices.
    positions: [Quantised; 3],
    /// Two bytes a vertex: the normal on an octahedron.
    normals: Packed,
    /// Three vertices a triangle.
    triangles: Packed,
}

/// Curvature of one surface at the vertices.
#[derive(Debug, Serialize)]
struct Layer {
    of: &'static str,
    k1: Quantised,
    k2: Quantised,
    errors: Vec<(&'static str, Quantised)>,
}

#[derive(Debug, Serialize)]
struct Distance {
    to: &'static str,
    values: Quantised,
    /// Beyond it there is nothing of the other surface that could be meant, mm.
    reach: f64,
}

/// Voxels of a kind.
#[derive(Debug, Serialize)]
struct Cloud {
    kind: &'static str,
    /// How many there are; some may be left out.
    count: usize,
    /// Voxel indices, three a voxel.
    voxels: Packed,
}

/// Whole numbers that the middle half of a quantity's values are told apart by, at least.
const LEVELS: f64 = 240.0;
/// Steps of positions in the smallest spacing.
const STEPS_OF_SPACING: f64 = 48.0;
/// How far the other surface may be away, in largest spacings.
const REACH: f64 = 2.0;

/// Everything of an object's viewer as text; `None` where there is no surface.
pub(super) fn scene(
    object: &Object,
    shown: &NamedSurface,
    other: Option<&NamedSurface>,
    share: PageShare,
) -> io::Result<Option<(String, DisplayMesh)>> {
    let surface = shown.surface;
    if surface.is_empty() {
        return Ok(None);
    }
    let mesh = DisplayMesh::of(surface, share.triangles());
    let mut packer = Packer::default();
    let spacing = object.grid().spacing();
    let shape = Shape::of(&mut packer, surface, &mesh, spacing.smallest() / STEPS_OF_SPACING);
    let own: Vec<Option<usize>> = mesh.vertices.iter().map(|&v| Some(v as usize)).collect();
    let mut layers = vec![layer(&mut packer, shown, &own)];
    let mut distance = None;
    if let Some(other) = other.filter(|other| !other.surface.is_empty()) {
        let reach = REACH * spacing.largest();
        let nearest = Nearest::of(&other.surface.mesh.vertices, reach);
        let found = mesh.vertices.iter().map(|&v| nearest.to(surface.mesh.vertices[v as usize]));
        let found: Vec<Option<usize>> = found.collect();
        layers.push(layer(&mut packer, other, &found));
        let away = even(&mut packer, &distances(surface, &mesh.vertices, other.surface, &found));
        distance = Some(Distance { to: other.name, values: away, reach });
    }
    let mut known = |of: fn(&VertexGeometry) -> Option<f64>| {
        values(surface, &mesh.vertices, of).map(|values| even(&mut packer, &values))
    };
    let displacement = known(|vertex| vertex.displacement);
    let curvature_sigma = known(|vertex| vertex.curvature_sigma.map(f64::from));
    let phi_reach = phi_reach(object);
    let Affine { linear, origin } = *object.grid().affine();
    let head = Head {
        of_triangles: surface.mesh.triangles.len(),
        of_vertices: surface.mesh.vertices.len(),
        shape,
        layers,
        distance,
        displacement,
        curvature_sigma,
        clouds: clouds(&mut packer, object, share.wrong_voxels()),
        slices: slice_stacks(&mut packer, object, phi_reach, share.pixels()),
        delta: (0..=u8::MAX).map(|byte| object.delta().delta(phi_of(byte, phi_reach))).collect(),
        phi_reach,
        linear,
        origin,
    };
    Ok(Some((packer.finish(&head)?, mesh)))
}

impl Shape {
    fn of(packer: &mut Packer, surface: &Surface, mesh: &DisplayMesh, step: f64) -> Self {
        let vertices = || mesh.vertices.iter().map(|&v| v as usize);
        let positions = [0, 1, 2].map(|a| {
            let along: Vec<f64> = vertices().map(|v| surface.mesh.vertices[v][a]).collect();
            packer.quantised(&along, step)
        });
        let normals: Vec<u8> = vertices().flat_map(|v| octahedral(surface.vertices[v].normal)).collect();
        let normals = packer.bytes(&normals);
        Self { positions, normals, triangles: packer.integers(mesh.triangles.iter().flatten().copied()) }
    }
}

/// From vertices of a surface to those that were found on another one, along the normal; NaN where none was.
fn distances(surface: &Surface, vertices: &[u32], other: &Surface, found: &[Option<usize>]) -> Vec<f64> {
    let distance = |(&vertex, &found): (&u32, &Option<usize>)| {
        let from = surface.mesh.vertices[vertex as usize];
        let away = minus(other.mesh.vertices[found?], from);
        Some(dot(away, surface.vertices[vertex as usize].normal))
    };
    vertices.iter().zip(found).map(|pair| distance(pair).unwrap_or(f64::NAN)).collect()
}

/// A number at vertices; `None` where none has it, NaN where curvature is not known.
fn values(
    surface: &Surface,
    vertices: &[u32],
    of: impl Fn(&VertexGeometry) -> Option<f64>,
) -> Option<Vec<f64>> {
    let value =
        |v: &u32| Some(&surface.vertices[*v as usize]).filter(|vertex| vertex.has_normal).and_then(&of);
    let values: Vec<f64> = vertices.iter().map(|v| value(v).unwrap_or(f64::NAN)).collect();
    values.iter().any(|value| value.is_finite()).then_some(values)
}

/// A number of a vertex' standard errors.
type OfErrors = fn(&CurvatureErrors) -> f32;

const ERRORS: [(LocalQuantity, OfErrors); 4] = [
    (LocalQuantity::MeanCurvature, |e| e.mean_curvature),
    (LocalQuantity::GaussianCurvature, |e| e.gaussian_curvature),
    (LocalQuantity::K1, |e| e.principal),
    (LocalQuantity::ShapeIndex, |e| e.shape_index),
];

/// Curvature of a surface at some of its vertices.
fn layer(packer: &mut Packer, named: &NamedSurface, vertices: &[Option<usize>]) -> Layer {
    let known = |v: &Option<usize>| Some(&named.surface.vertices[(*v)?]).filter(|vertex| vertex.has_normal);
    let mut pack = |of: &dyn Fn(&VertexGeometry) -> Option<f64>| {
        let value = |v| known(v).and_then(of).unwrap_or(f64::NAN);
        even(packer, &vertices.iter().map(value).collect::<Vec<_>>())
    };
    let (k1, k2) = (pack(&|v| LocalQuantity::K1.at(v)), pack(&|v| LocalQuantity::K2.at(v)));
    let has_errors = named.surface.vertices.iter().any(|vertex| vertex.errors.is_some());
    let errors = ERRORS.into_iter().filter(|_| has_errors);
    let errors = errors.map(|(quantity, error)| {
        (quantity.name(), pack(&|v| v.errors.map(|errors| f64::from(error(&errors)))))
    });
    Layer { of: named.name, k1, k2, errors: errors.collect() }
}

/// Values in steps by which most of them are told apart.
fn even(packer: &mut Packer, values: &[f64]) -> Quantised {
    let mut finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let quantile = |finite: &mut Vec<f64>, share: f64| {
        let place = (share * (finite.len() - 1) as f64) as usize;
        *finite.select_nth_unstable_by(place, f64::total_cmp).1
    };
    let step = if finite.is_empty() {
        0.0
    } else {
        (quantile(&mut finite, 0.9) - quantile(&mut finite, 0.1)) / LEVELS
    };
    packer.quantised(values, step)
}

/// A direction as a place on the faces of an octahedron (Meyer et al. 2010).
fn octahedral([x, y, z]: [f64; 3]) -> [u8; 2] {
    let sum = (x.abs() + y.abs() + z.abs()).max(f64::MIN_POSITIVE);
    let folded =
        |a: f64, b: f64| if z >= 0.0 { a } else { (1.0 - b.abs()) * if a < 0.0 { -1.0 } else { 1.0 } };
    let (u, v) = (x / sum, y / sum);
    [folded(u, v), folded(v, u)].map(|c| libm::round(127.5 * (c + 1.0)) as u8)
}

/// |phi| that slices tell apart: the band, and what is around it.
fn phi_reach(object: &Object) -> f64 {
    let level = object.parameters().level.unwrap_or_default();
    level.max(1.6 * object.delta().half_width())
}

/// Voxels that the blur takes and adds, and those at which the image cuts the object.
fn clouds(packer: &mut Packer, object: &Object, most: usize) -> Vec<Cloud> {
    let wrong = object.wrong_sides();
    let kinds = [("lost", wrong.lost), ("filled", wrong.filled), ("cut", cut_voxels(object))];
    let cloud = |(kind, voxels): (&'static str, Vec<[i64; 3]>)| {
        let every = voxels.len().div_ceil(most.max(1)).max(1);
        let shown = voxels.iter().step_by(every).flatten().map(|&index| index.max(0) as u32);
        Cloud { kind, count: voxels.len(), voxels: packer.integers(shown) }
    };
    kinds.into_iter().filter(|(_, voxels)| !voxels.is_empty()).map(cloud).collect()
}

/// The object's voxels in the image's first and last slices.
fn cut_voxels(object: &Object) -> Vec<[i64; 3]> {
    let all = object.grid().index_box();
    let bounds = object.mask().bounds();
    let mut found = Vec::new();
    for axis in 0..3 {
        for edge in [all.lower[axis], all.upper[axis] - 1] {
            let mut side = bounds;
            (side.lower[axis], side.upper[axis]) = (edge, edge + 1);
            found.extend(voxels_in(object, &side.intersection(&bounds)));
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

fn voxels_in(object: &Object, region: &IndexBox) -> Vec<[i64; 3]> {
    let range = (region.lower[0], region.upper[0]);
    let row = |(y, z)| {
        let runs = object.mask().runs_within(y, z, range);
        runs.flat_map(move |(a, b)| (a..b).map(move |x| [x, y, z]))
    };
    region.rows().flat_map(row).collect()
}
