//! The fast machine: straight-line code on registers, for evaluations without faults.
//!
//! If a fault is possible, it stops and the exact machine evaluates again.

use crate::builtin::Builtin;
use crate::graph::table_entry;
use crate::noise;
use crate::program::Host;

/// Index of a register.
pub(crate) type Register = u16;

/// Number of registers of most codes. Every thread has them; clearing and allocating as many as a
/// [`Register`] can name costs more than a short picture.
const FEW: usize = 1 << 8;

/// Number of registers that a [`Register`] can name.
const MANY: usize = 1 << 16;

/// An instruction; `d` is the destination register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Op {
    Constant {
        d: Register,
        value: f64,
    },
    Channel {
        d: Register,
        channel: u32,
    },
    Argument {
        d: Register,
        index: u16,
    },
    Move {
        d: Register,
        a: Register,
    },
    Negate {
        d: Register,
        a: Register,
    },
    Absolute {
        d: Register,
        a: Register,
    },
    Add {
        d: Register,
        a: Register,
        b: Register,
    },
    Subtract {
        d: Register,
        a: Register,
        b: Register,
    },
    Multiply {
        d: Register,
        a: Register,
        b: Register,
    },
    Divide {
        d: Register,
        a: Register,
        b: Register,
    },
    AddConstant {
        d: Register,
        a: Register,
        b: f64,
    },
    MultiplyConstant {
        d: Register,
        a: Register,
        b: f64,
    },
    /// Constant minus register.
    SubtractFrom {
        d: Register,
        a: Register,
        b: f64,
    },
    /// Constant over register.
    DivideInto {
        d: Register,
        a: Register,
        b: f64,
    },
    Least {
        d: Register,
        a: Register,
        b: Register,
    },
    Greatest {
        d: Register,
        a: Register,
        b: Register,
    },
    LeastConstant {
        d: Register,
        a: Register,
        b: f64,
    },
    GreatestConstant {
        d: Register,
        a: Register,
        b: f64,
    },
    ConstantOrLess {
        d: Register,
        a: Register,
        b: f64,
    },
    ConstantOrGreater {
        d: Register,
        a: Register,
        b: f64,
    },
    Power {
        d: Register,
        a: Register,
        b: Register,
    },
    PowerConstant {
        d: Register,
        a: Register,
        b: f64,
    },
    SquareRoot {
        d: Register,
        a: Register,
    },
    Floor {
        d: Register,
        a: Register,
    },
    Function {
        d: Register,
        a: Register,
        builtin: Builtin,
    },
    Function2 {
        d: Register,
        a: Register,
        b: Register,
        builtin: Builtin,
    },
    Noise {
        d: Register,
        a: Register,
        b: Register,
        c: Register,
        builtin: Builtin,
    },
    Table {
        d: Register,
        a: Register,
        table: u32,
    },
    /// Calls a host function with `count` registers of [`Code::lists`] from `first`.
    Host {
        d: Register,
        function: u16,
        first: u32,
        count: u16,
    },
    Check {
        a: Register,
    },
    JumpUnlessPositive {
        a: Register,
        target: u32,
    },
    JumpIfPositive {
        a: Register,
        target: u32,
    },
    JumpUnlessNegative {
        a: Register,
        target: u32,
    },
    JumpIfNegative {
        a: Register,
        target: u32,
    },
    JumpUnlessGreater {
        a: Register,
        b: Register,
        target: u32,
    },
    JumpIfGreater {
        a: Register,
        b: Register,
        target: u32,
    },
    JumpUnlessAbove {
        a: Register,
        target: u32,
        b: f64,
    },
    JumpIfAbove {
        a: Register,
        target: u32,
        b: f64,
    },
    JumpUnlessBelow {
        a: Register,
        target: u32,
        b: f64,
    },
    JumpIfBelow {
        a: Register,
        target: u32,
        b: f64,
    },
    Jump {
        target: u32,
    },
    /// Jumps by an entry of [`Code::chains`].
    Chain {
        a: Register,
        chain: u32,
    },
    /// Runs a shared value's code unless it has run.
    Share {
        shared: u16,
        target: u32,
    },
    Return {
        shared: u16,
    },
    GiveUp,
    End,
}

