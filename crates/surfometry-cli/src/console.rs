//! What a person sees of a run on stderr: a bar where that is a terminal, failures, notes; and Ctrl-C.

use crate::output::{one_line, say};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use surfometry::inputs::grey_image_warning;
use surfometry::{Control, Event};

/// How much is said.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Voice {
    /// Nothing but failures.
    pub(crate) quiet: bool,
    /// Also how much memory was needed.
    pub(crate) memory: bool,
}

/// How long a run may take to stop after Ctrl-C before it is ended where it is: what was finished is written
/// by then.
const PATIENCE: Duration = Duration::from_millis(150);
/// What is done before a run is ended where it is.
static BEFORE_THE_END: Mutex<Option<Box<dyn FnOnce() + Send>>> = Mutex::new(None);
/// Exit status of a run that Ctrl-C ended, as shells have it.
pub(crate) const INTERRUPTED: u8 = 130;

/// The control of a run over some inputs, whose events are shown, and which Ctrl-C stops.
pub(crate) fn control(steps: usize, voice: Voice) -> Control {
    let bar = progress_bar(steps, voice.quiet);
    let warned: Mutex<Vec<String>> = Mutex::default();
    let control = Control::heard_by(move |event| {
        show(event, &bar, voice, &warned);
        if steps == 1 {
            show_stage(event, &bar);
        }
    });
    let stopped = control.clone();
    // Where there is no handler to be had, Ctrl-C ends the program as it always does.
    let _ = ctrlc::set_handler(move || {
        if stopped.is_stopped() {
            std::process::exit(i32::from(INTERRUPTED));
        }
        stopped.stop();
        std::thread::spawn(|| {
            std::thread::sleep(PATIENCE);
            let last = BEFORE_THE_END.lock().unwrap_or_else(PoisonError::into_inner).take();
            if let Some(last) = last {
                last();
            }
            say(STOPPED);
            std::process::exit(i32::from(INTERRUPTED));
        });
    });
    control
}

/// Has something done before a run that does not stop by itself is ended where it is.
pub(crate) fn before_the_end(last: impl FnOnce() + Send + 'static) {
    *BEFORE_THE_END.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(last));
}

/// What is said of a run that Ctrl-C ended.
pub(crate) const STOPPED: &str =
    "stopped; what was finished is written (to NAME.partial, where -o NAME was given)";

pub(crate) fn progress_bar(steps: usize, quiet: bool) -> ProgressBar {
    let shown = !quiet && std::io::stderr().is_terminal();
    let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{bar:20} {pos}/{len} {eta:>4} left {wide_msg}");
    let style = style.expect("a constant template");
    ProgressBar::with_draw_target(Some(steps as u64), target).with_style(style)
}

fn show(event: &Event, bar: &ProgressBar, voice: Voice, warned: &Mutex<Vec<String>>) {
    let say_above = |text: &str| bar.suspend(|| say(text));
    let warn_once = |input: &str, labels: usize| {
        let Some(warning) = grey_image_warning(input, labels).filter(|_| !voice.quiet) else { return };
        let mut warned = warned.lock().unwrap_or_else(PoisonError::into_inner);
        if !warned.iter().any(|name| name == input) {
            warned.push(input.to_owned());
            say_above(&warning);
        }
    };
    match *event {
        Event::Started { input } => bar.set_message(one_line(input).into_owned()),
        Event::Slices { input, done, of, labels } => {
            warn_once(input, labels);
            bar.set_message(format!("{}, slice {done} of {of}", one_line(input)));
        }
        Event::Object { input, number, of } => {
            warn_once(input, of);
            bar.set_message(format!("{}, object {number} of {of}", one_line(input)));
        }
        Event::Note { input, text } => say_above(&format!("{}: {text}", one_line(input))),
        Event::Failed { input, error } => say_above(&format!("{}: {error}", one_line(input))),
        Event::Finished { input } => {
            bar.inc(1);
            if voice.memory {
                say_above(&memory_text(input));
            }
        }
        _ => {}
    }
}

/// Of one input alone the bar is that of the stage in hand, so that what is left of it can be told.
fn show_stage(event: &Event, bar: &ProgressBar) {
    let (Event::Slices { done, of, .. } | Event::Object { number: done, of, .. }) = *event else { return };
    if bar.length() != Some(of as u64) || bar.position() > done as u64 {
        bar.reset();
        bar.set_length(of as u64);
    }
    bar.set_position(done as u64);
}

/// The most memory that the program held so far (Linux tells it).
fn memory_text(input: &str) -> String {
    peak_memory().map_or_else(
        || format!("{input}: peak memory unknown on this system"),
        |mib| format!("{input}: peak memory so far {mib:.0} MiB"),
    )
}

fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}
