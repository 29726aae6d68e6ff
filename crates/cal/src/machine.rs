//! The exact machine: evaluates in Radiance's order, with Radiance's treatment of faults.
//!
//! Arguments and variables are evaluated at their first use, and once. A fault of a built-in
//! function is recorded and makes its value 0; so does a fault that one of its arguments left. The
//! next built-in function clears it. This rule (the behaviour of C's `errno` in calcomp) decides
//! the appearance of a scene whose pattern divides by zero, so it is implemented exactly.
//!
//! Nothing recurses in Rust: depth and steps are limited, and memory is kept in the [`Stacks`]
//! between evaluations.

use crate::builtin::{Builtin, WIDEST, truncated};
use crate::fault::{FaultKind, Place, Warning};
use crate::limits::{DEEPEST_CALL, MOST_WARNINGS};
use crate::program::Host;

/// An instruction. Operands are on a stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Op {
    Number(f64),
    Channel(u32),
    Parameter(u16),
    Variable(u32),
    Negate,
    Add,
    Subtract,
    Multiply,
    /// If the divisor on the stack is zero, records a fault, leaves 0, and jumps.
    DivideGuard(u32),
    /// Dividend over divisor; the divisor is below.
    Divide,
    /// Base to the exponent; the exponent is below.
    Power,
    Swap,
    Least,
    Greatest,
    /// Start of a built-in function: clears the fault.
    Clear,
    Library {
        builtin: Builtin,
        count: u16,
    },
    /// End of a built-in function that selected its arguments itself.
    LibraryEnd(Builtin),
    HostCall {
        function: u16,
        count: u16,
    },
    JumpUnlessPositive(u32),
    Jump(u32),
    /// Entries of [`Image::tables`]: the end, then one for each argument after the first.
    Select {
        count: u16,
        table: u32,
    },
    Call {
        routine: u32,
        first: u32,
        count: u16,
    },
    CallParameter {
        parameter: u16,
        first: u32,
        count: u16,
    },
    Return,
    Stop,
    Fail,
}

/// Code of a function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Routine {
    pub(crate) entry: u32,
    /// Number of arguments that it can use.
    pub(crate) uses: u16,
}

/// Target of a call through an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Callable {
    Function(u32),
    /// The caller's argument of this index.
    Parameter(u16),
    /// `select`, `min` or `max`, whose code depends on the number of arguments.
    Variadic(Builtin),
}

/// One argument of one call.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Argument {
    pub(crate) entry: u32,
    pub(crate) callable: Option<Callable>,
}

/// The first instruction of every image, for expressions that cannot be evaluated.
pub(crate) const FAIL_ENTRY: u32 = 0;

/// Linked code.
#[derive(Clone, Debug)]
pub(crate) struct Image {
    pub(crate) code: Vec<Op>,
    pub(crate) routines: Vec<Routine>,
    pub(crate) arguments: Vec<Argument>,
    /// Start of each variable's code.
    pub(crate) variables: Vec<u32>,
    pub(crate) tables: Vec<u32>,
    pub(crate) variadic: Vec<(Builtin, u16, u32)>,
    /// Channels that occur in the code.
    pub(crate) channels: Vec<u32>,
}

impl Image {
    pub(crate) fn new() -> Image {
        Image {
            code: vec![Op::Fail],
            routines: Vec::new(),
            arguments: Vec::new(),
            variables: Vec::new(),
            tables: Vec::new(),
            variadic: Vec::new(),
            channels: Vec::new(),
        }
    }

    /// Whether a function of the host may be called.
    pub(crate) fn calls_host(&self) -> bool {
        self.code.iter().any(|op| matches!(op, Op::HostCall { .. }))
    }

    pub(crate) fn sorted_channels(&self) -> Vec<u32> {
        let mut channels = self.channels.clone();
        channels.sort_unstable();
        channels
    }
}

/// Continuation when code returns.
#[derive(Clone, Copy, Debug)]
enum After {
    /// Store the value as an argument of an activation.
    KeepArgument {
        activation: u32,
        index: u16,
    },
    KeepVariable(u32),
    /// Remove the innermost activation.
    EndCall,
    /// The function is a root.
    Stop,
}

