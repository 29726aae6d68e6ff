//! Faults of evaluations.

use crate::builtin::Builtin;

/// Kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum FaultKind {
    /// A function has no value for its arguments, such as `acos(2)`.
    #[error("domain error")]
    Domain,
    /// A division by zero, or an infinite value of a function.
    #[error("range error")]
    Range,
    /// Calls are nested without end, or nearly so.
    #[error("functions call each other more than {} deep", crate::limits::DEEPEST_CALL)]
    TooDeep,
    /// The evaluation takes too many steps.
    #[error("evaluation takes more than {} steps", crate::limits::MOST_STEPS)]
    TooLong,
    /// The evaluation reached an unknown name, a missing argument, or a number called as a
    /// function.
    #[error("an undefined name or a missing argument was used")]
    Undefined,
    /// The value exceeds single precision; the evaluation continues with it.
    #[error("a value exceeds single precision")]
    Overflow,
}

impl FaultKind {
    /// Whether Radiance would end the whole program, instead of noting a computation error.
    #[must_use]
    pub fn is_fatal(self) -> bool {
        !matches!(self, FaultKind::Domain | FaultKind::Range | FaultKind::Overflow)
    }
}

/// A fault of an evaluation.
///
/// Radiance continues after a mathematical fault with 0 as the value of the function that failed.
/// Patterns and textures then do nothing ("compute error"); other uses take the value.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{kind}")]
pub struct Fault {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Value with which Radiance continues; 0 for a fatal fault.
    pub value: f64,
}

/// A mathematical fault, as Radiance reports it on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Warning {
    pub(crate) place: Place,
    pub(crate) kind: FaultKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Place {
    Division,
    Power,
    Builtin(Builtin),
    HostFunction(u16),
}

impl std::fmt::Display for Warning {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.place {
            Place::Division => write!(out, "division by zero"),
            Place::Power => write!(out, "illegal power"),
            Place::Builtin(builtin) => write!(out, "{}(): {}", builtin.name(), self.kind),
            Place::HostFunction(index) => write!(out, "host function {index}: {}", self.kind),
        }
    }
}
