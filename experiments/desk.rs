//! Where an experiment puts what it finds: numbers, figures, and the text around them.

use crate::bones::{self, Bone};
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use surfometry::pictures::Figure;

/// This folder, and where the page goes.
const HERE: &str = env!("CARGO_MANIFEST_DIR");
const PAGE: &str = "../docs/reproduction.md";
const IMAGES: &str = "../docs/images/reproduction";
/// Relative difference from which on a number is another one: sums are the same bits everywhere, the system's
/// mathematical functions need not be.
const TOLERANCE: f64 = 1e-9;

/// A named result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Number {
    name: String,
    value: f64,
}

/// An experiment's desk.
pub(crate) struct Desk {
    root: PathBuf,
    name: &'static str,
    numbers: Vec<Number>,
    text: String,
}

impl Desk {
    pub(crate) fn new(root: &Path, name: &'static str) -> Result<Self> {
        let desk = Self { root: root.to_owned(), name, numbers: Vec::new(), text: String::new() };
        fs::create_dir_all(desk.folder()).with_context(|| desk.folder().display().to_string())?;
        Ok(desk)
    }

    /// Forgets what was done.
    pub(crate) fn clear(&self) -> Result<()> {
        fs::remove_dir_all(self.folder())?;
        Ok(fs::create_dir_all(self.folder())?)
    }

    /// Its folder of results.
    pub(crate) fn folder(&self) -> PathBuf {
        self.root.join(self.name)
    }

    /// A file that another experiment left.
    pub(crate) fn of_other(&self, experiment: &str, file: &str) -> PathBuf {
        self.root.join(experiment).join(file)
    }

    /// The cohort, made where it is not there.
    pub(crate) fn cohort(&self) -> Result<Vec<Bone>> {
        bones::cohort(&self.root.join("cohort"))
    }

    pub(crate) fn is_done(&self) -> bool {
        self.numbers_file().exists()
    }

    /// Keeps a number, and hands it back.
    pub(crate) fn number(&mut self, name: impl Into<String>, value: f64) -> f64 {
        self.numbers.push(Number { name: name.into(), value });
        value
    }

    /// Adds a paragraph, or a table.
    pub(crate) fn say(&mut self, text: &str) {
        let _ = writeln!(self.text, "{text}\n");
    }

    /// Adds a figure.
    pub(crate) fn figure(&mut self, name: &str, figure: &Figure, caption: &str) -> Result<()> {
        self.figures(&[(name.to_owned(), figure.clone())], caption)
    }

    /// Adds figures that belong together, two beside each other.
    pub(crate) fn figures(&mut self, figures: &[(String, Figure)], caption: &str) -> Result<()> {
        let mut tags = String::new();
        let width = if figures.len() == 1 { 80 } else { 48 };
        for (name, figure) in figures {
            let file = format!("{}-{name}.png", self.name);
            fs::write(self.folder().join(&file), figure.to_png(1.0)?)?;
            let _ =
                writeln!(tags, "<img src=\"images/reproduction/{file}\" width=\"{width}%\" alt=\"{name}\">");
        }
        self.say(&format!("{tags}\n*{caption}*"));
        Ok(())
    }

    /// Writes numbers and section; the numbers last, as they say that all is done.
    pub(crate) fn finish(&self, title: &str) -> Result<()> {
        let command = format!("`cargo run --release -p surfometry-experiments -- {}`", self.name);
        fs::write(self.section_file(), format!("## {title}\n\n{}{command}\n", self.text))?;
        let mut writer = csv::Writer::from_path(self.numbers_file())?;
        self.numbers.iter().try_for_each(|number| writer.serialize(number))?;
        Ok(writer.flush()?)
    }

    /// Where numbers differ from the expected ones, a line each.
    pub(crate) fn differences(&self) -> Result<Vec<String>> {
        let (found, expected) = (read(&self.numbers_file())?, read(&self.expected_file())?);
        let same =
            |a: f64, b: f64| (a - b).abs() <= TOLERANCE * b.abs().max(1e-6) || (a.is_nan() && b.is_nan());
        let mut lines = Vec::new();
        for Number { name, value } in &expected {
            match found.iter().find(|number| number.name == *name) {
                Some(number) if same(number.value, *value) => {}
                Some(number) => {
                    lines.push(format!("{}: {name} is {}, expected {value}", self.name, number.value));
                }
                None => lines.push(format!("{}: {name} is missing", self.name)),
            }
        }
        let new = found.iter().filter(|number| !expected.iter().any(|e| e.name == number.name));
        lines.extend(new.map(|number| format!("{}: {} is new", self.name, number.name)));
        Ok(lines)
    }

    /// Makes the numbers the expected ones.
    pub(crate) fn accept(&self) -> Result<()> {
        fs::create_dir_all(self.expected_file().parent().context("a file in a folder")?)?;
        fs::copy(self.numbers_file(), self.expected_file())?;
        let images = Path::new(HERE).join(IMAGES);
        fs::create_dir_all(&images)?;
        // Figures that are no longer made.
        for entry in fs::read_dir(&images)? {
            let entry = entry?;
            if entry.file_name().to_string_lossy().starts_with(&format!("{}-", self.name)) {
                fs::remove_file(entry.path())?;
            }
        }
        for entry in fs::read_dir(self.folder())? {
            let path = entry?.path();
            if path.extension().is_some_and(|ending| ending == "png") {
                fs::copy(&path, images.join(path.file_name().context("a file")?))?;
            }
        }
        Ok(())
    }

    fn numbers_file(&self) -> PathBuf {
        self.folder().join("numbers.csv")
    }

    fn section_file(&self) -> PathBuf {
        self.folder().join("section.md")
    }

    fn expected_file(&self) -> PathBuf {
        Path::new(HERE).join(self.name).join("expected/numbers.csv")
    }
}

fn read(path: &Path) -> Result<Vec<Number>> {
    let mut reader = csv::Reader::from_path(path).with_context(|| path.display().to_string())?;
    Ok(reader.deserialize().collect::<Result<_, _>>()?)
}

/// Puts the sections together.
pub(crate) fn write_page(root: &Path, names: &[&str]) -> Result<()> {
    let mut page = include_str!("introduction.md").to_owned();
    for name in names {
        let file = root.join(name).join("section.md");
        let section = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
        let _ = write!(page, "\n{section}");
    }
    Ok(fs::write(Path::new(HERE).join(PAGE), page)?)
}