#[derive(Clone, Copy, Debug)]
struct Frame {
    resume: u32,
    activation: u32,
    after: After,
}

/// A function that is being evaluated.
#[derive(Clone, Copy, Debug)]
struct Activation {
    first: u32,
    count: u16,
    caller: u32,
    /// Position of its arguments' values.
    kept: u32,
}

/// Memory of the machine, reused between evaluations.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stacks {
    values: Vec<f64>,
    frames: Vec<Frame>,
    activations: Vec<Activation>,
    kept: Vec<Option<f64>>,
    variables: Vec<Option<f64>>,
    /// Last value of each variable, for those that depend on themselves.
    last: Vec<f64>,
    /// Mathematical faults of the last evaluation.
    pub(crate) warnings: Vec<Warning>,
}

/// Start of a root.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Entry {
    Expression(u32),
    Function(u32),
}

/// One evaluation, of one root or several.
pub(crate) struct Machine<'m, H: ?Sized> {
    image: &'m Image,
    real_arguments: &'m [f64],
    stacks: &'m mut Stacks,
    host: &'m H,
    steps: u64,
    /// Fault left by the last built-in function, power or division.
    pub(crate) fault: Option<FaultKind>,
}

type Fatal = FaultKind;

impl<'m, H: Host + ?Sized> Machine<'m, H> {
    /// Starts an evaluation without values of variables; `steps` limits the whole evaluation.
    pub(crate) fn new(
        image: &'m Image,
        real_arguments: &'m [f64],
        stacks: &'m mut Stacks,
        host: &'m H,
        steps: u64,
    ) -> Self {
        stacks.variables.clear();
        stacks.variables.resize(image.variables.len(), None);
        stacks.last.resize(image.variables.len(), 0.0);
        stacks.warnings.clear();
        Machine { image, real_arguments, stacks, host, steps, fault: None }
    }

    /// Remaining steps.
    pub(crate) fn steps_left(&self) -> u64 {
        self.steps
    }

    /// Evaluates a root.
    pub(crate) fn run(&mut self, entry: Entry, arguments: &[f64]) -> Result<f64, Fatal> {
        self.stacks.values.clear();
        self.stacks.frames.clear();
        self.stacks.activations.clear();
        self.stacks.kept.clear();
        self.stacks.kept.extend(arguments.iter().copied().map(Some));
        let count = u16::try_from(arguments.len()).unwrap_or(u16::MAX);
        self.stacks.activations.push(Activation { first: u32::MAX, count, caller: 0, kept: 0 });
        let start = match entry {
            Entry::Expression(start) => start,
            Entry::Function(routine) => {
                self.stacks.frames.push(Frame { resume: 0, activation: 0, after: After::Stop });
                self.image.routines[routine as usize].entry
            }
        };
        self.execute(start as usize)
    }

