//! The record of a run: times and decisions of the renderer.

use radsight_render::RenderPlan;
use radsight_report::{Decision, RunRecord, Stage};
use std::time::Instant;

/// Measures consecutive stages of a run.
pub(crate) struct Stopwatch {
    stages: Vec<Stage>,
    started: Instant,
    started_processor_s: Option<f64>,
    /// Start of the current stage.
    begun: Instant,
    processor_s: Option<f64>,
}

impl Stopwatch {
    /// Begins the first stage.
    pub(crate) fn start() -> Stopwatch {
        let (now, processor_s) = (Instant::now(), processor_seconds());
        Stopwatch { stages: Vec::new(), started: now, started_processor_s: processor_s, begun: now, processor_s }
    }

    /// Tells the processor time since the first stage began, s; the time itself where the system
    /// does not say.
    pub(crate) fn processor_clock(&self) -> impl Fn() -> f64 + Send + Sync + 'static {
        let (started, before) = (self.started, self.started_processor_s);
        move || match before.zip(processor_seconds()) {
            Some((before, now)) => now - before,
            None => started.elapsed().as_secs_f64(),
        }
    }

    /// Ends the current stage, with its name, and starts the next.
    pub(crate) fn lap(&mut self, name: &str) {
        let (now, processor_s) = (Instant::now(), processor_seconds());
        let spent = processor_s.zip(self.processor_s).map(|(now, before)| now - before);
        let elapsed_s = (now - self.begun).as_secs_f64();
        self.stages.push(Stage { name: name.to_owned(), elapsed_s, processor_s: spent });
        (self.begun, self.processor_s) = (now, processor_s);
    }

    /// A record of the stages so far, of the program's words and of the plan's decisions.
    pub(crate) fn record(&self, plan: &RenderPlan, command: &[String]) -> RunRecord {
        let decision = |decision: &radsight_render::PlanDecision| Decision {
            what: decision.what.clone(),
            why: decision.why.clone(),
            skipped: decision.skip.is_some(),
        };
        RunRecord {
            software: format!(
                "radsight {} on {} {}",
                env!("CARGO_PKG_VERSION"),
                std::env::consts::OS,
                std::env::consts::ARCH
            ),
            command: command.to_vec(),
            date: Some(crate::clock::now_local()),
            stages: self.stages.clone(),
            decisions: plan.decisions().iter().map(decision).collect(),
            ..RunRecord::default()
        }
    }
}

/// Processor time of this process and its finished children, s; `None` if the system does not
/// report it.
#[cfg(unix)]
fn processor_seconds() -> Option<f64> {
    use nix::sys::resource::{UsageWho, getrusage};
    let seconds = |time: nix::sys::time::TimeVal| time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64;
    let usages = [UsageWho::RUSAGE_SELF, UsageWho::RUSAGE_CHILDREN].map(getrusage);
    usages
        .into_iter()
        .map(|usage| usage.ok().map(|usage| seconds(usage.user_time()) + seconds(usage.system_time())))
        .sum()
}

#[cfg(not(unix))]
fn processor_seconds() -> Option<f64> {
    None
}
