//! Objects to files that show them.

use super::joint_maps::JointMaps;
use super::map_files::{write_joint_maps, write_map_files};
use super::{
    Against, AgainstRecord, FileLedger, InputObject, Item, MapFile, MapStyle, Opened, Plan, Reading,
    RunError, Scene, SurfaceRecord, Task,
};
use crate::inputs::with_parts;
use crate::pictures::PictureKind;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// Maps every selected object of an input: files, and a record with the distributions of curvature.
///
/// ```
/// use surfometry::{Control, runs::{Batch, Collected, FileLedger, MapStyle, MapTask, Plan, SharedFiles}};
/// let folder = tempfile::tempdir()?;
/// let mesh = folder.path().join("ball.ply");
/// let (inputs, control) = (["phantom:ball?radius=6".to_owned()], Control::default());
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// let task = MapTask {
///     plan: Plan::default(),
///     against: None,
///     files: vec![mesh.clone()],
///     style: MapStyle::default(),
///     ledger: FileLedger::new(&inputs),
///     shared: SharedFiles::new(&inputs),
/// };
/// batch.run(&task, &mut Collected::default())?;
/// assert!(mesh.is_file());
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct MapTask {
    /// What is asked.
    pub plan: Plan,
    /// A later image, with whose surfaces they are compared.
    pub against: Option<Against>,
    /// Files for each object; where there are several inputs or objects, `_NAME` and `_label-N` go before
    /// their endings.
    pub files: Vec<PathBuf>,
    /// How they are made.
    pub style: MapStyle,
    /// The files of the run.
    pub ledger: FileLedger,
    /// What is made of all objects together.
    pub shared: SharedFiles,
}

/// What a map's run makes of all objects together.
#[derive(Debug, Default)]
pub struct SharedFiles {
    inputs: Vec<String>,
    scene: Scene,
    /// Files that were written, with the input's name.
    written: Mutex<Vec<(String, PathBuf)>>,
}

impl SharedFiles {
    /// For a run over these inputs.
    pub fn new(inputs: &[String]) -> Self {
        Self { inputs: inputs.to_vec(), scene: Scene::new(inputs), written: Mutex::default() }
    }
}

impl Task for MapTask {
    type Row = SurfaceRecord;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<SurfaceRecord>)) -> Result<(), RunError> {
        input.begin_hashing();
        let reading = Reading::of(input, &self.plan)?;
        let files: Vec<PathBuf> =
            self.files.iter().map(|path| with_parts(path, input.part.as_slice())).collect();
        let voxels: Vec<&PathBuf> =
            files.iter().filter(|path| MapFile::of_path(path) == Some(MapFile::Voxels)).collect();
        let mut joint = (self.style.together && !voxels.is_empty())
            .then(|| JointMaps::new(&self.style.voxels, self.style.outside));
        for object in reading.mapped_objects() {
            let mut object = object?;
            object.surface();
            input.control.check()?;
            for error in object.without_values(&self.plan) {
                input.fail(object.failure(&error), out);
            }
            let against = self.compared(input, &mut object, out)?;
            let written = self.write(input, &object, &files, out);
            if let Err(error) = self.share(&object, joint.as_mut()) {
                input.fail(object.failure(&error), out);
            }
            input.control.check()?;
            let record = SurfaceRecord::of(&object);
            out(Item::Row(SurfaceRecord { against, files: written, ..record }));
        }
        match joint {
            Some(joint) => self.write_joint(input, joint, &voxels),
            None => Ok(()),
        }
    }
}

impl MapTask {
    /// How an object's surface differs from the later one. That the later image lacks it is handed out, and the rest is done
    /// all the same.
    fn compared(
        &self,
        input: &Opened,
        object: &mut InputObject,
        out: &mut dyn FnMut(Item<SurfaceRecord>),
    ) -> Result<Option<AgainstRecord>, RunError> {
        match self.against.as_ref().map(|later| later.change(object)) {
            Some(Err(error)) if error.is_stop() => Err(error),
            Some(Err(error)) => {
                input.fail(object.failure(&error), out);
                Ok(None)
            }
            Some(Ok(record)) => Ok(Some(record)),
            None => Ok(None),
        }
    }

    /// Writes an object's files; their names. What cannot be written is handed out, and the others are
    /// written all the same.
    fn write(
        &self,
        input: &Opened,
        object: &InputObject,
        files: &[PathBuf],
        out: &mut dyn FnMut(Item<SurfaceRecord>),
    ) -> Vec<String> {
        let (mut written, mut errors) = (Vec::new(), Vec::new());
        for path in files {
            match write_map_files(object, path, &self.style, &self.ledger) {
                Ok(paths) => written.extend(paths.iter().map(|path| path.display().to_string())),
                // That there is no surface is said once, not for each file.
                Err(error) if errors.contains(&error.to_string()) => {}
                Err(error) => {
                    errors.push(error.to_string());
                    input.fail(object.failure(&error), out);
                }
            }
        }
        written
    }

    /// Gives an object its place in what all objects are in.
    fn share(&self, object: &InputObject, joint: Option<&mut JointMaps>) -> Result<(), RunError> {
        // That there is none is said already.
        if self.style.together && self.draws_surfaces() && !object.surface().is_empty() {
            self.shared.scene.add(object, &self.style)?;
        }
        joint.map_or(Ok(()), |joint| joint.add(object))
    }

    fn draws_surfaces(&self) -> bool {
        let drawn = |path: &PathBuf| MapFile::of_path(path).is_some_and(MapFile::is_picture);
        self.style.pictures.contains(&PictureKind::Surface) && self.files.iter().any(drawn)
    }

    fn write_joint(&self, input: &Opened, joint: JointMaps, files: &[&PathBuf]) -> Result<(), RunError> {
        let joint = joint.finish().ok_or(RunError::NoSurface)?;
        for path in files {
            let paths = write_joint_maps(&joint, path, &self.style, &self.ledger)?;
            let named = paths.into_iter().map(|path| (input.name.to_owned(), path));
            self.shared.written.lock().unwrap_or_else(PoisonError::into_inner).extend(named);
        }
        Ok(())
    }

    /// Writes what shows all objects of a run that has ended; the names of all files that objects share, in the order of
    /// the inputs.
    ///
    /// # Errors
    /// [`RunError`].
    pub fn finish(&self) -> Result<Vec<PathBuf>, RunError> {
        let SharedFiles { inputs, written, .. } = &self.shared;
        let mut written = std::mem::take(&mut *written.lock().unwrap_or_else(PoisonError::into_inner));
        written.sort_by_key(|(name, _)| inputs.iter().position(|input| input == name));
        let mut written: Vec<PathBuf> = written.into_iter().map(|(_, path)| path).collect();
        if self.style.together && self.draws_surfaces() {
            written.extend(self.shared.scene.write(&self.files, &self.style, &self.ledger)?);
        }
        Ok(written)
    }
}
