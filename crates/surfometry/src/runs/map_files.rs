//! Files that show one object: meshes, voxel maps, pictures.

use super::{FileLedger, InputObject, RunError};
use crate::Choice;
use crate::inputs::with_parts;
use crate::io::{MeshDocument, MeshFormat, mesh_paths, write_mesh, write_voxel_map, write_whole};
use crate::measurement::VoxelQuantity;
use crate::pictures::{Figure, PictureKind, PictureStyle, color_scale, picture};
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
}

impl Default for MapStyle {
    /// H on the surface, from one oblique view at 192 dots per inch.
    fn default() -> Self {
        Self {
            picture: PictureStyle::default(),
            pictures: vec![PictureKind::Surface],
            dpi_scale: 2.0,
            voxels: vec![VoxelQuantity::MeanCurvature],
        }
    }
}

/// Writes one file, or several where several pictures or quantities are asked for; their names.
///
/// Where the input has several objects, `_NAME`, or `_label-N` of one without a name of its own, goes before the ending.
///
/// # Errors
/// [`RunError`].
pub fn write_map_files(
    source: &InputObject,
    path: &Path,
    style: &MapStyle,
    ledger: &FileLedger,
) -> Result<Vec<PathBuf>, RunError> {
    let file = MapFile::of_path(path).ok_or(RunError::Unfit("the file's name ends in no known format"))?;
    let path = with_parts(path, source.file_part.as_slice());
    match file {
        // Voxel maps show what is there instead.
        MapFile::Mesh(_) | MapFile::Png | MapFile::Svg if source.surface().is_empty() => {
            Err(RunError::NoSurface)
        }
        MapFile::Mesh(_) => mesh_files(source, &path, style, ledger),
        MapFile::Voxels => voxel_files(source, &path, style, ledger),
        MapFile::Png | MapFile::Svg => picture_files(source, &path, style, ledger),
    }
}

fn mesh_files(
    source: &InputObject,
    path: &Path,
    style: &MapStyle,
    ledger: &FileLedger,
) -> Result<Vec<PathBuf>, RunError> {
    for file in mesh_paths(path).map_err(|e| written(path, e))? {
        ledger.claim(&file)?;
    }
    let surface = source.surface();
    let PictureStyle { quantity, limit, .. } = style.picture;
    let scale = color_scale(surface, quantity, limit);
    let colors = surface.values(quantity).map(|values| scale.colors(&values));
    let title = format!("surfometry {}: {}", env!("CARGO_PKG_VERSION"), source.title());
    let arrays = surface.arrays();
    let document =
        MeshDocument { mesh: &surface.mesh, arrays: &arrays, colors: colors.as_deref(), title: &title };
    write_mesh(path, &document).map_err(|e| written(path, e))
}

fn voxel_files(
    source: &InputObject,
    path: &Path,
    style: &MapStyle,
    ledger: &FileLedger,
) -> Result<Vec<PathBuf>, RunError> {
    let grid = source.object.grid();
    let name = |quantity: VoxelQuantity| match style.voxels.len() {
        1 => path.to_owned(),
        _ => with_parts(path, &[quantity.name()]),
    };
    let mut write = |&quantity: &VoxelQuantity| {
        let path = name(quantity);
        ledger.claim(&path)?;
        let map = source.local().voxel_map(quantity, &grid.index_box()).ok_or(RunError::NoSurface)?;
        write_voxel_map(&path, grid, map.values(), quantity.name()).map_err(|e| written(&path, e))?;
        Ok(path)
    };
    style.voxels.iter().map(&mut write).collect()
}

fn picture_files(
    source: &InputObject,
    path: &Path,
    style: &MapStyle,
    ledger: &FileLedger,
) -> Result<Vec<PathBuf>, RunError> {
    let titled = PictureStyle { title: source.title(), ..style.picture.clone() };
    let mut write = |&kind: &PictureKind| {
        let path = match style.pictures.len() {
            1 => path.to_owned(),
            _ => with_parts(path, &[kind.word()]),
        };
        ledger.claim(&path)?;
        let figure = picture(kind, source.local(), source.surface(), &titled)?;
        write_figure(&figure, &path, style.dpi_scale)?;
        Ok(path)
    };
    style.pictures.iter().map(&mut write).collect()
}

/// Writes a figure as PNG where its name says so, else as SVG.
///
/// # Errors
/// [`RunError::Picture`], [`RunError::Write`].
pub fn write_figure(figure: &Figure, path: &Path, dpi_scale: f64) -> Result<(), RunError> {
    let bytes = match MapFile::of_path(path) {
        Some(MapFile::Png) => figure.to_png(dpi_scale)?,
        _ => figure.svg().as_bytes().to_vec(),
    };
    write_whole(path, |out| out.write_all(&bytes)).map_err(|e| written(path, e))
}

fn written(path: &Path, source: io::Error) -> RunError {
    RunError::Write { path: path.to_owned(), source }
}
