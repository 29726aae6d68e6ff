//! Runs plugins in processes of their own, so that they cannot affect the program.
//!
//! Each library has one worker process, with a memory limit and a supervisor that leaves no process
//! behind. Calls of `create` and similar functions go through a socket as lines of JSON. Calls of
//! `eval_pdf` and `sample` go through shared memory: a thread of the program writes a batch of
//! directions into a channel and sleeps until the thread on the other side has written the answer.
//! The worker calls the plugin as the program would, so that results have the same bits.
//!
//! If a worker ends prematurely, the program ends with [`crate::guard::FAULT`] and a message. The
//! guard's watch detects calls that take too long ([`crate::guard::install`]). Linux only.

use crate::ChildCommand;
use glam::DVec3;

#[cfg(not(target_os = "linux"))]
mod absent;
#[cfg(target_os = "linux")]
mod channel;
#[cfg(target_os = "linux")]
mod child;
#[cfg(target_os = "linux")]
mod parent;
mod wire;

#[cfg(not(target_os = "linux"))]
pub(crate) use absent::Worker;
#[cfg(not(target_os = "linux"))]
pub use absent::child_main;
#[cfg(target_os = "linux")]
pub use child::child_main;
#[cfg(target_os = "linux")]
pub(crate) use parent::Worker;
pub(crate) use wire::{bit_list, bits};

/// Settings of isolation.
#[derive(Clone, Debug)]
pub struct Isolation {
    /// Command that calls [`child_main`].
    pub child: ChildCommand,
    /// Memory, in bytes, that a plugin may use beyond the initial memory of its process.
    pub memory: Option<u64>,
}

/// Interval at which the program checks the progress of a worker that has not answered.
#[cfg(target_os = "linux")]
const PROGRESS_INTERVAL: std::time::Duration = std::time::Duration::from_millis(100);

/// Arguments of `eval_pdf`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question<'a> {
    pub(crate) outgoing: DVec3,
    pub(crate) incident: [&'a [f64]; 3],
}
