//! Files of kinds that are known and not read: what they are, and what helps.

use super::folder::{name_of, visible};
use super::{ReadError, foreign};
use std::collections::BTreeMap;
use std::path::Path;

/// Pictures by the endings of their names, and what helps.
const PICTURES: [(&[&str], &str); 2] = [
    (&[".bmp", ".gif", ".jp2", ".pgm"], "convert the slices to a folder of PNG or TIFF files"),
    (
        &[".jpg", ".jpeg"],
        "JPEG changes values, so that labels are damaged; export the slices again, to a folder of PNG or TIFF files",
    ),
];

/// Meshes by the endings of their names.
const MESHES: [(&str, &str); 12] = [
    (".gltf", "a mesh as glTF in text"),
    (".vtu", "a mesh of cells (VTK's unstructured grid), of which the surface is wanted"),
    (".msh", "a mesh of Gmsh or ANSYS"),
    (".mesh", "a mesh"),
    (".3mf", "a mesh as 3MF"),
    (".amf", "a mesh as AMF"),
    (".dae", "a mesh as COLLADA"),
    (".fbx", "a mesh as FBX"),
    (".wrl", "a mesh as VRML"),
    (".x3d", "a mesh as X3D"),
    (".ctm", "a mesh as OpenCTM"),
    (".blend", "a scene of Blender"),
];

/// Why a file is not read that is of one of these kinds.
pub(super) fn of_file(path: &Path) -> Option<ReadError> {
    let name = name_of(path).to_lowercase();
    if let Some((ending, cure)) = picture(&name) {
        return Some(ReadError::UnknownFormat(format!("a {ending} picture, which is not read: {cure}")));
    }
    let by_name = MESHES.iter().find(|(ending, _)| name.ends_with(*ending)).map(|(_, kind)| *kind);
    let by_content = || foreign::content(path).filter(|kind| *kind == foreign::FREESURFER_SURFACE);
    by_name.or_else(by_content).map(|kind| ReadError::UnreadMesh { kind })
}

/// Why a folder is not read that holds pictures: of several kinds the one of most files is told.
pub(super) fn of_folder(folder: &Path) -> Result<Option<ReadError>, ReadError> {
    let mut counts = BTreeMap::new();
    for kind in visible(folder)?.iter().filter_map(|path| picture(&name_of(path).to_lowercase())) {
        *counts.entry(kind).or_insert(0usize) += 1;
    }
    let most = counts.into_iter().max_by_key(|(_, count)| *count);
    Ok(most.map(|((ending, cure), count)| {
        let files = if count == 1 { "picture, which is" } else { "pictures, which are" };
        ReadError::UnknownFormat(format!("a folder of {count} {ending} {files} not read: {cure}"))
    }))
}

/// The ending of a picture, and what helps.
fn picture(name: &str) -> Option<(&'static str, &'static str)> {
    PICTURES.iter().find_map(|(endings, cure)| {
        let ending = endings.iter().find(|ending| name.ends_with(**ending))?;
        Some((*ending, *cure))
    })
}
