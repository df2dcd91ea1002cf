//! Inputs to the parts of a page.

use super::{HashedInput, MOST_TRIANGLES, ObjectReport};
use crate::inputs::InputError;
use crate::runs::{Item, Opened, Plan, Reading, RunError, Task};
use std::sync::atomic::{AtomicU64, Ordering};

/// Measures and draws every selected object of an input.
#[derive(Debug, Default)]
pub struct ReportTask {
    /// What is asked.
    pub plan: Plan,
    /// Triangles of the surfaces that can be turned so far.
    shown: AtomicU64,
}

/// What a page is made of.
#[derive(Debug)]
pub enum ReportPart {
    /// A section.
    Object(Box<ObjectReport>),
    /// An input of which there are sections.
    Source(HashedInput),
}

impl ReportTask {
    /// By a plan.
    pub fn new(plan: Plan) -> Self {
        Self { plan, shown: AtomicU64::new(0) }
    }
}

impl Task for ReportTask {
    type Row = ReportPart;

    /// Which surfaces a page has room for depends on those before.
    fn side_by_side(&self) -> bool {
        false
    }

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<ReportPart>)) -> Result<(), RunError> {
        input.begin_hashing();
        let reading = Reading::of(input, &self.plan)?;
        for object in reading.objects() {
            let room = MOST_TRIANGLES.saturating_sub(self.shown.load(Ordering::Relaxed) as usize);
            let object = object?;
            object.surface();
            input.control.check()?;
            let section = ObjectReport::of(&object, room)?;
            input.control.check()?;
            let shown = section.triangles().filter(|_| section.scene.is_some());
            self.shown.fetch_add(shown.unwrap_or_default(), Ordering::Relaxed);
            out(Item::Row(ReportPart::Object(Box::new(section))));
        }
        let source = match input.hashed_files() {
            Some(files) => HashedInput { input: input.name.to_owned(), files: files.to_vec() },
            // Says which cannot be read.
            None => HashedInput::of(input.name, &input.source.files()).map_err(InputError::from)?,
        };
        out(Item::Row(ReportPart::Source(source)));
        Ok(())
    }
}
