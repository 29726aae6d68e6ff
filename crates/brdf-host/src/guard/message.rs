//! Final messages, written by means that are safe in a signal handler, and the end of the process
//! after them.

use super::call::{Breadcrumb, Slot, Text};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicPtr, AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

/// Exit code after a message; if negative, the process ends as it would have.
static END_WITH: AtomicI32 = AtomicI32::new(-1);
/// Set by the first thread that reports: one fault often causes others.
static SPEAKING: AtomicBool = AtomicBool::new(false);
/// Names of the loaded libraries.
static LOADED: AtomicPtr<Text> = AtomicPtr::new(null_mut());
/// Counter of messages, readable by another process.
static SPOKEN: AtomicPtr<AtomicU32> = AtomicPtr::new(null_mut());

/// From now on the program ends with this code after a crash message.
pub(super) fn end_with(code: i32) {
    END_WITH.store(code, Ordering::Release);
}

pub(super) fn code_at_end() -> Option<i32> {
    let code = END_WITH.load(Ordering::Acquire);
    (code >= 0).then_some(code)
}

/// From now on every message increments `place`, which lives as long as the process.
pub(crate) fn announce_reports_in(place: &'static AtomicU32) {
    SPOKEN.store(std::ptr::from_ref(place).cast_mut(), Ordering::Release);
}

/// Records that a library is loaded: it may be the cause of a crash outside of its calls.
pub(crate) fn note_library(name: &str) {
    static NAMES: Mutex<Vec<String>> = Mutex::new(Vec::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    let name = format!("\"{name}\"");
    if !names.contains(&name) {
        names.push(name);
        let text = Breadcrumb::keep(names.join(", ")).text();
        LOADED.store(std::ptr::from_ref(text).cast_mut(), Ordering::Release);
    }
}

pub(super) fn loaded() -> Option<&'static str> {
    // SAFETY: only pointers to texts that are kept for ever are stored, and null.
    unsafe { LOADED.load(Ordering::Acquire).as_ref() }.map(|text| &*text.0)
}

/// Whether this thread is the first to report a fault. Other threads wait here for the end of the
/// process.
pub(super) fn is_first_to_speak() -> bool {
    !SPEAKING.swap(true, Ordering::AcqRel)
}

/// Reports what happened in the call of a slot; `kind` is "crash" or "fault".
pub(super) fn report_call(kind: &str, slot: &Slot, text: &Text, what: &[&str]) {
    let mut line = Line::default();
    ["radsight: ", kind, " in ", &text.0, ": "].iter().chain(what).for_each(|part| line.push(part.as_bytes()));
    if let Some(direction) = slot.outgoing() {
        line.push(b"; outgoing direction in the surface's frame");
        direction.iter().for_each(|&number| line.push_number(number));
    }
    line.write();
}

/// Reports what happened outside of all calls.
pub(super) fn report(parts: &[&str]) {
    let mut line = Line::default();
    line.push(b"radsight: ");
    parts.iter().for_each(|part| line.push(part.as_bytes()));
    line.write();
}

/// Reports a fault found by an ordinary thread, and ends the program.
pub(crate) fn end_program(message: &str) -> ! {
    if is_first_to_speak() {
        report(&[message]);
        end_now(super::FAULT)
    }
    wait_for_the_end()
}

/// Ends the program without a message: another process has reported.
pub(crate) fn end_silently() -> ! {
    if is_first_to_speak() {
        end_now(super::FAULT)
    }
    wait_for_the_end()
}

/// Ends the process without running any more code of the program or its plugins.
pub(super) fn end_now(code: i32) -> ! {
    // `_exit` is replaced in this program, so the system call is used.
    #[cfg(target_os = "linux")]
    loop {
        // SAFETY: async-signal-safe, and does not return.
        unsafe { libc::syscall(libc::SYS_exit_group, code) };
    }
    #[cfg(all(unix, not(target_os = "linux")))]
    // SAFETY: async-signal-safe, and does not return.
    unsafe {
        libc::_exit(code)
    }
    #[cfg(not(unix))]
    std::process::exit(code)
}

/// Waits, because another thread is about to end the process.
pub(super) fn wait_for_the_end() -> ! {
    loop {
        #[cfg(unix)]
        // SAFETY: async-signal-safe.
        unsafe {
            libc::pause();
        }
        #[cfg(not(unix))]
        std::thread::park();
    }
}

/// Text without line ends and other control characters.
pub(crate) fn one_line(text: &str) -> String {
    text.replace(|c: char| c.is_control(), "\u{fffd}")
}

/// A line assembled without heap memory and written at once, so that no other output interleaves.
struct Line {
    bytes: [u8; LONGEST_LINE],
    length: usize,
}

/// Longer lines are cut. The stack of a handler is at least eight times as large.
const LONGEST_LINE: usize = 2048;

impl Default for Line {
    fn default() -> Self {
        Line { bytes: [0; LONGEST_LINE], length: 0 }
    }
}

impl Line {
    fn push(&mut self, text: &[u8]) {
        // One byte is reserved for the line end.
        let room = LONGEST_LINE - 1 - self.length;
        let text = &text[..text.len().min(room)];
        self.bytes[self.length..][..text.len()].copy_from_slice(text);
        self.length += text.len();
    }

    /// Appends a space and a number of magnitude 1 or less, with four decimals.
    fn push_number(&mut self, number: f64) {
        let sign: &[u8] = if number < 0.0 { b" -" } else { b" " };
        let scaled = (number.abs().min(99.0) * 1e4 + 0.5) as u32;
        self.push(sign);
        let whole = scaled / 10_000;
        if whole > 9 {
            self.push(&[b'0' + (whole / 10) as u8]);
        }
        self.push(&[b'0' + (whole % 10) as u8, b'.']);
        for power in [1000, 100, 10, 1] {
            self.push(&[b'0' + (scaled / power % 10) as u8]);
        }
    }

    fn write(mut self) {
        self.bytes[self.length] = b'\n';
        let text = &self.bytes[..=self.length];
        #[cfg(unix)]
        // SAFETY: `write` is async-signal-safe; the slice is valid.
        let written = unsafe { libc::write(super::standard_output::messages(), text.as_ptr().cast(), text.len()) };
        #[cfg(not(unix))]
        let written = std::io::Write::write(&mut std::io::stderr(), text).unwrap_or(0);
        // SAFETY: the pointer is null or leads to a number that stays.
        if let (true, Some(spoken)) = (written > 0, unsafe { SPOKEN.load(Ordering::Acquire).as_ref() }) {
            spoken.fetch_add(1, Ordering::AcqRel);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_without_the_heap() {
        let mut line = Line::default();
        [0.6, -0.8, 0.0, 1.0, -0.00004, 0.00006, 12.5].iter().for_each(|&number| line.push_number(number));
        let text = std::str::from_utf8(&line.bytes[..line.length]).unwrap();
        assert_eq!(text, " 0.6000 -0.8000 0.0000 1.0000 -0.0000 0.0001 12.5000");
    }

    #[test]
    fn a_line_that_is_too_long_is_cut() {
        let mut line = Line::default();
        line.push(&[b'x'; 3 * LONGEST_LINE]);
        line.push(b"more");
        assert_eq!(line.length, LONGEST_LINE - 1);
    }
}
