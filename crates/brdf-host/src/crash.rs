//! The last words of a program that a plugin brought down: which plugin, model, material and place.
//!
//! Each call into a plugin leaves a breadcrumb in the thread; a handler for the signals of a crash prints it with functions
//! that are safe in a handler and hands the signal on to whoever handled it before, so that the process ends as it would have.

use std::cell::Cell;

/// What is said of a call, made before it: a handler cannot build text.
#[derive(Debug)]
pub(crate) struct Breadcrumb {
    text: Box<str>,
}

impl Breadcrumb {
    pub(crate) fn for_library(library: &str, activity: &str) -> Self {
        Breadcrumb { text: format!("plugin \"{library}\", function {activity}").into() }
    }

    pub(crate) fn for_model(library: &str, model: &str, material: &str, place: &str, activity: &str) -> Self {
        let text =
            format!("plugin \"{library}\", model \"{model}\", material \"{material}\" ({place}), function {activity}");
        Breadcrumb { text: text.into() }
    }
}

thread_local! {
    // Constant and without a destructor: reading it in a signal handler is a plain memory access.
    static CURRENT: Cell<*const Breadcrumb> = const { Cell::new(std::ptr::null()) };
}

/// Puts the breadcrumb away when it is dropped.
struct Trail {
    before: *const Breadcrumb,
}

/// Marks the thread as being inside a plugin. The result must be dropped in the same thread, as all local values are.
#[inline]
pub(crate) fn enter<'a>(breadcrumb: &'a Breadcrumb) -> impl Drop + use<'a> {
    Trail { before: CURRENT.replace(std::ptr::from_ref(breadcrumb)) }
}

impl Drop for Trail {
    #[inline]
    fn drop(&mut self) {
        CURRENT.set(self.before);
    }
}

/// Installs the handler, once in a process; does nothing where there are no signals.
pub fn install_crash_messages() {
    #[cfg(unix)]
    unix::install();
}

#[cfg(unix)]
mod unix {
    use super::CURRENT;
    use libc::{SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, c_int, c_void, sigaction, siginfo_t};
    use std::cell::UnsafeCell;
    use std::mem::MaybeUninit;
    use std::sync::Once;

    const SIGNALS: [(c_int, &str); 5] = [
        (SIGSEGV, "SIGSEGV, invalid memory access"),
        (SIGBUS, "SIGBUS, invalid memory access"),
        (SIGFPE, "SIGFPE, arithmetic fault"),
        (SIGILL, "SIGILL, illegal instruction"),
        (SIGABRT, "SIGABRT, abort"),
    ];

    /// Who handled each signal before.
    struct Previous(UnsafeCell<[MaybeUninit<sigaction>; SIGNALS.len()]>);

    // SAFETY: written once before the handler that reads it is installed.
    unsafe impl Sync for Previous {}

    static PREVIOUS: Previous = Previous(UnsafeCell::new([const { MaybeUninit::zeroed() }; SIGNALS.len()]));

    pub(super) fn install() {
        static ONCE: Once = Once::new();
        ONCE.call_once(|| {
            for (index, (signal, _)) in SIGNALS.iter().enumerate() {
                // SAFETY: all-zero is a valid `sigaction`; the handler has the signature that SA_SIGINFO asks for. The previous
                // action is fetched into its place before the handler, which reads it, is installed.
                unsafe {
                    let mut action: sigaction = std::mem::zeroed();
                    action.sa_sigaction = handler as *const () as usize;
                    action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
                    libc::sigemptyset(&raw mut action.sa_mask);
                    libc::sigaction(*signal, std::ptr::null(), (*PREVIOUS.0.get())[index].as_mut_ptr());
                    libc::sigaction(*signal, &raw const action, std::ptr::null_mut());
                }
            }
        });
    }

    extern "C" fn handler(signal: c_int, _info: *mut siginfo_t, _context: *mut c_void) {
        let index = SIGNALS.iter().position(|(known, _)| *known == signal).unwrap_or(0);
        // SAFETY: the breadcrumb outlives the call that it marks.
        if let Some(breadcrumb) = unsafe { CURRENT.get().as_ref() } {
            for part in ["radsight: crash in ", &breadcrumb.text, ": ", SIGNALS[index].1, "\n"] {
                say(part.as_bytes());
            }
        }
        // SAFETY: written before the handler was installed. Both functions are async-signal-safe.
        unsafe {
            libc::sigaction(signal, (*PREVIOUS.0.get())[index].as_ptr(), std::ptr::null_mut());
            if signal == SIGABRT {
                libc::raise(signal);
            }
        }
        // For the others the faulting instruction runs again, under the previous action.
    }

    fn say(text: &[u8]) {
        // SAFETY: `write` is async-signal-safe; the slice is valid.
        let _ = unsafe { libc::write(libc::STDERR_FILENO, text.as_ptr().cast(), text.len()) };
    }
}
