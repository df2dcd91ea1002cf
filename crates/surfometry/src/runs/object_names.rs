//! What the objects of an input are called, by people and in names of files.

use crate::volume::{LabelGroup, LabelTable};
use std::collections::HashMap;

/// Bytes of a name that go into a file's name.
const LONGEST: usize = 80;

/// What the objects of an input are called.
#[derive(Default)]
pub(super) struct ObjectNames {
    table: LabelTable,
    /// Of each object, where there are several.
    file_parts: Vec<(LabelGroup, String)>,
}

impl ObjectNames {
    pub(super) fn new(table: LabelTable, objects: &[LabelGroup]) -> Self {
        let file_parts = if objects.len() > 1 { file_parts(&table, objects) } else { Vec::new() };
        Self { table, file_parts }
    }

    pub(super) fn of(&self, object: &LabelGroup) -> Option<String> {
        self.table.name_of(object)
    }

    pub(super) fn colour_of(&self, object: &LabelGroup) -> Option<[u8; 3]> {
        self.table.colour_of(object)
    }

    /// What tells an object's files from those of the others; `None` where it is the only one.
    pub(super) fn file_part(&self, object: &LabelGroup) -> Option<String> {
        self.file_parts.iter().find(|(known, _)| known == object).map(|(_, part)| part.clone())
    }
}

/// A name that only one object has, also on disks that do not tell capitals; else the number, with the name if any.
fn file_parts(table: &LabelTable, objects: &[LabelGroup]) -> Vec<(LabelGroup, String)> {
    let safe =
        |object: &LabelGroup| table.name_of(object).map(|name| safe_name(&name)).filter(|n| !n.is_empty());
    let mut count: HashMap<String, usize> = HashMap::new();
    for name in objects.iter().filter_map(safe) {
        *count.entry(name.to_lowercase()).or_default() += 1;
    }
    let part = |object: &LabelGroup| match safe(object) {
        None => format!("label-{object}"),
        // A name that looks like a number's part could be another label's.
        Some(name) if count[&name.to_lowercase()] == 1 && !name.starts_with("label-") => name,
        Some(name) => format!("label-{object}_{name}"),
    };
    objects.iter().map(|object| (object.clone(), part(object))).collect()
}

/// A name in which whatever a file system, a shell or a pattern may take amiss is a dash.
fn safe_name(name: &str) -> String {
    let mut safe = String::new();
    for c in name.chars() {
        let c = if c.is_alphanumeric() || matches!(c, '_' | '.' | '+') { c } else { '-' };
        if safe.len() + c.len_utf8() > LONGEST {
            break;
        }
        if !(c == '-' && safe.ends_with('-')) {
            safe.push(c);
        }
    }
    safe.trim_matches(['-', '.']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_made_safe_and_kept_apart() {
        let names = ["Left kidney/../x", "Tumour*", "tumour?", "", "label-3", "…", "é L4"];
        let table: LabelTable = (1..).zip(names.map(str::to_owned)).collect();
        let objects: Vec<LabelGroup> = (1..=8).map(LabelGroup::single).collect();
        let names = ObjectNames::new(table, &objects);
        let parts: Vec<String> = objects.iter().map(|object| names.file_part(object).unwrap()).collect();
        let expected = [
            "Left-kidney-..-x",
            "label-2_Tumour",
            "label-3_tumour",
            "label-4",
            "label-5_label-3",
            "label-6",
            "é-L4",
            "label-8",
        ];
        assert_eq!(parts, expected);
    }

    #[test]
    fn the_only_object_needs_no_part() {
        let names = ObjectNames::new(LabelTable::default(), &[LabelGroup::single(4)]);
        assert_eq!(names.file_part(&LabelGroup::single(4)), None);
    }
}
