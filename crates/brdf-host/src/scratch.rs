//! Scratch memory that plugins get for the duration of a call.

use radsight_brdf_abi::SCRATCH_ALIGNMENT;
use std::cell::RefCell;
use std::ffi::c_void;

#[derive(Clone, Copy)]
#[repr(align(64))]
struct Line(#[allow(dead_code, reason = "only its address is used")] [u8; 64]);

const _: () = assert!(align_of::<Line>() == SCRATCH_ALIGNMENT && size_of::<Line>() == SCRATCH_ALIGNMENT);

thread_local! {
    static SCRATCH: RefCell<Vec<Line>> = const { RefCell::new(Vec::new()) };
}

/// Calls `call` with at least `fixed + count · per_direction` bytes of scratch memory: a line on
/// the stack if that suffices, otherwise memory of the thread, which grows to the largest request
/// and stays.
#[inline]
pub(crate) fn with_scratch<R>(fixed: u64, per_direction: u64, count: usize, call: impl FnOnce(*mut c_void) -> R) -> R {
    let bytes = fixed + per_direction * count as u64;
    if bytes <= size_of::<Line>() as u64 {
        let mut line = Line([0; 64]);
        return call((&raw mut line).cast());
    }
    let lines = usize::try_from(bytes.div_ceil(size_of::<Line>() as u64)).unwrap_or(usize::MAX);
    SCRATCH.with_borrow_mut(|scratch| {
        if scratch.len() < lines {
            scratch.resize(lines, Line([0; 64]));
        }
        call(scratch.as_mut_ptr().cast())
    })
}
