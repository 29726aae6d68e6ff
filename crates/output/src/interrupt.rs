//! Handles the signals that end a program from outside, among them SIGINT, SIGTERM and SIGXCPU of
//! `ulimit -t`: saves what is to be saved, removes hidden files, and ends the program by the signal,
//! so that a shell sees 130 or 143 and stops its loop.
//!
//! Signals that were ignored at the start, as in `nohup` and in background jobs of scripts, stay
//! ignored.

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
    /// Whether the first signal is only recorded, and which signal came.
    is_postponed: bool,
}

/// The recorded signal; 0 for none.
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

/// Creates a file that is removed at a signal. No signal is handled between its creation and its
/// registration.
pub(crate) fn make_file<F>(make: impl FnOnce() -> io::Result<(F, PathBuf)>) -> io::Result<(F, FileGuard)> {
    let mut state = state();
    watch(&mut state);
    let (file, path) = make()?;
    let number = state.take_number();
    state.files.insert(number, path);
    Ok((file, FileGuard(number)))
}

/// A file that is removed at a signal while this guard lives.
#[derive(Debug)]
pub(crate) struct FileGuard(u64);

impl FileGuard {
    /// Performs an action after which the file must not be removed. No signal is handled in
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

/// An action to run at a signal while this guard lives. It runs in a thread of its own.
#[derive(Debug)]
pub struct ActionGuard(u64);

/// Registers an action to run at a signal before the program ends.
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

/// While this lives, the first signal is only recorded, so that the work can be finished in order;
/// the second one ends the program.
#[derive(Debug)]
pub struct Postponed(());

/// Starts to record signals.
#[must_use]
pub fn postpone() -> Postponed {
    let mut state = state();
    watch(&mut state);
    state.is_postponed = true;
    Postponed(())
}

/// Whether a signal was recorded.
#[must_use]
pub fn is_asked() -> bool {
    ASKED.load(Ordering::Relaxed) != 0
}

impl Postponed {
    /// Ends the program by the recorded signal, if any.
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

/// Runs the actions, removes hidden files, and ends the program.
fn end_by(signal: i32) {
    // Actions write files themselves, so the state must be unlocked.
    let actions = std::mem::take(&mut state().actions);
    actions.into_values().for_each(|action| action());
    // No file can be created from here on.
    let state = state();
    state.files.values().for_each(|path| drop(fs::remove_file(path)));
    end_process(signal);
}

/// Removes all hidden files and ends the program at once, without other cleanup: for faults after
/// which the state cannot be trusted.
pub fn end_with(code: i32) -> ! {
    // The thread that holds the lock may be the one with the fault.
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
    // This fails only for signals that do not end a program.
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
    // Without a thread to receive them, signals end the program by default.
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

/// Makes writes beyond the largest size of a file (`ulimit -f`) fail, instead of ending the program
/// by SIGXFSZ.
#[cfg(unix)]
pub fn refuse_large_files() {
    // Any handler does; without one, which is only possible out of memory, the signal ends the program.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
}

/// Has no effect on this system.
#[cfg(not(unix))]
pub fn refuse_large_files() {}

/// The signals that end a program from outside, except ignored ones.
#[cfg(unix)]
fn not_ignored() -> Vec<i32> {
    use signal_hook::consts::{SIGALRM, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU};
    let ending = [SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGALRM, SIGUSR1, SIGUSR2];
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    ending.into_iter().filter(|signal| mask >> (signal - 1) & 1 == 0).collect()
}
