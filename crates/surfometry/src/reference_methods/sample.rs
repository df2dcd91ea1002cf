//! Samples: objects that the edge of the image cuts, as a part of something larger.

use super::{Prepared, ReferenceMethod, ReferenceValues};
use crate::tiling::IndexBox;
use crate::volume::Mask;
use serde::{Deserialize, Serialize};

/// Values of a sample in which the image's cuts are no part of the object. Of an object that no face of the
/// image cuts, the same as the plain ones.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SampleValues {
    /// A without the flat faces in which the image cuts the object, and their edges, as large as the method has
    /// them; never more than A.
    pub surface_area_without_cuts_mm2: Option<f64>,
    /// Of the surface, twice the solid's, in which every corner, edge and face of voxels counts by its share
    /// in the image: those on the image's faces a half, on its edges a quarter, in its corners an eighth
    /// (Odgaard and Gundersen 1993; BoneJ). No whole number.
    pub euler_characteristic_edge_corrected: Option<f64>,
}

/// How many voxels, of the geometric mean of the spacings, from a cut a method sees it.
const SEEN: f64 = 6.0;

impl SampleValues {
    /// By a method, which is also given [prepared](ReferenceMethod::prepared) for the mask's spacing, and says
    /// `values` of the closed object.
    pub fn new(
        method: &dyn ReferenceMethod,
        measure: &Prepared<'_>,
        mask: &Mask,
        values: &ReferenceValues,
    ) -> Self {
        let area_of = |mask: &Mask| measure(mask).surface_area_mm2.unwrap_or_default();
        let open = |area: f64| (area - area_of_cuts(area_of, mask)).clamp(0.0, area);
        Self {
            surface_area_without_cuts_mm2: values.surface_area_mm2.map(open),
            euler_characteristic_edge_corrected: method.edge_corrected_euler(mask),
        }
    }
}

/// Area of the voxels' faces in which the image cuts an object, by axis, at its first and last slice, mm^2.
#[cfg(feature = "io")]
pub(crate) fn cut_areas(mask: &Mask) -> [[f64; 2]; 3] {
    let spacing = mask.grid().spacing();
    let mut areas = [[0.0; 2]; 3];
    for (axis, upper) in cut_faces(mask) {
        let voxels = mask.on_bounds(mask.edge_slices(axis, upper, 1)).voxels();
        areas[axis][usize::from(upper)] = voxels as f64 * spacing.cell_volume() / spacing.mm()[axis];
    }
    areas
}

/// A face of the image: axis, and whether at its last slice.
type Face = (usize, bool);

/// The faces of the image that cut an object.
fn cut_faces(mask: &Mask) -> impl Iterator<Item = Face> {
    let (image, bounds) = (mask.grid().index_box(), mask.bounds());
    let faces = (0..3).flat_map(|axis| [(axis, false), (axis, true)]);
    faces.filter(move |_| !bounds.is_empty()).filter(move |&(axis, upper)| {
        if upper { bounds.upper[axis] == image.upper[axis] } else { bounds.lower[axis] == image.lower[axis] }
    })
}

/// What a method takes the area of all cuts for. The object without cuts is what is left when every axis is opened, one
/// after the other, and each opening takes away what is in the faces of that axis: so where faces meet, what was
/// taken away with both is given back, and at corners taken away again.
fn area_of_cuts(area_of: impl Fn(&Mask) -> f64 + Copy, mask: &Mask) -> f64 {
    let meeting = meeting_faces(&cut_faces(mask).collect::<Vec<_>>());
    let signed = |faces: &Vec<Face>| {
        let area = area_of_cut(area_of, mask, faces);
        if faces.len() % 2 == 1 { area } else { -area }
    };
    meeting.iter().map(signed).sum()
}

/// Faces by themselves, and those that meet in an edge or a corner.
fn meeting_faces(faces: &[Face]) -> Vec<Vec<Face>> {
    let grow = |mut meeting: Vec<Vec<Face>>, face: &Face| {
        let known = meeting.iter().filter(|others| others.iter().all(|other| other.0 != face.0));
        let new: Vec<Vec<Face>> = known.map(|others| [&others[..], &[*face]].concat()).collect();
        meeting.extend(new);
        meeting
    };
    let all = faces.iter().fold(vec![Vec::new()], grow);
    all.into_iter().filter(|faces| !faces.is_empty()).collect()
}

/// What a method takes the area of a cut face for: what half of the slices next to it and their mirror image
/// has less than the slices alone. In the whole the face is not there, and the other ends are there twice. Of
/// faces that meet, what is lost by that in each of them, one after the other.
fn area_of_cut(area_of: impl Fn(&Mask) -> f64, mask: &Mask, faces: &[Face]) -> f64 {
    let spacing = mask.grid().spacing();
    let next_to = |region: IndexBox, &(axis, upper): &Face| {
        let depth = libm::ceil(SEEN * spacing.geometric_mean() / spacing.mm()[axis]) as i64;
        region.intersection(&mask.edge_slices(axis, upper, depth))
    };
    let region = faces.iter().fold(mask.bounds(), next_to);
    let slices = mask.on_bounds(region);
    let mirrored = faces.iter().fold(vec![(1.0, region)], |wholes, &(axis, upper)| {
        let both =
            |(share, whole): (f64, IndexBox)| [(share, whole), (-0.5 * share, doubled(&whole, axis, upper))];
        wholes.into_iter().flat_map(both).collect()
    });
    mirrored.iter().map(|(share, whole)| share * area_of(&slices.continued(whole))).sum()
}

/// A box at a face of the image with its mirror image in that face.
fn doubled(region: &IndexBox, axis: usize, upper: bool) -> IndexBox {
    let mut whole = *region;
    let thickness = region.upper[axis] - region.lower[axis];
    if upper {
        whole.upper[axis] += thickness;
    } else {
        whole.lower[axis] -= thickness;
    }
    whole
}
