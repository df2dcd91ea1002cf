//! Names and colours of labels in extensions of NIfTI: a Caret label table, as Connectome Workbench and
//! `TotalSegmentator --ml` write it.
//!
//! # References
//! nifti1.h on extensions; <https://www.nitrc.org/projects/caret> for the table.

use super::header::ByteOrder;
use super::label_names::distinct;
use crate::volume::{LabelEntry, LabelTable};
use roxmltree::{Document, Node};

/// The table in what stands between a header and the voxels: a mark of four bytes, then extensions of a size, a code and
/// content. Extensions of other programs are passed over, and so is one that cannot be read.
///
/// # Errors
/// A label with two names.
pub(super) fn labels(between: &[u8], order: ByteOrder) -> Result<LabelTable, String> {
    let marked = between.first().is_some_and(|mark| *mark != 0);
    let rest = between.get(4..).filter(|_| marked).unwrap_or_default();
    extensions(rest, order).find_map(of_extension).unwrap_or_else(|| Ok(LabelTable::default()))
}

/// The contents of extensions, one behind the other.
fn extensions(mut rest: &[u8], order: ByteOrder) -> impl Iterator<Item = &[u8]> {
    std::iter::from_fn(move || {
        let size = rest.first_chunk()?;
        let size = match order {
            ByteOrder::Little => u32::from_le_bytes(*size),
            ByteOrder::Big => u32::from_be_bytes(*size),
        };
        let (extension, others) = rest.split_at_checked(size as usize)?;
        rest = others;
        // A size that does not hold itself and the code ends the list.
        extension.get(8..)
    })
}

fn of_extension(content: &[u8]) -> Option<Result<LabelTable, String>> {
    // XML has no control characters; names may.
    let text = str::from_utf8(content).ok()?.replace(|c: char| c.is_control(), " ");
    let document = Document::parse(text.trim()).ok()?;
    let table = document.descendants().find(|node| node.has_tag_name("LabelTable"))?;
    let entries = table.children().filter(|node| node.has_tag_name("Label")).zip(1..);
    let rows = entries.filter_map(|(node, number)| Some((format!("entry {number}"), of_label(node)?)));
    Some(distinct(rows).map(|rows| rows.into_iter().collect()))
}

fn of_label(node: Node) -> Option<(i64, LabelEntry)> {
    let label = node.attribute("Key")?.trim().parse().ok().filter(|label| *label != 0)?;
    let part = |name: &str| Some(of_share(node.attribute(name)?.trim().parse().ok()?));
    let colour = || Some([part("Red")?, part("Green")?, part("Blue")?]);
    Some((label, LabelEntry { name: node.text().map(str::to_owned), colour: colour() }))
}

/// A share of full brightness, 0 to 1, as a byte.
pub(super) fn of_share(share: f64) -> u8 {
    (share.clamp(0.0, 1.0) * 255.0).round() as u8
}
