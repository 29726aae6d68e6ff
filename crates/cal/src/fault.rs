//! What can go wrong while a program runs.

use crate::builtin::Builtin;

/// Why an evaluation did not go well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[non_exhaustive]
pub enum FaultKind {
    /// A function was asked for a value where it has none, `acos(2)` say.
    #[error("domain error")]
    Domain,
    /// A division by zero, or a function's value is infinite.
    #[error("range error")]
    Range,
    /// Functions call each other without end, or nearly so.
    #[error("functions call each other more than {} deep", crate::limits::DEEPEST_CALL)]
    TooDeep,
    /// The evaluation takes too long.
    #[error("evaluation takes more than {} steps", crate::limits::MOST_STEPS)]
    TooLong,
    /// Something was reached that cannot be evaluated: an unknown name, a missing argument, a number called as a function.
    #[error("an undefined name or argument was used")]
    Undefined,
    /// A value that single precision cannot hold; the evaluation goes on with it.
    #[error("a value goes beyond single precision")]
    Overflow,
}

impl FaultKind {
    /// Whether Radiance would stop the whole program, not only note an error in the computation.
    #[must_use]
    pub fn is_fatal(self) -> bool {
        !matches!(self, FaultKind::Domain | FaultKind::Range | FaultKind::Overflow)
    }
}

/// An evaluation that did not go well.
///
/// Radiance goes on after a mathematical fault, with 0 in place of the value of the function that failed; patterns and
/// textures then do nothing ("compute error"), other places use the value.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{kind}")]
pub struct Fault {
    /// What went wrong.
    pub kind: FaultKind,
    /// The value that Radiance goes on with; 0 for a fatal fault.
    pub value: f64,
}

/// A mathematical fault, as Radiance reports it on its error output.
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
