//! A folder of masks, a class a file, as TotalSegmentator and others write them: one image of segments with the files' names.

use super::folder::{name_of, visible};
use super::known_stem;
use super::overlay::{Layer, Layers, Overlay};
use super::{Format, ImageHeader, ReadError, Voxels};
use crate::volume::{Affine, LabelTable, ScalarType};
use std::path::{Path, PathBuf};

/// Reads the headers of all images in a folder. Their names, in order, are those of segments 1, 2, 3, ..
pub(super) fn read_header(folder: &Path) -> Result<ImageHeader, ReadError> {
    let files = masks(folder)?;
    let mut headers = Vec::new();
    for file in &files {
        let header = super::read_header(file).map_err(|source| ReadError::in_file(file, source))?;
        if let Some(first) = headers.first() {
            check_same_lattice(first, &header)?;
        }
        headers.push(header);
    }
    let Some(first) = headers.first().cloned() else {
        return Err(ReadError::UnknownFormat("the folder holds no image".to_owned()));
    };
    let name = |file: &PathBuf| known_stem(&name_of(file)).to_owned();
    let labels: LabelTable = (1..).zip(files.iter().map(name)).collect();
    let layers = |(header, number)| Layers { header, layers: vec![Layer::Mask(number)] };
    let images = headers.into_iter().zip(1..).map(layers).collect();
    let data = Voxels::Assembled(Overlay::assembled(images, first.dimensions, [[0; 2]; 3]));
    Ok(ImageHeader {
        path: folder.to_owned(),
        format: Format::MaskFolder,
        scalar: ScalarType::I32,
        labels,
        data,
        ..first
    })
}

/// Images in a folder by their names, in order; the second file of a pair counts with the first, hidden ones not.
pub(super) fn masks(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let is_mask = |path: &PathBuf| {
        let name = name_of(path).to_lowercase();
        let second = [".img", ".img.gz", ".img.bz2"].iter().any(|ending| name.ends_with(ending));
        // A folder of TIFF files is one of slices.
        let is_image = Format::of_name(path).is_some_and(|format| format != Format::Tiff);
        !second && path.is_file() && is_image
    };
    Ok(visible(folder)?.into_iter().filter(is_mask).collect())
}

/// Part of a voxel by which places may differ: headers have single precision.
const SLACK: f64 = 0.05;

fn check_same_lattice(first: &ImageHeader, other: &ImageHeader) -> Result<(), ReadError> {
    let near = |a: &Affine, b: &Affine| {
        let corner = |n: usize| {
            std::array::from_fn(|a| if n >> a & 1 == 1 { first.dimensions[a] as f64 } else { 0.0 })
        };
        let smallest = a.column_lengths().into_iter().fold(f64::INFINITY, f64::min);
        (0..8).map(corner).all(|at| {
            let [p, q] = [a.apply(at), b.apply(at)];
            (0..3).all(|w| (p[w] - q[w]).abs() <= SLACK * smallest)
        })
    };
    let same_place = match (&first.affine, &other.affine) {
        (Some(a), Some(b)) => near(a, b),
        (a, b) => a.is_none() && b.is_none(),
    };
    if first.dimensions == other.dimensions && same_place {
        return Ok(());
    }
    Err(ReadError::OtherLattice { first: first.path.clone(), other: other.path.clone() })
}
