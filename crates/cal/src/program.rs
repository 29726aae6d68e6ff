//! Compiled expressions.

use crate::bindings::{Bindings, Known};
use crate::definitions::{Definitions, fold, read_expression};
use crate::emit::emit;
use crate::fast::{Code, Registers};
use crate::fault::{Fault, FaultKind, Warning};
use crate::fault_log::{FaultLog, Faults};
use crate::graph::Value;
use crate::limits::{MOST_FOLDING_STEPS, MOST_STEPS};
use crate::link::Linker;
use crate::lower::Lowering;
use crate::machine::{Entry, Image, Machine, Stacks};
use crate::names::{Scope, SymbolId};
use crate::syntax::{Body, Names, Node};
use radsight_diag::{Diagnostic, Span};
use std::sync::Arc;

/// What a program asks of its host while it runs.
pub trait Host {
    /// The value of a channel, from 1.
    fn channel(&self, channel: u32) -> f64;

    /// The value of a function of the host, by its index in [`Bindings::functions`]; a call may have more arguments than it needs. Must depend on nothing but the
    /// arguments and what the channels depend on.
    fn call(&self, function: u32, arguments: &[f64]) -> f64 {
        let _ = (function, arguments);
        0.0
    }
}

/// A host without channels.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoHost;

impl Host for NoHost {
    fn channel(&self, _channel: u32) -> f64 {
        0.0
    }
}

/// Channel values in a list; the first is `$1`. Channels past its end are 0.
impl Host for [f64] {
    fn channel(&self, channel: u32) -> f64 {
        (channel as usize).checked_sub(1).and_then(|index| self.get(index)).copied().unwrap_or(0.0)
    }
}

/// Something to compile.
#[derive(Clone, Copy, Debug)]
pub enum Root<'a> {
    /// An expression, as it stands in a primitive's string arguments.
    Expression {
        /// Its text.
        text: &'a str,
        /// Where the text stands; positions inside are counted from its start.
        span: Span,
    },
    /// A function, by its name; the host gives its arguments at each evaluation.
    Function {
        /// Its name.
        name: &'a str,
        /// How many arguments the host gives.
        arity: u16,
        /// Where the name stands.
        span: Span,
    },
}

/// Memory for evaluations, one for each thread. Any program can use it.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    stacks: Stacks,
    registers: Registers,
}

impl Scratch {
    /// Memory that grows as it is needed.
    #[must_use]
    pub fn new() -> Scratch {
        Scratch::default()
    }

    pub(crate) fn forget_warnings(&mut self) {
        self.stacks.warnings.clear();
    }

    pub(crate) fn copy_warnings(&mut self, other: &Scratch) {
        self.stacks.warnings.clone_from(&other.stacks.warnings);
    }

    /// The mathematical faults of the last evaluation that had any, in order; the first hundred of them.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.stacks.warnings
    }
}

/// Compiled roots, safe to share between threads.
///
/// Each root has exact code, and fast code if it has one: without recursion that only the ray ends. Fast code gives up at
/// anything that could be a fault, and the exact code runs instead.
#[derive(Clone, Debug)]
pub struct Program {
    image: Image,
    entries: Vec<Entry>,
    fast: Vec<Option<Code>>,
    fast_all: Option<Code>,
    constants: Vec<Option<f64>>,
    channels: Vec<u32>,
    faults: FaultLog,
}

