//! Counted: a number with its noun, for people.

/// Writes a number with the noun that it counts, in the singular for 1.
pub fn counted(count: impl TryInto<u64>, noun: &str) -> String {
    // What fits no u64 is not 1.
    let count = count.try_into().unwrap_or(u64::MAX);
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{ending}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thing_is_singular() {
        assert_eq!(counted(0_usize, "map"), "0 maps");
        assert_eq!(counted(1_u64, "map"), "1 map");
        assert_eq!(counted(2_i64, "more fault"), "2 more faults");
    }
}
