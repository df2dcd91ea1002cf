//! Text whose characters are of several sets, as ISO 2022 has them: escapes in it say of which what follows is.
//!
//! # References
//! DICOM PS3.3 C.12.1.1.2, tables C.12-3 and C.12-4; PS3.5 6.1.2.

use dicom_encoding::text::{SpecificCharacterSet, TextCodec};

const ESCAPE: u8 = 0x1b;

/// What follows an escape, and the set of the characters behind it: of bytes beyond 127, which ASCII leaves as they were, or
/// that of two bytes of seven bits a character, whose decoder wants the escape too.
const SETS: [(&[u8], &str); 16] = [
    (b"(B", ASCII),
    (b"(J", ASCII),
    (b"-A", "ISO_IR 100"),
    (b"-B", "ISO_IR 101"),
    (b"-C", "ISO_IR 109"),
    (b"-D", "ISO_IR 110"),
    (b"-L", "ISO_IR 144"),
    (b"-G", "ISO_IR 127"),
    (b"-F", "ISO_IR 126"),
    (b"-H", "ISO_IR 138"),
    (b"-M", LATIN_5),
    (b"-T", "ISO_IR 166"),
    (b")I", "ISO_IR 13"),
    (b"$B", KANJI),
    (b"$)C", "ISO_IR 149"),
    (b"$)A", "GBK"),
];
const ASCII: &str = "ISO_IR 6";
const KANJI: &str = "ISO_IR 87";
/// Not known to the decoders: Latin 1 but for six letters.
const LATIN_5: &str = "ISO_IR 148";
const TURKISH: [(char, char); 6] = [('Ð', 'Ğ'), ('Ý', 'İ'), ('Þ', 'Ş'), ('ð', 'ğ'), ('ý', 'ı'), ('þ', 'ş')];

/// A text that was decoded by the first of the character sets that a file declares, decoded by all of them. What cannot be
/// decoded stays as it is.
pub(super) fn decoded(text: &str, declared: &str) -> String {
    let named = |set: &str| set.trim().replace("ISO 2022 IR 58", "GBK").replace("ISO 2022 IR", "ISO_IR");
    let sets: Vec<String> = declared.split('\\').map(named).collect();
    let first = sets.first().map_or("", String::as_str);
    // ASCII and Kanji have no bytes beyond 127.
    let is_whole = |set: &&str| !["", ASCII, KANJI].contains(set);
    let mut set = sets.iter().map(String::as_str).find(is_whole).unwrap_or(ASCII);
    if !text.as_bytes().contains(&ESCAPE) && set == first && first != LATIN_5 {
        return text.to_owned();
    }
    // The bytes that were read.
    let Ok(bytes) = SpecificCharacterSet::from_code(first).unwrap_or_default().encode(text) else {
        return text.to_owned();
    };
    let mut runs = bytes.split(|byte| *byte == ESCAPE);
    let mut whole = of_set(set, runs.next().unwrap_or_default());
    for run in runs {
        let known = SETS.iter().find_map(|(escape, set)| Some((escape, *set, run.strip_prefix(*escape)?)));
        whole += &match known {
            Some((escape, KANJI, rest)) => of_set(KANJI, &[&[ESCAPE][..], *escape, rest].concat()),
            Some((_, ASCII, rest)) => of_set(set, rest),
            Some((_, other, rest)) => {
                set = other;
                of_set(set, rest)
            }
            None => return text.to_owned(),
        };
    }
    whole
}

fn of_set(set: &str, bytes: &[u8]) -> String {
    let codec = SpecificCharacterSet::from_code(set).unwrap_or_default();
    let text = codec.decode(bytes).unwrap_or_else(|_| String::from_utf8_lossy(bytes).into_owned());
    if set != LATIN_5 {
        return text;
    }
    let turkish = |c: char| TURKISH.iter().find(|(latin, _)| *latin == c).map_or(c, |(_, turkish)| *turkish);
    text.chars().map(turkish).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The standard's own examples (PS3.5 H.3.1, H.3.2, I.2), and a Turkish and a Greek name.
    #[test]
    fn names_of_several_sets() {
        let latin = |bytes: &[u8]| bytes.iter().map(|&byte| char::from(byte)).collect::<String>();
        let yamada = b"Yamada^Tarou=\x1b$B;3ED\x1b(B^\x1b$BB@O:\x1b(B";
        assert_eq!(decoded(&latin(yamada), "\\ISO 2022 IR 87"), "Yamada^Tarou=山田^太郎");
        assert_eq!(decoded(&latin(yamada), "ISO 2022 IR 6\\ISO 2022 IR 87"), "Yamada^Tarou=山田^太郎");
        // Half-width katakana first, as the decoder of Shift JIS gives them.
        let text = "ﾔﾏﾀﾞ^ﾀﾛｳ=\u{1b}$B;3ED\u{1b}(J^\u{1b}$BB@O:\u{1b}(J";
        assert_eq!(decoded(text, "ISO 2022 IR 13\\ISO 2022 IR 87"), "ﾔﾏﾀﾞ^ﾀﾛｳ=山田^太郎");
        let hong = b"Hong^Gildong=\x1b$)C\xfb\xf3^\x1b$)C\xd1\xce\xd4\xd7";
        assert_eq!(decoded(&latin(hong), "\\ISO 2022 IR 149"), "Hong^Gildong=洪^吉洞");
        let left = b"\x1b$)C\xfb\xf3 \x1b(Bleft \xfb\xf3";
        assert_eq!(decoded(&latin(left), "\\ISO 2022 IR 149"), "洪 left 洪");
        let heart = b"c\xf6eur \x1b-F\xea\xe1\xf1\xe4\xe9\xdc";
        assert_eq!(decoded(&latin(heart), "ISO 2022 IR 100\\ISO 2022 IR 126"), "cöeur καρδιά");
        // Chinese, and as pydicom writes it, without an escape.
        assert_eq!(decoded(&latin(b"liver \x1b$)A\xb8\xce\xd4\xe0"), "\\ISO 2022 IR 58"), "liver 肝脏");
        assert_eq!(decoded(&latin(b"liver \xb8\xce\xd4\xe0"), "\\ISO 2022 IR 58"), "liver 肝脏");
        assert_eq!(decoded(&latin(b"Ba\xf0\xfdrsak"), "ISO_IR 148"), "Bağırsak");
        assert_eq!(decoded("Leber", ""), "Leber");
        // An escape that no set has.
        assert_eq!(decoded("a\u{1b}%9b", ""), "a\u{1b}%9b");
    }
}
