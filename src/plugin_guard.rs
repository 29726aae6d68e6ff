//! Limits of plugins and their isolation in separate processes: options and environment variables.

use crate::failure::Failure;
use crate::render_args::number;
use clap::Args;
use radsight_brdf_host::isolate::Isolation;
use radsight_brdf_host::{ChildCommand, Limits, Registry, guard};
use std::ffi::OsString;
use std::str::FromStr;
use std::time::Duration;

const ISOLATE_VARIABLE: &str = "RADSIGHT_ISOLATE_PLUGINS";
const TIME_VARIABLE: &str = "RADSIGHT_PLUGIN_TIME_LIMIT";
const MEMORY_VARIABLE: &str = "RADSIGHT_PLUGIN_MEMORY_LIMIT";

/// The hidden words that start the process of an isolated plugin.
const CHILD_WORDS: [&str; 2] = ["plugin", "isolation-child"];

/// Options of the guard over plugins.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct PluginGuard {
    /// Run each plugin library in a separate process, which cannot damage this one; slower
    #[arg(long)]
    isolate_plugins: bool,
    /// Time limit of one plugin call, seconds; 0 for no limit [default: 120]
    #[arg(long, value_name = "S")]
    plugin_time_limit: Option<Seconds>,
    /// Memory limit of one plugin call, or of the process of an isolated plugin, MB; 0 for no limit
    /// [default: half of the memory]
    #[arg(long, value_name = "MB")]
    plugin_memory_limit: Option<Megabytes>,
}

impl PluginGuard {
    /// Parses one of these options at the front of a command line; returns the number of words it
    /// used, 0 for another option.
    pub(crate) fn take(&mut self, words: &[String]) -> Result<usize, Failure> {
        let word = words[0].as_str();
        match word {
            "--isolate-plugins" => {
                self.isolate_plugins = true;
                return Ok(1);
            }
            "--plugin-time-limit" => self.plugin_time_limit = Some(number(words, word, Seconds::EXPECTED)?),
            "--plugin-memory-limit" => self.plugin_memory_limit = Some(number(words, word, Megabytes::EXPECTED)?),
            _ => return Ok(0),
        }
        Ok(2)
    }

    /// Whether these options permit plugins more than `other`.
    pub(crate) fn allows_more_than(&self, other: &PluginGuard) -> bool {
        let (Ok(own), Ok(others)) = (self.limits(), other.limits()) else { return false };
        let is_more =
            |own: Option<f64>, others: Option<f64>| own.unwrap_or(f64::INFINITY) > others.unwrap_or(f64::INFINITY);
        is_more(own.time.map(|time| time.as_secs_f64()), others.time.map(|time| time.as_secs_f64()))
            || is_more(own.memory.map(|bytes| bytes as f64), others.memory.map(|bytes| bytes as f64))
    }

    /// Guards the program against plugins, unless that was done. Call it before a plugin is loaded.
    pub(crate) fn guard_program(&self) -> Result<(), String> {
        guard::install(&self.limits()?).map_err(|error| format!("cannot guard the program against plugins: {error}"))
    }

    /// A registry that runs libraries in the selected processes.
    pub(crate) fn with_isolation(&self, registry: Registry) -> Registry {
        let by_variable = std::env::var_os(ISOLATE_VARIABLE).is_some_and(|text| !text.is_empty() && text != "0");
        if !self.isolate_plugins && !by_variable {
            return registry;
        }
        // `guard_program` reports an invalid limit before any library is loaded.
        let memory = self.limits().unwrap_or_default().memory;
        registry.isolated(Isolation { child: ChildCommand::this_program(&CHILD_WORDS), memory })
    }

    /// Checks the environment variables of the limits, before the work.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        self.limits().map(drop).map_err(Failure::usage)
    }

    /// The limits of plugins.
    pub(crate) fn limits(&self) -> Result<Limits, String> {
        let defaults = Limits::default();
        let time =
            self.plugin_time_limit.map_or_else(|| variable(TIME_VARIABLE, Seconds::EXPECTED), |t| Ok(Some(t)))?;
        let memory =
            self.plugin_memory_limit.map_or_else(|| variable(MEMORY_VARIABLE, Megabytes::EXPECTED), |m| Ok(Some(m)))?;
        Ok(Limits {
            time: time.map_or(defaults.time, |Seconds(limit)| limit),
            memory: memory.map_or(defaults.memory, |Megabytes(limit)| limit),
        })
    }
}

/// The value of an environment variable, if it is set.
fn variable<T: FromStr>(name: &str, expected: &str) -> Result<Option<T>, String> {
    let Some(text) = std::env::var_os(name).filter(|text: &OsString| !text.is_empty()) else { return Ok(None) };
    let text = text.to_string_lossy();
    text.parse().map(Some).map_err(|_| format!("the variable {name} is \"{text}\", expected {expected}"))
}

/// A time limit; none for 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seconds(Option<Duration>);

impl Seconds {
    const EXPECTED: &str = "seconds, 0 for no limit";
}

impl FromStr for Seconds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("expected {}", Self::EXPECTED);
        let seconds: f64 = text.parse().map_err(|_| wrong())?;
        let limit = Duration::try_from_secs_f64(seconds).map_err(|_| wrong())?;
        Ok(Seconds((seconds > 0.0).then_some(limit)))
    }
}

/// A memory limit in bytes; none for 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Megabytes(Option<u64>);

impl Megabytes {
    const EXPECTED: &str = "a number of MB, 0 for no limit";
}

impl FromStr for Megabytes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let megabytes: f64 = text.parse().map_err(|_| format!("expected {}", Self::EXPECTED))?;
        if !(0.0..=1e12).contains(&megabytes) {
            return Err(format!("expected {}", Self::EXPECTED));
        }
        Ok(Megabytes((megabytes > 0.0).then_some((megabytes * f64::from(1 << 20)) as u64)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_numbers_and_zero_is_none() {
        assert_eq!("0".parse(), Ok(Seconds(None)));
        assert_eq!("1.5".parse(), Ok(Seconds(Some(Duration::from_millis(1500)))));
        assert_eq!(".5".parse(), Ok(Megabytes(Some(1 << 19))));
        assert_eq!("0".parse(), Ok(Megabytes(None)));
        for wrong in ["-1", "nan", "inf", "", "x", "1e300"] {
            assert!(wrong.parse::<Seconds>().is_err() && wrong.parse::<Megabytes>().is_err(), "{wrong}");
        }
    }
}
