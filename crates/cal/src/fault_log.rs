//! Counts of faults over all evaluations of a program.

use crate::fault::FaultKind;
use crate::limits::MOST_LONG_EVALUATIONS;
use crate::program::Host;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// Channel of the point's x in Radiance's numbering; y and z follow.
const POINT: u32 = 7;

/// Fault counter of a program, for all threads; clones of a program share it.
#[derive(Clone, Debug, Default)]
pub(crate) struct FaultLog(Arc<Counted>);

#[derive(Debug, Default)]
struct Counted {
    count: AtomicU64,
    too_long: AtomicU64,
    first: OnceLock<(FaultKind, [f64; 3])>,
}

/// Faults of a program's evaluations so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Faults {
    /// Number of evaluations with a fault.
    pub count: u64,
    /// Kind of one of the first faults.
    pub kind: FaultKind,
    /// Channels 7 to 9 of that evaluation: the point, if the host numbers its channels as Radiance
    /// does.
    pub point: [f64; 3],
}

impl FaultLog {
    #[cold]
    pub(crate) fn note<H: Host + ?Sized>(&self, kind: FaultKind, host: &H) {
        self.0.count.fetch_add(1, Ordering::Relaxed);
        self.0.too_long.fetch_add(u64::from(kind == FaultKind::TooLong), Ordering::Relaxed);
        self.0.first.get_or_init(|| (kind, [0, 1, 2].map(|axis| host.channel(POINT + axis))));
    }

    /// Whether so many evaluations took too long that no further one is tried.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.0.too_long.load(Ordering::Relaxed) >= MOST_LONG_EVALUATIONS
    }

    pub(crate) fn read(&self) -> Option<Faults> {
        let (kind, point) = *self.0.first.get()?;
        Some(Faults { count: self.0.count.load(Ordering::Relaxed), kind, point })
    }
}
