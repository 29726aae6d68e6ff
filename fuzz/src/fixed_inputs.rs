//! What makes a fuzzer's inputs depend on chance. It mutates what reached new code: where that
//! depends on the order of threads or on the keys of hash tables, so do all inputs that follow.
#![allow(unsafe_code)]

use std::ffi::{c_uint, c_void};
use std::sync::Once;

static ONE_THREAD: Once = Once::new();

/// Renders on the current thread only, where `RAYON_NUM_THREADS` is 1.
pub(crate) fn on_requested_threads() {
    ONE_THREAD.call_once(|| {
        if std::env::var_os("RAYON_NUM_THREADS").is_some_and(|number| number == "1") {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
            pool.build_global().expect("the first pool of the program");
        }
    });
}

/// The system's random numbers, of which the standard library makes the keys of its hash tables: the
/// same in each run.
///
/// # Safety
/// `buffer` must be valid for writes of `length` bytes.
#[cfg(target_os = "linux")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn getrandom(buffer: *mut c_void, length: usize, _flags: c_uint) -> isize {
    const BYTE: u8 = 0x5a;
    // SAFETY: the caller says that so many bytes can be written there.
    unsafe { buffer.cast::<u8>().write_bytes(BYTE, length) };
    length.try_into().expect("fewer bytes than half of the address space")
}