    fn execute(&mut self, start: usize) -> Result<f64, Fatal> {
        let image = self.image;
        let mut at = start;
        let mut current = 0_u32;
        loop {
            self.steps = self.steps.checked_sub(1).ok_or(FaultKind::TooLong)?;
            let op = *image.code.get(at).ok_or(FaultKind::Undefined)?;
            at += 1;
            match op {
                Op::Number(value) => self.push(value),
                Op::Channel(channel) => {
                    let value = self.host.channel(channel);
                    self.push(value);
                }
                Op::Negate => {
                    let value = self.pop();
                    self.push(-value);
                }
                // Radiance adds to zero, so a sum is never a negative zero.
                Op::Add => self.binary(|a, b| 0.0 + a + b),
                Op::Subtract => self.binary(|a, b| a - b),
                Op::Multiply => self.binary(|a, b| a * b),
                Op::Divide => self.binary(|divisor, dividend| dividend / divisor),
                Op::Least => self.binary(|least, x| if least > x { x } else { least }),
                Op::Greatest => self.binary(|greatest, x| if greatest < x { x } else { greatest }),
                Op::DivideGuard(end) => {
                    if self.stacks.values.last() == Some(&0.0) {
                        self.warn(Place::Division, FaultKind::Range);
                        at = end as usize;
                    }
                }
                Op::Power => self.power(),
                Op::Swap => {
                    let (above, below) = (self.pop(), self.pop());
                    self.push(above);
                    self.push(below);
                }
                Op::Clear => self.fault = None,
                Op::Library { builtin, count } => self.library(builtin, usize::from(count))?,
                Op::LibraryEnd(builtin) => {
                    let value = self.pop();
                    self.finish(value, Place::Builtin(builtin));
                }
                Op::HostCall { function, count } => self.host_call(function, usize::from(count)),
                Op::JumpUnlessPositive(target) => {
                    let positive = self.pop() > 0.0;
                    if !positive {
                        at = target as usize;
                    }
                }
                Op::Jump(target) => at = target as usize,
                Op::Select { count, table } => at = self.select(count, table)? as usize,
                Op::Parameter(index) => self.parameter(index, &mut at, &mut current)?,
                Op::Variable(variable) => match self.stacks.variables[variable as usize] {
                    Some(value) => self.push(value),
                    None => {
                        // A variable that depends on itself gets its value of the previous
                        // evaluation.
                        self.stacks.variables[variable as usize] = Some(self.stacks.last[variable as usize]);
                        self.enter(at, current, After::KeepVariable(variable))?;
                        at = image.variables[variable as usize] as usize;
                    }
                },
                Op::Call { routine, first, count } => {
                    self.call(routine, (first, count), &mut at, &mut current)?;
                }
                Op::CallParameter { parameter, first, count } => {
                    let routine = self.resolve(parameter, count, current)?;
                    self.call(routine, (first, count), &mut at, &mut current)?;
                }
                Op::Return => {
                    let frame = self.stacks.frames.pop().ok_or(FaultKind::Undefined)?;
                    let value = self.stacks.values.last().copied().unwrap_or(0.0);
                    match frame.after {
                        After::KeepArgument { activation, index } => {
                            let kept = self.stacks.activations[activation as usize].kept as usize;
                            self.stacks.kept[kept + usize::from(index)] = Some(value);
                        }
                        After::KeepVariable(variable) => {
                            self.stacks.variables[variable as usize] = Some(value);
                            self.stacks.last[variable as usize] = value;
                        }
                        After::EndCall => {
                            if let Some(ended) = self.stacks.activations.pop() {
                                self.stacks.kept.truncate(ended.kept as usize);
                            }
                        }
                        After::Stop => return Ok(self.pop()),
                    }
                    at = frame.resume as usize;
                    current = frame.activation;
                }
                Op::Stop => return Ok(self.pop()),
                Op::Fail => return Err(FaultKind::Undefined),
            }
        }
    }

    fn push(&mut self, value: f64) {
        self.stacks.values.push(value);
    }

    fn pop(&mut self) -> f64 {
        self.stacks.values.pop().unwrap_or(0.0)
    }

    fn binary(&mut self, apply: impl Fn(f64, f64) -> f64) {
        let (above, below) = (self.pop(), self.pop());
        self.push(apply(below, above));
    }

    /// Replaces the value on the stack by 0 and records the fault.
    fn warn(&mut self, place: Place, kind: FaultKind) {
        self.fault = Some(kind);
        if self.stacks.warnings.len() < MOST_WARNINGS {
            self.stacks.warnings.push(Warning { place, kind });
        }
        self.pop();
        self.push(0.0);
    }

    /// Ends a built-in function with a value.
    fn finish(&mut self, value: f64, place: Place) {
        self.push(value);
        let own = if value.is_nan() {
            Some(FaultKind::Domain)
        } else if value.is_infinite() {
            Some(FaultKind::Range)
        } else {
            None
        };
        if let Some(kind) = self.fault.or(own) {
            self.warn(place, kind);
        }
    }

    fn power(&mut self) {
        let (base, exponent) = (self.pop(), self.pop());
        self.finish(base.powf(exponent), Place::Power);
    }

