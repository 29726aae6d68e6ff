//! Radiance's switches: an option that toggles a state; `+` or `1` turns it on, `-` or `0` off.

/// The new state of a switch; `None` if the word is another option.
pub(crate) fn switched(word: &str, name: &str, now: bool) -> Option<bool> {
    match word.strip_prefix(name)? {
        "" => Some(!now),
        "+" | "1" => Some(true),
        "-" | "0" => Some(false),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bare_switch_turns_over() {
        assert_eq!(switched("-bv", "-bv", true), Some(false));
        assert_eq!(switched("-bv+", "-bv", true), Some(true));
        assert_eq!(switched("-bv0", "-bv", true), Some(false));
        assert_eq!(switched("-bvx", "-bv", true), None);
        assert_eq!(switched("-dv", "-bv", true), None);
    }
}
