//! Lowering of definitions to a graph: functions are inlined at their calls, variables are shared.
//!
//! Arguments are lowered only when they are used, as at run time, so a branch that constants
//! exclude costs nothing and is never an error. Recursion that constants do not terminate cannot be
//! inlined. Such roots are left to the exact machine, besides the first few levels of the recursion,
//! which are enough for patterns that refer to themselves a few times.

use crate::bindings::{Bindings, Known};
use crate::builtin::Builtin;
use crate::graph::{DEEPEST, Graph, Node as GraphNode, Value};
use crate::link::{highest_parameter, too_few_arguments, unknown};
use crate::names::SymbolId;
use crate::program::ReadRoot;
use crate::syntax::{Body, Callee, Expr, Node, Operator};
use radsight_diag::{Diagnostic, Span};
use std::collections::HashMap;

/// Maximum number of lowered expressions per program.
const MOST_STEPS: usize = 400_000;
/// Maximum number of nodes.
const MOST_NODES: usize = 30_000;
/// Maximum nesting of expressions and calls together.
const DEEPEST_NESTING: usize = 1200;
/// Maximum nesting of calls.
const DEEPEST_CALLS: usize = 200;
/// Maximum number of arguments of `select` that become branches instead of a table.
const MOST_BRANCHES: usize = 256;

/// Number of calls of a function inside of its own in an unrolled graph; deeper ones are faults.
const UNROLLED_CALLS: usize = 3;

/// The root cannot be represented as a graph, although it may be valid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TooComplex;

type Lowered<T> = Result<T, TooComplex>;

/// Lowers roots to values of a graph.
pub(crate) struct Lowering<'a> {
    known: &'a Known<'a>,
    bindings: &'a Bindings<'a>,
    pub(crate) graph: Graph,
    /// Lowered variables; `None` while a variable is being lowered.
    variables: HashMap<SymbolId, Option<Value>>,
    frames: Vec<Frame<'a>>,
    /// Functions that are being called, if recursion is unrolled.
    unrolled: Option<Vec<SymbolId>>,
    /// Which real arguments are late.
    late: &'a [bool],
    /// Position in a file that led to the current expression.
    place: Option<Span>,
    steps: usize,
    depth: usize,
    /// A variable that depends on itself, with its position.
    circular: Option<(SymbolId, Option<Span>)>,
    /// Errors that an evaluation could reach.
    pub(crate) problems: Vec<Diagnostic>,
}

/// A call whose body is being lowered.
struct Frame<'a> {
    arguments: Vec<Slot<'a>>,
    caller: usize,
    /// The function and the position of the call; none for the outermost frame.
    call: Option<(SymbolId, Option<Span>)>,
}

#[derive(Clone, Copy)]
enum Slot<'a> {
    Unseen(&'a Body, Node),
    Seen(Value),
}

/// A function to call.
#[derive(Clone, Copy)]
enum Function {
    Symbol(SymbolId),
    Unknown,
}

