//! Codes: identifiers that are compared exactly, as fiducial markers, UUIDs and links are.

use unicode_normalization::UnicodeNormalization;

/// Returns the text of a code, in NFC without blanks around it; none if the text is no code by its own form.
///
/// Codes by form are the names that ROS gives to AprilTags (`tag36h11:7`, `36h11:7`), a family and a number after a colon
/// (`aruco_4x4_50:23`), UUIDs and links.
pub fn by_form(raw: &str) -> Option<String> {
    let text = exact(raw);
    let is_one = !text.is_empty() && !text.contains(char::is_whitespace);
    (is_one && (is_marker(&text) || is_uuid(&text) || is_link(&text))).then_some(text)
}

/// Returns a code as it is compared.
pub fn exact(raw: &str) -> String {
    raw.nfc().collect::<String>().trim().to_owned()
}

/// Whether it is a family of markers and a number: `tag36h11:7`. Families are named after their bits and distance (`36h11`),
/// or begin with a word for markers.
fn is_marker(text: &str) -> bool {
    let Some((family, number)) = text.rsplit_once(':') else { return false };
    let family = family.to_ascii_lowercase();
    let has_distance = family
        .rsplit_once('h')
        .is_some_and(|(bits, distance)| bits.ends_with(|c: char| c.is_ascii_digit()) && is_digits(distance));
    let is_named =
        ["aruco", "apriltag", "tag", "dict_", "marker"].iter().any(|word| family.starts_with(word));
    let is_plain = family.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    is_plain && (has_distance || is_named) && is_digits(number)
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

fn is_uuid(text: &str) -> bool {
    let groups = text
        .split('-')
        .map(|group| if group.bytes().all(|byte| byte.is_ascii_hexdigit()) { group.len() } else { 0 });
    groups.eq([8, 4, 4, 4, 12])
}

fn is_link(text: &str) -> bool {
    let lower = text.to_ascii_lowercase();
    let scheme = lower.split_once("://").map(|(scheme, _)| scheme);
    let is_scheme =
        |scheme: &str| !scheme.is_empty() && scheme.bytes().all(|byte| byte.is_ascii_alphanumeric());
    scheme.is_some_and(is_scheme) || lower.starts_with("www.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_known_by_their_form() {
        for code in [
            "tag36h11:7",
            "36h11:7",
            "aruco_4x4_50:23",
            "DICT_5X5_100:4",
            "123e4567-e89b-12d3-a456-426614174000",
            "https://example.org/a/17",
            "WWW.example.org/17",
        ] {
            assert_eq!(by_form(&format!(" {code} ")).as_deref(), Some(code), "{code}");
        }
        for text in
            ["10:30", "room: 12", "Gate:7", "T9:312", "901", "B-204", "12-34", "", "see https://example.org"]
        {
            assert_eq!(by_form(text), None, "{text}");
        }
    }
}
