//! The canonical spelling of a text: what a reader would call "written the same".

use unicode_normalization::UnicodeNormalization;

/// NFKC, one kind of dash, quote, digit and space, nothing invisible. Case is kept, for it tells proper names.
pub fn clean(raw: &str) -> String {
    let visible = raw.chars().filter_map(visible);
    let mut out = String::with_capacity(raw.len());
    for c in visible.nfkc().filter_map(self::visible).map(plain) {
        if c != ' ' || !(out.is_empty() || out.ends_with(' ')) {
            out.push(c);
        }
    }
    out.truncate(out.trim_end().len());
    out
}

/// Folds the case of a [`clean`] text and trims the punctuation around it, which OCR and captions add freely.
pub fn fold(clean: &str) -> String {
    let folded: String = fold_case(clean).nfkc().collect();
    let frame = |c: char| c == ' ' || ".,;:!?\"'*_()[]{}".contains(c);
    folded.trim_matches(frame).to_owned()
}

/// Lower case without diacritics: "Étage" and "ETAGE" are one word on a sign.
pub fn bare(word: &str) -> String {
    if word.is_ascii() {
        return word.to_ascii_lowercase();
    }
    let is_accent = |c: &char| ('\u{300}'..='\u{36f}').contains(c);
    fold_case(word).nfd().filter(|c| !is_accent(c)).nfc().collect()
}

/// By way of upper case, so that "ß" and "SS", "ς" and "σ" meet.
fn fold_case(text: &str) -> impl Iterator<Item = char> + '_ {
    text.chars().flat_map(char::to_uppercase).flat_map(char::to_lowercase)
}

fn visible(c: char) -> Option<char> {
    if c.is_whitespace() {
        return Some(' ');
    }
    let zero_width_or_bidi = matches!(c,
        '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}'
        | '\u{2060}'..='\u{206f}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{e0000}'..='\u{e01ef}');
    (!c.is_control() && !zero_width_or_bidi).then_some(c)
}

fn plain(c: char) -> char {
    match c {
        // Every dash; the wave dashes too, which East Asian signs use for ranges.
        '\u{2010}'..='\u{2015}'
        | '\u{2043}'
        | '\u{2212}'
        | '\u{2e3a}'
        | '\u{2e3b}'
        | '\u{2e40}'
        | '\u{58a}'
        | '\u{1806}'
        | '\u{301c}'
        | '\u{3030}'
        | '\u{fe58}'
        | '~' => '-',
        '\u{2018}' | '\u{2019}' | '\u{2bc}' | '`' | '\u{b4}' => '\'',
        '\u{201c}'..='\u{201f}' | '\u{ab}' | '\u{bb}' | '\u{300c}'..='\u{300f}' => '"',
        '\u{2044}' | '\u{2215}' => '/',
        '\u{3001}' => ',',
        '\u{3002}' => '.',
        _ => decimal_digit(c).unwrap_or(c),
    }
}

/// NFKC leaves the digits of other scripts alone; a door number reads the same in all of them.
fn decimal_digit(c: char) -> Option<char> {
    const ZEROS: [u32; 58] = [
        0x660, 0x6f0, 0x7c0, 0x966, 0x9e6, 0xa66, 0xae6, 0xb66, 0xbe6, 0xc66, 0xce6, 0xd66, 0xde6, 0xe50,
        0xed0, 0xf20, 0x1040, 0x1090, 0x17e0, 0x1810, 0x1946, 0x19d0, 0x1a80, 0x1a90, 0x1b50, 0x1bb0, 0x1c40,
        0x1c50, 0xa620, 0xa8d0, 0xa900, 0xa9d0, 0xa9f0, 0xaa50, 0xabf0, 0x104a0, 0x10d30, 0x11066, 0x110f0,
        0x11136, 0x111d0, 0x112f0, 0x11450, 0x114d0, 0x11650, 0x116c0, 0x11730, 0x118e0, 0x11950, 0x11c50,
        0x11d50, 0x11da0, 0x16a60, 0x16ac0, 0x16b50, 0x1e140, 0x1e2f0, 0x1e950,
    ];
    let value = ZEROS.iter().filter_map(|zero| (c as u32).checked_sub(*zero)).find(|value| *value < 10)?;
    char::from_digit(value, 10)
}
