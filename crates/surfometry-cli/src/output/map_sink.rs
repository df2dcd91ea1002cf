//! What a map's run gives: documents that grow, names of files, flags.

use super::numbers::significant;
use super::{map_flags_text, one_line, record_name, say};
use anyhow::{Result, anyhow};
use std::io;
use std::path::PathBuf;
use surfometry::io::ResultOutput;
use surfometry::runs::{AgainstRecord, Failure, JsonSink, Outcome, Record, Settings, Sink, SurfaceRecord};

/// Writes the results of a map into documents while they come, and keeps the names of all files.
pub(crate) struct MapSink {
    documents: Vec<(PathBuf, JsonSink<SurfaceRecord>)>,
    /// Files that were written.
    names: Vec<String>,
    /// Of the input in hand, where flags are to be said.
    records: Option<Vec<Record>>,
}

impl MapSink {
    /// Begins the documents.
    pub(crate) fn new(documents: Vec<PathBuf>, settings: &Settings, quiet: bool) -> Result<Self> {
        let begun = documents.into_iter().map(|path| {
            let begun = ResultOutput::create(&path).and_then(|out| JsonSink::new(out, settings));
            // Not as an error of writing: nothing is measured yet.
            let sink = begun.map_err(|error| anyhow!("{}: cannot be written: {error}", path.display()))?;
            Ok((path, sink))
        });
        let documents = begun.collect::<Result<_>>()?;
        Ok(Self { documents, names: Vec::new(), records: (!quiet).then(Vec::new) })
    }

    /// Hears of files that several objects share.
    pub(crate) fn written(&mut self, files: &[PathBuf]) {
        self.names.extend(files.iter().map(|path| path.display().to_string()));
    }

    /// Ends the documents; names of all that was written, one a line. What a run that was stopped leaves keeps
    /// the name of an unfinished file.
    pub(crate) fn finish(mut self, outcome: Outcome) -> io::Result<String> {
        for (path, sink) in self.documents {
            let unfinished = sink.finish()?.end(outcome.stopped)?;
            self.names.push(unfinished.unwrap_or(path).display().to_string());
        }
        self.names.push(String::new());
        Ok(self.names.join("\n"))
    }
}

impl Sink<SurfaceRecord> for MapSink {
    fn row(&mut self, row: SurfaceRecord) -> io::Result<()> {
        self.names.extend_from_slice(&row.files);
        if let Some(records) = &mut self.records {
            row.against.iter().for_each(|against| say(&change_text(&row.record, against)));
            records.push(row.record.clone());
        }
        self.documents.iter_mut().try_for_each(|(_, sink)| sink.row(row.clone()))
    }

    fn failure(&mut self, failure: Failure) -> io::Result<()> {
        self.documents.iter_mut().try_for_each(|(_, sink)| sink.failure(failure.clone()))
    }

    fn input_ends(&mut self) -> io::Result<()> {
        let records = self.records.as_mut().map(std::mem::take).unwrap_or_default();
        let flags = map_flags_text(&records.iter().collect::<Vec<_>>());
        if let Some(record) = records.first().filter(|_| !flags.is_empty()) {
            say(&format!("{}\n{}", one_line(&record.input), flags.trim_end()));
        }
        self.documents.iter_mut().try_for_each(|(_, sink)| sink.input_ends())
    }
}

/// How far an object's surface is from the later one, and what of that is noise, in a line.
fn change_text(record: &Record, against: &AgainstRecord) -> String {
    let (change, object) = (&against.change.distance_mm, record_name(record));
    let object = if object.is_empty() { object } else { format!(" label {object}") };
    let noise = match change.noise_rms.zip(change.share_beyond_noise) {
        Some((noise, share)) => format!(
            "{} mm would be noise; {:.0} % of the area differs by more than two standard errors, of one object about 5 %",
            significant(noise, 2),
            100.0 * share
        ),
        None => "how much of that is noise is not known".to_owned(),
    };
    format!(
        "{}{object}: to {} {:+.3} mm on the mean, rms {} mm, of which {noise}; 95 % of either surface lies within {} mm of the other",
        one_line(&record.input),
        one_line(&against.input),
        change.mean,
        significant(change.rms, 2),
        significant(against.change.hausdorff_95_mm, 2)
    )
}
