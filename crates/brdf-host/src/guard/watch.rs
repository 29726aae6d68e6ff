//! A thread that watches calls: those that do not return, and those that take too much memory.

use super::call::{CallSnapshot, Slot, all_slots};
use super::message::{end_now, is_first_to_speak, report_call, wait_for_the_end};
use super::{FAULT, Limits, endings, standard_output};
use std::time::{Duration, Instant};

/// Interval of the checks.
const TICK: Duration = Duration::from_millis(100);

/// Starts the thread.
pub(super) fn start(limits: &Limits) -> std::io::Result<()> {
    let limits = *limits;
    let tick = limits.time.map_or(TICK, |time| (time / 4).clamp(Duration::from_millis(5), TICK));
    let thread = std::thread::Builder::new().name("plugin watch".to_owned()).stack_size(256 << 10);
    let (ready, is_ready) = std::sync::mpsc::channel();
    thread.spawn(move || watch(&limits, tick, &ready))?;
    is_ready.recv().map_err(std::io::Error::other)
}

fn watch(limits: &Limits, tick: Duration, ready: &std::sync::mpsc::Sender<()>) {
    // A library whose initialiser does not return keeps the dynamic linker locked. Functions that
    // are resolved at their first use are therefore used before any library is loaded.
    std::thread::sleep(Duration::from_micros(1));
    memory_in_use();
    let mut calls = scan(&[], Duration::ZERO);
    super::take_back_handlers(None);
    let mut last = Instant::now();
    let _ = ready.send(());
    loop {
        std::thread::sleep(tick);
        // Time in which the process was stopped does not count.
        let passed = last.elapsed().min(2 * tick);
        last = Instant::now();
        calls = scan(&calls, passed);
        for call in &calls {
            if limits.time.is_some_and(|limit| call.age >= limit) {
                end(call.slot, call.snapshot, |slot| too_long(slot, call.age));
            }
            if limits.memory.is_some_and(|limit| call.growth() > limit) {
                end(call.slot, call.snapshot, |slot| too_much(slot, call.growth()));
            }
        }
        super::take_back_handlers(None);
        if !standard_output::is_intact() {
            endings::end_for_closed_files(None);
        }
    }
}

/// A call that was already running at the last check.
struct Watched {
    slot: &'static Slot,
    snapshot: CallSnapshot,
    age: Duration,
    /// Memory of the process at the first check of the call, and now, bytes.
    memory: [u64; 2],
}

impl Watched {
    fn growth(&self) -> u64 {
        self.memory[1].saturating_sub(self.memory[0])
    }
}

/// The running calls, with their age if they were running before.
fn scan(before: &[Watched], passed: Duration) -> Vec<Watched> {
    let mut memory = None;
    let snapshot = all_slots().into_iter().filter_map(|slot| Some((slot, slot.snapshot()?)));
    snapshot
        .map(|(slot, snapshot)| {
            let memory = *memory.get_or_insert_with(memory_in_use);
            let known = before.iter().find(|call| std::ptr::eq(call.slot, slot) && call.snapshot == snapshot);
            match known {
                Some(call) => Watched { slot, snapshot, age: call.age + passed, memory: [call.memory[0], memory] },
                None => Watched { slot, snapshot, age: Duration::ZERO, memory: [memory; 2] },
            }
        })
        .collect()
}

/// Ends the program because of a call, unless the call has returned in the meantime.
fn end(slot: &Slot, snapshot: CallSnapshot, say: impl FnOnce(&Slot)) {
    if slot.snapshot() != Some(snapshot) {
        return;
    }
    if is_first_to_speak() {
        say(slot);
        end_now(FAULT);
    }
    wait_for_the_end()
}

fn too_long(slot: &Slot, age: Duration) {
    if let Some(text) = slot.text() {
        let age = format!("{:.1}", age.as_secs_f64());
        report_call("fault", slot, text, &["it has not returned for ", &age, " s (--plugin-time-limit)"]);
    }
}

fn too_much(slot: &Slot, growth: u64) {
    if let Some(text) = slot.text() {
        let megabytes = (growth >> 20).to_string();
        report_call("fault", slot, text, &["it took ", &megabytes, " MB in one call (--plugin-memory-limit)"]);
    }
}

/// Memory of the process, bytes; 0 if unknown.
fn memory_in_use() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse::<u64>().ok()).map_or(0, |pages| pages * page_bytes())
}

#[cfg(unix)]
fn page_bytes() -> u64 {
    rustix::param::page_size() as u64
}

#[cfg(not(unix))]
fn page_bytes() -> u64 {
    4096
}

/// Memory of the machine, or of the container, bytes.
pub(super) fn machine_memory() -> Option<u64> {
    let number = |path: &str| std::fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let container =
        number("/sys/fs/cgroup/memory.max").or_else(|| number("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
    let machine = std::fs::read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
        Some(line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()? << 10)
    });
    machine.into_iter().chain(container).min()
}
