//! The current plugin call of each thread, readable by signal handlers and other threads.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Description of a call, made in advance: a signal handler cannot build text.
#[derive(Debug)]
pub(crate) struct Text(pub(crate) Box<str>);

/// Description of a plugin's function. Equal descriptions are stored once and never freed, so that
/// any thread may read them at any time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Breadcrumb(&'static Text);

impl Breadcrumb {
    pub(crate) fn for_library(library: &str, activity: &str) -> Self {
        Self::keep(format!("plugin \"{library}\", function {activity}"))
    }

    pub(crate) fn for_model(library: &str, model: &str, material: &str, place: &str, activity: &str) -> Self {
        let place = if place.is_empty() { String::new() } else { format!(" ({place})") };
        Self::keep(format!(
            "plugin \"{library}\", model \"{model}\", material \"{material}\"{place}, function {activity}"
        ))
    }

    pub(crate) fn keep(text: String) -> Self {
        static KEPT: Mutex<BTreeMap<String, &'static Text>> = Mutex::new(BTreeMap::new());
        // Names come from files; control characters must not reach the terminal.
        let text = super::one_line(&text);
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        let make = |text: &String| &*Box::leak(Box::new(Text(text.as_str().into())));
        Breadcrumb(kept.entry(text).or_insert_with_key(make))
    }

    pub(crate) fn text(self) -> &'static Text {
        self.0
    }
}

/// The call of one thread, in cache lines of its own.
#[derive(Debug)]
#[repr(align(128))]
pub(super) struct Slot {
    /// Null outside of calls.
    current: AtomicPtr<Text>,
    /// The call that began last; null before the first.
    last: AtomicPtr<Text>,
    /// Number of calls, which distinguishes two calls of the same function.
    calls: AtomicU64,
    /// Bits of the outgoing direction in the surface's frame; NaN if there is none.
    outgoing: [AtomicU64; 3],
    /// Lowest address of the thread's stack; 0 if unknown.
    pub(super) stack_end: AtomicUsize,
    taken: AtomicBool,
}

/// All slots. A slot is reused after its thread has ended.
static SLOTS: Mutex<Vec<&'static Slot>> = Mutex::new(Vec::new());

thread_local! {
    // Constant and without a destructor: a signal handler reads it by a plain memory access.
    static SLOT: Cell<Option<&'static Slot>> = const { Cell::new(None) };
    static AT_THREAD_END: GiveBack = const { GiveBack };
}

/// Returns the slot when the thread ends.
struct GiveBack;

impl Drop for GiveBack {
    fn drop(&mut self) {
        // Only a plugin ends a thread within its call: by `exit`, which begins with this
        // destructor, or by ending the thread.
        super::endings::end_if_in_call("it called exit, or ended its thread");
        if let Some(slot) = SLOT.take() {
            super::signals::give_back_stack();
            slot.taken.store(false, Ordering::Release);
        }
    }
}

/// The calls that began last in each thread, each once.
pub(super) fn last_calls() -> Vec<&'static str> {
    let mut texts: Vec<&str> = all_slots().into_iter().filter_map(Slot::last_text).map(|text| &*text.0).collect();
    texts.sort_unstable();
    texts.dedup();
    texts
}

/// A call as seen by another thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CallSnapshot {
    text: *const Text,
    calls: u64,
}

impl Slot {
    /// The current call.
    pub(super) fn snapshot(&self) -> Option<CallSnapshot> {
        let text = self.current.load(Ordering::Acquire).cast_const();
        (!text.is_null()).then(|| CallSnapshot { text, calls: self.calls.load(Ordering::Acquire) })
    }

    pub(super) fn text(&self) -> Option<&'static Text> {
        // SAFETY: only pointers to texts that are kept for ever are stored, and null.
        unsafe { self.current.load(Ordering::Acquire).as_ref() }
    }

    fn last_text(&self) -> Option<&'static Text> {
        // SAFETY: as for `text`.
        unsafe { self.last.load(Ordering::Acquire).as_ref() }
    }

    pub(super) fn outgoing(&self) -> Option<[f64; 3]> {
        let direction = [0, 1, 2].map(|axis| f64::from_bits(self.outgoing[axis].load(Ordering::Relaxed)));
        direction.iter().all(|number| number.is_finite()).then_some(direction)
    }
}

/// Slot of the current thread, if it ever called a plugin.
pub(super) fn own_slot() -> Option<&'static Slot> {
    SLOT.get()
}

/// The slots of all threads.
pub(super) fn all_slots() -> Vec<&'static Slot> {
    SLOTS.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Marks the call as finished when dropped.
