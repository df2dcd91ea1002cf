//! Files that are damaged, and objects that nobody would draw, by the hundred thousand: nothing panics, hangs or takes memory that
//! the data do not need. docs/reliability.md has what was run and found.
//!
//! Own mutations in the place of cargo-fuzz: that wants a nightly compiler's instrumentation, and every input here is a
//! hundred bytes of a known layout. What was found is a test in `crates/surfometry/tests`.

mod chance;
mod damage;
mod seeds;
mod trial;

use anyhow::{Result, bail};
use chance::Chance;
use clap::Parser;
use std::path::{Path, PathBuf};
use trial::{Tally, Watchdog};

/// Damage files and see what becomes of them
#[derive(Debug, Parser)]
struct Args {
    /// What is tried
    #[arg(value_enum)]
    what: What,
    /// How many cases by chance
    #[arg(long, default_value_t = 10_000)]
    count: u64,
    /// Where chance begins
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only files of this ending
    #[arg(long)]
    ending: Option<String>,
    /// Folder for what went wrong
    #[arg(long)]
    keep: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum What {
    /// Files of every kind, damaged by chance
    Files,
    /// Every field with every hostile value, and truncations
    Matrix,
    /// Every bit of compressed files
    Flips,
    /// Objects by chance
    Objects,
}

fn main() -> Result<()> {
    let args = Args::parse();
    // What panics is counted; its words stand in the list.
    std::panic::set_hook(Box::new(|_| {}));
    let tally = tried(&args)?;
    println!(
        "{:?}: {} cases, {} accepted, {} refused in words, {} faults; slowest {:.2} s, peak {} MB",
        args.what,
        tally.accepted + tally.refused + tally.faults.len() as u64,
        tally.accepted,
        tally.refused,
        tally.faults.len(),
        tally.slowest.as_secs_f64(),
        trial::peak_megabytes()
    );
    for fault in tally.faults.iter().take(20) {
        println!("  {fault}");
    }
    if tally.faults.is_empty() { Ok(()) } else { bail!("{} faults", tally.faults.len()) }
}

fn tried(args: &Args) -> Result<Tally> {
    // Tmpfs where there is one: a file a case.
    let place = Path::new("/dev/shm");
    let folder = if place.is_dir() { tempfile::tempdir_in(place)? } else { tempfile::tempdir()? };
    let (dog, mut tally) = (Watchdog::new(), Tally::default());
    let wanted = |seed: &seeds::Seed| args.ending.as_ref().is_none_or(|ending| ending == seed.ending);
    let files: Vec<seeds::Seed> = seeds::files().into_iter().filter(wanted).collect();
    let mut chance = Chance(args.seed);
    match args.what {
        What::Files => {
            for case in 0..args.count {
                let seed = chance.of(&files);
                let bytes = damage::by_chance(seed, &files, &mut chance);
                let measures = case % 64 == 0;
                tried_file(args, (&dog, &mut tally), (case, folder.path(), seed.ending), &bytes, |path| {
                    trial::read(path, measures)
                })?;
            }
        }
        What::Matrix => {
            let cases = files.iter().flat_map(|seed| {
                damage::one_at_a_time(seed).into_iter().map(move |bytes| (seed.ending, bytes))
            });
            for (case, (ending, bytes)) in (0..).zip(cases) {
                tried_file(args, (&dog, &mut tally), (case, folder.path(), ending), &bytes, |path| {
                    trial::read(path, true)
                })?;
            }
        }
        What::Flips => flips(args, &dog, &mut tally, folder.path())?,
        What::Objects => {
            for case in 0..args.count {
                dog.run(case, &mut tally, || {
                    trial::measure(&mut Chance(args.seed.wrapping_mul(1 << 32) + case))
                });
            }
        }
    }
    Ok(tally)
}

fn tried_file(
    args: &Args,
    (dog, tally): (&Watchdog, &mut Tally),
    (case, folder, ending): (u64, &Path, &str),
    bytes: &[u8],
    work: impl FnOnce(&Path) -> Result<(), String>,
) -> Result<()> {
    let path = folder.join(format!("case.{ending}"));
    std::fs::write(&path, bytes)?;
    let faults = tally.faults.len();
    dog.run(case, tally, || work(&path));
    if let (true, Some(keep)) = (tally.faults.len() > faults, &args.keep) {
        std::fs::create_dir_all(keep)?;
        std::fs::write(keep.join(format!("{case}.{ending}")), bytes)?;
    }
    Ok(())
}

/// Every bit behind the header of every compressed file: what is read is refused, or the same.
fn flips(args: &Args, dog: &Watchdog, tally: &mut Tally, folder: &Path) -> Result<()> {
    let mut case = 0;
    for seed in seeds::compressed() {
        let whole = folder.join(format!("whole.{}", seed.ending));
        std::fs::write(&whole, &seed.bytes)?;
        let image = trial::labels(&whole).map_err(anyhow::Error::msg)?;
        for bit in 8 * damage::header_end(&seed)..8 * seed.bytes.len() {
            let mut bytes = seed.bytes.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            tried_file(args, (dog, tally), (case, folder, seed.ending), &bytes, |path| {
                let same = trial::same(&image, &trial::labels(path)?);
                if same {
                    Ok(())
                } else {
                    Err(format!("WRONG: bit {bit} of a .{} gives other voxels", seed.ending))
                }
            })?;
            case += 1;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(what: What, count: u64) -> Tally {
        std::panic::set_hook(Box::new(|_| {}));
        let tally = tried(&Args { what, count, seed: 7, ending: None, keep: None }).unwrap();
        assert!(tally.faults.is_empty(), "{:?}", tally.faults);
        assert!(trial::peak_megabytes() < 1000);
        tally
    }

    /// A sample of what docs/reliability.md has figures of.
    #[test]
    fn damage_is_refused_in_words() {
        let files = sample(What::Files, 5000);
        assert!(files.refused > 1000 && files.accepted > 100, "{files:?}");
        let objects = sample(What::Objects, 100);
        assert!(objects.accepted > 50, "{objects:?}");
    }

    #[test]
    fn seeds_are_right() {
        let folder = tempfile::tempdir().unwrap();
        for seed in seeds::files() {
            let path = folder.path().join(format!("seed.{}", seed.ending));
            std::fs::write(&path, &seed.bytes).unwrap();
            trial::read(&path, true).unwrap_or_else(|error| panic!("{}: {error}", seed.ending));
        }
        assert_eq!(seeds::compressed().len(), 5);
    }
}