impl Op {
    /// Registers that the instruction refers to.
    pub(crate) fn registers(&mut self) -> [Option<&mut Register>; 4] {
        match self {
            Op::Constant { d, .. } | Op::Channel { d, .. } | Op::Argument { d, .. } | Op::Host { d, .. } => {
                [Some(d), None, None, None]
            }
            Op::Move { d, a } | Op::Negate { d, a } | Op::Absolute { d, a } => [Some(d), Some(a), None, None],
            Op::SquareRoot { d, a } | Op::Floor { d, a } => [Some(d), Some(a), None, None],
            Op::AddConstant { d, a, .. } | Op::MultiplyConstant { d, a, .. } => [Some(d), Some(a), None, None],
            Op::SubtractFrom { d, a, .. } | Op::DivideInto { d, a, .. } => [Some(d), Some(a), None, None],
            Op::LeastConstant { d, a, .. } | Op::GreatestConstant { d, a, .. } => [Some(d), Some(a), None, None],
            Op::ConstantOrLess { d, a, .. } | Op::ConstantOrGreater { d, a, .. } => [Some(d), Some(a), None, None],
            Op::PowerConstant { d, a, .. } | Op::Function { d, a, .. } | Op::Table { d, a, .. } => {
                [Some(d), Some(a), None, None]
            }
            Op::Add { d, a, b } | Op::Subtract { d, a, b } | Op::Multiply { d, a, b } | Op::Divide { d, a, b } => {
                [Some(d), Some(a), Some(b), None]
            }
            Op::Least { d, a, b } | Op::Greatest { d, a, b } => [Some(d), Some(a), Some(b), None],
            Op::Power { d, a, b } | Op::Function2 { d, a, b, .. } => [Some(d), Some(a), Some(b), None],
            Op::Noise { d, a, b, c, .. } => [Some(d), Some(a), Some(b), Some(c)],
            Op::Check { a } | Op::JumpUnlessPositive { a, .. } | Op::JumpIfPositive { a, .. } => {
                [Some(a), None, None, None]
            }
            Op::JumpUnlessNegative { a, .. } | Op::JumpIfNegative { a, .. } => [Some(a), None, None, None],
            Op::JumpUnlessAbove { a, .. } | Op::JumpIfAbove { a, .. } => [Some(a), None, None, None],
            Op::JumpUnlessBelow { a, .. } | Op::JumpIfBelow { a, .. } => [Some(a), None, None, None],
            Op::JumpUnlessGreater { a, b, .. } | Op::JumpIfGreater { a, b, .. } => [Some(a), Some(b), None, None],
            Op::Chain { a, .. } => [Some(a), None, None, None],
            Op::Jump { .. } | Op::Share { .. } | Op::Return { .. } | Op::GiveUp | Op::End => [None, None, None, None],
        }
    }

    /// Jump target of the instruction.
    pub(crate) fn target(&mut self) -> Option<&mut u32> {
        match self {
            Op::JumpUnlessPositive { target, .. }
            | Op::JumpIfPositive { target, .. }
            | Op::JumpUnlessNegative { target, .. }
            | Op::JumpIfNegative { target, .. }
            | Op::JumpUnlessGreater { target, .. }
            | Op::JumpIfGreater { target, .. }
            | Op::JumpUnlessAbove { target, .. }
            | Op::JumpIfAbove { target, .. }
            | Op::JumpUnlessBelow { target, .. }
            | Op::JumpIfBelow { target, .. }
            | Op::Jump { target }
            | Op::Share { target, .. } => Some(target),
            _ => None,
        }
    }
}

/// A chain of tests of one value against numbers; the first that holds decides.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    /// Whether the tests are "above" with descending numbers, or "below" with ascending ones.
    pub(crate) above: bool,
    pub(crate) limits: Box<[f64]>,
    /// Target if each test holds, and last the target if none does.
    pub(crate) targets: Box<[u32]>,
}

impl Chain {
    #[inline]
    fn target(&self, x: f64) -> u32 {
        // If a test holds, so do the following ones.
        let first = match (self.above, self.limits.len()) {
            (true, ..=COUNTED) => self.limits.iter().map(|&limit| usize::from(!is_above(x, limit))).sum(),
            (false, ..=COUNTED) => self.limits.iter().map(|&limit| usize::from(!is_above(limit, x))).sum(),
            (true, _) => self.limits.partition_point(|&limit| !is_above(x, limit)),
            (false, _) => self.limits.partition_point(|&limit| !is_above(limit, x)),
        };
        self.targets[first]
    }
}

/// Up to this number of tests they are counted without a branch; more are searched.
const COUNTED: usize = 32;

/// Code for one or more roots.
#[derive(Clone, Debug, Default)]
pub(crate) struct Code {
    pub(crate) ops: Vec<Op>,
    /// Registers of the roots' values.
    pub(crate) results: Vec<Register>,
    pub(crate) tables: Vec<Box<[f64]>>,
    pub(crate) lists: Vec<Register>,
    pub(crate) chains: Vec<Chain>,
    /// The late real arguments that the first registers hold.
    pub(crate) late: Vec<u16>,
    /// Number of shared values.
    pub(crate) shared: u16,
    /// Number of registers.
    pub(crate) registers: u32,
}

/// Memory of the machine.
#[derive(Clone, Debug)]
pub(crate) struct Registers {
    few: Box<[f64; FEW]>,
    /// Instead of these, for codes that need more.
    many: Option<Box<[f64; MANY]>>,
    calls: Calls,
}