pub(crate) struct Trail {
    slot: &'static Slot,
    before: *mut Text,
}

impl Drop for Trail {
    #[inline]
    fn drop(&mut self) {
        self.slot.current.store(self.before, Ordering::Release);
    }
}

/// Marks the thread as inside a plugin. The result is dropped in the same thread, like all local
/// values.
#[inline]
pub(crate) fn enter(breadcrumb: Breadcrumb) -> Trail {
    enter_at(breadcrumb, [f64::NAN; 3])
}

/// The same, with the outgoing direction in the surface's frame.
#[inline]
pub(crate) fn enter_at(breadcrumb: Breadcrumb, outgoing: [f64; 3]) -> Trail {
    let slot = SLOT.get().unwrap_or_else(take_slot);
    let before = slot.current.load(Ordering::Relaxed);
    for (place, number) in slot.outgoing.iter().zip(outgoing) {
        place.store(number.to_bits(), Ordering::Relaxed);
    }
    slot.calls.store(slot.calls.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
    let text = std::ptr::from_ref(breadcrumb.0).cast_mut();
    slot.last.store(text, Ordering::Relaxed);
    slot.current.store(text, Ordering::Release);
    Trail { slot, before }
}

/// Returns a function that gives the number of calls that this thread has begun.
#[cfg(target_os = "linux")]
pub(crate) fn count_calls() -> impl Fn() -> u64 + Send {
    let slot = SLOT.get().unwrap_or_else(take_slot);
    move || slot.calls.load(Ordering::Relaxed)
}

/// Marks the thread as inside a plugin until it ends.
pub(super) fn enter_for_good(breadcrumb: Breadcrumb) {
    std::mem::forget(enter(breadcrumb));
}

#[cold]
fn take_slot() -> &'static Slot {
    let mut slots = SLOTS.lock().unwrap_or_else(PoisonError::into_inner);
    let free = slots.iter().find(|slot| !slot.taken.swap(true, Ordering::Acquire)).copied();
    let slot = free.unwrap_or_else(|| {
        let slot = Box::leak(Box::new(Slot {
            current: AtomicPtr::new(null_mut()),
            last: AtomicPtr::new(null_mut()),
            calls: AtomicU64::new(0),
            outgoing: [const { AtomicU64::new(0) }; 3],
            stack_end: AtomicUsize::new(0),
            taken: AtomicBool::new(true),
        }));
        slots.push(slot);
        slot
    });
    drop(slots);
    SLOT.set(Some(slot));
    super::signals::take_stack(slot);
    // If the thread is already ending, the slot is lost, which is a few bytes.
    let _ = AT_THREAD_END.try_with(|_| ());
    slot
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_is_seen_from_outside_and_calls_within_calls_come_back() {
        let outer = Breadcrumb::for_library("outer", "load");
        let inner = Breadcrumb::for_model("outer", "m", "steel", "s.rad:1:1", "eval_pdf");
        let slot_text = || own_slot().and_then(Slot::text).map(|text| text.0.to_string());
        assert_eq!(slot_text(), None);
        {
            let _outer = enter(outer);
            let first = own_slot().unwrap().snapshot();
            {
                let _inner = enter_at(inner, [0.6, 0.0, 0.8]);
                let text = "plugin \"outer\", model \"m\", material \"steel\" (s.rad:1:1), function eval_pdf";
                assert_eq!(slot_text().as_deref(), Some(text));
                assert_eq!(own_slot().unwrap().outgoing(), Some([0.6, 0.0, 0.8]));
                assert_ne!(own_slot().unwrap().snapshot(), first);
            }
            assert_eq!(slot_text().as_deref(), Some("plugin \"outer\", function load"));
        }
        assert_eq!(slot_text(), None);
    }

    #[test]
    fn equal_words_are_kept_once_and_cannot_speak_to_the_terminal() {
        let [one, two] = [1, 2].map(|_| Breadcrumb::for_library("a\u{1b}[2J\nb", "load"));
        assert!(std::ptr::eq(one.text(), two.text()));
        assert_eq!(&*one.text().0, "plugin \"a\u{fffd}[2J\u{fffd}b\", function load");
    }

    #[test]
    fn a_thread_that_ended_gives_its_slot_back() {
        let crumb = Breadcrumb::for_library("slots", "load");
        let address = || {
            std::thread::spawn(move || {
                let _trail = enter(crumb);
                std::ptr::from_ref(own_slot().unwrap()).addr()
            })
        };
        let before = all_slots().len();
        let used: Vec<usize> = (0..20).map(|_| address().join().unwrap()).collect();
        assert!(all_slots().len() < before + 20, "{used:?}");
    }
}
