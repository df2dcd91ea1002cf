//! A bar on stderr, where that is a terminal.

use crate::inputs::grey_image_warning;
use crate::output::say;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use surfometry::runs::{Failure, InputObject};

pub(crate) fn progress_bar(inputs: usize, quiet: bool) -> ProgressBar {
    let shown = !quiet && std::io::stderr().is_terminal();
    let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{bar:24} {pos}/{len} {wide_msg}").expect("a constant template");
    ProgressBar::with_draw_target(Some(inputs as u64), target).with_style(style)
}

/// Shows which object of its input is at work; before the first of very many, says what they may be.
pub(crate) fn announce(progress: &ProgressBar, object: &InputObject) {
    let InputObject { input, number, count, .. } = object;
    progress.set_message(format!("{input}, object {} of {count}", number + 1));
    if let Some(warning) = grey_image_warning(input, *count).filter(|_| *number == 0) {
        progress.suspend(|| say(&warning));
    }
}

/// Says above the bar why an input failed, and hands that out for the results.
pub(crate) fn said_failure(progress: &ProgressBar, input: &str, error: &impl std::fmt::Display) -> Failure {
    let failure = Failure::new(input, error);
    progress.suspend(|| say(&failure.to_string()));
    failure
}