    fn library(&mut self, builtin: Builtin, count: usize) -> Result<(), Fatal> {
        let mut arguments = [0.0; WIDEST];
        for index in (0..count).rev() {
            arguments[index] = self.pop();
        }
        let value = if builtin == Builtin::Arg {
            real_argument(self.real_arguments, arguments[0]).ok_or(FaultKind::Undefined)?
        } else {
            builtin.apply(&arguments[..count])
        };
        self.finish(value, Place::Builtin(builtin));
        Ok(())
    }

    fn host_call(&mut self, function: u16, count: usize) {
        let from = self.stacks.values.len().saturating_sub(count);
        let value = self.host.call(u32::from(function), &self.stacks.values[from..]);
        self.stacks.values.truncate(from);
        self.finish(value, Place::HostFunction(function));
    }

    /// Continuation of `select`.
    fn select(&mut self, count: u16, table: u32) -> Result<u32, Fatal> {
        let choice = self.pop();
        let end = self.image.tables[table as usize];
        let index = truncated(choice + 0.5);
        if choice < -0.5 || index >= i32::from(count) || index < 0 {
            self.fault = Some(FaultKind::Domain);
            self.push(0.0);
            return Ok(end);
        }
        if index == 0 {
            self.push(f64::from(count) - 1.0);
            return Ok(end);
        }
        Ok(self.image.tables[table as usize + index as usize])
    }

    fn enter(&mut self, resume: usize, activation: u32, after: After) -> Result<(), Fatal> {
        if self.stacks.frames.len() >= DEEPEST_CALL {
            return Err(FaultKind::TooDeep);
        }
        self.stacks.frames.push(Frame { resume: resume as u32, activation, after });
        Ok(())
    }

    fn parameter(&mut self, index: u16, at: &mut usize, current: &mut u32) -> Result<(), Fatal> {
        let activation = self.stacks.activations[*current as usize];
        if index >= activation.count {
            return Err(FaultKind::Undefined);
        }
        if let Some(value) = self.stacks.kept[activation.kept as usize + usize::from(index)] {
            self.push(value);
            return Ok(());
        }
        self.enter(*at, *current, After::KeepArgument { activation: *current, index })?;
        *current = activation.caller;
        *at = self.image.arguments[activation.first as usize + usize::from(index)].entry as usize;
        Ok(())
    }

    fn call(&mut self, routine: u32, given: (u32, u16), at: &mut usize, current: &mut u32) -> Result<(), Fatal> {
        let routine = self.image.routines[routine as usize];
        let (first, count) = given;
        self.enter(*at, *current, After::EndCall)?;
        // Unused arguments are never evaluated; missing ones are a fault when they are used.
        let count = count.min(routine.uses);
        let kept = self.stacks.kept.len();
        self.stacks.kept.resize(kept + usize::from(count), None);
        self.stacks.activations.push(Activation { first, count, caller: *current, kept: kept as u32 });
        *current = self.stacks.activations.len() as u32 - 1;
        *at = routine.entry as usize;
        Ok(())
    }

    /// The function that an argument refers to.
    fn resolve(&self, parameter: u16, count: u16, current: u32) -> Result<u32, Fatal> {
        let (mut index, mut activation) = (parameter, current);
        loop {
            let act = self.stacks.activations[activation as usize];
            if act.first == u32::MAX || index >= act.count {
                return Err(FaultKind::Undefined);
            }
            match self.image.arguments[act.first as usize + usize::from(index)].callable {
                Some(Callable::Function(routine)) => return Ok(routine),
                Some(Callable::Parameter(outer)) => (index, activation) = (outer, act.caller),
                Some(Callable::Variadic(builtin)) => {
                    let mut known = self.image.variadic.iter();
                    let found = known.find(|(name, arguments, _)| *name == builtin && *arguments == count);
                    return found.map(|(_, _, routine)| *routine).ok_or(FaultKind::Undefined);
                }
                None => return Err(FaultKind::Undefined),
            }
        }
    }
}

/// `arg(n)`.
pub(crate) fn real_argument(arguments: &[f64], index: f64) -> Option<f64> {
    match truncated(index + 0.5) {
        ..1 => Some(arguments.len() as f64),
        index => arguments.get(index as usize - 1).copied(),
    }
}
