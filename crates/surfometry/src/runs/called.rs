//! Objects that are called by names, until an input says which labels have them.

use super::label_scales::LabelScales;
use super::label_words::{GroupWords, LabelWord};
use super::{Plan, RunError, SelectionWords};
use crate::text::{SHOWN_LABELS, listed, nearest, question};
use crate::volume::{LabelGroup, LabelSelection, LabelTable, VolumeError, without_repeats};
use serde::{Deserialize, Serialize};

/// Lengths of objects that are called by names, mm; `None` stands for the automatic one.
type CalledLengths = Vec<(GroupWords, Option<f64>)>;

/// Objects that are called by names: each input has its own table of them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CalledObjects {
    /// The objects to measure; `None` where none of them is called by name. Then the plan's own selection counts.
    pub(super) labels: Option<Vec<GroupWords>>,
    pub(super) sigma_mm: CalledLengths,
    pub(super) thickness_mm: CalledLengths,
}

impl CalledObjects {
    /// Whether no object of a plan is called by name.
    pub fn is_empty(&self) -> bool {
        self.labels.is_none() && !self.has_lengths()
    }

    /// Whether some objects have lengths of their own.
    pub(super) fn has_lengths(&self) -> bool {
        !self.sigma_mm.is_empty() || !self.thickness_mm.is_empty()
    }

    /// The selection that stands for what is written, and what of it waits for names.
    pub(super) fn of_selection(words: &SelectionWords) -> (LabelSelection, Option<Vec<GroupWords>>) {
        match (words.numbers(), words) {
            (Some(numbers), _) => (numbers, None),
            (None, SelectionWords::All) => (LabelSelection::All, None),
            (None, SelectionWords::Groups(groups)) => {
                (LabelSelection::Groups(Vec::new()), Some(groups.clone()))
            }
        }
    }

    /// Lengths of labels, and those that wait for names.
    pub(super) fn of_lengths(lengths: CalledLengths) -> (Vec<(LabelGroup, Option<f64>)>, CalledLengths) {
        let (mut known, mut called) = (Vec::new(), Vec::new());
        for (words, length) in lengths {
            match words.numbers() {
                Some(label) => known.push((label, length)),
                None => called.push((words, length)),
            }
        }
        (known, called)
    }
}

/// What a plan asks of an input, whose labels are known.
pub(super) struct Asked {
    pub(super) labels: LabelSelection,
    /// Of objects to measure, the names that the input does not know.
    pub(super) missing: Vec<RunError>,
    pub(super) scales: LabelScales,
    /// What has lengths of its own, and its label, where the input knows the name.
    with_lengths: Vec<(String, Option<LabelGroup>)>,
    /// The first name that the input does not know of something with lengths.
    unknown: Option<RunError>,
}

impl Asked {
    /// By the input's table of names.
    ///
    /// # Errors
    /// [`RunError::NoSuchName`] where the input knows no object to measure. Lengths of what it lacks wait for [`Self::check`].
    pub(super) fn of(plan: &Plan, table: &LabelTable) -> Result<Self, RunError> {
        let (labels, missing) = match &plan.called.labels {
            None => (plan.labels.clone(), Vec::new()),
            Some(groups) => known(groups, table)?,
        };
        let with_lengths =
            plan.scales.labels().map(|label| (label.to_string(), Some(label.clone()))).collect();
        let mut asked = Self { labels, missing, scales: plan.scales.clone(), with_lengths, unknown: None };
        let CalledObjects { sigma_mm, thickness_mm, .. } = &plan.called;
        for (words, length) in sigma_mm {
            let label = asked.with_length(words, table);
            asked.scales.sigma_mm.extend(label.map(|label| (label, *length)));
        }
        for (words, length) in thickness_mm {
            let label = asked.with_length(words, table);
            asked.scales.thickness_mm.extend(label.map(|label| (label, *length)));
        }
        Ok(asked)
    }

