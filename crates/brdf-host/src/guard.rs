//! Keeps a plugin from ending the program without a message.
//!
//! Every call into a plugin is recorded in a slot of its thread (`enter`), at the cost of a few
//! stores. Handlers of signals, of `exit`, of `fork`, and a watching thread read the slots. They
//! end the program with exit code 3 and a message that names plugin, model, material, position and
//! function.
//!
//! A guard in the same process has limits, which `docs/plugins.md` states: it cannot detect silent
//! memory corruption, and a malicious plugin can evade it. [`crate::isolate`] has neither limit.

mod call;
mod endings;
mod message;
mod signals;
pub mod standard_output;
mod watch;

#[cfg(target_os = "linux")]
pub(crate) use call::count_calls;
pub(crate) use call::{Breadcrumb, Text, enter, enter_at};
pub(crate) use message::{announce_reports_in, end_program, end_silently, note_library, one_line};

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Exit code of a program that was stopped by a limit or a fault.
pub const FAULT: i32 = 3;

/// Limits of a plugin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Time limit of one call. Default 120 s; `None` is no limit.
    pub time: Option<Duration>,
    /// Memory, in bytes, by which the program may grow during one call, or which the process of an
    /// isolated plugin may use. Default half of the machine's memory; `None` is no limit.
    pub memory: Option<u64>,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { time: Some(Duration::from_secs(120)), memory: machine_memory().map(|bytes| bytes / 2) }
    }
}

/// Memory of the machine, or of the container, bytes; `None` if unknown.
#[must_use]
pub fn machine_memory() -> Option<u64> {
    watch::machine_memory()
}

/// Makes a crash inside a plugin report its position; the process then ends as usual. Call it once
/// per process.
pub fn install_crash_messages() {
    signals::install();
}

/// Guards the whole program: a fault of a plugin ends it with [`FAULT`] and a message, and the
/// output of plugins goes to standard error. Call it before the first plugin is loaded; only the
/// first call has an effect.
///
/// From then on the program writes its data through [`standard_output`].
///
/// # Errors
/// If standard output cannot be redirected, or the watching thread cannot be started.
pub fn install(limits: &Limits) -> std::io::Result<()> {
    static INSTALLED: std::sync::Mutex<bool> = std::sync::Mutex::new(false);
    let mut installed = INSTALLED.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if *installed {
        return Ok(());
    }
    standard_output::set_aside()?;
    install_crash_messages();
    message::end_with(FAULT);
    endings::install();
    watch::start(limits)?;
    *installed = true;
    Ok(())
}

/// Restores signal handlers that a plugin replaced, and reports that once: with the current call,
/// or without one.
fn take_back_handlers(breadcrumb: Option<Breadcrumb>) {
    static TOLD: AtomicBool = AtomicBool::new(false);
    let replaced = signals::reinstall();
    if !replaced.is_empty() && !TOLD.swap(true, Ordering::Relaxed) {
        let who = breadcrumb.map_or("one of the plugins", |crumb| &crumb.text().0);
        let names = replaced.join(", ");
        message::report(&["warning: ", who, ": it replaced the handlers of ", &names, ", which are put back"]);
    }
}

/// Call it after a library's initialisers have run: undoes what they may have done to the guard.
pub(crate) fn after_load(breadcrumb: Breadcrumb) {
    after_call(breadcrumb);
    endings::come_first();
}

/// Call it after each call that does not count for speed: undoes what it may have done to the
/// guard, and ends the program if it closed a standard file.
pub(crate) fn after_call(breadcrumb: Breadcrumb) {
    take_back_handlers(Some(breadcrumb));
    if !standard_output::is_intact() {
        endings::end_for_closed_files(Some(breadcrumb));
    }
}

/// Ends the program if one of the last calls closed a standard file.
pub(crate) fn check_files() {
    if !standard_output::is_intact() {
        endings::end_for_closed_files(None);
    }
}

/// The guard of a process that runs only a plugin, and whose parent enforces the limits: a crash
/// ends it with its signal after the message, other faults with [`FAULT`].
pub(crate) fn install_in_child() -> std::io::Result<()> {
    standard_output::set_aside()?;
    install_crash_messages();
    signals::die_after_messages();
    endings::install();
    // Handlers are restored here too.
    watch::start(&Limits { time: None, memory: None })
}
