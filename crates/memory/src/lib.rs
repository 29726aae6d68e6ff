//! An allocator that calls a function of the program when memory is exhausted.
//!
//! Without it a program ends by SIGABRT, leaves hidden files behind and gives no useful exit code.
//! Otherwise [`ReportingAllocator`] is the system's allocator; it costs one comparison with null.
//!
//! Large allocations of known size, such as acceleration structures, get huge pages where the
//! system (Linux) leaves the choice to the program: incoherent rays would wait for a page-table
//! walk at every other step. Buffers that grow do not: they are mostly read in order, and the
//! system takes longer to find huge pages.
//!
//! Guarantees: the function runs once, in the thread that first found no memory; other threads wait
//! for the end of the process. If the function itself finds no memory, the process aborts. This
//! crate may not know limits, options or messages.
//!
//! ```
//! #[global_allocator]
//! static ALLOCATOR: radsight_memory::ReportingAllocator = radsight_memory::ReportingAllocator;
//!
//! radsight_memory::when_exhausted(|bytes| {
//!     eprintln!("{bytes} bytes more cannot be had");
//!     std::process::exit(3)
//! });
//! ```

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The program's function for exhausted memory. Its argument is the number of bytes requested.
pub type Exhausted = fn(usize) -> !;

static EXHAUSTED: OnceLock<Exhausted> = OnceLock::new();
/// Set by the first thread that finds no memory.
static IS_ENDING: AtomicBool = AtomicBool::new(false);

thread_local! {
    static ENDS_HERE: Cell<bool> = const { Cell::new(false) };
}

/// Smallest allocation that gets huge pages, bytes; a huge page has 2 MiB.
const LARGE: usize = 4 << 20;

/// Sets the function to call when memory is exhausted. Only the first call has an effect.
pub fn when_exhausted(act: Exhausted) {
    let _ = EXHAUSTED.set(act);
}

/// Prepares the memory of a program that will allocate much, in its main thread: small pieces come
/// from 28 MiB of huge pages, as much as most short commands use, and what is freed stays with the
/// program. To be called before there are other threads.
///
/// In the GNU C library a piece of more than 128 KiB is a mapping of its own at first, and the heap
/// shrinks where its last piece is freed. A short program would take the same pages from the
/// system again and again, one by one, and each takes as long as several rays. The memory is asked
/// for, not touched, so it takes no pages. With other libraries this does nothing.
pub fn prepare_program() {
    heap::prepare_program();
}