/// What the machine remembers besides the registers.
#[derive(Clone, Debug, Default)]
struct Calls {
    /// Number of the evaluation that computed each shared value last.
    computed: Vec<u32>,
    evaluation: u32,
    returns: Vec<u32>,
    arguments: Vec<f64>,
}

impl Default for Registers {
    fn default() -> Self {
        Registers { few: zeros(), many: None, calls: Calls::default() }
    }
}

/// Built on the heap: the stack may be too small.
fn zeros<const COUNT: usize>() -> Box<[f64; COUNT]> {
    vec![0.0; COUNT].into_boxed_slice().try_into().expect("the list has as many registers as there are")
}

impl Registers {
    /// The value of a root after [`Code::run`].
    #[inline]
    pub(crate) fn result(&self, code: &Code, root: usize) -> f64 {
        let register = usize::from(code.results[root]);
        match &self.many {
            Some(many) if code.has_many_registers() => many[register],
            _ => self.few[register % FEW],
        }
    }
}

impl Calls {
    /// Forgets the shared values of the previous evaluation.
    #[inline]
    fn begin(&mut self, shared: u16) {
        if shared == 0 {
            return;
        }
        self.evaluation = self.evaluation.wrapping_add(1);
        if self.evaluation == 0 {
            self.computed.fill(0);
            self.evaluation = 1;
        }
        if self.computed.len() < usize::from(shared) {
            self.computed.resize(usize::from(shared), 0);
        }
        self.returns.clear();
    }
}

/// The fast machine stopped because a fault is possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct GaveUp;

macro_rules! checked {
    ($value:expr) => {{
        let value: f64 = $value;
        if !value.is_finite() {
            return Err(GaveUp);
        }
        value
    }};
}

impl Code {
    #[inline]
    fn has_many_registers(&self) -> bool {
        self.registers as usize > FEW
    }

    /// Runs the code; [`Registers::result`] then gives the values. `real` are the real arguments.
    #[inline]
    pub(crate) fn run<H: Host + ?Sized>(
        &self,
        memory: &mut Registers,
        host: &H,
        arguments: &[f64],
        real: &[f64],
    ) -> Result<(), GaveUp> {
        memory.calls.begin(self.shared);
        if self.has_many_registers() {
            let many = memory.many.get_or_insert_with(zeros);
            self.place_late(&mut many[..], real);
            self.run_on(many, &mut memory.calls, host, arguments)
        } else {
            self.place_late(&mut memory.few[..], real);
            self.run_on(&mut memory.few, &mut memory.calls, host, arguments)
        }
    }

    #[inline]
    fn place_late(&self, registers: &mut [f64], real: &[f64]) {
        for (register, &argument) in registers.iter_mut().zip(&self.late) {
            *register = real[usize::from(argument)];
        }
    }

