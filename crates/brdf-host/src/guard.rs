//! Keeps a plugin from taking the program along without a word.
//!
//! Every call into a plugin is marked in a slot of its thread (`enter`): a few stores before it,
//! one after it. Handlers of signals, of `exit`, of `fork`, and a watching thread read the slots.
//! What they find ends the program with exit code 3 and a message that names plugin, model,
//! material, place and function.
//!
//! A guard in the same process has limits, which `docs/plugins.md` states: it cannot see memory
//! that is damaged quietly, and a plugin that means harm can get round it. [`crate::isolate`] has
//! neither limit.

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

/// The exit code of a program that a limit or a fault stopped.
pub const FAULT: i32 = 3;

/// What plugins may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// For one call. Default 120 s; `None` is no limit.
    pub time: Option<Duration>,
    /// Bytes by which the program may grow during one call, or which the process of an isolated
    /// plugin may have. Default half of the machine's memory; `None` is no limit.
    pub memory: Option<u64>,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { time: Some(Duration::from_secs(120)), memory: machine_memory().map(|bytes| bytes / 2) }
    }
}

/// Bytes of memory that the machine, or the container, has; `None` where it is not known.
#[must_use]
pub fn machine_memory() -> Option<u64> {
    watch::machine_memory()
}

/// Makes a crash inside a plugin say where it was; the process then ends as it would have. Once in
/// a process.
pub fn install_crash_messages() {
    signals::install();
}

/// Guards the whole program: what a plugin does to it ends it with [`FAULT`] and a message, and
/// what a plugin prints goes to standard error. To be called before the first plugin is loaded; the
/// first call counts.
///
/// From then on the program writes its data through [`standard_output`].
///
/// # Errors
/// When standard output cannot be set aside, or the watching thread cannot be started.
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

/// Puts back the handlers of signals that a plugin replaced, and tells so once: during this call,
/// or at some time.
pub(crate) fn take_back_handlers(breadcrumb: Option<Breadcrumb>) {
    static TOLD: AtomicBool = AtomicBool::new(false);
    let replaced = signals::reinstall();
    if !replaced.is_empty() && !TOLD.swap(true, Ordering::Relaxed) {
        let who = breadcrumb.map_or("one of the plugins", |crumb| &crumb.text().0);
        let names = replaced.join(", ");
        message::report(&["warning: ", who, ": it replaced the handlers of ", &names, ", which are put back"]);
    }
}

/// To be called when a library's initialisers have run: undoes what they may do to the guard.
pub(crate) fn after_load(breadcrumb: Breadcrumb) {
    take_back_handlers(Some(breadcrumb));
    endings::come_first();
}

/// The guard of a process that runs nothing but a plugin, and whose parent keeps the limits: a
/// crash ends it with its signal after the message, other faults with [`FAULT`].
pub(crate) fn install_in_child() -> std::io::Result<()> {
    standard_output::set_aside()?;
    install_crash_messages();
    signals::die_after_messages();
    endings::install();
    // Handlers are put back here too.
    watch::start(&Limits { time: None, memory: None })
}
