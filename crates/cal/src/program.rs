//! Compiled expressions.

use crate::bindings::{Bindings, Known};
use crate::definitions::{Definitions, fold, read_expression};
use crate::emit::emit;
use crate::fast::{Code, Registers};
use crate::fault::{Fault, FaultKind, Warning};
use crate::fault_log::{FaultLog, Faults};
use crate::graph::{Graph, Value};
use crate::limits::{MOST_FOLDING_STEPS, MOST_STEPS};
use crate::link::Linker;
use crate::lower::Lowering;
use crate::machine::{Entry, Image, Machine, Stacks};
use crate::names::{Scope, SymbolId};
use crate::syntax::{Body, Names, Node};
use radsight_diag::{Diagnostic, Span};
use std::sync::Arc;

/// Host of a running program.
pub trait Host {
    /// Value of a channel, numbered from 1.
    fn channel(&self, channel: u32) -> f64;

    /// Value of a host function, by its index in [`Bindings::functions`]; a call may have more
    /// arguments than needed. It must depend only on the arguments and on what the channels depend
    /// on.
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

/// Channel values in a slice; the first is `$1`. Channels past its end are 0.
impl Host for [f64] {
    fn channel(&self, channel: u32) -> f64 {
        (channel as usize).checked_sub(1).and_then(|index| self.get(index)).copied().unwrap_or(0.0)
    }
}

/// A root to compile.
#[derive(Clone, Copy, Debug)]
pub enum Root<'a> {
    /// An expression, as in a primitive's string arguments.
    Expression {
        /// Its text.
        text: &'a str,
        /// Position of the text; positions inside are relative to its start.
        span: Span,
    },
    /// A function by name; the host gives its arguments at each evaluation.
    Function {
        /// Its name.
        name: &'a str,
        /// Number of arguments.
        arity: u16,
        /// Position of the name.
        span: Span,
    },
}

/// Memory for evaluations, one per thread. Any program can use it.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    stacks: Stacks,
    registers: Registers,
}

impl Scratch {
    /// Memory that grows as needed.
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

    /// Mathematical faults of the last evaluation that had any, in order; at most the first
    /// hundred.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.stacks.warnings
    }
}

/// Compiled roots, which threads can share.
///
/// Each root has exact code, and mostly fast code: of recursion that depends on the ray, the first
/// levels. Fast code stops at any possible fault and deeper calls, and the exact code runs instead.
#[derive(Clone, Debug)]
pub struct Program {
    compiled: Arc<Compiled>,
    real_arguments: Box<[f64]>,
    faults: FaultLog,
}

/// The part of a program that all programs of a [`Family`](crate::Family) may share.
#[derive(Debug)]
pub(crate) struct Compiled {
    image: Image,
    entries: Vec<Entry>,
    fast: Vec<Option<Code>>,
    fast_all: Option<Code>,
    constants: Vec<Option<f64>>,
    channels: Vec<u32>,
}

impl Program {
    /// Compiles roots, whose names are looked up in `scope` first.
    ///
    /// # Errors
    /// Every unknown name, missing argument, illegal channel and syntax error that an evaluation
    /// could reach.
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

    /// A program, and the error of a variable that depends on itself.
    pub(crate) fn build(
        known: &Known<'_>,
        roots: &[ReadRoot],
        bindings: &Bindings<'_>,
    ) -> Result<(Program, Option<Diagnostic>), Vec<Diagnostic>> {
        let (image, entries, exact_problems) = link(known, roots, bindings);
        let mut lowering = Lowering::new(known, bindings);
        let values: Vec<Option<Value>> = roots.iter().map(|root| lowering.root(root).ok()).collect();
        // The graph contains what an evaluation can reach; exact code also contains what constants
        // exclude.
        let all: Option<Vec<Value>> = values.iter().copied().collect();
        let problems = match all {
            Some(_) => std::mem::take(&mut lowering.problems),
            None => exact_problems,
        };
        if !problems.is_empty() {
            return Err(problems);
        }
        let compiled = match all {
            Some(all) => Compiled::of_graph((image, entries), &lowering, &all),
            None => {
                let constant = |value: &Option<Value>| value.and_then(|value| lowering.graph.as_constant(value));
                let constants = values.iter().map(constant).collect();
                let mut unrolled = Lowering::unrolled(known, bindings);
                let values: Vec<Option<Value>> = roots.iter().map(|root| unrolled.root(root).ok()).collect();
                let (fast, fast_all) = fast_code(&unrolled.graph, &values);
                Compiled { channels: image.sorted_channels(), image, entries, fast, fast_all, constants }
            }
        };
        Ok((Program::new(Arc::new(compiled), bindings.real_arguments), lowering.circular()))
    }

