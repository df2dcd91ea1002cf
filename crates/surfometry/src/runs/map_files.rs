//! Files that show one object: meshes, voxel maps, pictures.

use super::joint_maps::NamedMap;
use super::{FileLedger, InputObject, RunError};
use crate::Choice;
use crate::inputs::with_parts;
use crate::io::{MeshDocument, MeshFormat, mesh_paths, write_mesh, write_voxel_map, write_whole};
use crate::measurement::{Outside, VoxelQuantity};
use crate::pictures::{Figure, PictureKind, PictureStyle, picture};
use crate::volume::Grid;
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
    /// Pictures as PDF, a file each.
    Pdf,
}

impl MapFile {
    /// Endings of the names of map files.
    pub const EXTENSIONS: &str = ".ply, .vtp, .stl, .obj, .glb, .gii, .csv, .nii, .nii.gz, .png, .svg, .pdf";

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
        } else if ends(&[".pdf"]) {
            Some(Self::Pdf)
        } else {
            MeshFormat::of_path(path).map(Self::Mesh)
        }
    }

    /// Whether it is drawn.
    pub fn is_picture(self) -> bool {
        matches!(self, Self::Png | Self::Svg | Self::Pdf)
    }
}

/// How the files of a map are made.
#[derive(Debug, Clone, PartialEq)]
pub struct MapStyle {
    /// Quantity, limits and views of colours and pictures; its title is replaced by that below.
    pub picture: PictureStyle,
    /// Above pictures; `None` takes the object's name.
    pub title: Option<String>,
    /// Kinds of pictures.
    pub pictures: Vec<PictureKind>,
    /// Pixels a picture unit; 1 is 96 dots per inch.
    pub dpi_scale: f64,
    /// Quantities of voxel maps.
    pub voxels: Vec<VoxelQuantity>,
    /// What voxel maps of curvature have outside the band.
    pub outside: Outside,
    /// Whether surfaces are seen in one picture, and voxel maps of an input's objects are one image.
    pub together: bool,
}

impl Default for MapStyle {
    /// H on the surface, from one oblique view at 192 dots per inch.
    fn default() -> Self {
        Self {
            picture: PictureStyle::default(),
            pictures: vec![PictureKind::Surface],
            dpi_scale: 2.0,
            title: None,
            voxels: vec![VoxelQuantity::MeanCurvature],
            outside: Outside::default(),
            together: false,
        }
    }
}

/// Writes one file, or several where several pictures or quantities are asked for; their names.
///
/// What is made of all objects together is left out. Where the input has several objects, `_NAME`, or `_label-N` of one without a name of its own, goes before the ending.
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
        MapFile::Voxels if style.together => Ok(Vec::new()),
        MapFile::Voxels => voxel_files(source, &path, style, ledger),
        _ if source.surface().is_empty() => Err(RunError::NoSurface),
        MapFile::Mesh(_) => mesh_files(source, &path, style, ledger),
        MapFile::Png | MapFile::Svg | MapFile::Pdf => picture_files(source, &path, style, ledger),
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
    let scale = style.picture.color_scale(surface);
    let colors = surface.values(style.picture.quantity).map(|values| scale.colors(&values));
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
    let mut write = |&quantity: &VoxelQuantity| {
        let path = voxel_file(path, style, quantity);
        ledger.claim(&path)?;
        let map = source.local().voxel_map_on(quantity, &grid.index_box(), style.outside.value());
        let map = map.ok_or(RunError::NoSurface)?;
        write_voxel_map(&path, grid, map.values(), quantity.name()).map_err(|e| written(&path, e))?;
        Ok(path)
    };
    style.voxels.iter().map(&mut write).collect()
}

/// The file of a quantity, of which there may be several.
fn voxel_file(path: &Path, style: &MapStyle, quantity: VoxelQuantity) -> PathBuf {
    match style.voxels.len() {
        1 => path.to_owned(),
        _ => with_parts(path, &[quantity.name()]),
    }
}

/// Writes the maps of all objects of an input; their names.
pub(super) fn write_joint_maps(
    (grid, maps): &(Grid, Vec<NamedMap>),
    path: &Path,
    style: &MapStyle,
    ledger: &FileLedger,
) -> Result<Vec<PathBuf>, RunError> {
    let mut write = |(quantity, values): &NamedMap| {
        let path = voxel_file(path, style, *quantity);
        ledger.claim(&path)?;
        write_voxel_map(&path, grid, values, quantity.name()).map_err(|e| written(&path, e))?;
        Ok(path)
    };
    maps.iter().map(&mut write).collect()
}

fn picture_files(
    source: &InputObject,
    path: &Path,
    style: &MapStyle,
    ledger: &FileLedger,
) -> Result<Vec<PathBuf>, RunError> {
    let title = style.title.clone().unwrap_or_else(|| source.title());
    let titled = PictureStyle { title, ..style.picture.clone() };
    let mut write = |(kind, path): (PictureKind, PathBuf)| {
        ledger.claim(&path)?;
        let figure = picture(kind, source.local(), source.surface(), &titled)?;
        write_figure(&figure, &path, style.dpi_scale)?;
        Ok(path)
    };
    let apart = |(kind, _): &(PictureKind, PathBuf)| !(style.together && *kind == PictureKind::Surface);
    kinds_of(path, style).filter(apart).map(&mut write).collect()
}

/// The kinds of pictures with the file of each, of which there may be several.
pub(super) fn kinds_of(path: &Path, style: &MapStyle) -> impl Iterator<Item = (PictureKind, PathBuf)> {
    let several = style.pictures.len() > 1;
    style
        .pictures
        .iter()
        .map(move |kind| (*kind, if several { with_parts(path, &[kind.word()]) } else { path.to_owned() }))
}

/// Writes a figure as PNG or PDF where its name says so, else as SVG.
///
/// # Errors
/// [`RunError::Picture`], [`RunError::Write`].
pub fn write_figure(figure: &Figure, path: &Path, dpi_scale: f64) -> Result<(), RunError> {
    let bytes = match MapFile::of_path(path) {
        Some(MapFile::Png) => figure.to_png(dpi_scale)?,
        Some(MapFile::Pdf) => figure.to_pdf()?,
        _ => figure.svg().as_bytes().to_vec(),
    };
    write_whole(path, |out| out.write_all(&bytes)).map_err(|e| written(path, e))
}

fn written(path: &Path, source: io::Error) -> RunError {
    RunError::Write { path: path.to_owned(), source }
}
