//! The record of how a picture was made.

use crate::ReportError;
use serde::{Deserialize, Serialize};

/// The version of the format.
const FORMAT: u32 = 1;

/// How a picture was made. `--record` writes it as JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRecord {
    /// The version of the format: 1.
    pub format: u32,
    /// Program and version.
    #[serde(default)]
    pub software: String,
    /// The words of the command line.
    #[serde(default)]
    pub command: Vec<String>,
    /// The date in the format of Radiance's headers.
    #[serde(default)]
    pub date: Option<String>,
    /// The options, including defaults.
    #[serde(default)]
    pub settings: Vec<Setting>,
    /// The stages of the run, in order.
    #[serde(default)]
    pub stages: Vec<Stage>,
    /// The estimated error of the picture.
    #[serde(default)]
    pub error: Option<ErrorEstimate>,
    /// Number of camera rays.
    #[serde(default)]
    pub rays: Option<u64>,
    /// Relative noise of cached irradiance, without interpolation bias and before the correction of
    /// pixels.
    #[serde(default)]
    pub cache_noise: Option<f64>,
    /// The renderer's decisions: what was computed, and what was skipped.
    #[serde(default)]
    pub decisions: Vec<Decision>,
    /// Further notes, such as that the picture is partial.
    #[serde(default)]
    pub notes: Vec<String>,
}

/// An option.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setting {
    /// Its name.
    pub name: String,
    /// Its value, with its unit.
    pub value: String,
}

/// A stage of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// Elapsed time, s.
    pub elapsed_s: f64,
    /// Processor time of all threads, s, if known.
    #[serde(default)]
    pub processor_s: Option<f64>,
}

/// The relative error of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorEstimate {
    /// The requested error.
    #[serde(default)]
    pub asked: Option<f64>,
    /// The error estimated from the picture's own samples.
    pub reached: f64,
    /// Half-width of the 95 % confidence interval of the estimate.
    #[serde(default)]
    pub uncertainty: Option<f64>,
}

/// A decision of the renderer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Decision {
    /// The work that was done or skipped.
    pub what: String,
    /// The reason.
    pub why: String,
    /// Whether the work was skipped.
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
    /// Parses a record.
    ///
    /// # Errors
    /// [`ReportError::Record`] with the position, and [`ReportError::RecordFormat`].
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

    /// The record as indented JSON with a line feed at the end.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a record contains only text and numbers");
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