impl<'a> Lowering<'a> {
    pub(crate) fn new(known: &'a Known<'a>, bindings: &'a Bindings<'a>) -> Lowering<'a> {
        Lowering {
            known,
            bindings,
            graph: Graph::default(),
            variables: HashMap::new(),
            frames: vec![Frame { arguments: Vec::new(), caller: 0, call: None }],
            unrolled: None,
            late: &[],
            place: None,
            steps: 0,
            depth: 0,
            circular: None,
            problems: Vec::new(),
        }
    }

    /// Lowers only the first levels of recursion: a deeper call is a fault, after which the exact
    /// machine evaluates. So problems and constants of this graph mean nothing.
    pub(crate) fn unrolled(known: &'a Known<'a>, bindings: &'a Bindings<'a>) -> Lowering<'a> {
        Lowering { unrolled: Some(Vec::new()), ..Lowering::new(known, bindings) }
    }

    /// Lowers for all values of the real arguments that are `late`.
    pub(crate) fn of_family(known: &'a Known<'a>, bindings: &'a Bindings<'a>, late: &'a [bool]) -> Lowering<'a> {
        Lowering { late, ..Lowering::new(known, bindings) }
    }

    /// A root that is an expression.
    fn expression(&mut self, body: &'a Body) -> Lowered<Value> {
        let value = self.lower(body, body.root, 0);
        self.end_root(value)
    }

    /// A root after parsing.
    pub(crate) fn root(&mut self, root: &'a ReadRoot) -> Lowered<Value> {
        match root {
            ReadRoot::Expression(body) => self.expression(body),
            ReadRoot::Function { symbol, arity, span } => self.function(*symbol, *arity, *span),
        }
    }

    /// A root that is a function; the host gives its arguments.
    fn function(&mut self, symbol: SymbolId, arity: u16, span: Option<Span>) -> Lowered<Value> {
        let arguments: Vec<_> = (0..arity).map(|index| Slot::Seen(self.graph.argument(index))).collect();
        let value = self.call(symbol, arguments, 0, span);
        self.end_root(value)
    }

    /// The error of a variable that depends on itself.
    pub(crate) fn circular(&self) -> Option<Diagnostic> {
        let (symbol, span) = self.circular?;
        let message = format!("variable \"{}\" depends on itself", self.known.bare_name(symbol));
        Some(span.into_iter().fold(Diagnostic::error(message), Diagnostic::at))
    }

    fn end_root(&mut self, value: Lowered<Value>) -> Lowered<Value> {
        if value.is_err() {
            self.frames.truncate(1);
            self.unrolled.iter_mut().for_each(Vec::clear);
            self.variables.retain(|_, value| value.is_some());
            self.depth = 0;
            self.place = None;
        }
        value
    }

    fn problem(&mut self, diagnostic: Diagnostic, span: Option<Span>) -> Value {
        let diagnostic = span.or(self.place).into_iter().fold(diagnostic, Diagnostic::at);
        if !self.problems.contains(&diagnostic) {
            self.problems.push(diagnostic);
        }
        self.graph.fault()
    }

    fn lower(&mut self, body: &'a Body, node: Node, frame: usize) -> Lowered<Value> {
        self.steps += 1;
        self.depth += 1;
        if self.steps > MOST_STEPS || self.depth > DEEPEST_NESTING || self.graph.len() > MOST_NODES {
            return Err(TooComplex);
        }
        let outer_place = self.place;
        self.place = body.span(node).or(outer_place);
        let value = match body.expr(node) {
            Expr::Number(value) => self.graph.constant(value),
            Expr::Channel(channel) => self.channel(channel, body.span(node)),
            Expr::Parameter(index) => self.parameter(usize::from(index), frame)?,
            Expr::Variable(symbol) => self.variable(symbol, body.span(node))?,
            Expr::Negate(inner) => {
                let inner = self.lower(body, inner, frame)?;
                self.graph.negate(inner)
            }
            Expr::Binary(operator, left, right) => self.binary(body, operator, left, right, frame)?,
            Expr::Call { callee, first, count } => {
                let function = match callee {
                    Callee::Symbol(symbol) => Function::Symbol(symbol),
                    Callee::Parameter(index) => self.resolve(usize::from(index), frame),
                };
                let arguments = body.arguments(first, count).iter().map(|&node| Slot::Unseen(body, node)).collect();
                match function {
                    Function::Symbol(symbol) => self.call(symbol, arguments, frame, body.span(node))?,
                    Function::Unknown => self.problem(Diagnostic::error("argument is not a function"), body.span(node)),
                }
            }
        };
        self.depth -= 1;
        self.place = outer_place;
        if self.graph.depth(value) > DEEPEST { Err(TooComplex) } else { Ok(value) }
    }

    fn binary(&mut self, body: &'a Body, operator: Operator, left: Node, right: Node, frame: usize) -> Lowered<Value> {
        let left = self.lower(body, left, frame)?;
        let right = self.lower(body, right, frame)?;
        Ok(self.graph.binary(operator, left, right))
    }

    fn channel(&mut self, channel: u32, span: Option<Span>) -> Value {
        if let Some(value) = self.bindings.constant_channel(channel) {
            return self.graph.constant(value);
        }
        if self.bindings.highest_channel.is_some_and(|highest| channel > highest) {
            return self.problem(self.bindings.no_such_channel(channel), span);
        }
        self.graph.channel(channel)
    }

    fn parameter(&mut self, index: usize, frame: usize) -> Lowered<Value> {
        match self.frames[frame].arguments.get(index).copied() {
            Some(Slot::Seen(value)) => Ok(value),
            Some(Slot::Unseen(body, node)) => {
                let caller = self.frames[frame].caller;
                let value = self.lower(body, node, caller)?;
                self.frames[frame].arguments[index] = Slot::Seen(value);
                Ok(value)
            }
            None => Ok(self.missing(index, frame)),
        }
    }

    /// A used argument that the call does not give.
    fn missing(&mut self, index: usize, frame: usize) -> Value {
        let Frame { arguments, call: Some((symbol, span)), .. } = &self.frames[frame] else {
            return self.graph.fault();
        };
        let known = self.known.symbol(*symbol);
        let needed = match known.map(|symbol| (symbol.function(), symbol.builtin)) {
            Some((Some(definition), _)) => highest_parameter(&definition.body),
            Some((None, Some(builtin))) => builtin.arity(),
            _ => index + 1,
        };
        let problem = too_few_arguments(self.known.bare_name(*symbol), arguments.len() as u16, needed);
        self.problem(problem, *span)
    }

    fn variable(&mut self, symbol: SymbolId, span: Option<Span>) -> Lowered<Value> {
        match self.variables.get(&symbol) {
            Some(Some(value)) => return Ok(*value),
            // The variable needs its own value, of the previous evaluation.
            Some(None) => {
                self.circular.get_or_insert((symbol, span));
                return Err(TooComplex);
            }
            None => {}
        }
        let Some(definition) = self.known.symbol(symbol).and_then(|symbol| symbol.variable()) else {
            return Ok(match self.bindings.variable(self.known.bare_name(symbol)) {
                Some(channel) => self.channel(channel, span),
                None => self.problem(unknown(self.known, self.bindings, symbol, "variable"), span),
            });
        };
        self.variables.insert(symbol, None);
        let value = self.lower(&definition.body, definition.body.root, 0)?;
        self.variables.insert(symbol, Some(value));
        Ok(value)
    }

    /// The function that an argument refers to.
    fn resolve(&self, mut index: usize, mut frame: usize) -> Function {
        while let Some(Slot::Unseen(body, node)) = self.frames[frame].arguments.get(index) {
            match body.expr(*node) {
                Expr::Variable(symbol) => return Function::Symbol(symbol),
                Expr::Parameter(outer) => (index, frame) = (usize::from(outer), self.frames[frame].caller),
                _ => break,
            }
        }
        Function::Unknown
    }

    fn call(&mut self, symbol: SymbolId, arguments: Vec<Slot<'a>>, frame: usize, span: Option<Span>) -> Lowered<Value> {
        let known = self.known.symbol(symbol);
        let count = arguments.len();
        if self.frames.len() > DEEPEST_CALLS {
            return Err(TooComplex);
        }
        if let Some(definition) = known.and_then(|symbol| symbol.function()) {
            if let Some(calls) = &mut self.unrolled {
                if calls.iter().filter(|call| **call == symbol).count() > UNROLLED_CALLS {
                    return Ok(self.graph.fault());
                }
                calls.push(symbol);
            }
            self.frames.push(Frame { arguments, caller: frame, call: Some((symbol, span)) });
            let value = self.lower(&definition.body, definition.body.root, self.frames.len() - 1)?;
            self.frames.pop();
            self.unrolled.as_mut().and_then(Vec::pop);
            return Ok(value);
        }
        let host = self.bindings.function(self.known.bare_name(symbol));
        let needed = match (known.and_then(|symbol| symbol.builtin), host) {
            (Some(builtin), _) => builtin.least_arity(),
            (None, Some((_, arity))) => arity,
            (None, None) => return Ok(self.problem(unknown(self.known, self.bindings, symbol, "function"), span)),
        };
        if let Some(fault) = self.lacking(symbol, count, needed, span) {
            return Ok(fault);
        }
        // A frame of its own, so that an argument is lowered once.
        self.frames.push(Frame { arguments, caller: frame, call: Some((symbol, span)) });
        let own = self.frames.len() - 1;
        let value = match (known.and_then(|symbol| symbol.builtin), host) {
            (Some(builtin), _) => self.builtin(builtin, own, span)?,
            (None, Some((function, _))) => {
                let values = (0..count).map(|index| self.parameter(index, own)).collect::<Lowered<Vec<_>>>()?;
                self.graph.host(function, values.into_boxed_slice())
            }
            (None, None) => self.graph.fault(),
        };
        self.frames.pop();
        Ok(value)
    }

    fn lacking(&mut self, symbol: SymbolId, given: usize, needed: usize, span: Option<Span>) -> Option<Value> {
        if given >= needed {
            return None;
        }
        let problem = too_few_arguments(self.known.bare_name(symbol), given as u16, needed);
        Some(self.problem(problem, span))
    }

    fn builtin(&mut self, builtin: Builtin, frame: usize, span: Option<Span>) -> Lowered<Value> {
        match builtin {
            Builtin::If => {
                let test = self.parameter(0, frame)?;
                self.graph.decided_by(test);
                if let Some(test) = self.graph.as_constant(test) {
                    let value = self.parameter(if test > 0.0 { 1 } else { 2 }, frame)?;
                    return Ok(self.graph.guarded(value));
                }
                let then = self.parameter(1, frame)?;
                let otherwise = self.parameter(2, frame)?;
                Ok(self.graph.choose(test, then, otherwise))
            }
            Builtin::Select => self.select(frame),
            Builtin::Min | Builtin::Max => {
                let mut value = self.parameter(0, frame)?;
                for index in (1..self.frames[frame].arguments.len()).rev() {
                    let next = self.parameter(index, frame)?;
                    value = self.graph.extreme(builtin, value, next);
                }
                Ok(self.graph.guarded(value))
            }
            Builtin::Arg => self.real_argument(frame, span),
            _ => {
                let arguments: Lowered<Vec<Value>> =
                    (0..builtin.arity()).map(|index| self.parameter(index, frame)).collect();
                Ok(self.graph.function(builtin, &arguments?))
            }
        }
    }

    fn real_argument(&mut self, frame: usize, span: Option<Span>) -> Lowered<Value> {
        let index = self.parameter(0, frame)?;
        let given = self.bindings.real_arguments;
        self.graph.decided_by(index);
        if let Some(number) = self.graph.as_constant(index) {
            if let Some(late) = late_argument(self.late, number) {
                return Ok(self.graph.late(late));
            }
            return Ok(match crate::machine::real_argument(given, number) {
                Some(value) => self.graph.constant(value),
                None => {
                    let number = (number + 0.5).floor();
                    let message = format!("real argument {number} is missing, {} given", given.len());
                    self.problem(Diagnostic::error(message), span)
                }
            });
        }
        self.graph.decisive.extend((0..).zip(self.late).filter(|(_, late)| **late).map(|(argument, _)| argument));
        let entries = std::iter::once(given.len() as f64).chain(given.iter().copied());
        Ok(self.graph.table(index, entries.collect()))
    }

    fn select(&mut self, frame: usize) -> Lowered<Value> {
        let index = self.parameter(0, frame)?;
        self.graph.decided_by(index);
        let count = self.frames[frame].arguments.len();
        if let Some(number) = self.graph.as_constant(index) {
            let choice = crate::builtin::truncated(number + 0.5);
            return match usize::try_from(choice) {
                Ok(0) if number >= -0.5 => Ok(self.graph.constant(count as f64 - 1.0)),
                Ok(choice) if (1..count).contains(&choice) => {
                    let value = self.parameter(choice, frame)?;
                    Ok(self.graph.guarded(value))
                }
                _ => Ok(self.graph.fault()),
            };
        }
        let mut values = Vec::with_capacity(count);
        values.push(self.graph.constant(count as f64 - 1.0));
        for choice in 1..count {
            let value = self.parameter(choice, frame)?;
            values.push(self.graph.guarded(value));
        }
        let numbers: Option<Box<[f64]>> = values.iter().map(|&value| self.graph.as_constant(value)).collect();
        if let Some(numbers) = numbers {
            return Ok(self.graph.table(index, numbers));
        }
        if count > MOST_BRANCHES {
            return Err(TooComplex);
        }
        let half = self.graph.constant(0.5);
        let shifted = self.graph.binary(Operator::Add, index, half);
        // Outside are faults: below −0.5, and from the number of arguments up.
        let fault = self.graph.fault();
        let chosen = self.branch(shifted, &values, 0);
        let end = self.graph.constant(count as f64);
        let below_end = self.graph.binary(Operator::Subtract, end, shifted);
        let bounded = self.graph.choose(below_end, chosen, fault);
        let below = self.graph.negate(shifted);
        Ok(self.graph.choose(below, fault, bounded))
    }

    /// The value whose index, counted from `first`, is the whole part of `shifted`.
    fn branch(&mut self, shifted: Value, values: &[Value], first: usize) -> Value {
        if let [only] = values {
            return *only;
        }
        let (low, high) = values.split_at(values.len() / 2);
        let middle = self.graph.constant((first + low.len()) as f64);
        let below = self.graph.binary(Operator::Subtract, middle, shifted);
        let (then, otherwise) = (self.branch(shifted, low, first), self.branch(shifted, high, first + low.len()));
        if then == otherwise { then } else { self.graph.choose(below, then, otherwise) }
    }

    /// The channels that the values of some roots depend on.
    pub(crate) fn channels(&self, roots: &[Value]) -> Vec<u32> {
        let mut reached = vec![false; self.graph.len()];
        roots.iter().for_each(|&root| reached[root as usize] = true);
        let mut channels = Vec::new();
        for value in (0..self.graph.len()).rev() {
            if reached[value] {
                let node = self.graph.node(value as Value);
                self.graph.operands(node, |operand| reached[operand as usize] = true);
                if let GraphNode::Channel(channel) = node {
                    channels.push(channel);
                }
            }
        }
        channels.sort_unstable();
        channels
    }
}

/// The late argument, from 0, that `arg` of a number means.
fn late_argument(late: &[bool], number: f64) -> Option<u16> {
    let argument = crate::builtin::truncated(number + 0.5).checked_sub(1)?;
    let is_late = usize::try_from(argument).ok().and_then(|argument| late.get(argument).copied());
    if is_late == Some(true) { u16::try_from(argument).ok() } else { None }
}
