//! Which inputs of a run have the objects that are given lengths of their own.

use super::called::Asked;
use crate::text::{SHOWN_LABELS, listed};
use crate::volume::LabelGroup;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};

/// Which inputs of a run have the objects that [`LabelScales`](super::LabelScales) names. One input that lacks an object is no fault where
/// others have it. Clones are the same ledger.
#[derive(Debug, Clone, Default)]
pub struct ScaleLedger(Arc<Mutex<BTreeMap<String, Found>>>);

#[derive(Debug, Default)]
struct Found {
    having: usize,
    lacking: usize,
    /// The first name of those that lack it, and the objects that are there.
    example: Option<(String, String)>,
}

impl ScaleLedger {
    /// Notes which of the objects that have their own lengths an input has.
    pub(super) fn note(&self, asked: &Asked, input: &str, objects: &[LabelGroup]) {
        let mut found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let named: BTreeSet<(&str, bool)> = asked.found(objects).collect();
        for (label, is_there) in named {
            let found = found.entry(label.to_owned()).or_default();
            if is_there {
                found.having += 1;
                continue;
            }
            found.lacking += 1;
            // Whichever thread came first.
            if found.example.as_ref().is_none_or(|(other, _)| input < other.as_str()) {
                found.example = Some((input.to_owned(), listed(objects.iter(), SHOWN_LABELS)));
            }
        }
    }

    /// What is wrong: lengths of objects that no input has.
    pub fn unused(&self) -> Vec<String> {
        self.told(|label, found, input, objects| {
            (found.having == 0).then(|| {
                format!("a sigma or thickness is given for label {label}, which none of the {} inputs has: {input} has {objects}; name one of its objects, or leave that length out", found.lacking)
            })
        })
    }

    /// What a person may want to know: lengths of objects that some inputs lack.
    pub fn partly_used(&self) -> Vec<String> {
        self.told(|label, found, input, _| {
            (found.having > 0).then(|| {
                let all = found.having + found.lacking;
                format!("a sigma or thickness is given for label {label}, which {} of {all} inputs lack, as {input}", found.lacking)
            })
        })
    }

    fn told(&self, words: impl Fn(&str, &Found, &str, &str) -> Option<String>) -> Vec<String> {
        let found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let of = |(label, found): (&String, &Found)| {
            let (input, objects) = found.example.as_ref()?;
            words(label, found, input, objects)
        };
        found.iter().filter_map(of).collect()
    }
}
