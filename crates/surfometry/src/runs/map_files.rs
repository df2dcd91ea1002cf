//! Files that show one object: meshes, voxel maps, pictures.

use super::{InputError, InputObject, with_parts};
use crate::io::{MeshDocument, MeshFormat, write_mesh, write_voxel_map, write_whole};
use crate::measurement::VoxelQuantity;
use crate::pictures::{PictureKind, PictureStyle, color_scale, picture};
use crate::surface::Surface;
use std::io;
use std::path::{Path, PathBuf};

/// What a file of a map holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapFile {
    /// The mesh with its arrays.
    Mesh(MeshFormat),
    /// Voxel maps, a file each.
    Voxels,
    /// Pictures as PNG, a file each.
    Png,
    /// Pictures as SVG, a file each.
    Svg,
}

impl MapFile {
    /// Endings of the names of map files.
    pub const EXTENSIONS: &str = ".ply, .vtp, .stl, .obj, .glb, .gii, .csv, .nii, .nii.gz, .png, .svg";

    /// By a name's ending, in either case.
    pub fn of_path(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        let ends = |endings: &[&str]| endings.iter().any(|e| name.ends_with(e));
        if ends(&[".nii", ".nii.gz"]) {
            Some(Self::Voxels)
        } else if ends(&[".png"]) {
            Some(Self::Png)
        } else if ends(&[".svg"]) {
            Some(Self::Svg)
        } else {
            MeshFormat::of_path(path).map(Self::Mesh)
        }
    }
}

/// How the files of a map are made.
#[derive(Debug, Clone, PartialEq)]
pub struct MapStyle {
    /// Quantity, limit and views of colours and pictures; its title is replaced by the object's name.
    pub picture: PictureStyle,
    /// Kinds of pictures.
    pub pictures: Vec<PictureKind>,
    /// Pixels a picture unit; 1 is 96 dots per inch.
    pub dpi_scale: f64,
    /// Quantities of voxel maps.
    pub voxels: Vec<VoxelQuantity>,
    /// Files that must stay as they are: the run's inputs, canonical.
    pub protected: Vec<PathBuf>,
}

impl Default for MapStyle {
    /// H on the surface, from one oblique view at 192 dots per inch.
    fn default() -> Self {
        Self {
            picture: PictureStyle::default(),
            pictures: vec![PictureKind::Surface],
            dpi_scale: 2.0,
            voxels: vec![VoxelQuantity::MeanCurvature],
            protected: Vec::new(),
        }
    }
}

/// Writes one file, or several where several pictures or quantities are asked for; their names.
///
/// Where the input has several objects, `_label-N` goes before the ending.
///
/// # Errors
/// [`InputError`].
pub fn write_map_files(
    source: &InputObject,
    surface: &Surface,
    path: &Path,
    style: &MapStyle,
) -> Result<Vec<PathBuf>, InputError> {
    let file = MapFile::of_path(path).ok_or(InputError::Unfit("the file's name ends in no known format"))?;
    let label = source.label.as_ref().filter(|_| source.count > 1).map(|label| format!("label-{label}"));
    let path = with_parts(path, label.as_slice());
    match file {
        // Voxel maps show what is there instead.
        MapFile::Mesh(_) | MapFile::Png | MapFile::Svg if surface.is_empty() => Err(InputError::NoSurface),
        MapFile::Mesh(_) => mesh_files(source, surface, &path, style),
        MapFile::Voxels => voxel_files(source, &path, style),
        MapFile::Png | MapFile::Svg => picture_files(source, surface, &path, style, file),
    }
}

/// Refuses a file that would replace an input.
fn spare_inputs(path: &Path, style: &MapStyle) -> Result<(), InputError> {
    let replaces = path.canonicalize().is_ok_and(|path| style.protected.contains(&path));
    if replaces { Err(InputError::ReplacesInput { path: path.to_owned() }) } else { Ok(()) }
}

fn mesh_files(
    source: &InputObject,
    surface: &Surface,
    path: &Path,
    style: &MapStyle,
) -> Result<Vec<PathBuf>, InputError> {
    spare_inputs(path, style)?;
    let PictureStyle { quantity, limit, .. } = style.picture;
    let scale = color_scale(surface, quantity, limit);
    let colors = surface.values(quantity).map(|values| scale.colors(&values));
    let title = format!("surfometry {}: {}", env!("CARGO_PKG_VERSION"), source.title());
    let arrays = surface.arrays();
    let document =
        MeshDocument { mesh: &surface.mesh, arrays: &arrays, colors: colors.as_deref(), title: &title };
    write_mesh(path, &document).map_err(|e| written(path, e))
}

fn voxel_files(source: &InputObject, path: &Path, style: &MapStyle) -> Result<Vec<PathBuf>, InputError> {
    let grid = source.object.grid();
    let name = |quantity: VoxelQuantity| match style.voxels.len() {
        1 => path.to_owned(),
        _ => with_parts(path, &[quantity.name()]),
    };
    let write = |&quantity: &VoxelQuantity| {
        let map = source.object.voxel_map(quantity, &grid.index_box());
        let path = name(quantity);
        spare_inputs(&path, style)?;
        write_voxel_map(&path, grid, map.values(), quantity.name()).map_err(|e| written(&path, e))?;
        Ok(path)
    };
    style.voxels.iter().map(write).collect()
}

fn picture_files(
    source: &InputObject,
    surface: &Surface,
    path: &Path,
    style: &MapStyle,
    file: MapFile,
) -> Result<Vec<PathBuf>, InputError> {
    let titled = PictureStyle { title: source.title(), ..style.picture.clone() };
    let write = |&kind: &PictureKind| {
        let path = match style.pictures.len() {
            1 => path.to_owned(),
            _ => with_parts(path, &[kind.to_string()]),
        };
        spare_inputs(&path, style)?;
        let figure = picture(kind, &source.object, surface, &titled)?;
        let bytes = match file {
            MapFile::Svg => figure.svg().as_bytes().to_vec(),
            _ => figure.to_png(style.dpi_scale)?,
        };
        write_whole(&path, |out| out.write_all(&bytes)).map_err(|e| written(&path, e))?;
        Ok(path)
    };
    style.pictures.iter().map(write).collect()
}

fn written(path: &Path, source: io::Error) -> InputError {
    InputError::Write { path: path.to_owned(), source }
}