/// Prepares the memory of another thread that will allocate much, in that thread: its heap, which
/// in the GNU C library grows by single pages with a system call each, begins with a huge page.
pub fn prepare_thread() {
    heap::prepare_thread();
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod heap {
    use super::make_pages_huge;
    use std::alloc::{GlobalAlloc, Layout, System};

    /// A huge page where the system has them, bytes.
    const HUGE_PAGE: usize = 2 << 20;

    /// The heap of the main thread begins with so many bytes of huge pages.
    const MAIN_HEAP: usize = LARGEST_IN_HEAP - 2 * HUGE_PAGE;

    /// The largest piece that the library takes from a heap if it is told to, bytes.
    const LARGEST_IN_HEAP: usize = 32 << 20;

    /// Larger pieces are mappings of their own, bytes: lists that grow beyond are moved without a
    /// copy.
    const OWN_MAPPING: usize = 8 << 20;

    /// Free memory beyond this at the end of the heap goes back to the system, bytes.
    const KEPT: usize = 64 << 20;

    pub(super) fn prepare_program() {
        // Where memory is limited, none is set aside.
        let mut is_plenty = false;
        with_piece(4 * MAIN_HEAP, |_| is_plenty = true);
        if is_plenty {
            set(libc::M_TRIM_THRESHOLD, KEPT);
            set(libc::M_MMAP_THRESHOLD, LARGEST_IN_HEAP);
            begin_with_huge_pages(MAIN_HEAP);
            set(libc::M_MMAP_THRESHOLD, OWN_MAPPING);
        }
    }

    pub(super) fn prepare_thread() {
        begin_with_huge_pages(HUGE_PAGE);
    }

    /// Makes the heap of the thread grow and go on with huge pages.
    fn begin_with_huge_pages(bytes: usize) {
        let mut before = 0;
        with_piece(HUGE_PAGE + bytes, |memory| {
            // A huge page can only be where none of its small pages is in use.
            before = memory.addr().next_multiple_of(HUGE_PAGE) - memory.addr();
            make_pages_huge(memory.wrapping_add(before), bytes);
        });
        // What is before the huge pages stays unused.
        std::mem::forget(std::hint::black_box(Vec::<u8>::with_capacity(before)));
    }

    /// Takes a piece of memory for the time of a call, if there is as much.
    fn with_piece(bytes: usize, act: impl FnOnce(*mut u8)) {
        let Ok(layout) = Layout::array::<u8>(bytes) else { return };
        // SAFETY: the callers ask for more than nothing.
        let memory = std::hint::black_box(unsafe { System.alloc(layout) });
        if !memory.is_null() {
            act(memory);
            // SAFETY: the piece is the system's and has this layout.
            unsafe { System.dealloc(memory, layout) };
        }
    }

    /// Sets a parameter of the library, in bytes. It keeps its own value if it refuses.
    fn set(parameter: libc::c_int, bytes: usize) {
        let value = libc::c_int::try_from(bytes).unwrap_or(libc::c_int::MAX);
        // SAFETY: the library takes any value, with a lock.
        unsafe { libc::mallopt(parameter, value) };
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
mod heap {
    pub(super) fn prepare_program() {}

    pub(super) fn prepare_thread() {}
}

/// The system's allocator with huge pages for large allocations, which calls the function set by
/// [`when_exhausted`] instead of returning null.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReportingAllocator;

// SAFETY: all memory comes from the system's allocator and goes back to it, unchanged but for the
// size of its pages.
unsafe impl GlobalAlloc for ReportingAllocator {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller guarantees what the system's allocator requires.
        checked(in_huge_pages(unsafe { System.alloc(layout) }, layout.size()), layout.size())
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as for `alloc`.
        checked(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    #[inline]
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as for `alloc`.
        checked(unsafe { System.realloc(memory, layout, size) }, size)
    }

    #[inline]
    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as for `alloc`.
        unsafe { System.dealloc(memory, layout) }
    }
}

/// Asks for huge pages where a piece is large; gives the piece.
#[inline]
fn in_huge_pages(memory: *mut u8, bytes: usize) -> *mut u8 {
    if bytes >= LARGE && !memory.is_null() {
        ask_for_huge_pages(memory, bytes);
    }
    memory
}

#[cfg(target_os = "linux")]
#[cold]
fn ask_for_huge_pages(memory: *mut u8, bytes: usize) {
    // Whole pages, those of both ends among them: a part without the advice would be a mapping of
    // its own, and a piece in two mappings is copied where it grows instead of moved.
    let before = memory.addr() % rustix::param::page_size();
    make_pages_huge(memory.wrapping_sub(before), bytes + before);
}

#[cfg(not(target_os = "linux"))]
#[cold]
fn ask_for_huge_pages(_: *mut u8, _: usize) {}

/// Asks for huge pages from the start of a page on.
#[cfg(target_os = "linux")]
fn make_pages_huge(page: *mut u8, bytes: usize) {
    use rustix::mm::{Advice, madvise};
    // SAFETY: the advice changes neither what pages hold nor who may use them, so it may cover what
    // stands beside a piece in the pages of its ends. Systems without huge pages refuse it, which
    // does no harm.
    let _ = unsafe { madvise(page.cast(), bytes, Advice::LinuxHugepage) };
}

#[inline]
fn checked(memory: *mut u8, bytes: usize) -> *mut u8 {
    if memory.is_null() {
        exhausted(bytes);
    }
    memory
}

/// Returns only if no function is set, or in the thread that runs it.
#[cold]
fn exhausted(bytes: usize) {
    let Some(act) = EXHAUSTED.get() else { return };
    if ENDS_HERE.get() {
        return;
    }
    if !IS_ENDING.swap(true, Ordering::AcqRel) {
        ENDS_HERE.set(true);
        act(bytes);
    }
    loop {
        std::thread::sleep(Duration::from_secs(1));
    }
}
