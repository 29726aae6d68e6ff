//! What the checks found, for people and for programs.

use super::job::{Response, Stage};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Duration;

/// A check that fails with several sets of parameters is shown with this many of them; JSON has all.
const MESSAGES_SHOWN: usize = 2;

/// All checks of a library.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Its file.
    pub library: PathBuf,
    /// With which the report can be repeated.
    pub seed: u64,
    /// In the order in which they were made.
    pub outcomes: Vec<Outcome>,
}

/// One check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// What was checked.
    pub check: Stage,
    /// Of which model; none for the library as a whole.
    pub model: Option<String>,
    /// Whether it passed.
    pub verdict: Verdict,
    /// What is wrong; the reason why it was skipped.
    pub messages: Vec<String>,
    /// What is worth knowing.
    pub notes: Vec<String>,
    /// How long it took.
    pub seconds: f64,
}

/// How a check ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Nothing was found.
    Passed,
    /// It does not apply.
    Skipped,
    /// Something was found.
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

    /// The messages of all failed checks.
    #[must_use]
    pub fn failures(&self) -> Vec<&str> {
        let failed = self.outcomes.iter().filter(|outcome| outcome.verdict == Verdict::Failed);
        failed.flat_map(|outcome| outcome.messages.iter().map(String::as_str)).collect()
    }

    /// For people.
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
            let more = (more > 0).then(|| format!("… and so with {more} more sets of parameters"));
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

    /// For programs: one JSON object.
    #[must_use]
    pub fn json(&self) -> String {
        let mut value = serde_json::json!(self);
        value["passed"] = self.passed().into();
        serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
    }
}
