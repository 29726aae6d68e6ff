//! The memory limit of the program.
//!
//! The operating system enforces the limit (`RLIMIT_DATA`: all private writable memory), so it
//! costs nothing. It also applies to each command that the program starts.

use crate::failure::{Failure, say};
use crate::trust::WORDS_OF_FILE;
use radsight_brdf_host::guard;
use radsight_output::interrupt;
use std::sync::atomic::{AtomicU64, Ordering};

const OPTION: &str = "--limit-memory";
const VARIABLE: &str = "RADSIGHT_LIMIT_MEMORY";
const EXPECTED: &str = "a size such as 500M, 2G or 1.5G, at least 16M; 0 for no limit";

/// The smallest limit with which the program can start, bytes.
const LEAST: u64 = 16 << 20;

/// The limit in bytes; 0 for none. For the message, which cannot allocate memory.
static LIMIT: AtomicU64 = AtomicU64::new(0);

/// A memory limit in bytes; `None` for none.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Size(Option<u64>);

impl Size {
    fn parse(text: &str) -> Option<Size> {
        let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
        let shift = match text[digits.len()..].to_ascii_lowercase().as_str() {
            "" | "b" => 0,
            "k" | "kb" | "kib" => 10,
            "m" | "mb" | "mib" => 20,
            "g" | "gb" | "gib" => 30,
            "t" | "tb" | "tib" => 40,
            _ => return None,
        };
        let bytes = digits.parse::<f64>().ok()? * (1_u64 << shift) as f64;
        match bytes {
            0.0 => Some(Size(None)),
            _ if bytes >= LEAST as f64 && bytes < (1_u64 << 60) as f64 => Some(Size(Some(bytes as u64))),
            _ => None,
        }
    }
}

/// Removes `--limit-memory SIZE` from the command line and sets the limit: the given size, or
/// `RADSIGHT_LIMIT_MEMORY`, or three quarters of the memory of the machine or container. Words of a
/// file are unchanged: there the option is unknown.
pub(crate) fn take(words: Vec<String>) -> Result<Vec<String>, Failure> {
    radsight_memory::when_exhausted(end);
    let (words, value) = without_option(words)?;
    let wrong = |what: &str, text: &str| Failure::usage(format!("{what} \"{text}\", expected {EXPECTED}"));
    let by_variable = std::env::var(VARIABLE).ok().filter(|text| !text.is_empty());
    let asked = match (value, by_variable) {
        (Some(text), _) => {
            Some(Size::parse(&text).ok_or_else(|| wrong(&format!("option \"{OPTION}\" is followed by"), &text))?)
        }
        (None, Some(text)) => {
            Some(Size::parse(&text).ok_or_else(|| wrong(&format!("the variable {VARIABLE} is"), &text))?)
        }
        (None, None) => None,
    };
    match asked {
        Some(Size(limit)) => {
            system::set(limit).map_err(|reason| Failure::fault(format!("cannot set {OPTION}: {reason}")))?
        }
        // A lower limit set by the caller is kept.
        None => guard::machine_memory().into_iter().for_each(|bytes| system::lower_to(bytes / 4 * 3)),
    }
    Ok(words)
}

fn without_option(mut words: Vec<String>) -> Result<(Vec<String>, Option<String>), Failure> {
    let mut value = None;
    let own = words.iter().position(|word| word == WORDS_OF_FILE || word == "--");
    let mut own = own.unwrap_or(words.len());
    while let Some(at) = words[..own].iter().position(|word| word == OPTION) {
        if at + 1 >= own {
            return Err(Failure::usage(format!(
                "option \"{OPTION}\" ends the command line, expected {EXPECTED} after it"
            )));
        }
        value = words.drain(at..at + 2).nth(1);
        own -= 2;
    }
    Ok((words, value))
}

/// Reports exhausted memory, removes unfinished files, and ends the program.
fn end(bytes: usize) -> ! {
    // The message itself needs some memory.
    system::lift();
    let limit = LIMIT.load(Ordering::Relaxed);
    let asked = readable(bytes as u64);
    say(&match (system::address_space(), limit) {
        (Some(space), _) if limit == 0 || space <= limit => format!(
            "radsight: out of memory: {asked} more would exceed the address space of {} (ulimit -v)\n",
            readable(space)
        ),
        (_, 0) => format!("radsight: out of memory: the system has not {asked} left\n"),
        _ => format!(
            "radsight: out of memory: {asked} more would exceed the limit of {}\nhint: {OPTION} SIZE sets another limit\n",
            readable(limit)
        ),
    });
    interrupt::end_with(guard::FAULT)
}

