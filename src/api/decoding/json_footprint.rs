//! JSON footprint: how much a JSON text holds, found without holding it.

use std::cell::Cell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

use crate::api::limits::{BODY_VALUES, LIST_ITEMS};

/// How much a text holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JsonFootprint {
    /// Its values, over all levels.
    pub values: usize,
    /// The members of its objects.
    pub members: usize,
    /// The bytes of its texts, names left out.
    pub text_bytes: usize,
}

/// Why a text is not to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TooMany {
    /// It holds more than [`BODY_VALUES`] values.
    Values,
    /// One of its lists has more than [`LIST_ITEMS`] items.
    Items,
}

/// Counts what a text holds. One that is no JSON is counted up to where it stops being any: reading it tells more.
pub fn survey(bytes: &[u8]) -> Result<JsonFootprint, TooMany> {
    let count = Count::default();
    let mut json = serde_json::Deserializer::from_slice(bytes);
    // Whether this is JSON is not asked here.
    let _ = (&count).deserialize(&mut json);
    match count.too_many.get() {
        Some(too_many) => Err(too_many),
        None => Ok(JsonFootprint {
            values: count.values.get(),
            members: count.members.get(),
            text_bytes: count.text_bytes.get(),
        }),
    }
}

#[derive(Default)]
struct Count {
    values: Cell<usize>,
    members: Cell<usize>,
    text_bytes: Cell<usize>,
    too_many: Cell<Option<TooMany>>,
}

impl Count {
    fn refuse<T, E: serde::de::Error>(&self, why: TooMany) -> Result<T, E> {
        self.too_many.set(Some(why));
        Err(E::custom("too many"))
    }
}

impl<'de> DeserializeSeed<'de> for &Count {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.values.set(self.values.get() + 1);
        if self.values.get() > BODY_VALUES {
            return self.refuse(TooMany::Values);
        }
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for &Count {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_bool<E>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_i64<E>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_u64<E>(self, _: u64) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E>(self, text: &str) -> Result<(), E> {
        self.text_bytes.set(self.text_bytes.get() + text.len());
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        let mut count = 0;
        while items.next_element_seed(self)?.is_some() {
            count += 1;
            if count > LIST_ITEMS {
                return self.refuse(TooMany::Items);
            }
        }
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<(), A::Error> {
        while members.next_key::<IgnoredAny>()?.is_some() {
            self.members.set(self.members.get() + 1);
            members.next_value_seed(self)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_and_every_member_counts_and_what_is_no_json_counts_as_far_as_it_goes() {
        let counted = |json: &str| survey(json.as_bytes()).map(|survey| (survey.values, survey.members));
        assert_eq!(counted(r#"{"a":[1,-2,3.5,"x",null,true],"b":{"c":{}}}"#), Ok((10, 3)));
        assert_eq!(counted("[1,2,oops"), Ok((4, 0)));
        assert_eq!(counted(""), Ok((1, 0)));
        assert_eq!(counted(&"[".repeat(1_000_000)), Ok((128, 0)));
    }

    #[test]
    fn long_lists_and_many_values_are_too_many() {
        let list = format!("[{}0]", "0,".repeat(LIST_ITEMS));
        assert_eq!(survey(list.as_bytes()), Err(TooMany::Items));
        let row = format!("[{}0],", "0,".repeat(999));
        let many = format!("[{}0]", row.repeat(BODY_VALUES / 1000));
        assert_eq!(survey(many.as_bytes()), Err(TooMany::Values));
    }
}
