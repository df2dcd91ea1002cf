//! `embed`: the blurred mask made binary again, where closed forms say what is left of it.

use std::path::PathBuf;
use std::process::{Command, Output};
use surfometry::io::{read_labels, write_labels};
use surfometry::volume::{Grid, LabelImage};

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_surfometry")).args(args).output().expect("the program runs")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

const SIZE: [usize; 3] = [34, 34, 40];

/// A folder with an image whose voxels have the labels that a function says.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new(label: impl Fn([usize; 3]) -> u8) -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        let [nx, ny, nz] = SIZE;
        let at = (0..nx * ny * nz).map(|n| [n % nx, n / nx % ny, n / (nx * ny)]);
        let voxels: Vec<u8> = at.map(label).collect();
        // 1 mm across the plates, whatever it is along them.
        let grid = Grid::axis_aligned(SIZE, [1.4, 0.7, 1.0]).unwrap();
        write_labels(desk.path("in.nii.gz"), &LabelImage::from_voxels(grid, &voxels).unwrap()).unwrap();
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn embed(&self, options: &[&str]) -> Output {
        let (input, output) = (self.path("in.nii.gz"), self.path("out.nii.gz"));
        run(&[&["embed", input.to_str().unwrap(), "-o", output.to_str().unwrap()], options].concat())
    }

    /// The labels along the axis of the plates, in their middle.
    fn middle(&self) -> Vec<i64> {
        let image = read_labels(self.path("out.nii.gz")).expect("it was written");
        let labels: Vec<i64> = image.summaries().iter().map(|summary| summary.label).collect();
        let masks: Vec<_> = labels.iter().map(|&label| (label, image.mask(label))).collect();
        let at = |z: usize| {
            let is_in = |(_, mask): &&(i64, surfometry::volume::Mask)| mask.get([17, 17, z as i64]);
            masks.iter().find(is_in).map_or(0, |(label, _)| *label)
        };
        (0..SIZE[2]).map(at).collect()
    }
}

/// Whether a voxel lies off the image's sides, so that nothing is cut.
fn is_within([x, y, _]: [usize; 3]) -> bool {
    (3..31).contains(&x) && (3..31).contains(&y)
}

/// Plates of 9 and 3 slices, of which a blur of 2 leaves a share of (erf((z + w / 2) / 2.83) - erf((z - w / 2) /
/// 2.83)) / 2 of a voxel z off the middle: 0.547 and 0.493 in the thin one, so that its middle slice stays alone;
/// 0.512 and 0.323 at the end of the thick one, which stays as it is.
#[test]
fn the_blurred_mask_is_written_by_default() {
    let desk = Desk::new(|at| match at[2] {
        _ if !is_within(at) => 0,
        6..15 => 7,
        25..28 => 4,
        _ => 0,
    });
    let output = desk.embed(&["--sigma", "2"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let plates = |thin: std::ops::Range<usize>| -> Vec<i64> {
        let label = |z: usize| if (6..15).contains(&z) { 7 } else { 4 * i64::from(thin.contains(&z)) };
        (0..SIZE[2]).map(label).collect()
    };
    assert_eq!(desk.middle(), plates(26..27));
    let shown = text(&output.stdout);
    assert!(shown.contains("gaussian") && shown.contains("! thickness-above-object (label 4)"), "{shown}");
    // So it is at defaults, which have no sigma, and recovering gives the plate back.
    assert!(desk.embed(&[]).status.success());
    assert_eq!(desk.middle(), plates(26..27));
    assert!(desk.embed(&["--embedding", "recovering"]).status.success());
    assert_eq!(desk.middle(), plates(25..28));
}

/// A plate of 2 slices, of whose middle a blur of 2 leaves erf(0.354) = 0.38: nothing is left of it. The others are
/// written, and without others nothing is.
#[test]
fn what_vanishes_has_failed() {
    let plates = |at: [usize; 3]| match at[2] {
        _ if !is_within(at) => 0,
        6..15 => 7,
        25..27 => 4,
        _ => 0,
    };
    let desk = Desk::new(plates);
    let output = desk.embed(&["--sigma", "2"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("label 4: nothing is left inside"), "{}", text(&output.stderr));
    assert_eq!(desk.middle().iter().filter(|label| **label == 7).count(), 9);
    assert!(!desk.middle().contains(&4));
    let alone = Desk::new(|at| if plates(at) == 4 { 4 } else { 0 });
    let output = alone.embed(&["--sigma", "2", "--label", "4"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stdout));
    assert!(!alone.path("out.nii.gz").exists());
}

/// Two blocks and a thin bridge between them, which the blur breaks: `measure --embedding gaussian` and `embed` say so
/// in the same words.
#[test]
fn what_breaks_is_flagged() {
    let desk = Desk::new(|at| {
        let bridge = (16..18).contains(&at[0]) && (15..19).contains(&at[1]);
        u8::from(
            is_within(at)
                && ((5..14).contains(&at[2])
                    || (26..35).contains(&at[2])
                    || bridge && (5..35).contains(&at[2])),
        )
    });
    let output = desk.embed(&["--sigma", "2"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let input = desk.path("in.nii.gz");
    let measured = run(&["measure", input.to_str().unwrap(), "--sigma", "2", "--embedding", "gaussian"]);
    let flags = |output: &Output| -> Vec<String> {
        text(&output.stdout).lines().filter(|line| line.starts_with("  ! ")).map(str::to_owned).collect()
    };
    assert!(flags(&output).iter().any(|flag| flag.contains("euler-differs-from-voxels")), "{output:?}");
    assert_eq!(flags(&output), flags(&measured));
}

/// A voxel has one value, so no two objects may have it.
#[test]
fn objects_that_share_a_label_are_refused() {
    let desk =
        Desk::new(|at| if is_within(at) && (6..30).contains(&at[2]) { 1 + u8::from(at[2] > 17) } else { 0 });
    for selection in ["1+2,1", "2,1+2", "1+2,2+1"] {
        let output = desk.embed(&["--label", selection]);
        assert_eq!(output.status.code(), Some(2), "{selection}");
        let told = text(&output.stderr);
        assert!(told.contains("share label") && told.contains("name each label once"), "{told}");
        assert!(!desk.path("out.nii.gz").exists());
    }
    assert!(desk.embed(&["--label", "1+2"]).status.success());
}

/// Of several inputs the second has the name that the first one's image would get: nothing is written, not even of the
/// input whose image would be in nobody's way.
#[test]
fn no_input_is_replaced() {
    let desk = Desk::new(|at| u8::from(is_within(at) && (6..30).contains(&at[2])));
    let names = ["x.nii.gz", "a.nii.gz", "s_a.nii.gz"].map(|name| desk.path(name));
    for name in &names {
        std::fs::copy(desk.path("in.nii.gz"), name).unwrap();
    }
    let before = std::fs::read(&names[2]).unwrap();
    let [x, a, s_a] = names.each_ref().map(|name| name.to_str().unwrap());
    let output = run(&["embed", x, a, s_a, "-o", desk.path("s.nii.gz").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stdout));
    assert!(text(&output.stderr).contains("s_a.nii.gz: the output would replace the input"), "{output:?}");
    assert!(!desk.path("s_x.nii.gz").exists() && std::fs::read(s_a).unwrap() == before);
}