fn readable(bytes: u64) -> String {
    let units = [("GB", 30), ("MB", 20), ("kB", 10)];
    match units.into_iter().find(|(_, shift)| bytes >> shift > 0) {
        Some((unit, shift)) => {
            let number = format!("{:.1}", bytes as f64 / (1_u64 << shift) as f64);
            format!("{} {unit}", number.trim_end_matches(".0"))
        }
        None => format!("{bytes} bytes"),
    }
}

#[cfg(target_os = "linux")]
mod system {
    use super::LIMIT;
    use nix::sys::resource::{RLIM_INFINITY, Resource, getrlimit, setrlimit};
    use std::sync::atomic::Ordering;

    /// Sets the limit, in bytes.
    pub(super) fn set(limit: Option<u64>) -> Result<(), String> {
        let (_, hard) = getrlimit(Resource::RLIMIT_DATA).map_err(|error| error.desc().to_lowercase())?;
        let soft = limit.map_or(hard, |limit| limit);
        if soft > hard {
            return Err(format!("the system allows {} at most", super::readable(hard)));
        }
        setrlimit(Resource::RLIMIT_DATA, soft, hard).map_err(|error| error.desc().to_lowercase())?;
        LIMIT.store(if soft == RLIM_INFINITY { 0 } else { soft }, Ordering::Relaxed);
        Ok(())
    }

    /// Sets the limit unless it is lower already.
    pub(super) fn lower_to(limit: u64) {
        let Ok((soft, hard)) = getrlimit(Resource::RLIMIT_DATA) else { return };
        let lower = limit.min(soft);
        LIMIT.store(lower, Ordering::Relaxed);
        if lower < soft {
            // If the limit cannot be set, only the system's own limit applies.
            let _ = setrlimit(Resource::RLIMIT_DATA, lower, hard);
        }
    }

    /// The caller's limit on the address space, bytes; `None` for none.
    pub(super) fn address_space() -> Option<u64> {
        getrlimit(Resource::RLIMIT_AS).ok().map(|(soft, _)| soft).filter(|soft| *soft != RLIM_INFINITY)
    }

    /// Removes the limit for the final message.
    pub(super) fn lift() {
        if let Ok((_, hard)) = getrlimit(Resource::RLIMIT_DATA) {
            let _ = setrlimit(Resource::RLIMIT_DATA, hard, hard);
        }
    }
}

/// Other systems have no such limit: there the program ends when they run out of memory.
#[cfg(not(target_os = "linux"))]
mod system {
    pub(super) fn set(limit: Option<u64>) -> Result<(), String> {
        limit.map_or(Ok(()), |_| Err("this system cannot limit a program's memory".to_owned()))
    }

    pub(super) fn lower_to(_limit: u64) {}

    pub(super) fn address_space() -> Option<u64> {
        None
    }

    pub(super) fn lift() {}
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn sizes_have_units_and_zero_is_none() {
        for (text, bytes) in [("500M", 500 << 20), ("1.5g", 3 << 29), ("2GiB", 2 << 30), ("33554432", 32 << 20)] {
            assert_eq!(Size::parse(text), Some(Size(Some(bytes))), "{text}");
        }
        assert_eq!(Size::parse("0"), Some(Size(None)));
        for wrong in ["", "M", "-1G", "1", "15M", "nan", "inf", "1e9T", "2X", "2 G"] {
            assert_eq!(Size::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn the_option_counts_on_the_command_line_alone() {
        let (rest, value) = without_option(words("rpict --limit-memory 1G -x 5 --limit-memory 2G a.rad")).unwrap();
        assert_eq!((rest, value.as_deref()), (words("rpict -x 5 a.rad"), Some("2G")));
        let of_file = words("radsight --words-of-file rpict --limit-memory 1G a.rad");
        assert_eq!(without_option(of_file.clone()).unwrap(), (of_file, None));
        assert!(without_option(words("rpict --limit-memory")).is_err());
    }
}
