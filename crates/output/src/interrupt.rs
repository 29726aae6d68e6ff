//! What happens at SIGINT, SIGTERM and SIGHUP: what is to be saved is saved, hidden files are
//! removed, and the program ends by the signal, so that a shell sees 130 or 143 and stops its loop.
//!
//! Signals that were ignored when the program began, as in `nohup` and in background jobs of
//! scripts, stay ignored.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

type Action = Box<dyn FnOnce() + Send>;

struct State {
    next: u64,
    files: BTreeMap<u64, PathBuf>,
    actions: BTreeMap<u64, Action>,
    is_watching: bool,
    /// Whether the first signal is only noted, and which one came.
    is_postponed: bool,
}

/// The signal that was noted; 0 for none.
static ASKED: AtomicI32 = AtomicI32::new(0);

static STATE: Mutex<State> = Mutex::new(State {
    next: 0,
    files: BTreeMap::new(),
    actions: BTreeMap::new(),
    is_watching: false,
    is_postponed: false,
});

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes a file that is removed at a signal. No signal is handled between its making and its being
/// known.
pub(crate) fn make_file<F>(make: impl FnOnce() -> io::Result<(F, PathBuf)>) -> io::Result<(F, FileGuard)> {
    let mut state = state();
    watch(&mut state);
    let (file, path) = make()?;
    let number = state.take_number();
    state.files.insert(number, path);
    Ok((file, FileGuard(number)))
}

/// A file that is removed at a signal as long as this lives.
#[derive(Debug)]
pub(crate) struct FileGuard(u64);

impl FileGuard {
    /// Does something after which the file is no longer to be removed, with no signal handled in
    /// between.
    pub(crate) fn release<T>(self, act: impl FnOnce() -> T) -> T {
        let mut state = state();
        let done = act();
        state.files.remove(&self.0);
        drop(state);
        done
    }
}

impl Drop for FileGuard {
    fn drop(&mut self) {
        state().files.remove(&self.0);
    }
}

/// What is done at a signal, in a thread of its own, as long as this lives.
#[derive(Debug)]
pub struct ActionGuard(u64);

/// Does something at a signal, before the program ends by it.
#[must_use]
pub fn at_signal(action: impl FnOnce() + Send + 'static) -> ActionGuard {
    let mut state = state();
    watch(&mut state);
    let number = state.take_number();
    state.actions.insert(number, Box::new(action));
    ActionGuard(number)
}

impl Drop for ActionGuard {
    fn drop(&mut self) {
        let action = state().actions.remove(&self.0);
        drop(action);
    }
}

/// As long as this lives, the first signal is only noted, so that the work can be ended in order;
/// the second one ends the program.
#[derive(Debug)]
pub struct Postponed(());

/// Begins to note signals.
#[must_use]
pub fn postpone() -> Postponed {
    let mut state = state();
    watch(&mut state);
    state.is_postponed = true;
    Postponed(())
}

/// Whether a signal was noted.
#[must_use]
pub fn is_asked() -> bool {
    ASKED.load(Ordering::Relaxed) != 0
}

impl Postponed {
    /// Ends the program by the signal that was noted; does nothing if none was.
    pub fn end(self) {
        let asked = ASKED.load(Ordering::Relaxed);
        if asked != 0 {
            end_by(asked);
        }
    }
}

impl Drop for Postponed {
    fn drop(&mut self) {
        state().is_postponed = false;
    }
}

impl State {
    fn take_number(&mut self) -> u64 {
        self.next += 1;
        self.next
    }
}

/// Saves, removes, and ends the program.
fn end_by(signal: i32) {
    // Actions write files themselves, so the state must be free for them.
    let actions = std::mem::take(&mut state().actions);
    actions.into_values().for_each(|action| action());
    // From here on no file can be begun.
    let state = state();
    state.files.values().for_each(|path| drop(fs::remove_file(path)));
    end_process(signal);
}

/// Removes all hidden files and ends the program at once, without what else it does at its end: for
/// faults after which nothing can be relied on.
pub fn end_with(code: i32) -> ! {
    // Whoever has the state at this moment may be the one that met the fault.
    if let Ok(state) = STATE.try_lock() {
        state.files.values().for_each(|path| drop(fs::remove_file(path)));
    }
    #[cfg(unix)]
    signal_hook::low_level::exit(code);
    #[cfg(not(unix))]
    std::process::exit(code)
}

#[cfg(unix)]
fn end_process(signal: i32) {
    // It only fails for signals that do not end a program.
    let _ = signal_hook::low_level::emulate_default_handler(signal);
    std::process::exit(128 + signal);
}

#[cfg(not(unix))]
fn end_process(signal: i32) {
    std::process::exit(128 + signal);
}

#[cfg(unix)]
fn watch(state: &mut State) {
    use signal_hook::iterator::Signals;
    if std::mem::replace(&mut state.is_watching, true) {
        return;
    }
    // Without a thread to take them, signals end the program as they always did.
    let (send, receive) = std::sync::mpsc::channel::<Signals>();
    let watcher = move || {
        let Ok(mut signals) = receive.recv() else { return };
        signals.forever().for_each(take);
    };
    if std::thread::Builder::new().name("signals".to_owned()).spawn(watcher).is_ok()
        && let Ok(signals) = Signals::new(not_ignored())
    {
        let _ = send.send(signals);
    }
}

#[cfg(not(unix))]
fn watch(_state: &mut State) {}

#[cfg(unix)]
fn take(signal: i32) {
    let now = state();
    if now.is_postponed && !is_asked() {
        ASKED.store(signal, Ordering::Relaxed);
        return;
    }
    drop(now);
    end_by(signal);
}

/// The signals that ask a program to end, but for those that are ignored.
#[cfg(unix)]
fn not_ignored() -> Vec<i32> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| mask >> (signal - 1) & 1 == 0).collect()
}
