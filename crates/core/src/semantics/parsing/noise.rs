//! Noise: what a reader makes of a wall without a text on it (M21).

/// A longer number that is nearly all zeros is a railing or a row of lamps.
pub const NUMBER_DIGITS_MAX: usize = 6;
/// The share of zeros, in per cent, from which a longer number is noise.
pub const ZERO_PERCENT: usize = 80;

/// Whether a bare number is what a railing, dots or a window frame look like: "0", "000", "00-0", "00000000010".
pub fn is_noise_number(code: &str) -> bool {
    let is_digits = !code.is_empty() && code.bytes().all(|byte| byte.is_ascii_digit());
    let zeros = code.bytes().filter(|digit| *digit == b'0').count();
    let nearly_all = code.len() > NUMBER_DIGITS_MAX && zeros * 100 >= ZERO_PERCENT * code.len();
    let only_zeros = zeros > 0 && code.bytes().all(|byte| matches!(byte, b'0' | b'-' | b'.'));
    only_zeros || (is_digits && nearly_all)
}

/// Whether a text is one symbol, such as a dot or an arrow. One letter is no word, and so tells nothing either.
pub fn is_one_symbol(normalised: &str) -> bool {
    let mut characters = normalised.chars();
    characters.next().is_some_and(|only| !only.is_alphanumeric()) && characters.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_zeros_are_noise_and_every_other_number_is_one() {
        for code in ["0", "00", "000", "0000000", "00000000010", "0000100", "0800000", "0-00", "0.0"] {
            assert!(is_noise_number(code), "{code}");
        }
        // Six digits may be any number, and five zeros of seven digits are 71 %.
        for code in ["3", "10", "11", "222", "100", "100000", "0100020", "0.02", "10-0", "A0", ""] {
            assert!(!is_noise_number(code), "{code}");
        }
    }

    #[test]
    fn one_symbol_is_noise_and_one_character_that_is_a_word_is_not() {
        assert!(["?", "→", "."].into_iter().all(is_one_symbol));
        assert!(!["", "3", "押", "a", "→→"].into_iter().any(is_one_symbol));
    }
}
