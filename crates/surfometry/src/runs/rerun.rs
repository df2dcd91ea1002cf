//! A result measured again, and compared with what it was.

use super::{Failure, MadeBy, Plan, Record, SCHEMA, Settings, Sink, flatten};
use crate::io::{ReadError, read_text};
use serde::de::{Deserialize, Deserializer, Error as _};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What differs from run to run and says nothing of an object.
const TIMES: [&str; 2] = ["read_seconds", "seconds"];

/// Why a result cannot be repeated.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RerunError {
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It is something else.
    #[error("{path}: no document of `measure --format json` that names its settings ({reason}): name a file that `measure -o FILE.json` wrote", path = path.display())]
    NotOne {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

/// A document that `measure` wrote.
#[derive(Debug, Clone, serde::Deserialize)]
pub struct WrittenRun {
    schema: String,
    #[serde(flatten)]
    made_by: MadeBy,
    #[serde(deserialize_with = "stated")]
    settings: Settings,
    results: Vec<Value>,
    #[serde(default)]
    failures: Vec<Failure>,
}

fn stated<'de, D: Deserializer<'de>>(document: D) -> Result<Settings, D::Error> {
    Settings::stated(&Value::deserialize(document)?).map_err(D::Error::custom)
}

impl WrittenRun {
    /// Reads one.
    ///
    /// # Errors
    /// [`RerunError`].
    pub fn read(path: &Path) -> Result<Self, RerunError> {
        let not_one = |reason: String| RerunError::NotOne { path: path.to_owned(), reason };
        let text = read_text(path)?.map_err(|_| not_one("it is no text".to_owned()))?;
        let run: Self = serde_json::from_str(&text).map_err(|error| not_one(error.to_string()))?;
        if run.schema != SCHEMA {
            return Err(not_one(format!("its schema is {}, not {SCHEMA}", run.schema)));
        }
        match run.of_several_parameters() {
            Some(object) => Err(not_one(format!(
                "{object} stands in it with several parameters, as `sweep` writes it; what `measure` writes can be measured again"
            ))),
            None => Ok(run),
        }
    }

    /// An object that was measured in several ways.
    fn of_several_parameters(&self) -> Option<String> {
        let mut known = BTreeMap::new();
        self.results.iter().find_map(|row| {
            let earlier = known.insert(key(row), &row["parameters"]);
            let (input, object) = key(row);
            earlier
                .is_some_and(|earlier| *earlier != row["parameters"])
                .then(|| format!("{input}, label {object}"))
        })
    }

    /// What made it.
    pub fn made_by(&self) -> &MadeBy {
        &self.made_by
    }

    /// How its objects were measured.
    pub fn plan(&self) -> Plan {
        self.settings.plan()
    }

    /// Its inputs, in order, those that failed last.
    pub fn inputs(&self) -> Vec<String> {
        let of_results = self.results.iter().filter_map(|row| row["input"].as_str().map(str::to_owned));
        let of_failures = self.failures.iter().map(|failure| failure.input.clone());
        of_results.chain(of_failures).fold(Vec::new(), |mut inputs, input| {
            if inputs.last() != Some(&input) && !inputs.contains(&input) {
                inputs.push(input);
            }
            inputs
        })
    }
}

/// An object, measured again.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeated {
    /// The input as named.
    pub input: String,
    /// Label and piece, as written; empty of what has none.
    pub object: String,
    /// What came of it.
    pub finding: Finding,
}

/// How a result compares with what it was.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// The same, to the last bit.
    Same,
    /// Something differs.
    Differs {
        /// Whether the input's files are others than they were.
        other_input: bool,
        /// The field that differs most.
        field: String,
        /// What it was.
        before: Value,
        /// What it is.
        now: Value,
        /// How many fields differ.
        fields: usize,
    },
    /// It is no longer there, or the input failed, for this reason.
    Missing(Option<String>),
    /// It was not there.
    New,
}

/// Takes what is measured again, and compares it with what was written.
#[derive(Debug)]
pub struct Repetition {
    before: BTreeMap<(String, String), Value>,
    order: Vec<(String, String)>,
    found: BTreeMap<(String, String), Finding>,
    failures: BTreeMap<String, String>,
}

impl Repetition {
    /// Of a document.
    pub fn of(run: &WrittenRun) -> Self {
        let mut order = Vec::new();
        let mut before = BTreeMap::new();
        // An input may have been named twice.
        for row in &run.results {
            if before.insert(key(row), row.clone()).is_none() {
                order.push(key(row));
            }
        }
        Self { before, order, found: BTreeMap::new(), failures: BTreeMap::new() }
    }

    /// What came of every object: those that were written in their order, then those that are new.
    pub fn finish(mut self) -> Vec<Repeated> {
        let mut all = Vec::new();
        for key in std::mem::take(&mut self.order) {
            let missing = || Finding::Missing(self.failures.get(&key.0).cloned());
            let finding = self.found.remove(&key).unwrap_or_else(missing);
            all.push(Repeated { input: key.0, object: key.1, finding });
        }
        all.extend(self.found.into_iter().map(|((input, object), finding)| Repeated {
            input,
            object,
            finding,
        }));
        all
    }
}

impl Sink<Record> for Repetition {
    fn row(&mut self, row: Record) -> io::Result<()> {
        // As it would be written and read.
        let now: Value = serde_json::from_str(&serde_json::to_string(&row)?)?;
        let key = key(&now);
        let finding = self.before.get(&key).map_or(Finding::New, |before| compared(before, &now));
        self.found.insert(key, finding);
        Ok(())
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.failures.insert(failure.input, failure.error);
        Ok(())
    }
}

/// Input, and what tells its objects apart.
fn key(row: &Value) -> (String, String) {
    let text = |value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let piece = Some(text(&row["component"])).filter(|piece| !piece.is_empty());
    let object = [Some(text(&row["label"])), piece.map(|piece| format!("component {piece}"))];
    (text(&row["input"]), object.into_iter().flatten().collect::<Vec<_>>().join(" "))
}

fn compared(before: &Value, now: &Value) -> Finding {
    let [before, now] = [before, now].map(flatten);
    let names = before.keys().chain(now.keys().filter(|name| !before.contains_key(*name)));
    let names = names.filter(|name| !TIMES.contains(&name.as_str()));
    let of = |row: &serde_json::Map<String, Value>, name: &str| row.get(name).cloned().unwrap_or_default();
    let differing: Vec<(&String, Value, Value)> =
        names.map(|name| (name, of(&before, name), of(&now, name))).filter(|(_, a, b)| a != b).collect();
    let hash = |name: &str| name == "input_sha256";
    let other_input = differing.iter().any(|(name, ..)| hash(name));
    let numbers = differing.iter().filter(|(name, ..)| !hash(name));
    let most = numbers.max_by(|a, b| difference(&a.1, &a.2).total_cmp(&difference(&b.1, &b.2)));
    match most.or(differing.first()) {
        None => Finding::Same,
        Some((field, before, now)) => Finding::Differs {
            other_input,
            field: (*field).clone(),
            before: before.clone(),
            now: now.clone(),
            fields: differing.len(),
        },
    }
}

/// Relative difference of two numbers; of what are none, or of which one is null, more than of any.
fn difference(before: &Value, now: &Value) -> f64 {
    match (before.as_f64(), now.as_f64()) {
        (Some(before), Some(now)) => (now - before).abs() / before.abs().max(now.abs()),
        _ => f64::INFINITY,
    }
}