impl Program {
    /// Compiles roots, whose names are looked up in `scope` first.
    ///
    /// # Errors
    /// Every unknown name, missing argument, illegal channel and mistake of syntax that an evaluation could meet.
    pub fn compile(
        definitions: &Definitions,
        scope: &Scope,
        roots: &[Root<'_>],
        bindings: &Bindings<'_>,
    ) -> Result<Program, Vec<Diagnostic>> {
        let mut known = Known::new(definitions);
        let roots = read_roots(&mut known, scope, roots)?;
        match Program::build(&known, &roots, bindings)? {
            (program, None) => Ok(program),
            (_, Some(circle)) => Err(vec![circle]),
        }
    }

    /// A program, and what is wrong with a variable of it that is defined by means of itself.
    pub(crate) fn build(
        known: &Known<'_>,
        roots: &[ReadRoot],
        bindings: &Bindings<'_>,
    ) -> Result<(Program, Option<Diagnostic>), Vec<Diagnostic>> {
        let mut linker = Linker::new(known, bindings);
        let mut lowering = Lowering::new(known, bindings);
        let mut entries = Vec::with_capacity(roots.len());
        let mut values = Vec::with_capacity(roots.len());
        for root in roots {
            match root {
                ReadRoot::Expression(body) => {
                    entries.push(Entry::Expression(linker.expression_root(body, body.root)));
                    values.push(lowering.expression(body).ok());
                }
                ReadRoot::Function { symbol, arity, span } => {
                    let routine = linker.function_root(*symbol, *arity, *span);
                    entries.push(Entry::Function(routine.unwrap_or(0)));
                    values.push(lowering.function(*symbol, *arity, *span).ok());
                }
            }
        }
        let (image, exact_problems) = linker.finish();
        // What the graph reaches is what an evaluation can reach; exact code also has what constants rule out.
        let all: Option<Vec<Value>> = values.iter().copied().collect();
        let problems = match all {
            Some(_) => std::mem::take(&mut lowering.problems),
            None => exact_problems,
        };
        if !problems.is_empty() {
            return Err(problems);
        }
        let channels = match &all {
            Some(all) => lowering.channels(all),
            None => image.sorted_channels(),
        };
        let graph = &lowering.graph;
        let program = Program {
            fast: values.iter().map(|value| value.and_then(|value| emit(graph, &[value]))).collect(),
            fast_all: all.filter(|all| all.len() > 1).and_then(|all| emit(graph, &all)),
            constants: values.iter().map(|value| value.and_then(|value| graph.as_constant(value))).collect(),
            channels,
            image,
            entries,
            faults: FaultLog::default(),
        };
        Ok((program, lowering.circular()))
    }

    /// How many roots there are.
    #[must_use]
    pub fn roots(&self) -> usize {
        self.entries.len()
    }

    /// The channels that an evaluation may read, in increasing order.
    #[must_use]
    pub fn channels_used(&self) -> &[u32] {
        &self.channels
    }

    /// The value of a root that is the same for every ray.
    ///
    /// # Panics
    /// If there is no such root.
    #[must_use]
    pub fn constant(&self, root: usize) -> Option<f64> {
        self.constants[root]
    }

    /// Whether every root is the same for every ray.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.constants.iter().all(Option::is_some)
    }

    /// Evaluates one root. `arguments` are those of a [`Root::Function`].
    ///
    /// # Errors
    /// A [`Fault`], which holds the value that Radiance would go on with.
    ///
    /// # Panics
    /// If there is no such root.
    #[inline]
    pub fn eval<H: Host + ?Sized>(
        &self,
        root: usize,
        arguments: &[f64],
        host: &H,
        scratch: &mut Scratch,
    ) -> Result<f64, Fault> {
        if let Some(code) = &self.fast[root]
            && code.run(&mut scratch.registers, host, arguments).is_ok()
        {
            let value = scratch.registers.file[usize::from(code.results[0])];
            if is_beyond(value) {
                self.faults.note(FaultKind::Overflow, host);
            }
            return Ok(value);
        }
        self.eval_exactly(root, arguments, host, scratch)
    }

    /// Evaluates all roots into `values`, as many as there are roots; what they share is computed once.
    ///
    /// # Errors
    /// The fault that stands at the end, when Radiance's colour and texture functions look: the library functions of a later
    /// root forget a fault of an earlier one. `values` holds what Radiance would go on with.
    ///
    /// # Panics
    /// If `values` is shorter than the roots are many.
    pub fn eval_all<H: Host + ?Sized>(
        &self,
        arguments: &[f64],
        host: &H,
        scratch: &mut Scratch,
        values: &mut [f64],
    ) -> Result<(), Fault> {
        let code = if self.entries.len() == 1 { self.fast[0].as_ref() } else { self.fast_all.as_ref() };
        if let Some(code) = code
            && code.run(&mut scratch.registers, host, arguments).is_ok()
        {
            for (value, result) in values.iter_mut().zip(&code.results) {
                *value = scratch.registers.file[usize::from(*result)];
                if is_beyond(*value) {
                    self.faults.note(FaultKind::Overflow, host);
                }
            }
            return Ok(());
        }
        self.eval_all_exactly(arguments, host, scratch, values)
    }

