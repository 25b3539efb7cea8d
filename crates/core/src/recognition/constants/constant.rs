//! One constant of the method, with its unit and its source.

/// A number that decides verdicts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    /// The rule and the quantity, as `rule.quantity`.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit; `1` for counts, shares and factors.
    pub unit: &'static str,
    /// Its meaning and its source.
    pub doc: &'static str,
}

// Makes a table. A row: name, value, unit, meaning and source.
macro_rules! constants {
    ($($name:literal = $value:expr, $unit:literal, $doc:literal;)*) => {
        &[$(Constant { name: $name, value: $value, unit: $unit, doc: $doc },)*]
    };
}

pub(super) use constants;