    /// The value of an expression that reading alone decides: a number, a constant, or a function of
    /// constants. Variables are not, even if they always have the same value.
    #[must_use]
    pub fn constant_expression(definitions: &Definitions, scope: &Scope, text: &str, span: Span) -> Option<f64> {
        let root = Root::Expression { text, span };
        match read_roots(&mut Known::new(definitions), scope, &[root]).ok()?.as_slice() {
            [ReadRoot::Expression(body)] => body.as_number(),
            _ => None,
        }
    }

    pub(crate) fn new(compiled: Arc<Compiled>, real_arguments: &[f64]) -> Program {
        Program { compiled, real_arguments: real_arguments.into(), faults: FaultLog::default() }
    }

    /// Number of roots.
    #[must_use]
    pub fn roots(&self) -> usize {
        self.compiled.entries.len()
    }

    /// Channels that an evaluation may read, in ascending order.
    #[must_use]
    pub fn channels_used(&self) -> &[u32] {
        &self.compiled.channels
    }

    /// Value of a root that is the same for every ray.
    ///
    /// # Panics
    /// If there is no such root.
    #[must_use]
    pub fn constant(&self, root: usize) -> Option<f64> {
        self.compiled.constants[root]
    }

    /// Whether every root is the same for every ray.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.compiled.constants.iter().all(Option::is_some)
    }

    /// Evaluates one root. `arguments` are those of a [`Root::Function`].
    ///
    /// # Errors
    /// A [`Fault`], with the value with which Radiance would continue.
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
        if let Some(code) = &self.compiled.fast[root]
            && code.run(&mut scratch.registers, host, arguments, &self.real_arguments).is_ok()
        {
            let value = scratch.registers.result(code, 0);
            if is_beyond(value) {
                self.faults.note(FaultKind::Overflow, host);
            }
            return Ok(value);
        }
        self.eval_exactly(root, arguments, host, scratch)
    }

    /// Evaluates all roots into `values`, one per root; common subexpressions are computed once.
    ///
    /// # Errors
    /// The fault that remains at the end, where Radiance's colour and texture functions test for
    /// one: built-in functions of a later root clear the fault of an earlier one. `values` holds
    /// the values with which Radiance would continue.
    ///
    /// # Panics
    /// If `values` is shorter than the number of roots.
    pub fn eval_all<H: Host + ?Sized>(
        &self,
        arguments: &[f64],
        host: &H,
        scratch: &mut Scratch,
        values: &mut [f64],
    ) -> Result<(), Fault> {
        let compiled = &self.compiled;
        let code = if compiled.entries.len() == 1 { compiled.fast[0].as_ref() } else { compiled.fast_all.as_ref() };
        if let Some(code) = code
            && code.run(&mut scratch.registers, host, arguments, &self.real_arguments).is_ok()
        {
            for (root, value) in values.iter_mut().enumerate().take(code.results.len()) {
                *value = scratch.registers.result(code, root);
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
        let mut machine = self.machine(host, scratch)?;
        let mut last = 0.0;
        for (entry, value) in self.compiled.entries.iter().zip(values) {
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
    pub(crate) fn compiled_code(&self) -> &Arc<Compiled> {
        &self.compiled
    }

    #[cfg(test)]
    pub(crate) fn goes_fast<H: Host + ?Sized>(&self, root: usize, host: &H, scratch: &mut Scratch) -> bool {
        self.compiled.fast[root]
            .as_ref()
            .is_some_and(|code| code.run(&mut scratch.registers, host, &[], &self.real_arguments).is_ok())
    }

    #[cold]
    pub(crate) fn eval_exactly<H: Host + ?Sized>(
        &self,
        root: usize,
        arguments: &[f64],
        host: &H,
        scratch: &mut Scratch,
    ) -> Result<f64, Fault> {
        let mut machine = self.machine(host, scratch)?;
        match (machine.run(self.compiled.entries[root], arguments), machine.fault) {
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

    /// Starts an evaluation, unless too many took too long.
    fn machine<'m, H: Host + ?Sized>(&'m self, host: &'m H, scratch: &'m mut Scratch) -> Result<Machine<'m, H>, Fault> {
        if self.is_exhausted() {
            return Err(self.fault(FaultKind::TooLong, 0.0, host));
        }
        Ok(Machine::new(&self.compiled.image, &self.real_arguments, &mut scratch.stacks, host, MOST_STEPS))
    }

    fn fault<H: Host + ?Sized>(&self, kind: FaultKind, value: f64, host: &H) -> Fault {
        self.faults.note(kind, host);
        Fault { kind, value }
    }

    /// Faults of the evaluations so far, of this program and its clones in all threads; `None` if
    /// there were none.
    #[must_use]
    pub fn faults(&self) -> Option<Faults> {
        self.faults.read()
    }

    /// Whether [`MOST_LONG_EVALUATIONS`](crate::limits::MOST_LONG_EVALUATIONS) evaluations of this
    /// program and its clones took too many steps. All further ones fail at once.
    #[must_use]
    pub fn is_exhausted(&self) -> bool {
        self.faults.is_exhausted()
    }
}

impl Compiled {
    /// Code for all values of the real arguments that are `late`; otherwise the arguments that the
    /// code depends on. `None` if there is no such code.
    pub(crate) fn of_family(
        known: &Known<'_>,
        roots: &[ReadRoot],
        bindings: &Bindings<'_>,
        late: &[bool],
    ) -> Option<Result<Compiled, Vec<u16>>> {
        let mut lowering = Lowering::of_family(known, bindings, late);
        let values: Option<Vec<Value>> = roots.iter().map(|root| lowering.root(root).ok()).collect();
        for &value in values.iter().flatten() {
            lowering.graph.decided_by(value);
        }
        if !lowering.graph.decisive.is_empty() {
            return Some(Err(lowering.graph.decisive));
        }
        let values = values.filter(|_| lowering.problems.is_empty() && lowering.circular().is_none())?;
        let (image, entries, _) = link(known, roots, bindings);
        Some(Ok(Compiled::of_graph((image, entries), &lowering, &values)))
    }

    /// With the fast code of roots whose values a graph has.
    fn of_graph((image, entries): (Image, Vec<Entry>), lowering: &Lowering<'_>, values: &[Value]) -> Compiled {
        let constants = values.iter().map(|&value| lowering.graph.as_constant(value)).collect();
        let channels = lowering.channels(values);
        let values: Vec<Option<Value>> = values.iter().copied().map(Some).collect();
        let (fast, fast_all) = fast_code(&lowering.graph, &values);
        Compiled { image, entries, fast, fast_all, constants, channels }
    }
}

/// The exact code of roots, where each begins, and the mistakes in it.
fn link(known: &Known<'_>, roots: &[ReadRoot], bindings: &Bindings<'_>) -> (Image, Vec<Entry>, Vec<Diagnostic>) {
    let mut linker = Linker::new(known, bindings);
    let mut entries = Vec::with_capacity(roots.len());
    for root in roots {
        entries.push(match root {
            ReadRoot::Expression(body) => Entry::Expression(linker.expression_root(body, body.root)),
            ReadRoot::Function { symbol, arity, span } => {
                Entry::Function(linker.function_root(*symbol, *arity, *span).unwrap_or(0))
            }
        });
    }
    let (image, problems) = linker.finish();
    (image, entries, problems)
}

/// Fast code of each root that a graph has a value of, and of all together.
fn fast_code(graph: &Graph, values: &[Option<Value>]) -> (Vec<Option<Code>>, Option<Code>) {
    let all: Option<Vec<Value>> = values.iter().copied().collect();
    let of_each = values.iter().map(|value| value.and_then(|value| emit(graph, &[value]))).collect();
    (of_each, all.filter(|all| all.len() > 1).and_then(|all| emit(graph, &all)))
}

/// Whether a value exceeds single precision, or is not a number.
#[inline]
fn is_beyond(value: f64) -> bool {
    value.is_nan() || value.abs() > f64::from(f32::MAX)
}

/// A root after parsing.
pub(crate) enum ReadRoot {
    Expression(Arc<Body>),
    Function { symbol: SymbolId, arity: u16, span: Option<Span> },
}

pub(crate) fn read_roots(
    known: &mut Known<'_>,
    scope: &Scope,
    roots: &[Root<'_>],
) -> Result<Vec<ReadRoot>, Vec<Diagnostic>> {
    let mut read = Vec::with_capacity(roots.len());
    let mut mistakes = Vec::new();
    let mut names = RootNames { known, scope, steps: MOST_FOLDING_STEPS };
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

/// Resolution of names in a root.
struct RootNames<'k, 'd> {
    known: &'k mut Known<'d>,
    scope: &'k Scope,
    steps: u64,
}

impl RootNames<'_, '_> {
    fn find(&mut self, name: &str) -> SymbolId {
        match self.known.definitions.symbols.find(name, self.scope) {
            Some(symbol) => symbol,
            None => self.known.stranger(name),
        }
    }
}

impl Names for RootNames<'_, '_> {
    fn resolve(&mut self, name: &str) -> Result<SymbolId, Diagnostic> {
        Ok(self.find(name))
    }

    fn fold(&mut self, body: &Body, node: Node) -> Result<Option<f64>, Diagnostic> {
        fold(self.known, body, node, &mut self.steps)
    }
}
