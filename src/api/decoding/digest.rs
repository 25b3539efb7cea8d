//! Digest of a JSON text: the same for two bodies, whatever their white space, order of names or spelling of numbers.
//!
//! Versions before digests of facts kept it on disk, where it is compared with those of bodies sent years later: this form
//! never changes. The golden value below holds it in place.

use sha2::{Digest as _, Sha256};

use super::document::{Json, Kind};
use crate::domain::request::Digest;

/// Returns the digest of a value, without one of its members.
pub fn of(value: Json<'_>, left_out: Option<&str>) -> Digest {
    let mut sha = Sha256::new();
    add(&mut sha, value, left_out);
    sha.finalize().into()
}

/// Every value starts with a letter for its kind, and what has a length says it, so that no two values read alike.
fn add(sha: &mut Sha256, value: Json<'_>, left_out: Option<&str>) {
    match value.kind() {
        Kind::Null => sha.update(b"n"),
        Kind::Bool => sha.update(if value.as_bool() == Some(true) { b"t" } else { b"f" }),
        Kind::Number => add_number(sha, value),
        Kind::Text => add_text(sha, value.as_str().unwrap_or_default()),
        Kind::List => {
            add_length(sha, b"a", value.len());
            value.items().for_each(|item| add(sha, item, None));
        }
        Kind::Object => {
            let mut sorted: Vec<_> = value.members().filter(|(name, _)| Some(*name) != left_out).collect();
            sorted.sort_unstable_by_key(|&(name, _)| name);
            add_length(sha, b"o", sorted.len());
            for (name, value) in sorted {
                add_text(sha, name);
                add(sha, value, None);
            }
        }
    }
}

/// `1` and `1.0` are one number, written by two libraries.
fn add_number(sha: &mut Sha256, number: Json<'_>) {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let float = number.as_f64().unwrap_or(f64::NAN);
    if let Some(whole) = number.as_i64() {
        sha.update(b"i");
        sha.update(whole.to_le_bytes());
    } else if let Some(huge) = number.as_number().and_then(|number| number.as_u64()) {
        sha.update(b"u");
        sha.update(huge.to_le_bytes());
    } else if float.fract() == 0.0 && float.abs() <= EXACT {
        sha.update(b"i");
        sha.update((float as i64).to_le_bytes());
    } else {
        sha.update(b"d");
        sha.update(float.to_le_bytes());
    }
}

fn add_text(sha: &mut Sha256, text: &str) {
    add_length(sha, b"s", text.len());
    sha.update(text.as_bytes());
}

fn add_length(sha: &mut Sha256, kind: &[u8], length: usize) {
    sha.update(kind);
    sha.update((length as u64).to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::decoding::syntax::parse;

    fn digest(json: &str) -> Digest {
        of(parse(json.as_bytes()).expect("JSON").root(), None)
    }

    #[test]
    fn spelling_does_not_matter_and_meaning_does() {
        let body = digest(r#"{"a":1,"b":[0.5,"x"]}"#);
        assert_eq!(digest("{ \"b\": [5e-1, \"\\u0078\"],\n \"a\": 1.0 }"), body);
        assert_ne!(digest(r#"{"a":1,"b":["x",0.5]}"#), body);
        assert_ne!(digest(r#"{"a":"1","b":[0.5,"x"]}"#), body);
        assert_ne!(digest(r#"[["a"],"b"]"#), digest(r#"[["a","b"]]"#));
    }

    #[test]
    fn the_form_never_changes() {
        use std::fmt::Write as _;
        let hex = digest(r#"{"a":[1,0.5,"x",null,true,{}]}"#).iter().fold(String::new(), |mut hex, byte| {
            let _ = write!(hex, "{byte:02x}");
            hex
        });
        assert_eq!(hex, "1e2fe767ec654406ecbd385c089bce8b99dfc7706a6e25f8f2ac1c61fd5facfe");
    }
}
