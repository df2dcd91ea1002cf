//! Names of the files that several objects are written to.

use super::Kind;
use crate::io::PACKED;
use std::collections::HashSet;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

/// Endings of two parts, which a name is split before.
const DOUBLE: [&str; 2] = [".nii.gz", ".surf.gii"];

/// A path with parts put in before its ending: `out.ply` with `L4` and `label-1` is `out_L4_label-1.ply`.
pub fn with_parts<S: AsRef<str>>(path: &Path, parts: &[S]) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (stem, ending) = split(&name);
    let inserted: String = parts.iter().flat_map(|part| ["_", part.as_ref()]).collect();
    path.with_file_name(format!("{stem}{inserted}{ending}"))
}

/// A file's name as text. Bytes that are none are shown as `\xE9`; [`open`](super::open) tells of such a name.
pub fn shown_name(name: &OsStr) -> String {
    let mut text = String::new();
    for chunk in name.as_encoded_bytes().utf8_chunks() {
        text += chunk.valid();
        text.extend(chunk.invalid().iter().map(|byte| format!("\\x{byte:02X}")));
    }
    text
}

/// Whether a name shows bytes that were no text.
pub(super) fn shows_bytes(name: &str) -> bool {
    let is_byte =
        |code: &str| code.get(..2).is_some_and(|code| u8::from_str_radix(code, 16).is_ok_and(|b| b > 127));
    name.split("\\x").skip(1).any(is_byte)
}

/// An input's name for people: a file's without its folders, a phantom's whole.
pub fn input_title(input: &str) -> String {
    match Path::new(input).file_name() {
        Some(name) if Kind::of(input).is_path() => name.to_string_lossy().into_owned(),
        _ => input.to_owned(),
    }
}

/// Labels beyond which an image is more likely a grey one.
const MANY_LABELS: usize = 1000;

/// Says so of an input with so many labels, before an hour goes by.
pub fn grey_image_warning(input: &str, labels: usize) -> Option<String> {
    (labels > MANY_LABELS)
        .then(|| format!("{input}: {labels} labels; if this is a grey image, threshold it first"))
}

/// A file's name without folders and ending, for use in other names; of a phantom, its shape's.
fn input_stem(input: &str) -> String {
    if let Some(phantom) = input.strip_prefix("phantom:") {
        return phantom.split('?').next().unwrap_or_default().to_owned();
    }
    let name = Path::new(input).file_name().unwrap_or_default().to_string_lossy().into_owned();
    split(&name).0.to_owned()
}

/// For each input what tells its files from the others': nothing where it is the only one, its stem, or,
/// where stems are alike, its folders as well, and a number where it is named twice.
pub fn distinct_parts(inputs: &[String]) -> Vec<Option<String>> {
    if inputs.len() == 1 {
        return vec![None];
    }
    let stems: Vec<String> = inputs.iter().map(|input| input_stem(input)).collect();
    let with_folders = |input: &str, stem: &str| {
        let folders = Path::new(input).parent().filter(|_| Kind::of(input).is_path());
        let names = folders.into_iter().flat_map(Path::components).filter_map(|part| match part {
            Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
            _ => None,
        });
        names.chain([stem.to_owned()]).collect::<Vec<_>>().join("-")
    };
    let mut taken = HashSet::new();
    let distinct = |(input, stem): (&String, &String)| {
        let alike = stems.iter().filter(|other| *other == stem).count() > 1;
        let name = if alike { with_folders(input, stem) } else { stem.clone() };
        let numbered = (2..).map(|n| format!("{name}-{n}"));
        [name.clone()].into_iter().chain(numbered).find(|name| taken.insert(name.clone()))
    };
    inputs.iter().zip(&stems).map(distinct).collect()
}

/// Stem and ending, the dot included.
fn split(name: &str) -> (&str, &str) {
    let lower = name.to_ascii_lowercase();
    let double =
        DOUBLE.iter().find(|ending| lower.ends_with(**ending)).map(|ending| name.len() - ending.len());
    // A leading dot hides a file and begins no ending.
    let packed =
        PACKED.iter().find_map(|ending| lower.strip_suffix(ending)).map_or(name, |stem| &name[..stem.len()]);
    let single = packed.rfind('.').or(name.rfind('.')).filter(|&at| at > 0);
    double.or(single).filter(|&at| name.is_char_boundary(at)).map_or((name, ""), |at| name.split_at(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_go_before_the_ending() {
        let with = |path: &str, parts: &[&str]| with_parts(Path::new(path), parts).display().to_string();
        assert_eq!(with("a/out.ply", &[]), "a/out.ply");
        assert_eq!(with("a.b/out.v1.ply", &["L4", "label-1"]), "a.b/out.v1_L4_label-1.ply");
        assert_eq!(with("map.NII.GZ", &["phi"]), "map_phi.NII.GZ");
        assert_eq!(with("x.surf.gii", &["label-2+3"]), "x_label-2+3.surf.gii");
        assert_eq!(with(".hidden", &["x"]), ".hidden_x");
        assert_eq!(with("bone.v2.stl.gz", &["x"]), "bone.v2_x.stl.gz");
        assert_eq!(with("bone.gz", &["x"]), "bone_x.gz");
    }

    #[test]
    fn inputs_that_look_alike_are_told_apart() {
        let parts = |inputs: &[&str]| -> Vec<String> {
            let inputs: Vec<String> = inputs.iter().map(ToString::to_string).collect();
            distinct_parts(&inputs).into_iter().map(Option::unwrap_or_default).collect()
        };
        assert_eq!(parts(&["a/L4.nii"]), [""]);
        assert_eq!(parts(&["a/L4.nii", "b/L5.nii.gz"]), ["L4", "L5"]);
        assert_eq!(parts(&["a/L4.nii", "../b/L4.nii.gz", "L4.mha"]), ["a-L4", "b-L4", "L4"]);
        assert_eq!(parts(&["L4.nii", "L4.nii", "L4.mha"]), ["L4", "L4-2", "L4-3"]);
        assert_eq!(parts(&["phantom:ball?radius=3", "phantom:ball?radius=4"]), ["ball", "ball-2"]);
    }

    #[cfg(unix)]
    #[test]
    fn names_that_are_no_text() {
        use std::os::unix::ffi::OsStrExt;
        let shown = shown_name(OsStr::from_bytes(b"M\xfcller \xc3\xa9.nii"));
        assert_eq!(shown, "M\\xFCller \u{e9}.nii");
        assert!(shows_bytes(&shown));
        assert!(!shows_bytes("a\\x41.nii") && !shows_bytes("a\\x") && !shows_bytes("a\\x\u{e9}\u{e9}"));
    }

    #[test]
    fn stems_of_inputs() {
        assert_eq!(input_stem("scans/L4.nii.gz"), "L4");
        assert_eq!(input_stem("phantom:torus?major=3"), "torus");
        assert_eq!(input_stem("é.nrrd"), "é");
    }
}
