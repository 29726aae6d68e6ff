//! How a picture was made, as the program writes it down.

use crate::ReportError;
use serde::{Deserialize, Serialize};

/// The format of records.
const FORMAT: u32 = 1;

/// How a picture was made. As JSON it is what `--record` writes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRecord {
    /// The format of the record: 1.
    pub format: u32,
    /// Program and version.
    #[serde(default)]
    pub software: String,
    /// The words of the command line.
    #[serde(default)]
    pub command: Vec<String>,
    /// When it was made, as Radiance's headers write it.
    #[serde(default)]
    pub date: Option<String>,
    /// What was asked for, the defaults as well.
    #[serde(default)]
    pub settings: Vec<Setting>,
    /// Where the time went, in order.
    #[serde(default)]
    pub stages: Vec<Stage>,
    /// How exact the picture is.
    #[serde(default)]
    pub error: Option<ErrorEstimate>,
    /// Rays that were traced from the camera.
    #[serde(default)]
    pub rays: Option<u64>,
    /// Relative noise of cached irradiance; interpolation bias is not in it, nor what correcting pixels takes away.
    #[serde(default)]
    pub cache_noise: Option<f64>,
    /// What the renderer decided: what it did, and what it left out.
    #[serde(default)]
    pub decisions: Vec<Decision>,
    /// What else is to be known, such as that the picture is partial.
    #[serde(default)]
    pub notes: Vec<String>,
}

/// Something that was asked for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// What it is.
    pub name: String,
    /// Its value, with its unit.
    pub value: String,
}

/// A part of the work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// What was done.
    pub name: String,
    /// Time that passed, s.
    pub elapsed_s: f64,
    /// Processor time of all threads, s; where it is known.
    #[serde(default)]
    pub processor_s: Option<f64>,
}

/// The error of a picture, as shares.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorEstimate {
    /// Which one was asked for.
    #[serde(default)]
    pub asked: Option<f64>,
    /// Which one was reached, as far as the picture's own samples tell.
    pub reached: f64,
    /// With 95 % confidence it is no farther away from this.
    #[serde(default)]
    pub uncertainty: Option<f64>,
}

/// A decision of the renderer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Decision {
    /// What is done or left out.
    pub what: String,
    /// Why.
    pub why: String,
    /// Whether work was left out by it.
    pub skipped: bool,
}

impl Default for RunRecord {
    fn default() -> Self {
        RunRecord {
            format: FORMAT,
            software: String::new(),
            command: Vec::new(),
            date: None,
            settings: Vec::new(),
            stages: Vec::new(),
            error: None,
            rays: None,
            cache_noise: None,
            decisions: Vec::new(),
            notes: Vec::new(),
        }
    }
}

impl RunRecord {
    /// Reads a record.
    ///
    /// # Errors
    /// [`ReportError::Record`] with the place, and [`ReportError::RecordFormat`].
    pub fn from_json(bytes: &[u8]) -> Result<RunRecord, ReportError> {
        let record: RunRecord = serde_json::from_slice(bytes).map_err(|error| {
            let text = error.to_string();
            let reason = text.split(" at line ").next().unwrap_or(&text).to_owned();
            ReportError::Record { line: error.line(), column: error.column(), reason }
        })?;
        match record.format {
            FORMAT => Ok(record),
            format => Err(ReportError::RecordFormat { format, expected: FORMAT }),
        }
    }

    /// The record as JSON, indented, with a line feed at the end.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a record is text and numbers");
        text.push('\n');
        text
    }

    /// Adds a setting.
    pub fn push_setting(&mut self, name: impl Into<String>, value: impl Into<String>) {
        self.settings.push(Setting { name: name.into(), value: value.into() });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_come_back() {
        let mut record = RunRecord {
            software: "radsight 0.1.0".into(),
            command: vec!["radsight".into(), "a \"quoted\" word".into()],
            stages: vec![Stage { name: "rays".into(), elapsed_s: 1.5, processor_s: Some(2.9) }],
            error: Some(ErrorEstimate { asked: Some(0.01), reached: 0.0099, uncertainty: None }),
            ..RunRecord::default()
        };
        record.push_setting("seed", "7");
        assert_eq!(RunRecord::from_json(record.to_json().as_bytes()).unwrap(), record);
    }

    #[test]
    fn mistakes_have_their_place() {
        let error = RunRecord::from_json(b"{\n \"format\": 1,\n \"colour\": 2}").unwrap_err();
        let ReportError::Record { line, reason, .. } = &error else { panic!("{error}") };
        assert!(*line == 3 && reason.contains("colour"), "{error}");
        assert_eq!(RunRecord::from_json(b"{\"format\": 9}"), Err(ReportError::RecordFormat { format: 9, expected: 1 }));
        assert!(RunRecord::from_json(b"\xff").is_err());
    }
}
