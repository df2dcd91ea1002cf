//! Objects to files that show them.

use super::write_map_files;
use super::{
    Against, AgainstRecord, FileLedger, InputObject, Item, MapStyle, Opened, Plan, Reading, RunError,
    SurfaceRecord, Task,
};
use crate::inputs::with_parts;
use std::path::PathBuf;

/// Maps every selected object of an input: files, and a record with the distributions of curvature.
///
/// ```
/// use surfometry::{Control, runs::{Batch, Collected, FileLedger, MapStyle, MapTask, Plan}};
/// let folder = tempfile::tempdir()?;
/// let mesh = folder.path().join("ball.ply");
/// let (inputs, control) = (["phantom:ball?radius=6".to_owned()], Control::default());
/// let batch = Batch { inputs: &inputs, open: Default::default(), control: &control, cure: |_| None };
/// let task = MapTask {
///     plan: Plan { recover: false, ..Plan::default() },
///     against: None,
///     files: vec![mesh.clone()],
///     style: MapStyle::default(),
///     ledger: FileLedger::new(&inputs),
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
}

impl Task for MapTask {
    type Row = SurfaceRecord;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<SurfaceRecord>)) -> Result<(), RunError> {
        input.begin_hashing();
        let reading = Reading::of(input, &self.plan)?;
        let files: Vec<PathBuf> =
            self.files.iter().map(|path| with_parts(path, input.part.as_slice())).collect();
        for object in reading.objects() {
            let mut object = object?;
            object.surface();
            input.control.check()?;
            let against = self.compared(input, &mut object, out)?;
            let written = self.write(input, &object, &files, out);
            input.control.check()?;
            let record = SurfaceRecord::of(&object);
            out(Item::Row(SurfaceRecord { against, files: written, ..record }));
        }
        Ok(())
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
}
