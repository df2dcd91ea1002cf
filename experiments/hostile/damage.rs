//! How files are damaged: by chance, and one field at a time.

use crate::chance::Chance;
use crate::seeds::Seed;

/// What is put in the place of a word.
pub(crate) const WORDS: [&str; 34] = [
    "",
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "3.5",
    "16",
    "255",
    "65536",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "1e-320",
    "1e-9",
    "1e9",
    "3e38",
    "1e308",
    "1e400",
    "nan",
    "NaN",
    "inf",
    "-inf",
    "None",
    "True",
    "../../../../etc/passwd",
    "/dev/zero",
    "%d",
    "LIST",
    "\u{1b}[31m",
    "\u{e9}\u{0}",
];

/// Bytes that are put in the place of numbers.
pub(crate) fn numbers() -> Vec<Vec<u8>> {
    let mut all: Vec<Vec<u8>> = [0u8, 1, 0x7f, 0x80, 0xff].iter().map(|byte| vec![*byte]).collect();
    all.extend([0i16, 1, -1, i16::MAX, i16::MIN].iter().map(|v| v.to_le_bytes().to_vec()));
    all.extend([0i32, 1, -1, i32::MAX, i32::MIN].iter().map(|v| v.to_le_bytes().to_vec()));
    all.extend([f32::NAN, f32::INFINITY, f32::MAX, 1e-40, -1.0].iter().map(|v| v.to_le_bytes().to_vec()));
    all.extend([i64::MAX, i64::MIN, 1 << 40].iter().map(|v| v.to_le_bytes().to_vec()));
    all.extend([f64::NAN, 1e308, 5e-324].iter().map(|v| v.to_le_bytes().to_vec()));
    all
}

/// One to six changes by chance.
pub(crate) fn by_chance(seed: &Seed, others: &[Seed], chance: &mut Chance) -> Vec<u8> {
    let mut bytes = seed.bytes.clone();
    for _ in 0..=chance.below(6) {
        change(&mut bytes, others, chance);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, others: &[Seed], chance: &mut Chance) {
    let at = chance.below(bytes.len() + 1);
    let end = (at + chance.below(40)).min(bytes.len());
    match chance.below(9) {
        0 if at < bytes.len() => bytes[at] ^= 1 << chance.below(8),
        1 if at < bytes.len() => bytes[at] = chance.next() as u8,
        2 => drop(bytes.splice(at..end, chance.of(&numbers()).clone())),
        3 => replace_word(bytes, at, chance.of::<&str>(&WORDS)),
        4 => bytes.truncate(at),
        5 => drop(bytes.drain(at..end)),
        6 => {
            let again = bytes[at..end].to_vec();
            drop(bytes.splice(at..at, again));
        }
        7 => {
            let other = &chance.of(others).bytes;
            let from = chance.below(other.len());
            drop(bytes.splice(at..end, other[from..].iter().copied().take(60)));
        }
        _ => {
            let number = chance.of(&numbers()).clone();
            overwrite(bytes, at, &number);
        }
    }
}

fn overwrite(bytes: &mut [u8], at: usize, number: &[u8]) {
    for (byte, new) in bytes.iter_mut().skip(at).zip(number) {
        *byte = *new;
    }
}

fn is_of_word(byte: u8) -> bool {
    !byte.is_ascii_whitespace() && !b",;:=()[]{}'\"".contains(&byte)
}

fn replace_word(bytes: &mut Vec<u8>, at: usize, word: &str) {
    let start = (0..at).rev().take_while(|&n| is_of_word(bytes[n])).last().unwrap_or(at);
    let end = (at..bytes.len()).find(|&n| !is_of_word(bytes[n])).unwrap_or(bytes.len());
    drop(bytes.splice(start..end, word.bytes()));
}

/// Where the header ends: what follows is voxels, or what is compressed.
pub(crate) fn header_end(seed: &Seed) -> usize {
    let after = |words: &[u8]| {
        seed.bytes.windows(words.len()).position(|window| window == words).map(|at| at + words.len())
    };
    match seed.ending {
        "nii" if seed.bytes[0] == 92 => 352,
        "nii" => 544,
        "mha" => after(b"LOCAL\n").unwrap_or_default(),
        "nrrd" => after(b"\n\n").unwrap_or_default(),
        "npy" => 128,
        "ply" => after(b"end_header\n").unwrap_or_default() + 40,
        "stl" => seed.bytes.len().min(160),
        "csv" | "tsv" => seed.bytes.len(),
        _ => 0,
    }
}

/// Every field of a header with every hostile value, every line left out and doubled, and forty truncations: files that are
/// all wrong in one place.
pub(crate) fn one_at_a_time(seed: &Seed) -> Vec<Vec<u8>> {
    let end = header_end(seed);
    let (header, rest) = seed.bytes.split_at(end);
    let is_text = header.is_ascii() && !header.contains(&0) && !header.is_empty();
    let mut all = Vec::new();
    if is_text {
        for (at, _) in header
            .iter()
            .enumerate()
            .filter(|(n, byte)| is_of_word(**byte) && (*n == 0 || !is_of_word(header[n - 1])))
        {
            for word in WORDS {
                let mut changed = header.to_vec();
                replace_word(&mut changed, at, word);
                all.push([&changed, rest].concat());
            }
        }
        let lines: Vec<&[u8]> = header.split_inclusive(|byte| *byte == b'\n').collect();
        for n in 0..lines.len() {
            all.push([&lines[..n].concat(), &lines[n + 1..].concat(), rest].concat());
            all.push([&lines[..=n].concat(), &lines[n..].concat(), rest].concat());
        }
    } else {
        for at in (0..end).step_by(2) {
            for number in numbers().into_iter().filter(|number| at % number.len().min(4) == 0) {
                let mut changed = seed.bytes.clone();
                overwrite(&mut changed, at, &number);
                all.push(changed);
            }
        }
    }
    all.extend((0..40).map(|n| seed.bytes[..seed.bytes.len() * n / 40].to_vec()));
    all
}
