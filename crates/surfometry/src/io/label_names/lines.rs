//! Names of labels in lines of text: colour tables of FreeSurfer and 3D Slicer, label descriptions of ITK-SNAP, CSV and TSV.

use super::{EXPECTED, Row, distinct, row};
use crate::volume::LabelTable;

/// The table in a text.
pub(super) fn table(text: &str) -> Result<LabelTable, String> {
    let is_said = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let first = text.lines().find(is_said).unwrap_or_default();
    let rows = match [',', '\t', ';'].into_iter().find(|separator| first.contains(*separator)) {
        Some(separator) if of_words(first).is_none() => separated(text, separator)?,
        _ => {
            let lines = text.lines().zip(1..).filter(|(line, _)| is_said(line));
            let read = |(line, number)| {
                let row = of_words(line).ok_or_else(|| {
                    format!("line {number}, `{}`: no label with a name; {EXPECTED}", start(line))
                });
                row.map(|row| (number, row))
            };
            lines.map(read).collect::<Result<_, _>>()?
        }
    };
    let placed = rows.into_iter().map(|(line, row): (u64, Row)| (format!("line {line}"), row));
    Ok(distinct(placed)?.into_iter().collect())
}

fn start(line: &str) -> String {
    line.chars().take(60).collect()
}

/// `1 255 0 0 1 1 1 "liver"` of ITK-SNAP, `1 liver 255 0 0 0` of FreeSurfer, also with the name in quotes, or `1 liver`.
fn of_words(line: &str) -> Option<Row> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let label = words.first()?.parse().ok()?;
    if let Some((before, quoted)) = line.split_once('"') {
        let (name, behind) = quoted.rsplit_once('"').unwrap_or((quoted, ""));
        let colour = |numbers: &str, skipped: usize| {
            colour_of(&numbers.split_whitespace().skip(skipped).collect::<Vec<_>>())
        };
        return Some(row(label, name, colour(before, 1).or_else(|| colour(behind, 0))));
    }
    // Names of FreeSurfer's have no spaces; others' may, so that colours are counted from the end.
    let is_number = |word: &&&str| word.parse::<u8>().is_ok();
    let numbers = words[1..].iter().rev().take_while(is_number).count();
    let names = words.len() - if numbers >= 3 { numbers.min(4) } else { 0 };
    let name = words.get(1..names).filter(|name| !name.is_empty())?.join(" ");
    (!name.contains([',', ';'])).then(|| row(label, &name, colour_of(&words[names..])))
}

fn colour_of(numbers: &[&str]) -> Option<[u8; 3]> {
    let [r, g, b] = numbers.get(..3)?.try_into().ok()?;
    let part = |text: &str| text.parse().ok();
    Some([part(r)?, part(g)?, part(b)?])
}

/// Columns of a table, in lower case.
const LABELS: [&str; 7] = ["label", "index", "id", "value", "labelvalue", "label_id", "number"];
const NAMES: [&str; 6] = ["name", "structure", "labelname", "label_name", "description", "roi"];
const COLOURS: [&str; 4] = ["color", "colour", "hex", "rgb"];
/// Those of red, green and blue, where each has its own.
const CHANNELS: [[&str; 4]; 3] = [
    ["color_r", "colour_r", "red", "r"],
    ["color_g", "colour_g", "green", "g"],
    ["color_b", "colour_b", "blue", "b"],
];

/// CSV or TSV: columns by their names, or a label and a name in a table without a head.
fn separated(text: &str, separator: char) -> Result<Vec<(u64, Row)>, String> {
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator as u8)
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut rows = Vec::new();
    let mut columns = None;
    for record in reader.records() {
        let record = record.map_err(|error| error.to_string())?;
        let at = |column: Option<usize>| column.and_then(|column| record.get(column)).unwrap_or_default();
        let Some(Columns { label, name, colour, channels }) = columns else {
            let head = Columns::of_head(&record);
            columns = Some(head.unwrap_or(Columns { label: 0, name: 1, colour: None, channels: None }));
            if head.is_some() {
                continue;
            }
            // A table without a head begins with its first row.
            rows.push(of_fields(&record, at(Some(0)), at(Some(1)), None)?);
            continue;
        };
        let parts = || colour_of(&channels?.map(|channel| at(Some(channel))));
        let colour = hexadecimal(at(colour)).or_else(parts);
        rows.push(of_fields(&record, at(Some(label)), at(Some(name)), colour)?);
    }
    Ok(rows)
}

#[derive(Clone, Copy)]
struct Columns {
    label: usize,
    name: usize,
    colour: Option<usize>,
    channels: Option<[usize; 3]>,
}