    fn with_length(&mut self, words: &GroupWords, table: &LabelTable) -> Option<LabelGroup> {
        let label = match object_called(words, table) {
            Ok(label) => Some(label),
            Err(error) => {
                self.unknown.get_or_insert(error);
                None
            }
        };
        self.with_lengths.push((words.to_string(), label.clone()));
        label
    }

    /// Refuses lengths of what is not among the objects.
    ///
    /// # Errors
    /// [`RunError::NoSuchName`], [`RunError::UnusedScale`].
    pub(super) fn check(self, objects: &[LabelGroup]) -> Result<LabelScales, RunError> {
        self.unknown.map_or(Ok(()), Err)?;
        self.scales.check(objects)?;
        Ok(self.scales)
    }

    /// What has lengths of its own, as written, and whether it is among the objects.
    pub(super) fn found<'s>(
        &'s self,
        objects: &'s [LabelGroup],
    ) -> impl Iterator<Item = (&'s str, bool)> + 's {
        let is_there =
            |label: &Option<LabelGroup>| label.as_ref().is_some_and(|label| label.is_among(objects));
        self.with_lengths.iter().map(move |(words, label)| (words.as_str(), is_there(label)))
    }
}

/// The objects that the input knows, of which there must be one, and why it does not know the others.
fn known(groups: &[GroupWords], table: &LabelTable) -> Result<(LabelSelection, Vec<RunError>), RunError> {
    let (mut known, mut missing) = (Vec::new(), Vec::new());
    for words in groups {
        match object_called(words, table) {
            Ok(object) => known.push(object),
            Err(error) => missing.push(error),
        }
    }
    if known.is_empty() && !missing.is_empty() {
        return Err(missing.remove(0));
    }
    Ok((LabelSelection::Groups(without_repeats(known)), missing))
}

/// The object that words stand for; the labels of a region are all of it.
fn object_called(words: &GroupWords, table: &LabelTable) -> Result<LabelGroup, RunError> {
    let mut labels = Vec::new();
    for word in &words.0 {
        match word {
            LabelWord::Number(label) => labels.push(*label),
            LabelWord::Name(name) => labels.extend_from_slice(label_called(name, table)?.labels()),
        }
    }
    Ok(LabelGroup::united(without_repeats(labels)))
}

fn label_called(name: &str, table: &LabelTable) -> Result<LabelGroup, RunError> {
    let found = table.called(name);
    let told = match &found[..] {
        [only] => return Ok(only.clone()),
        [] => unknown(name, table),
        several => {
            let labels: Vec<String> = several.iter().map(ToString::to_string).collect();
            format!(
                "labels {} are called so: write the number of the one that is meant",
                labels.join(" and ")
            )
        }
    };
    Err(RunError::NoSuchName { name: name.to_owned(), told, nameless: table.all_names().next().is_none() })
}

fn unknown(name: &str, table: &LabelTable) -> String {
    let names: Vec<&str> = table.all_names().collect();
    if names.is_empty() {
        return "the input has no names of labels: choose by number, or give a table of names".to_owned();
    }
    // As they are to be written.
    let word = |name: &&str| LabelWord::Name((*name).to_owned()).to_string();
    let near: Vec<String> = nearest(name, &names).iter().map(word).collect();
    format!("{}Names are {}", question(&near), listed(names.iter().map(word), SHOWN_LABELS))
}

/// An error of objects that do not occur, with the name of the one that is missing.
pub(super) fn with_name(error: VolumeError, table: &LabelTable) -> RunError {
    let VolumeError::NoSuchLabel { missing, present } = &error else {
        return crate::measurement::MeasureError::from(error).into();
    };
    match table.get(*missing).and_then(|entry| entry.name.as_ref()) {
        Some(name) => RunError::NoVoxels { name: name.clone(), label: *missing, present: present.clone() },
        None => crate::measurement::MeasureError::from(error).into(),
    }
}
