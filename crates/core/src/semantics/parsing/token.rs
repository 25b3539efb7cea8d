//! Tokens: the words, codes and symbols of a text, in reading order.

/// Tokens read of one text. What follows is ignored, so that the cost of a hostile text is bounded.
pub const MAX_TOKENS: usize = 256;

/// What a token is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Letters.
    Word,
    /// Letters and digits with at least one digit, with the separators inside it: `B1-03`, `15.02`, `10:30`.
    Code,
    /// A run of Han, Kana or Hangul.
    Ideographs,
    /// One character that means something by itself: an arrow, `%`, `#`, a pictogram.
    Symbol,
}

/// A token and where it stands.
#[derive(Clone, Copy, Debug)]
pub struct Token<'t> {
    /// Its characters.
    pub text: &'t str,
    /// What it is made of.
    pub kind: Kind,
    /// Byte offset of its first character in the text.
    pub start: usize,
    /// A comma, full stop or the like stands between it and the token before.
    pub after_break: bool,
}

impl Token<'_> {
    /// Byte offset just after the token.
    pub fn end(&self) -> usize {
        self.start + self.text.len()
    }
}

/// Splits a cleaned text into tokens, at most [`MAX_TOKENS`].
pub fn tokenise(text: &str) -> Vec<Token<'_>> {
    let mut tokens: Vec<Token<'_>> = Vec::new();
    let (mut at, mut after_break) = (0, false);
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let (kind, len) = if is_ideograph(c) {
            (Kind::Ideographs, run(rest, is_ideograph))
        } else if is_letter_or_digit(c) {
            let len = word_or_code(rest);
            let has_digit = rest[..len].bytes().any(|b| b.is_ascii_digit());
            (if has_digit { Kind::Code } else { Kind::Word }, len)
        } else if rest.starts_with("->") || rest.starts_with("<-") {
            (Kind::Symbol, 2)
        } else if is_symbol(c) {
            (Kind::Symbol, c.len_utf8())
        } else {
            after_break |= is_break(c, tokens.last());
            at += c.len_utf8();
            continue;
        };
        if tokens.len() == MAX_TOKENS {
            break;
        }
        tokens.push(Token { text: &rest[..len], kind, start: at, after_break });
        (at, after_break) = (at + len, false);
    }
    tokens
}

/// "No. 5", "Rm. 9" and the German "9. Stock" go on after their full stop.
fn is_break(c: char, before: Option<&Token<'_>>) -> bool {
    let abbreviation = before.is_some_and(|t| t.text.len() <= if t.kind == Kind::Code { 2 } else { 3 });
    matches!(c, ',' | ';' | '!' | '?' | '|' | '\u{2022}' | '\u{b7}') || (c == '.' && !abbreviation)
}

fn run(text: &str, belongs: impl Fn(char) -> bool) -> usize {
    text.find(|c| !belongs(c)).unwrap_or(text.len())
}

fn word_or_code(text: &str) -> usize {
    let mut len = 0;
    loop {
        let start = len;
        len += run(&text[len..], |c| is_letter_or_digit(c) && !is_ideograph(c));
        match text[len..].chars().next() {
            Some(joiner) if joins(joiner, &text[start..len], &text[len + joiner.len_utf8()..]) => {
                len += joiner.len_utf8();
            }
            _ => return len,
        }
    }
}

/// Whether `joiner` holds `before` and `after` together as one code or word.
fn joins(joiner: char, before: &str, after: &str) -> bool {
    let digit_after = after.starts_with(|c: char| c.is_ascii_digit());
    let digit_before = before.ends_with(|c: char| c.is_ascii_digit());
    // Looks ahead three characters only, to stay linear.
    let letters_after =
        after.chars().take(3).take_while(|c| is_letter_or_digit(*c) && !is_ideograph(*c)).count();
    match joiner {
        '\'' => letters_after > 0 && !digit_before,
        '-' => digit_after || (digit_before && (1..=2).contains(&letters_after)),
        '.' => (digit_after && (digit_before || before.len() == 1)) || (digit_before && letters_after == 1),
        ':' | '/' | ',' => digit_before && digit_after,
        _ => false,
    }
}

fn is_letter_or_digit(c: char) -> bool {
    // Marks of Devanagari, Thai and Arabic stand inside their words.
    let is_mark = matches!(c, '\u{300}'..='\u{36f}' | '\u{64b}'..='\u{65f}' | '\u{93c}' | '\u{94d}' | '\u{e47}'..='\u{e4e}');
    c.is_alphanumeric() || is_mark
}

fn is_ideograph(c: char) -> bool {
    matches!(c, '\u{3005}'..='\u{3007}' | '\u{3041}'..='\u{30ff}' | '\u{31f0}'..='\u{31ff}' | '\u{3400}'..='\u{9fff}'
        | '\u{ac00}'..='\u{d7a3}' | '\u{f900}'..='\u{faff}' | '\u{20000}'..='\u{3ffff}')
}

fn is_symbol(c: char) -> bool {
    "%#$+<>\u{b0}\u{a2}\u{a3}\u{a5}\u{a9}\u{20ac}".contains(c)
        || matches!(c, '\u{2190}'..='\u{2bff}' | '\u{1f000}'..='\u{1faff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_separator_joins_only_inside_a_code() {
        let check = |text: &str, expected: &[&str]| {
            let found: Vec<&str> = tokenise(text).iter().map(|t| t.text).collect();
            assert_eq!(found, expected, "{text}");
        };
        check("room b1-03, 15.02.", &["room", "b1-03", "15.02"]);
        check("no.5 close-up don't", &["no", "5", "close", "up", "don't"]);
        check("901号室 901-a 901-kitchen", &["901", "号室", "901-a", "901", "kitchen"]);
        check("901 - 905 -> 10:30", &["901", "905", "->", "10:30"]);
        check("", &[]);
    }
}
