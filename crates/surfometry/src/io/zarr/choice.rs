//! Which array a folder stands for.

use super::name_one;
use super::node::{Node, error, is_zarr};
use crate::io::ReadError;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// How far above an array its image may be.
const LEVELS_UP: usize = 3;

/// An array, and the image that says where it lies.
pub(super) struct Chosen {
    pub(super) array: PathBuf,
    pub(super) image: Option<Node>,
    /// The array's name in the image.
    pub(super) level: String,
    /// Metadata of the groups that say so, the image's among them.
    pub(super) groups: Vec<PathBuf>,
}

/// Of an array itself (`image.zarr/1`: the second resolution); of an image with one set of labels these; else the
/// image's first resolution, which is the full one.
pub(super) fn choose(path: &Path) -> Result<Chosen, ReadError> {
    let node = Node::read(path)?;
    if node.is_array() {
        return Ok(of_array(path));
    }
    let own = node.files();
    let chosen = below_group(path, node)?;
    Ok(Chosen { groups: [own, chosen.groups].concat(), ..chosen })
}

/// An array that is named itself.
fn of_array(path: &Path) -> Chosen {
    let array = path.to_owned();
    match image_of(path) {
        Some((image, level)) => Chosen { array, groups: image.files(), image: Some(image), level },
        None => Chosen { array, groups: Vec::new(), image: None, level: String::new() },
    }
}

/// What a group stands for; its own metadata are added by who knows them.
fn below_group(path: &Path, node: Node) -> Result<Chosen, ReadError> {
    check_version(&node)?;
    for (key, kind) in [("plate", "a plate"), ("well", "a well of a plate")] {
        if !node.ome(key).is_null() {
            return Err(error(format!(
                "{kind}, which holds many images: name one of them, such as FOLDER/A/1/0"
            )));
        }
    }
    if let Value::Array(names) = node.ome("labels") {
        return of_labels(path, names);
    }
    if node.ome("multiscales").is_null() {
        return of_group(&node);
    }
    // Labels have no labels of their own.
    let labels = path.join("labels");
    if node.ome("image-label").is_null()
        && is_zarr(&labels)
        && let Value::Array(names) = Node::read(&labels)?.ome("labels")
        && !names.is_empty()
    {
        return choose(&labels);
    }
    let first = node.ome("multiscales").pointer("/0/datasets/0/path").and_then(Value::as_str);
    let level =
        first.ok_or_else(|| error("multiscales without datasets; export the image again"))?.to_owned();
    Ok(Chosen { array: below(path, &level)?, image: Some(node), level, groups: Vec::new() })
}

/// The one set of labels of an image.
fn of_labels(folder: &Path, names: &[Value]) -> Result<Chosen, ReadError> {
    let names: Vec<String> = names.iter().filter_map(|name| name.as_str().map(str::to_owned)).collect();
    match &names[..] {
        [name] => choose(&below(folder, name)?),
        _ => Err(name_one(&format!("{} sets of labels", names.len()), folder, &names)),
    }
}

/// A group that is no image: with one image or array in it, this is meant.
fn of_group(group: &Node) -> Result<Chosen, ReadError> {
    let entries = group.path.read_dir().map_err(|e| ReadError::io(&group.path, e))?;
    let is_node = |entry: &std::fs::DirEntry| is_zarr(&entry.path()) && entry.file_name() != "OME";
    let mut names: Vec<String> = entries
        .filter_map(Result::ok)
        .filter(is_node)
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    match &names[..] {
        [] => Err(error("a group without images or arrays; name the folder of an image")),
        [name] => choose(&group.path.join(name)),
        _ => Err(name_one("a group of several images or arrays", &group.path, &names)),
    }
}

/// The image that an array is a resolution of, and its name there.
fn image_of(array: &Path) -> Option<(Node, String)> {
    let full = array.canonicalize().ok()?;
    full.ancestors().skip(1).take(LEVELS_UP).find_map(|folder| {
        let image = Node::read(folder).ok()?;
        let datasets = image.ome("multiscales").pointer("/0/datasets")?.as_array()?;
        let level = datasets
            .iter()
            .filter_map(|dataset| dataset.get("path")?.as_str())
            .find(|level| folder.join(level) == full)?;
        let level = level.to_owned();
        Some((image, level))
    })
}

/// A path within a folder, which does not lead out of it.
fn below(folder: &Path, name: &str) -> Result<PathBuf, ReadError> {
    let inside = Path::new(name).components().all(|part| matches!(part, std::path::Component::Normal(_)));
    if inside {
        Ok(folder.join(name))
    } else {
        Err(error(format!("the path {name}, which leads out of the image; export it again")))
    }
}

/// Versions that are known. What comes after them has transformations of another form.
fn check_version(node: &Node) -> Result<(), ReadError> {
    let version =
        node.ome("version").as_str().or_else(|| node.ome("multiscales").pointer("/0/version")?.as_str());
    let minor =
        version.and_then(|version| version.strip_prefix("0.")?.split(['.', '-']).next()?.parse::<u32>().ok());
    match version {
        Some(version) if minor.is_none_or(|minor| minor > 5) => Err(error(format!(
            "OME-Zarr {version}, where versions up to 0.5 are read: its transformations have another form; save the image as 0.5 or 0.4"
        ))),
        _ => Ok(()),
    }
}
