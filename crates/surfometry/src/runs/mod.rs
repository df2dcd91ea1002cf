//! Many inputs, from names to results: one [`Batch`], a [`Task`] for each thing that is done with an input, a
//! [`Sink`] for each place where results go. Every front end is a face of these.

mod against;
mod batch;
mod beside;
mod blockwise;
mod called;
mod choices;
mod cohort_files;
mod columns;
mod cure;
mod document;
mod embed;
mod error;
mod file_ledger;
mod fingerprint;
mod flatten;
mod info;
#[cfg(feature = "pictures")]
mod joint_maps;
mod journal;
mod journalled;
mod label_scales;
mod label_words;
mod lengths;
mod made_by;
#[cfg(feature = "pictures")]
mod map;
#[cfg(feature = "pictures")]
mod map_files;
mod measure;
mod merge;
mod mixed_sigma;
mod object;
mod object_names;
mod part_tables;
#[cfg(feature = "pictures")]
pub mod picture_words;
#[cfg(feature = "pictures")]
mod pictures;
mod plan;
mod reading;
mod record;
mod reference;
mod rerun;
mod scale_ledger;
#[cfg(feature = "pictures")]
mod scene;
mod settings;
mod shard;
mod stamps;
mod surface_record;
mod surface_task;
#[cfg(feature = "pictures")]
mod sweep;
#[cfg(feature = "pictures")]
mod sweep_chart;
mod table_columns;
mod voxel_map_task;
pub mod words;

pub use against::{Against, AgainstRecord};
pub use batch::{Batch, Collected, Item, Opened, Outcome, Sink, Task};
pub use beside::{RegionImage, SampleImage};
pub use blockwise::{BlockRecord, Blockwise};
pub use called::CalledObjects;
pub use choices::Choices;
pub use cohort_files::{CohortFile, write_cohort, write_zoo};
pub use cure::Cure;
#[cfg(feature = "report")]
pub(crate) use document::csv_lines;
pub use document::{CsvSink, DocumentForm, JsonLinesSink, JsonSink, Row};
pub use embed::{EmbedTask, EmbeddedObject};
pub use error::{BesideRole, RunError};
pub use file_ledger::FileLedger;
pub use flatten::flatten;
pub use info::{AffineDescription, InfoTask, InputDescription, LabelDescription};
pub use journal::{JOURNAL_SCHEMA, Journal, JournalError, RunHead};
pub use journalled::journal_line;
pub use label_scales::LabelScales;
pub use label_words::{GroupWords, LabelWord, SelectionWords};
pub use lengths::{Length, Lengths};
pub use made_by::MadeBy;
#[cfg(feature = "pictures")]
pub use map::{MapTask, SharedFiles};
#[cfg(feature = "pictures")]
pub use map_files::{MapFile, MapStyle, write_figure, write_map_files};
pub use measure::{MeasureTask, records_of};
pub use merge::Shards;
pub use mixed_sigma::SigmaRange;
pub use object::InputObject;
pub use part_tables::{PartFiles, PartTables};
#[cfg(feature = "pictures")]
pub use pictures::Pictures;
pub use plan::{ExplainTopology, Plan};
pub use reading::Reading;
pub use record::{Failure, Record, SCHEMA};
pub use reference::{REFERENCE_SCHEMA, ReferenceRecord, ReferenceTask};
pub use rerun::{Finding, Repeated, Repetition, RerunError, WrittenRun};
pub use scale_ledger::ScaleLedger;
#[cfg(feature = "pictures")]
pub use scene::Scene;
pub use settings::Settings;
pub use shard::Shard;
pub use surface_record::{MAP_SCHEMA, RegionDistributions, SurfaceRecord};
pub use surface_task::{MappedSurface, SurfaceTask};
#[cfg(feature = "pictures")]
pub use sweep::{SweepTask, SweptParameter, SweptSurfaces};
#[cfg(feature = "pictures")]
pub use sweep_chart::SweepChart;
#[cfg(feature = "pictures")]
pub(crate) use sweep_chart::sweep_panels;
#[cfg(feature = "pictures")]
use sweep_chart::write_sweep_chart;
pub use table_columns::table_columns;
pub use voxel_map_task::{VoxelMapTask, VoxelMaps};
pub use words::WordError;