    /// The remainder is no division, since `COUNT` is a power of two; no access needs a check.
    #[inline]
    fn run_on<const COUNT: usize, H: Host + ?Sized>(
        &self,
        file: &mut [f64; COUNT],
        memory: &mut Calls,
        host: &H,
        arguments: &[f64],
    ) -> Result<(), GaveUp> {
        const { assert!(COUNT.is_power_of_two()) };
        let mut at = 0_usize;
        macro_rules! r {
            ($register:expr) => {
                file[usize::from($register) % COUNT]
            };
        }
        macro_rules! jump_if {
            ($condition:expr, $target:expr) => {
                if $condition {
                    at = $target as usize;
                }
            };
        }
        loop {
            let Some(op) = self.ops.get(at) else { return Err(GaveUp) };
            at += 1;
            match *op {
                Op::Constant { d, value } => r!(d) = value,
                Op::Channel { d, channel } => r!(d) = checked!(host.channel(channel)),
                Op::Argument { d, index } => match arguments.get(usize::from(index)) {
                    Some(&value) => r!(d) = value,
                    None => return Err(GaveUp),
                },
                Op::Move { d, a } => r!(d) = r!(a),
                Op::Negate { d, a } => r!(d) = -r!(a),
                Op::Absolute { d, a } => r!(d) = if r!(a) > 0.0 { r!(a) } else { -r!(a) },
                Op::Add { d, a, b } => r!(d) = 0.0 + r!(a) + r!(b),
                Op::Subtract { d, a, b } => r!(d) = r!(a) - r!(b),
                Op::Multiply { d, a, b } => r!(d) = r!(a) * r!(b),
                Op::Divide { d, a, b } => {
                    let divisor = r!(b);
                    if divisor == 0.0 {
                        return Err(GaveUp);
                    }
                    r!(d) = r!(a) / divisor;
                }
                Op::AddConstant { d, a, b } => r!(d) = r!(a) + b,
                Op::MultiplyConstant { d, a, b } => r!(d) = r!(a) * b,
                Op::SubtractFrom { d, a, b } => r!(d) = b - r!(a),
                Op::DivideInto { d, a, b } => {
                    let divisor = r!(a);
                    if divisor == 0.0 {
                        return Err(GaveUp);
                    }
                    r!(d) = b / divisor;
                }
                Op::Least { d, a, b } => r!(d) = least(r!(a), r!(b)),
                Op::Greatest { d, a, b } => r!(d) = greatest(r!(a), r!(b)),
                Op::LeastConstant { d, a, b } => r!(d) = least(r!(a), b),
                Op::GreatestConstant { d, a, b } => r!(d) = greatest(r!(a), b),
                Op::ConstantOrLess { d, a, b } => r!(d) = least(b, r!(a)),
                Op::ConstantOrGreater { d, a, b } => r!(d) = greatest(b, r!(a)),
                Op::Power { d, a, b } => r!(d) = checked!(r!(a).powf(r!(b))),
                Op::PowerConstant { d, a, b } => r!(d) = checked!(r!(a).powf(b)),
                Op::SquareRoot { d, a } => r!(d) = checked!(r!(a).sqrt()),
                Op::Floor { d, a } => r!(d) = checked!(r!(a).floor()),
                Op::Function { d, a, builtin } => r!(d) = checked!(builtin.apply_to_one(r!(a))),
                Op::Function2 { d, a, b, builtin } => {
                    r!(d) = checked!(match builtin {
                        Builtin::Atan2 => r!(a).atan2(r!(b)),
                        _ => builtin.apply(&[r!(a), r!(b)]),
                    });
                }
                Op::Noise { d, a, b, c, builtin } => {
                    let point = [r!(a), r!(b), r!(c)];
                    r!(d) = checked!(match builtin {
                        Builtin::Noise => noise::value(point),
                        _ => builtin.apply(&point),
                    });
                }
                Op::Table { d, a, table } => match table_entry(&self.tables[table as usize], r!(a)) {
                    Some(value) => r!(d) = value,
                    None => return Err(GaveUp),
                },
                Op::Host { d, function, first, count } => {
                    let list = &self.lists[first as usize..first as usize + usize::from(count)];
                    memory.arguments.clear();
                    memory.arguments.extend(list.iter().map(|&register| r!(register)));
                    r!(d) = checked!(host.call(u32::from(function), &memory.arguments));
                }
                Op::Check { a } => {
                    checked!(r!(a));
                }
                Op::JumpUnlessPositive { a, target } => jump_if!(!is_above(r!(a), 0.0), target),
                Op::JumpIfPositive { a, target } => jump_if!(is_above(r!(a), 0.0), target),
                Op::JumpUnlessNegative { a, target } => jump_if!(!is_above(0.0, r!(a)), target),
                Op::JumpIfNegative { a, target } => jump_if!(is_above(0.0, r!(a)), target),
                Op::JumpUnlessGreater { a, b, target } => jump_if!(!is_above(r!(a), r!(b)), target),
                Op::JumpIfGreater { a, b, target } => jump_if!(is_above(r!(a), r!(b)), target),
                Op::JumpUnlessAbove { a, b, target } => jump_if!(!is_above(r!(a), b), target),
                Op::JumpIfAbove { a, b, target } => jump_if!(is_above(r!(a), b), target),
                Op::JumpUnlessBelow { a, b, target } => jump_if!(!is_above(b, r!(a)), target),
                Op::JumpIfBelow { a, b, target } => jump_if!(is_above(b, r!(a)), target),
                Op::Jump { target } => at = target as usize,
                Op::Chain { a, chain } => at = self.chains[chain as usize].target(r!(a)) as usize,
                Op::Share { shared, target } => {
                    if memory.computed[usize::from(shared)] != memory.evaluation {
                        memory.returns.push(at as u32);
                        at = target as usize;
                    }
                }
                Op::Return { shared } => {
                    memory.computed[usize::from(shared)] = memory.evaluation;
                    match memory.returns.pop() {
                        Some(caller) => at = caller as usize,
                        None => return Err(GaveUp),
                    }
                }
                Op::GiveUp => return Err(GaveUp),
                Op::End => return Ok(()),
            }
        }
    }
}

/// Greater than; false if either is not a number.
#[inline]
fn is_above(a: f64, b: f64) -> bool {
    a > b
}

#[inline]
fn least(so_far: f64, next: f64) -> f64 {
    if so_far > next { next } else { so_far }
}

#[inline]
fn greatest(so_far: f64, next: f64) -> f64 {
    if so_far < next { next } else { so_far }
}

const _: () = assert!(size_of::<Op>() == 16, "a step fits a quarter of a cache line");
