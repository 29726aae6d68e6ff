//! A progress bar with the remaining time, on a terminal only.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use radsight_output::interrupt;
use std::io::IsTerminal;

/// Shows the progress of rays.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// A bar with the name of a stage.
    pub(crate) fn new(what: &'static str) -> Bar {
        let bar = ProgressBar::new(0);
        if std::io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{msg} [{bar:40}] {percent}% {eta} left");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        } else {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.set_message(what);
        Bar(bar)
    }

    /// Removes the bar.
    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}

impl radsight_capture::Progress for Bar {
    fn report(&self, done: u64, total: u64) {
        if !self.0.is_hidden() {
            self.0.set_length(total);
            self.0.set_position(done);
        }
    }

    fn stops(&self) -> bool {
        interrupt::is_asked()
    }
}