    #[cold]
    pub(crate) fn eval_all_exactly<H: Host + ?Sized>(
        &self,
        arguments: &[f64],
        host: &H,
        scratch: &mut Scratch,
        values: &mut [f64],
    ) -> Result<(), Fault> {
        let mut machine = Machine::new(&self.image, &mut scratch.stacks, host, MOST_STEPS);
        let mut last = 0.0;
        for (entry, value) in self.entries.iter().zip(values) {
            *value = 0.0;
            last = machine.run(*entry, arguments).map_err(|kind| self.fault(kind, 0.0, host))?;
            *value = last;
            if is_beyond(last) {
                self.faults.note(FaultKind::Overflow, host);
            }
        }
        machine.fault.map_or(Ok(()), |kind| Err(self.fault(kind, last, host)))
    }

    #[cfg(test)]
    pub(crate) fn goes_fast<H: Host + ?Sized>(&self, root: usize, host: &H, scratch: &mut Scratch) -> bool {
        self.fast[root].as_ref().is_some_and(|code| code.run(&mut scratch.registers, host, &[]).is_ok())
    }

    #[cold]
    pub(crate) fn eval_exactly<H: Host + ?Sized>(
        &self,
        root: usize,
        arguments: &[f64],
        host: &H,
        scratch: &mut Scratch,
    ) -> Result<f64, Fault> {
        let mut machine = Machine::new(&self.image, &mut scratch.stacks, host, MOST_STEPS);
        match (machine.run(self.entries[root], arguments), machine.fault) {
            (Ok(value), None) => {
                if is_beyond(value) {
                    self.faults.note(FaultKind::Overflow, host);
                }
                Ok(value)
            }
            (Ok(value), Some(kind)) => Err(self.fault(kind, value, host)),
            (Err(kind), _) => Err(self.fault(kind, 0.0, host)),
        }
    }

    fn fault<H: Host + ?Sized>(&self, kind: FaultKind, value: f64, host: &H) -> Fault {
        self.faults.note(kind, host);
        Fault { kind, value }
    }

    /// What went wrong in the evaluations so far, of this program and its clones in all threads;
    /// `None` where nothing did.
    #[must_use]
    pub fn faults(&self) -> Option<Faults> {
        self.faults.read()
    }
}

/// Whether single precision cannot hold a value; so it is with what is no number.
#[inline]
fn is_beyond(value: f64) -> bool {
    value.is_nan() || value.abs() > f64::from(f32::MAX)
}

/// A root after reading.
pub(crate) enum ReadRoot {
    Expression(Arc<Body>),
    Function { symbol: SymbolId, arity: u16, span: Option<Span> },
}

fn read_roots(known: &mut Known<'_>, scope: &Scope, roots: &[Root<'_>]) -> Result<Vec<ReadRoot>, Vec<Diagnostic>> {
    let mut read = Vec::with_capacity(roots.len());
    let mut mistakes = Vec::new();
    let mut names = Looking { known, scope, steps: MOST_FOLDING_STEPS };
    for root in roots {
        match *root {
            Root::Expression { text, span } => {
                match read_expression(&mut names, text.as_bytes(), span.source, span.start) {
                    Ok(body) => read.push(ReadRoot::Expression(Arc::new(body))),
                    Err(mistake) => mistakes.push(mistake),
                }
            }
            Root::Function { name, arity, span } => {
                let symbol = names.find(name);
                read.push(ReadRoot::Function { symbol, arity, span: Some(span) });
            }
        }
    }
    if mistakes.is_empty() { Ok(read) } else { Err(mistakes) }
}

/// The meaning of names in a root.
struct Looking<'k, 'd> {
    known: &'k mut Known<'d>,
    scope: &'k Scope,
    steps: u64,
}

impl Looking<'_, '_> {
    fn find(&mut self, name: &str) -> SymbolId {
        match self.known.definitions.symbols.find(name, self.scope) {
            Some(symbol) => symbol,
            None => self.known.stranger(name),
        }
    }
}

impl Names for Looking<'_, '_> {
    fn resolve(&mut self, name: &str) -> Result<SymbolId, Diagnostic> {
        Ok(self.find(name))
    }

    fn fold(&mut self, body: &Body, node: Node) -> Result<Option<f64>, Diagnostic> {
        fold(self.known, body, node, &mut self.steps)
    }
}
