//! Pictures in which all objects of a run are seen, on one scale of colours.

use super::map_files::{kinds_of, write_figure};
use super::{FileLedger, InputObject, MapFile, MapStyle, RunError};
use crate::inputs::{distinct_parts, input_title};
use crate::pictures::{Figure, PictureKind, SceneSurface, SurfacePicture, how_mapped};
use crate::surface::Mesh;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The surfaces of a run: those of an input as one mesh, the inputs beside each other.
#[derive(Debug, Default)]
pub struct Scene {
    inputs: Mutex<Vec<InputScene>>,
}

/// The surfaces of one input, in one mesh.
#[derive(Debug, Default)]
struct InputScene {
    input: String,
    title: String,
    mesh: Mesh,
    normals: Vec<[f64; 3]>,
    values: Vec<f64>,
    /// How its surfaces were made, each once.
    made: Vec<String>,
}

impl Scene {
    /// An empty one for a run over these inputs.
    pub fn new(inputs: &[String]) -> Self {
        let scene = |(input, part): (&String, Option<String>)| InputScene {
            input: input.clone(),
            title: part.unwrap_or_else(|| input_title(input)),
            ..InputScene::default()
        };
        Self { inputs: Mutex::new(inputs.iter().zip(distinct_parts(inputs)).map(scene).collect()) }
    }

    /// Adds the surface of an object.
    pub(super) fn add(&self, object: &InputObject, style: &MapStyle) -> Result<(), RunError> {
        let surface = object.surface();
        let values = style.picture.values(surface)?;
        let mut inputs = self.inputs.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(scene) = inputs.iter_mut().find(|scene| scene.input == object.input()) {
            let first = scene.mesh.vertices.len() as u32;
            scene.mesh.vertices.extend_from_slice(&surface.mesh.vertices);
            let moved = surface.mesh.triangles.iter().map(|corners| corners.map(|vertex| vertex + first));
            scene.mesh.triangles.extend(moved);
            scene.normals.extend(surface.vertices.iter().map(|vertex| vertex.normal));
            scene.values.extend(values);
            let made = how_mapped(object.local());
            if !scene.made.contains(&made) {
                scene.made.push(made);
            }
        }
        Ok(())
    }

    /// Draws what there is into each of the files that are pictures; their names.
    ///
    /// # Errors
    /// [`RunError::NoSurface`] where there is nothing; what drawing and writing say.
    pub(super) fn write(
        &self,
        files: &[PathBuf],
        style: &MapStyle,
        ledger: &FileLedger,
    ) -> Result<Vec<PathBuf>, RunError> {
        let wanted = |path: &&PathBuf| MapFile::of_path(path).is_some_and(MapFile::is_picture);
        let named = |path: &Path| kinds_of(path, style).find(|(kind, _)| *kind == PictureKind::Surface);
        let paths: Vec<PathBuf> =
            files.iter().filter(wanted).filter_map(|path| named(path)).map(|(_, path)| path).collect();
        if paths.is_empty() {
            return Ok(paths);
        }
        let figure = self.figure(style)?;
        for path in &paths {
            ledger.claim(path)?;
            write_figure(&figure, path, style.dpi_scale)?;
        }
        Ok(paths)
    }

    fn figure(&self, style: &MapStyle) -> Result<Figure, RunError> {
        let inputs = self.inputs.lock().unwrap_or_else(PoisonError::into_inner);
        let shown: Vec<&InputScene> =
            inputs.iter().filter(|scene| !scene.mesh.triangles.is_empty()).collect();
        let [first, rest @ ..] = &shown[..] else { return Err(RunError::NoSurface) };
        let picture = &style.picture;
        let surfaces: Vec<SceneSurface> = shown
            .iter()
            .map(|scene| SceneSurface {
                name: &scene.title,
                mesh: &scene.mesh,
                values: &scene.values,
                normals: &scene.normals,
            })
            .collect();
        let title = style
            .title
            .clone()
            .unwrap_or_else(|| if rest.is_empty() { first.title.clone() } else { String::new() });
        let one_way = shown.iter().flat_map(|scene| &scene.made).all(|made| *made == first.made[0]);
        let made = if one_way { first.made[0].as_str() } else { "Each surface at a blur of its own." };
        Ok(SurfacePicture {
            surfaces: &surfaces,
            quantity: picture.quantity.into(),
            scale: picture.scale(|| {
                let values = shown.iter().flat_map(|scene| scene.values.iter().copied()).collect();
                (values, shown.iter().flat_map(|scene| scene.mesh.vertex_areas()).collect())
            }),
            views: &picture.views,
            title: &title,
            caption: &picture.caption_with(made),
            width: picture.width,
        }
        .figure()?)
    }
}
