//! Report of the checks, as text and as JSON.

use super::job::{Response, Stage};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Duration;

/// Number of messages shown for a check that fails with several parameter sets; JSON contains all.
const MESSAGES_SHOWN: usize = 2;

/// Report of all checks of a library.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// File of the library.
    pub library: PathBuf,
    /// Seed with which the checks can be repeated.
    pub seed: u64,
    /// Results in the order of the checks.
    pub outcomes: Vec<Outcome>,
}

/// Result of one check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// What was checked.
    pub check: Stage,
    /// The model; none for the library as a whole.
    pub model: Option<String>,
    /// Verdict of the check.
    pub verdict: Verdict,
    /// Violated requirements, or the reason for skipping.
    pub messages: Vec<String>,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// Duration, seconds.
    pub seconds: f64,
}

/// Verdict of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The check found nothing.
    Passed,
    /// The check does not apply.
    Skipped,
    /// The check found a violated requirement.
    Failed,
}

impl Outcome {
    pub(super) fn new(check: Stage, model: Option<&String>, response: Response, duration: Duration) -> Self {
        let Response { findings, notes, skipped, .. } = response;
        let verdict = match (&skipped, findings.is_empty()) {
            (_, false) => Verdict::Failed,
            (Some(_), true) => Verdict::Skipped,
            (None, true) => Verdict::Passed,
        };
        let messages = findings.into_iter().chain(skipped).collect();
        Outcome { check, model: model.cloned(), verdict, messages, notes, seconds: duration.as_secs_f64() }
    }
}

impl Report {
    /// Whether no check failed.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.outcomes.iter().all(|outcome| outcome.verdict != Verdict::Failed)
    }

    /// Messages of all failed checks.
    #[must_use]
    pub fn failures(&self) -> Vec<&str> {
        let failed = self.outcomes.iter().filter(|outcome| outcome.verdict == Verdict::Failed);
        failed.flat_map(|outcome| outcome.messages.iter().map(String::as_str)).collect()
    }

    /// The report as text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = format!("{} (seed {})\n", self.library.display(), self.seed);
        let mut model = &None;
        for outcome in &self.outcomes {
            if outcome.model != *model {
                let _ = writeln!(out, "model {}", outcome.model.as_deref().unwrap_or_default());
                model = &outcome.model;
            }
            let word = match outcome.verdict {
                Verdict::Passed => "ok",
                Verdict::Skipped => "skipped",
                Verdict::Failed => "FAILED",
            };
            let more = outcome.messages.len().saturating_sub(MESSAGES_SHOWN);
            let sets = if more == 1 { "set" } else { "sets" };
            let more = (more > 0).then(|| format!("… and the same with {more} more parameter {sets}"));
            let mut lines = outcome.messages.iter().take(MESSAGES_SHOWN).chain(&more).chain(&outcome.notes);
            let first = lines.next().map(|line| format!("  {line}")).unwrap_or_default();
            let _ = writeln!(out, "  {:<22} {word:<7}{first}", outcome.check.name());
            for line in lines {
                let _ = writeln!(out, "  {:<22} {:<7}  {line}", "", "");
            }
        }
        let count = |verdict| self.outcomes.iter().filter(|outcome| outcome.verdict == verdict).count();
        let (passed, skipped, failed) = (count(Verdict::Passed), count(Verdict::Skipped), count(Verdict::Failed));
        let _ = writeln!(out, "{passed} passed, {failed} failed, {skipped} skipped");
        out
    }

    /// The report as one JSON object.
    #[must_use]
    pub fn json(&self) -> String {
        let mut value = serde_json::json!(self);
        value["passed"] = self.passed().into();
        serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
    }
}
