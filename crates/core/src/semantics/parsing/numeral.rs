//! Numerals of Chinese and Japanese before what they number: 三楼, 二十四号室.

use crate::semantics::lexicon::role::{self, Role};

const DIGITS: &str = "〇一二三四五六七八九";

/// Returns the first number of a run that stands straight before what it numbers: the characters before it, the number, what it
/// numbers, and the characters after that.
pub fn first_numbered(run: &str) -> Option<(&str, String, Role, &str)> {
    let mut start = None;
    for (at, c) in run.char_indices() {
        if is_numeral(c) {
            start = start.or(Some(at));
            continue;
        }
        if let Some(first) = start.take()
            && let Some((role, suffix)) = role::role_of_suffix(&run[at..])
        {
            let before = &run[..first];
            let before = before.strip_suffix('第').unwrap_or(before);
            return Some((before, number(&run[first..at])?, role, &run[at + suffix..]));
        }
    }
    None
}

fn is_numeral(c: char) -> bool {
    c == '十' || c == '百' || DIGITS.contains(c)
}

/// Reads 二十四 as 24 and 三〇一 as 301; none from a thousand on.
fn number(numeral: &str) -> Option<String> {
    let digit = |c: char| DIGITS.chars().position(|other| other == c);
    if !numeral.contains(['十', '百']) {
        return numeral.chars().map(|c| char::from_digit(digit(c)? as u32, 10)).collect();
    }
    let (mut total, mut last) = (0, None);
    for c in numeral.chars() {
        match c {
            '百' => total += 100 * last.take().unwrap_or(1),
            '十' => total += 10 * last.take().unwrap_or(1),
            '〇' => last = None,
            _ => last = digit(c),
        }
    }
    let total = total + last.unwrap_or(0);
    (total < 1000).then(|| total.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_numeral_before_what_it_numbers_is_a_number() {
        for (run, before, number, rest) in [
            ("三楼会议室", "", "3", "会议室"),
            ("二十四号室", "", "24", ""),
            ("第三〇一号", "", "301", ""),
            ("科学楼百二十階", "科学楼", "120", ""),
        ] {
            let found = first_numbered(run).expect("a number");
            assert_eq!((found.0, &*found.1, found.3), (before, number, rest), "{run}");
        }
        for run in ["三菱", "十字路口", "会议室", ""] {
            assert!(first_numbered(run).is_none(), "{run}");
        }
    }
}
