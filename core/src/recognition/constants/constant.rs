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

/// Makes a row of the tables.
pub(super) const fn constant(
    name: &'static str,
    value: f64,
    unit: &'static str,
    doc: &'static str,
) -> Constant {
    Constant { name, value, unit, doc }
}
