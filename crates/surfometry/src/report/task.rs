//! Inputs to the parts of a page.

use super::page_share::PageShare;
use super::{HashedInput, ObjectReport};
use crate::Event;
use crate::inputs::InputError;
use crate::measurement::CurvatureScale;
use crate::runs::{Item, Opened, Plan, Reading, RunError, Task};

/// Measures and draws every selected object of an input.
#[derive(Debug)]
pub struct ReportTask {
    /// What is asked.
    pub plan: Plan,
    /// Inputs of the page.
    inputs: usize,
    /// Whether nothing was said of which surface is meant.
    is_free: bool,
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
        Self { plan, inputs: 1, is_free: false }
    }

    /// The same where nothing was said of a scale or field: where a page has few objects it shows their original surfaces at
    /// the scale that suits each place ([`CurvatureScale::Auto`]), as pictures do; of many it takes too long.
    #[must_use]
    pub fn of_free_choice(self, is_free: bool) -> Self {
        Self { is_free, ..self }
    }

    /// The same for a page of so many inputs: each has the same share of what a page can show, and so has each object
    /// of an input, so that what is shown of one does not depend on the others.
    #[must_use]
    pub fn of_inputs(self, inputs: usize) -> Self {
        Self { inputs: inputs.max(1), ..self }
    }
}

/// Labels of cells make pages that no browser is quick with, after minutes.
fn tell_of_size(input: &Opened, page: PageShare) {
    if let Some(megabytes) = page.large_megabytes() {
        let text = format!(
            "a page of {} objects has some {megabytes} MB, and browsers are slow with it: choose some of the labels, or write a table of their numbers",
            page.objects
        );
        input.control.tell(&Event::Note { input: input.name, text: &text });
    }
}

impl Task for ReportTask {
    type Row = ReportPart;

    fn run(&self, input: &Opened, out: &mut dyn FnMut(Item<ReportPart>)) -> Result<(), RunError> {
        input.begin_hashing();
        let reading = Reading::of(input, &self.plan)?;
        let objects = self.inputs * reading.count().max(1);
        tell_of_size(input, PageShare { objects: reading.count() });
        let few = self.is_free && PageShare { objects }.looks_closely();
        let curvature = if few { CurvatureScale::Auto } else { self.plan.curvature };
        let plan = Plan { curvature, ..self.plan.clone() };
        for object in reading.objects_of(&plan) {
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