impl Columns {
    fn of_head(record: &csv::StringRecord) -> Option<Self> {
        let find =
            |names: &[&str]| record.iter().position(|field| names.contains(&field.to_lowercase().as_str()));
        let channels = || {
            let [r, g, b] = CHANNELS.map(|names| find(&names));
            Some([r?, g?, b?])
        };
        let name = find(&NAMES)?;
        Some(Self { label: find(&LABELS)?, name, colour: find(&COLOURS), channels: channels() })
    }
}

/// A row and its line.
fn of_fields(
    record: &csv::StringRecord,
    label: &str,
    name: &str,
    colour: Option<[u8; 3]>,
) -> Result<(u64, Row), String> {
    let line = record.position().map_or(0, csv::Position::line);
    let label = label
        .parse()
        .map_err(|_| format!("line {line}: label `{}` is no whole number; {EXPECTED}", start(label)))?;
    Ok((line, row(label, name, colour)))
}

/// `#rrggbb`.
fn hexadecimal(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() >= 6 && digits.is_ascii())?;
    let part = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).ok();
    Some([part(0)?, part(2)?, part(4)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<String> {
        let table = table(text).unwrap();
        let say = |(label, entry): (i64, &crate::volume::LabelEntry)| {
            format!("{label} {} {:?}", entry.name.as_deref().unwrap_or("-"), entry.colour.unwrap_or_default())
        };
        table.iter().map(say).collect()
    }

    #[test]
    fn tables_of_four_programs() {
        let freesurfer =
            "#No. Label Name: R G B A\n\n0 Unknown 0 0 0 0\n  17   Left-Hippocampus   220 216 20 0\r\n";
        assert_eq!(read(freesurfer), ["17 Left-Hippocampus [220, 216, 20]"]);
        let snap = "################\n# ITK-SnAP Label Description File\n    0     0    0    0        0  0  0    \"Clear Label\"\n    2   255    0    9        1  1  1    \"Label, 2\"\n";
        assert_eq!(read(snap), ["2 Label, 2 [255, 0, 9]"]);
        let slicer = "# Color table file\n3 left kidney 185 102 83 255\n";
        assert_eq!(read(slicer), ["3 left kidney [185, 102, 83]"]);
        let quoted =
            "# Color table\n1 \"liver right\" 221 130 101 255\n2 \"a\"\n3 1 2 3 1 1 1 \"b \"c\"\" \n";
        let read_quoted = ["1 liver right [221, 130, 101]", "2 a [0, 0, 0]", "3 b \"c\" [1, 2, 3]"];
        assert_eq!(read(quoted), read_quoted);
        let slicer_csv = "LabelValue,Name,Color_R,Color_G,Color_B,Color_A,Segmented property\n3,\"kidney, left\",185,102,83,255,\n4,bone,,,,\n";
        assert_eq!(read(slicer_csv), ["3 kidney, left [185, 102, 83]", "4 bone [0, 0, 0]"]);
        assert_eq!(read("Label;NAME;R;G;B\n1;liver;255;0;9\n"), ["1 liver [255, 0, 9]"]);
        let named = "red,green,blue,color,id,name\n1,2,3,,1,liver\n1,2,3,#0a0b0c,2,spleen\n";
        assert_eq!(read(named), ["1 liver [1, 2, 3]", "2 spleen [10, 11, 12]"]);
        let bids = "index\tname\tabbreviation\tcolor\n1\tGray Matter\tGM\t#ff5300\n";
        assert_eq!(read(bids), ["1 Gray Matter [255, 83, 0]"]);
    }

    #[test]
    fn plain_tables_with_and_without_a_head() {
        assert_eq!(read("1,liver\n2,\"spleen, left\"\n"), ["1 liver [0, 0, 0]", "2 spleen, left [0, 0, 0]"]);
        assert_eq!(read("Structure;Label\nliver;5\n"), ["5 liver [0, 0, 0]"]);
        assert_eq!(read("1 liver\n7\tL 5\n"), ["1 liver [0, 0, 0]", "7 L 5 [0, 0, 0]"]);
        let twice = table("#\n1 liver\n2 spleen\n1 lung\n").unwrap_err();
        assert!(twice.contains("`liver` (line 2) and `lung` (line 4)"), "{twice}");
        let twice = table("id,name\n1,liver\n1,lung\n").unwrap_err();
        assert!(twice.contains("`liver` (line 2) and `lung` (line 3)"), "{twice}");
        assert_eq!(read("1 liver\n0 a\n0 b\n1 liver\n"), ["1 liver [0, 0, 0]"]);
        assert!(table("1,liver\nx,spleen\n").unwrap_err().contains("line 2"));
        assert!(table("1 liver\nnonsense\n").unwrap_err().contains("line 2, `nonsense`"));
    }
}
