//! The columns of tables: the same for every row, whatever an object has.

const VALUES: &[&str] = &[
    "volume_mm3",
    "surface_area_mm2",
    "total_mean_curvature_mm",
    "average_mean_curvature_per_mm",
    "total_gaussian_curvature",
    "euler_characteristic",
    "total_squared_mean_curvature",
];
const TRUTH: &[&str] = VALUES.split_at(6).0;
const AXES: &[&str] = &["x", "y", "z"];
const BOX: &[&str] = &["min_x", "min_y", "min_z", "max_x", "max_y", "max_z"];

/// Columns with a common beginning; an empty one stands for none.
pub(super) type Group = (&'static str, &'static [&'static str]);

/// Of a [`Record`](super::Record).
pub(super) const RECORD: [Group; 24] = [
    ("", &["input", "label", "name", "component", "surface"]),
    ("", VALUES),
    ("standard_error", VALUES),
    ("blurred", VALUES),
    ("blurred_grid_noise", VALUES),
    ("mesh", &["volume_mm3", "surface_area_mm2", "vertices", "triangles"]),
    ("voxels", &["count", "volume_mm3"]),
    ("voxels_centroid_mm", AXES),
    ("voxels", &["cut_area_mm2"]),
    ("voxels_bounding_box", BOX),
    (
        "topology",
        &[
            "euler_characteristic_mesh",
            "euler_characteristic_voxels_26",
            "euler_characteristic_voxels_6",
            "components",
            "cavities",
            "handles",
            "euler_characteristic_expected",
            "changes",
        ],
    ),
    ("clip", &["mode", "rim_mm"]),
    ("clip_region", BOX),
    ("clip", &["voxel_volume_mm3", "section_area_mm2", "boundary_curvature"]),
    (
        "parameters",
        &[
            "embedding",
            "derivatives",
            "quadrature",
            "delta",
            "sigma_mm",
            "thickness_mm",
            "level",
            "epsilon",
            "clip",
            "padding",
        ],
    ),
    ("grid_dimensions", AXES),
    ("grid_spacing_mm", AXES),
    ("recovery", &["beside", "violated", "corrected", "left", "refused", "noise", "noisy"]),
    ("", &["flags"]),
    ("truth", TRUTH),
    ("preparation_threshold", &["low", "high"]),
    (
        "preparation",
        &["largest_component", "fill_cavities", "dropped_pieces", "dropped_voxels", "filled_voxels"],
    ),
    ("", &["curvature_sigma_mm"]),
    ("", &["input_sha256", "read_seconds", "seconds"]),
];

/// Of a [`ReferenceRecord`](super::ReferenceRecord).
pub(super) const REFERENCE: [Group; 7] = [
    ("", &["input", "label", "method", "name"]),
    ("", VALUES.split_at(4).0),
    ("", &["euler_characteristic", "structure_model_index"]),
    ("", &["surface_area_without_cuts_mm2", "euler_characteristic_edge_corrected"]),
    ("", &["bone_volume_fraction", "specific_surface_per_mm", "connectivity_density_per_mm3"]),
    ("", &["specific_surface_without_cuts_per_mm", "connectivity_density_edge_corrected_per_mm3", "flags"]),
    ("truth", TRUTH),
];

/// The names that groups stand for.
pub(super) fn columns(groups: &[Group]) -> Vec<String> {
    let name = |group: &str, part: &str| {
        if group.is_empty() { part.to_owned() } else { format!("{group}_{part}") }
    };
    groups.iter().flat_map(|(group, parts)| parts.iter().map(move |part| name(group, part))).collect()
}
