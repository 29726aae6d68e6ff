//! Handlers of crash signals, which report the plugin.

use super::call::Slot;

/// Installs the handlers, once per process; does nothing on systems without signals.
pub(super) fn install() {
    #[cfg(unix)]
    unix::install();
}

/// From now on the signal ends the process after a message, whoever handled it before.
pub(super) fn die_after_messages() {
    #[cfg(unix)]
    unix::DIE.store(true, std::sync::atomic::Ordering::Release);
}

/// Reinstalls handlers that a plugin replaced; returns the names of their signals.
pub(super) fn reinstall() -> Vec<&'static str> {
    #[cfg(unix)]
    return unix::reinstall();
    #[cfg(not(unix))]
    Vec::new()
}

/// Gives the thread an alternate stack, so that handlers can run after a stack overflow.
pub(super) fn take_stack(slot: &Slot) {
    #[cfg(unix)]
    unix::take_stack(slot);
    #[cfg(not(unix))]
    let _ = slot;
}

/// Undoes [`take_stack`] at the end of the thread.
pub(super) fn give_back_stack() {
    #[cfg(unix)]
    unix::give_back_stack();
}

#[cfg(unix)]
mod unix {
    use super::super::call::{Slot, own_slot};
    use super::super::message::{
        code_at_end, end_now, is_first_to_speak, loaded, report, report_call, wait_for_the_end,
    };
    use libc::{SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS, SIGTRAP, c_int, c_void, sigaction, siginfo_t};
    use std::cell::{Cell, UnsafeCell};
    use std::mem::MaybeUninit;
    use std::sync::Once;
    use std::sync::atomic::{AtomicBool, Ordering};

    const SIGNALS: [(c_int, &str); 7] = [
        (SIGSEGV, "SIGSEGV, invalid memory access"),
        (SIGBUS, "SIGBUS, invalid memory access"),
        (SIGFPE, "SIGFPE, arithmetic fault"),
        (SIGILL, "SIGILL, illegal instruction"),
        (SIGABRT, "SIGABRT, abort"),
        (SIGTRAP, "SIGTRAP, trap"),
        (SIGSYS, "SIGSYS, forbidden system call"),
    ];
    const STACK_OVERFLOW: &str = "SIGSEGV, stack overflow";
    /// A fault this close to the end of the stack counts as an overflow, which accounts for guard
    /// pages and for frames that skip them.
    const NEAR_STACK_END: usize = 1 << 18;
    const HANDLER_STACK_BYTES: usize = 64 << 10;

    /// Previous handlers of the signals.
    struct Previous(UnsafeCell<[MaybeUninit<sigaction>; SIGNALS.len()]>);

    // SAFETY: written once before the handler that reads it is installed.
    unsafe impl Sync for Previous {}

    static PREVIOUS: Previous = Previous(UnsafeCell::new([const { MaybeUninit::zeroed() }; SIGNALS.len()]));
    pub(super) static DIE: AtomicBool = AtomicBool::new(false);
    static INSTALLED: AtomicBool = AtomicBool::new(false);

    fn own_action() -> sigaction {
        // SAFETY: all-zero is a valid `sigaction`; the handler has the signature that SA_SIGINFO
        // asks for.
        unsafe {
            let mut action: sigaction = std::mem::zeroed();
            action.sa_sigaction = handler as *const () as usize;
            action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
            libc::sigemptyset(&raw mut action.sa_mask);
            action
        }
    }

    pub(super) fn install() {
        static ONCE: Once = Once::new();
        ONCE.call_once(|| {
            let action = own_action();
            for (index, (signal, _)) in SIGNALS.iter().enumerate() {
                // SAFETY: the previous action is fetched into its place before the handler, which
                // reads it, is installed.
                unsafe {
                    libc::sigaction(*signal, std::ptr::null(), (*PREVIOUS.0.get())[index].as_mut_ptr());
                    libc::sigaction(*signal, &raw const action, std::ptr::null_mut());
                }
            }
            INSTALLED.store(true, Ordering::Release);
        });
    }

