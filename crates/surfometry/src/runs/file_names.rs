//! Names of the files that several objects are written to.

use std::path::{Path, PathBuf};

/// Endings of two parts, which a name is split before.
const DOUBLE: [&str; 2] = [".nii.gz", ".surf.gii"];

/// A path with parts put in before its ending: `out.ply` with `L4` and `label-1` is `out_L4_label-1.ply`.
pub fn with_parts<S: AsRef<str>>(path: &Path, parts: &[S]) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (stem, ending) = split(&name);
    let inserted: String = parts.iter().flat_map(|part| ["_", part.as_ref()]).collect();
    path.with_file_name(format!("{stem}{inserted}{ending}"))
}

/// A file's name without folders and ending, for use in other names; of a phantom, its shape's.
pub fn input_stem(input: &str) -> String {
    if let Some(phantom) = input.strip_prefix("phantom:") {
        return phantom.split('?').next().unwrap_or_default().to_owned();
    }
    let name = Path::new(input).file_name().unwrap_or_default().to_string_lossy().into_owned();
    split(&name).0.to_owned()
}

/// Stem and ending, the dot included.
fn split(name: &str) -> (&str, &str) {
    let lower = name.to_lowercase();
    let double =
        DOUBLE.iter().find(|ending| lower.ends_with(**ending)).map(|ending| name.len() - ending.len());
    // A leading dot hides a file and begins no ending.
    let single = name.rfind('.').filter(|&at| at > 0);
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
    }

    #[test]
    fn stems_of_inputs() {
        assert_eq!(input_stem("scans/L4.nii.gz"), "L4");
        assert_eq!(input_stem("phantom:torus?major=3"), "torus");
        assert_eq!(input_stem("é.nrrd"), "é");
    }
}
