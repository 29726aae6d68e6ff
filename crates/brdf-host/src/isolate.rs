//! Plugins in processes of their own: what they do cannot reach the program.
//!
//! Each library has one worker process, with limits of memory and a supervisor that leaves nothing
//! of it behind. Calls of `create` and the like go through a socket as lines of JSON. Calls of
//! `eval_pdf` and `sample` go through shared memory: a thread of the program writes a batch of
//! directions into a channel and sleeps until the thread at the other end has written the answer.
//! The worker calls the plugin as the program would, so that results have the same bits.
//!
//! When a worker ends before its time, the program ends with [`crate::guard::FAULT`] and a message;
//! a call that takes too long is seen by the guard's watch ([`crate::guard::install`]). Linux only.

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

/// How libraries get processes of their own.
#[derive(Clone, Debug)]
pub struct Isolation {
    /// The program that calls [`child_main`].
    pub child: ChildCommand,
    /// Bytes of memory that a plugin may have beyond what its process starts with.
    pub memory: Option<u64>,
}

/// How often the program looks whether a worker that has not answered gets on.
#[cfg(target_os = "linux")]
const BETWEEN_LOOKS: std::time::Duration = std::time::Duration::from_millis(100);

/// What `eval_pdf` is asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question<'a> {
    pub(crate) outgoing: DVec3,
    pub(crate) incident: [&'a [f64]; 3],
}
