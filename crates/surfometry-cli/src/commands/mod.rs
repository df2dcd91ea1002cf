//! One file a command.

pub(crate) mod cohort;
pub(crate) mod compare;
pub(crate) mod embed;
pub(crate) mod generate;
pub(crate) mod info;
pub(crate) mod map;
pub(crate) mod measure;
pub(crate) mod merge;
pub(crate) mod phantom;
pub(crate) mod reference;
pub(crate) mod report;
pub(crate) mod rerun;
pub(crate) mod sweep;
pub(crate) mod validate;

/// Exit status: everything was done.
pub(crate) const ALL_DONE: u8 = 0;
/// Exit status: some inputs failed, which are listed, or what was measured could not be written.
pub(crate) const SOME_FAILED: u8 = 1;
/// Exit status: the command itself was wrong, which is told before anything is measured.
pub(crate) const WRONG_COMMAND: u8 = 2;
