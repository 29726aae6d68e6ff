//! Ways in which a plugin can end or duplicate the process without a crash: `exit`, `quick_exit`,
//! `_exit`, `fork`.

use super::call::{Breadcrumb, last_calls, own_slot};
use super::message::{end_now, is_first_to_speak, loaded, report, report_call, wait_for_the_end};

/// Installs the handlers. Call it once, before any plugin is loaded.
pub(super) fn install() {
    #[cfg(unix)]
    unix::install();
}

/// Makes the `exit` handler run before those that a library has installed since.
pub(super) fn come_first() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    unix::come_first();
}

/// Ends the program if this thread is in a plugin's call.
pub(super) fn end_if_in_call(what: &str) {
    let Some((slot, text)) = own_slot().and_then(|slot| Some((slot, slot.text()?))) else { return };
    if is_first_to_speak() {
        report_call("fault", slot, text, &[what]);
        end_now(super::FAULT);
    }
    wait_for_the_end()
}

/// Ends the program because standard input, output or error was replaced: by the call, if it is
/// known, or by one of the last calls.
pub(super) fn end_for_closed_files(call: Option<Breadcrumb>) -> ! {
    if is_first_to_speak() {
        let calls = match call {
            Some(call) => call.text().0.to_string(),
            None => last_calls().join(" or "),
        };
        let what = "it closed or replaced standard input, output or error";
        match calls.as_str() {
            "" => report(&["fault of a plugin: ", what, "; loaded are ", loaded().unwrap_or("none")]),
            calls => report(&["fault in ", calls, ": ", what]),
        }
        end_now(super::FAULT);
    }
    wait_for_the_end()
}

#[cfg(unix)]
mod unix {
    use super::super::call::{Breadcrumb, enter_for_good};
    use super::super::message::{end_now, is_first_to_speak, loaded, report, wait_for_the_end};
    use super::super::standard_output;
    use super::{end_for_closed_files, end_if_in_call};
    use std::ffi::c_int;
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    use std::ffi::c_void;
    use std::sync::atomic::{AtomicU32, Ordering};

    /// Id of the process in which the handlers were installed.
    static GUARDED: AtomicU32 = AtomicU32::new(0);

    pub(super) fn install() {
        GUARDED.store(std::process::id(), Ordering::Release);
        #[cfg(all(target_os = "linux", target_env = "gnu"))]
        come_first();
        // SAFETY: none has conditions on when it may be called, and the handlers stay.
        unsafe {
            #[cfg(not(all(target_os = "linux", target_env = "gnu")))]
            libc::atexit(at_exit);
            libc::pthread_atfork(Some(before_fork), None, None);
        }
    }

    /// Handlers run in reverse order of their installation.
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    pub(super) fn come_first() {
        if GUARDED.load(Ordering::Acquire) == 0 {
            return;
        }
        // SAFETY: as for `install`. The handlers may be there several times: the first ends the
        // process.
        unsafe {
            on_exit(at_exit_with_status, std::ptr::null_mut());
            at_quick_exit(at_quick_exit_in_call);
        }
    }

    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    unsafe extern "C" {
        fn on_exit(handler: extern "C" fn(c_int, *mut c_void), argument: *mut c_void) -> c_int;
        fn at_quick_exit(handler: extern "C" fn()) -> c_int;
    }

    /// Runs when anything calls `exit`. If the program itself does, all work is done, and no
    /// further plugin code may change the exit code.
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    extern "C" fn at_exit_with_status(status: c_int, _: *mut c_void) {
        at_exit();
        // SAFETY: writes what plugins printed; no conditions.
        unsafe { libc::fflush(std::ptr::null_mut()) };
        // Whatever else failed may have failed for this reason.
        if !standard_output::is_intact() {
            end_for_closed_files(None);
        }
        end_now(status)
    }

    /// Replaces the C library's function in the whole program, so that a call by a plugin is
    /// noticed. The dynamic linker resolves it before the C library's.
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    #[unsafe(no_mangle)]
    extern "C" fn _exit(status: c_int) -> ! {
        // A child between fork and exec may end by it.
        if GUARDED.load(Ordering::Acquire) == std::process::id() {
            end_if_in_call("it called _exit");
        }
        end_now(status)
    }

    /// The same function by its C name.
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    #[unsafe(no_mangle)]
    extern "C" fn _Exit(status: c_int) -> ! {
        _exit(status)
    }

    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    extern "C" fn at_quick_exit_in_call() {
        end_if_in_call("it called quick_exit");
    }

    extern "C" fn at_exit() {
        end_if_in_call("it called exit");
        if !is_main_thread() {
            if is_first_to_speak() {
                report(&["a thread of a plugin called exit; loaded are ", loaded().unwrap_or("none")]);
                end_now(super::super::FAULT);
            }
            wait_for_the_end();
        }
        // Plugin code that runs from here on is guarded too.
        if let Some(names) = loaded() {
            enter_for_good(Breadcrumb::keep(format!("one of the plugins {names}, at the end of the program")));
        }
    }

    unsafe extern "C" fn before_fork() {
        end_if_in_call("it called fork");
    }

    #[cfg(target_os = "linux")]
    fn is_main_thread() -> bool {
        rustix::thread::gettid() == rustix::process::getpid()
    }

    #[cfg(not(target_os = "linux"))]
    fn is_main_thread() -> bool {
        true
    }
}
