//! `surfometry`: measures the surfaces of segmented 3-D objects.

use std::process::ExitCode;

fn main() -> ExitCode {
    surfometry_cli::run(std::env::args_os()).into()
}
