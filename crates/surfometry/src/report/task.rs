//! Inputs to the parts of a page.

use super::{HashedInput, ObjectReport};
use crate::inputs::InputError;
use crate::runs::{Item, Opened, Plan, Reading, RunError, Task};

/// Measures and draws every selected object of an input.
#[derive(Debug)]
pub struct ReportTask {
    /// What is asked.
    pub plan: Plan,
    /// Inputs of the page.
    inputs: usize,
}

/// What a page is made of.
#[derive(Debug)]
pub enum ReportPart {
    /// An object.
    Object(Box<ObjectReport>),
    /// An input of which there are objects.
    Source(HashedInput),
}

impl ReportTask {
    /// By a plan, of a page of one input.
    pub fn new(plan: Plan) -> Self {
        Self { plan, inputs: 1 }
    }

    /// The same for a page of so many inputs: each has the same share of what a page can show, and so has each object
    /// of an input, so that what is shown of one does not depend on the others.
    #[must_use]
    pub fn of_inputs(self, inputs: usize) -> Self {
        Self { inputs: inputs.max(1), ..self }
    }
}

impl Task for ReportTask {
    type Row = ReportPart;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<ReportPart>)) -> Result<(), RunError> {
        input.begin_hashing();
        let reading = Reading::of(input, &self.plan)?;
        let objects = self.inputs * reading.count().max(1);
        for object in reading.objects() {
            let object = object?;
            object.surface();
            input.control.check()?;
            let part = ObjectReport::of(&object, objects)?;
            input.control.check()?;
            out(Item::Row(ReportPart::Object(Box::new(part))));
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