    pub(super) fn reinstall() -> Vec<&'static str> {
        if !INSTALLED.load(Ordering::Acquire) {
            return Vec::new();
        }
        let action = own_action();
        let mut replaced = Vec::new();
        for (signal, name) in SIGNALS {
            // SAFETY: both structures are valid; the own action takes the place of a foreign one.
            unsafe {
                let mut found: sigaction = std::mem::zeroed();
                libc::sigaction(signal, std::ptr::null(), &raw mut found);
                if found.sa_sigaction != action.sa_sigaction {
                    libc::sigaction(signal, &raw const action, std::ptr::null_mut());
                    replaced.push(name.split(',').next().unwrap_or(name));
                }
            }
        }
        replaced
    }

    extern "C" fn handler(signal: c_int, info: *mut siginfo_t, _context: *mut c_void) {
        let index = SIGNALS.iter().position(|(known, _)| *known == signal).unwrap_or(0);
        if is_first_to_speak() {
            speak(signal, SIGNALS[index].1, info);
        } else if SPEAKING_THREAD.get() {
            // The report itself crashed.
            end_now(code_at_end().unwrap_or(super::super::FAULT));
        } else if code_at_end().is_some() {
            wait_for_the_end();
        }
        if let Some(code) = code_at_end() {
            end_now(code);
        }
        // SAFETY: written before the handler was installed. All functions are async-signal-safe.
        unsafe {
            if DIE.load(Ordering::Acquire) {
                libc::signal(signal, libc::SIG_DFL);
            } else {
                libc::sigaction(signal, (*PREVIOUS.0.get())[index].as_ptr(), std::ptr::null_mut());
            }
            if signal == SIGABRT || is_sent(info) {
                libc::raise(signal);
            }
        }
        // Other faults recur at the same instruction, under the previous action.
    }

    thread_local! {
        static SPEAKING_THREAD: Cell<bool> = const { Cell::new(false) };
        static OWN_STACK: Cell<*mut c_void> = const { Cell::new(std::ptr::null_mut()) };
    }

    fn speak(signal: c_int, what: &str, info: *mut siginfo_t) {
        SPEAKING_THREAD.set(true);
        let slot = own_slot();
        if let Some((slot, text)) = slot.and_then(|slot| Some((slot, slot.text()?))) {
            let overflow = signal == SIGSEGV && is_stack_overflow(slot, info);
            report_call("crash", slot, text, &[if overflow { STACK_OVERFLOW } else { what }]);
        } else if let (Some(_), Some(names)) = (code_at_end(), loaded()) {
            report(&[
                "crash outside of the calls of plugins: ",
                what,
                "; loaded are ",
                names,
                ", and one that damages memory or has threads of its own does this: --isolate-plugins names it",
            ]);
        }
        SPEAKING_THREAD.set(false);
    }

    /// Whether a process sent the signal, so that no instruction will fault again.
    fn is_sent(info: *mut siginfo_t) -> bool {
        // SAFETY: the system gives a valid structure, or null where it has none.
        unsafe { info.as_ref() }.is_some_and(|info| info.si_code <= 0)
    }

    fn is_stack_overflow(slot: &Slot, info: *mut siginfo_t) -> bool {
        let end = slot.stack_end.load(Ordering::Relaxed);
        // SAFETY: the system fills in the address for SIGSEGV.
        let address = unsafe { info.as_ref().map_or(0, |info| info.si_addr().addr()) };
        end != 0 && address.abs_diff(end) < NEAR_STACK_END
    }

    pub(super) fn take_stack(slot: &Slot) {
        slot.stack_end.store(stack_end(), Ordering::Relaxed);
        // SAFETY: a fresh private mapping, which stays until `give_back_stack` of this thread.
        unsafe {
            let flags = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS;
            let access = libc::PROT_READ | libc::PROT_WRITE;
            let memory = libc::mmap(std::ptr::null_mut(), HANDLER_STACK_BYTES, access, flags, -1, 0);
            if memory == libc::MAP_FAILED {
                // The standard library's smaller stack remains.
                return;
            }
            let stack = libc::stack_t { ss_sp: memory, ss_flags: 0, ss_size: HANDLER_STACK_BYTES };
            if libc::sigaltstack(&raw const stack, std::ptr::null_mut()) == 0 {
                OWN_STACK.set(memory);
            } else {
                libc::munmap(memory, HANDLER_STACK_BYTES);
            }
        }
    }

    pub(super) fn give_back_stack() {
        let memory = OWN_STACK.replace(std::ptr::null_mut());
        if memory.is_null() {
            return;
        }
        // SAFETY: made by `take_stack` of this thread, and switched off before it goes.
        unsafe {
            let none =
                libc::stack_t { ss_sp: std::ptr::null_mut(), ss_flags: libc::SS_DISABLE, ss_size: HANDLER_STACK_BYTES };
            libc::sigaltstack(&raw const none, std::ptr::null_mut());
            libc::munmap(memory, HANDLER_STACK_BYTES);
        }
    }

    /// Lowest address of this thread's stack.
    #[cfg(target_os = "linux")]
    fn stack_end() -> usize {
        // SAFETY: the attributes are initialised by the first function and freed by the last.
        unsafe {
            let mut attributes: libc::pthread_attr_t = std::mem::zeroed();
            if libc::pthread_getattr_np(libc::pthread_self(), &raw mut attributes) != 0 {
                return 0;
            }
            let (mut low, mut size) = (std::ptr::null_mut(), 0);
            let found = libc::pthread_attr_getstack(&raw const attributes, &raw mut low, &raw mut size);
            libc::pthread_attr_destroy(&raw mut attributes);
            if found == 0 { low.addr() } else { 0 }
        }
    }

    #[cfg(not(target_os = "linux"))]
    fn stack_end() -> usize {
        0
    }
}
