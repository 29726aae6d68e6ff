//! The progress reports of `rpict -t`, in Radiance's format, which scripts read.

use crate::failure::say;
use std::time::{Duration, Instant};

/// Seconds in an hour.
const HOUR: f64 = 3600.0;

/// Prints progress reports.
pub(super) struct Report {
    every: Duration,
    begun: Instant,
    last: Instant,
}

impl Report {
    /// Starts with the first report. `seconds` is the time between reports; 0 for none.
    pub(super) fn new(seconds: u64) -> Report {
        let now = Instant::now();
        let report = Report { every: Duration::from_secs(seconds), begun: now, last: now };
        report.say(0.0, 0.0);
        report
    }

    /// Reports if it is time, or if the picture is finished. `rays` are those of pixels.
    pub(super) fn update(&mut self, share: f64, rays: f64) {
        if share >= 1.0 || self.last.elapsed() >= self.every {
            self.last = Instant::now();
            self.say(share, rays);
        }
    }

    fn say(&self, share: f64, rays: f64) {
        if !self.every.is_zero() {
            let done = format!("{rays:.0} rays, {:.2}%", 100.0 * share);
            say(&format!("rpict: {done} {}\n", spent(self.begun.elapsed().as_secs_f64() / HOUR)));
        }
    }
}

/// The elapsed user and system time, then `real_hours`, and the host.
#[cfg(unix)]
fn spent(real_hours: f64) -> String {
    use nix::sys::resource::{UsageWho, getrusage};
    let usages = [UsageWho::RUSAGE_SELF, UsageWho::RUSAGE_CHILDREN].map(getrusage);
    let [mut user, mut system] = [0.0; 2];
    for usage in usages.into_iter().flatten() {
        let hours = |time: nix::sys::time::TimeVal| (time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64) / HOUR;
        user += hours(usage.user_time());
        system += hours(usage.system_time());
    }
    let host = nix::unistd::gethostname().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let process = std::process::id();
    format!("after {user:.3}u {system:.3}s {real_hours:.3}r hours on {host} (PID {process})")
}

/// The elapsed time.
#[cfg(not(unix))]
fn spent(real_hours: f64) -> String {
    format!("after {real_hours:5.4} hours")
}
