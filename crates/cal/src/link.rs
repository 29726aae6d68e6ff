//! Linker: generates the exact machine's code from definitions.
//!
//! Everything that the roots reach is generated once: the roots, each function, each variable, each
//! argument of each call. Arguments have code of their own, because they are evaluated only when
//! they are used.

use crate::bindings::{Bindings, Known};
use crate::builtin::Builtin;
use crate::machine::{Argument, Callable, FAIL_ENTRY, Image, Op, Routine};
use crate::names::SymbolId;
use crate::syntax::{Body, Callee, Expr, Node, Operator};
use radsight_diag::{Diagnostic, Span};
use std::collections::HashMap;

/// Generates an [`Image`].
pub(crate) struct Linker<'a> {
    known: &'a Known<'a>,
    bindings: &'a Bindings<'a>,
    image: Image,
    functions: HashMap<SymbolId, u32>,
    wrappers: HashMap<(Builtin, u16), u32>,
    host_wrappers: HashMap<(u16, u16), u32>,
    variables: HashMap<SymbolId, u32>,
    pending: Vec<Pending<'a>>,
    /// Numbers of arguments with which functions passed as arguments are called.
    parameter_calls: Vec<u16>,
    /// Errors in reachable code; evaluation fails where it gets there.
    pub(crate) problems: Vec<Diagnostic>,
}

enum Pending<'a> {
    Function { routine: u32, body: &'a Body },
    Variable { variable: u32, body: &'a Body },
    Argument { argument: u32, body: &'a Body, node: Node },
}

impl<'a> Linker<'a> {
    pub(crate) fn new(known: &'a Known<'a>, bindings: &'a Bindings<'a>) -> Linker<'a> {
        Linker {
            known,
            bindings,
            image: Image::new(),
            functions: HashMap::new(),
            wrappers: HashMap::new(),
            host_wrappers: HashMap::new(),
            variables: HashMap::new(),
            pending: Vec::new(),
            parameter_calls: Vec::new(),
            problems: Vec::new(),
        }
    }

    /// Adds an expression as a root and returns the start of its code.
    pub(crate) fn expression_root(&mut self, body: &'a Body, node: Node) -> u32 {
        let entry = self.here();
        self.expr(body, node);
        self.image.code.push(Op::Stop);
        entry
    }

    /// Adds a function as a root; its caller gives the arguments.
    pub(crate) fn function_root(&mut self, symbol: SymbolId, arity: u16, span: Option<Span>) -> Option<u32> {
        match self.callable(symbol, arity) {
            Some(Callable::Function(routine)) => {
                self.check_arity(symbol, arity, self.least_arity(symbol), span);
                Some(routine)
            }
            _ => {
                self.problem(unknown(self.known, self.bindings, symbol, "function"), span);
                None
            }
        }
    }

    /// Number of arguments that every call evaluates, as far as the name tells.
    fn least_arity(&self, symbol: SymbolId) -> usize {
        let known = self.known.symbol(symbol);
        match (known.and_then(|symbol| symbol.function()), known.and_then(|symbol| symbol.builtin)) {
            (Some(_), _) => 0,
            (None, Some(builtin)) => builtin.least_arity(),
            (None, None) => self.bindings.function(self.known.bare_name(symbol)).map_or(0, |(_, arity)| arity),
        }
    }

    /// Generates the remaining code and returns the image.
    pub(crate) fn finish(mut self) -> (Image, Vec<Diagnostic>) {
        while let Some(pending) = self.pending.pop() {
            let entry = self.here();
            match pending {
                Pending::Function { routine, body } => {
                    self.image.routines[routine as usize].entry = entry;
                    self.expr(body, body.root);
                }
                Pending::Variable { variable, body } => {
                    self.image.variables[variable as usize] = entry;
                    self.expr(body, body.root);
                }
                Pending::Argument { argument, body, node } => {
                    self.image.arguments[argument as usize].entry = entry;
                    self.expr(body, node);
                }
            }
            self.image.code.push(Op::Return);
        }
        for count in std::mem::take(&mut self.parameter_calls) {
            for builtin in [Builtin::Select, Builtin::Min, Builtin::Max] {
                let routine = self.wrapper(builtin, count);
                self.image.variadic.push((builtin, count, routine));
            }
        }
        (self.image, self.problems)
    }

    fn here(&self) -> u32 {
        u32::try_from(self.image.code.len()).unwrap_or(u32::MAX)
    }

    fn push(&mut self, op: Op) -> usize {
        self.image.code.push(op);
        self.image.code.len() - 1
    }

    fn problem(&mut self, diagnostic: Diagnostic, span: Option<Span>) {
        let diagnostic = span.into_iter().fold(diagnostic, Diagnostic::at);
        if !self.problems.contains(&diagnostic) {
            self.problems.push(diagnostic);
        }
    }

    fn expr(&mut self, body: &'a Body, node: Node) {
        match body.expr(node) {
            Expr::Number(value) => {
                self.push(Op::Number(value));
            }
            Expr::Channel(channel) => self.channel(channel, body.span(node)),
            Expr::Parameter(index) => {
                self.push(Op::Parameter(index));
            }
            Expr::Variable(symbol) => self.variable(symbol, body.span(node)),
            Expr::Negate(inner) => {
                self.expr(body, inner);
                self.push(Op::Negate);
            }
            Expr::Binary(..) => self.binary(body, node),
            Expr::Call { callee, first, count } => {
                let arguments = body.arguments(first, count);
                match callee {
                    Callee::Parameter(parameter) => {
                        let first = self.arguments(body, arguments);
                        if !self.parameter_calls.contains(&count) {
                            self.parameter_calls.push(count);
                        }
                        self.push(Op::CallParameter { parameter, first, count });
                    }
                    Callee::Symbol(symbol) => self.call(body, symbol, arguments, body.span(node)),
                }
            }
        }
    }

    fn channel(&mut self, channel: u32, span: Option<Span>) {
        if let Some(value) = self.bindings.constant_channel(channel) {
            self.push(Op::Number(value));
        } else if self.bindings.highest_channel.is_some_and(|highest| channel > highest) {
            self.problem(self.bindings.no_such_channel(channel), span);
            self.push(Op::Fail);
        } else {
            if !self.image.channels.contains(&channel) {
                self.image.channels.push(channel);
            }
            self.push(Op::Channel(channel));
        }
    }

    fn variable(&mut self, symbol: SymbolId, span: Option<Span>) {
        let Some(definition) = self.known.symbol(symbol).and_then(|symbol| symbol.variable()) else {
            match self.bindings.variable(self.known.bare_name(symbol)) {
                Some(channel) => self.channel(channel, span),
                None => {
                    self.problem(unknown(self.known, self.bindings, symbol, "variable"), span);
                    self.push(Op::Fail);
                }
            }
            return;
        };
        if let Some(value) = definition.body.as_number() {
            self.push(Op::Number(value));
            return;
        }
        let next = self.image.variables.len() as u32;
        let variable = *self.variables.entry(symbol).or_insert(next);
        if variable == next {
            self.image.variables.push(0);
            self.pending.push(Pending::Variable { variable, body: &definition.body });
        }
        self.push(Op::Variable(variable));
    }

    /// Operators, with a loop along their left operands: a sum may have any number of terms.
    fn binary(&mut self, body: &'a Body, node: Node) {
        let mut rights = Vec::new();
        let mut leftmost = node;
        while let Expr::Binary(operator, left, right) = body.expr(leftmost) {
            let mut guard = 0;
            match operator {
                // The divisor comes first: if it is zero, the dividend is not evaluated.
                Operator::Divide => {
                    self.expr(body, right);
                    guard = self.push(Op::DivideGuard(0));
                }
                // The exponent comes first, as in Radiance's own programs; it matters for faults
                // only.
                Operator::Power => {
                    self.push(Op::Clear);
                    self.expr(body, right);
                }
                Operator::Add | Operator::Subtract | Operator::Multiply => {}
            }
            rights.push((operator, right, guard));
            leftmost = left;
        }
        self.expr(body, leftmost);
        while let Some((operator, right, guard)) = rights.pop() {
            match operator {
                Operator::Divide => {
                    self.push(Op::Divide);
                    self.image.code[guard] = Op::DivideGuard(self.here());
                }
                Operator::Power => {
                    self.push(Op::Power);
                }
                Operator::Add | Operator::Subtract | Operator::Multiply => {
                    self.expr(body, right);
                    self.push(match operator {
                        Operator::Add => Op::Add,
                        Operator::Subtract => Op::Subtract,
                        _ => Op::Multiply,
                    });
                }
            }
        }
    }

    fn call(&mut self, body: &'a Body, symbol: SymbolId, arguments: &'a [Node], span: Option<Span>) {
        let count = arguments.len() as u16;
        let known = self.known.symbol(symbol);
        if known.is_some_and(|symbol| symbol.function().is_some()) {
            let Some(Callable::Function(routine)) = self.callable(symbol, count) else { return };
            let first = self.arguments(body, arguments);
            self.push(Op::Call { routine, first, count });
        } else if let Some(builtin) = known.and_then(|symbol| symbol.builtin) {
            if self.check_arity(symbol, count, builtin.least_arity(), span) {
                self.builtin(builtin, count, &mut |linker, index| match arguments.get(index) {
                    Some(&argument) => linker.expr(body, argument),
                    // A branch of `if` that is not given.
                    None => {
                        linker.push(Op::Fail);
                    }
                });
            }
        } else if let Some((function, arity)) = self.bindings.function(self.known.bare_name(symbol)) {
            if self.check_arity(symbol, count, arity, span) {
                self.host_call(function, arguments.len(), &mut |linker, index| linker.expr(body, arguments[index]));
            }
        } else {
            self.problem(unknown(self.known, self.bindings, symbol, "function"), span);
            self.push(Op::Fail);
        }
    }

    fn check_arity(&mut self, symbol: SymbolId, given: u16, needed: usize, span: Option<Span>) -> bool {
        let enough = usize::from(given) >= needed;
        if !enough {
            self.problem(too_few_arguments(self.known.bare_name(symbol), given, needed), span);
            self.push(Op::Fail);
        }
        enough
    }

    /// A built-in function; `argument` generates the code of one argument.
    fn builtin(&mut self, builtin: Builtin, count: u16, argument: &mut dyn FnMut(&mut Self, usize)) {
        match builtin {
            Builtin::If => {
                self.push(Op::Clear);
                argument(self, 0);
                let test = self.push(Op::JumpUnlessPositive(0));
                argument(self, 1);
                let skip = self.push(Op::Jump(0));
                self.image.code[test] = Op::JumpUnlessPositive(self.here());
                argument(self, 2);
                self.image.code[skip] = Op::Jump(self.here());
                self.push(Op::LibraryEnd(builtin));
            }
            Builtin::Select => self.select(count, argument),
            Builtin::Min | Builtin::Max => {
                self.push(Op::Clear);
                argument(self, 0);
                for index in (1..usize::from(count)).rev() {
                    argument(self, index);
                    self.push(if builtin == Builtin::Min { Op::Least } else { Op::Greatest });
                }
                self.push(Op::LibraryEnd(builtin));
            }
            Builtin::Atan2 => {
                // The second argument comes first, as in Radiance's own programs; it matters for
                // faults only.
                self.push(Op::Clear);
                argument(self, 1);
                argument(self, 0);
                self.push(Op::Swap);
                self.push(Op::Library { builtin, count: 2 });
            }
            _ => {
                self.push(Op::Clear);
                for index in 0..builtin.arity() {
                    argument(self, index);
                }
                self.push(Op::Library { builtin, count: builtin.arity() as u16 });
            }
        }
    }

    fn select(&mut self, count: u16, argument: &mut dyn FnMut(&mut Self, usize)) {
        self.push(Op::Clear);
        argument(self, 0);
        let head = self.push(Op::Fail);
        let table = self.image.tables.len();
        self.image.tables.resize(table + usize::from(count), 0);
        let mut skips = Vec::new();
        for index in 1..usize::from(count) {
            self.image.tables[table + index] = self.here();
            argument(self, index);
            skips.push(self.push(Op::Jump(0)));
        }
        let end = self.here();
        self.image.tables[table] = end;
        for skip in skips {
            self.image.code[skip] = Op::Jump(end);
        }
        self.image.code[head] = Op::Select { count, table: table as u32 };
        self.push(Op::LibraryEnd(Builtin::Select));
    }

    fn host_call(&mut self, function: u16, arity: usize, argument: &mut dyn FnMut(&mut Self, usize)) {
        self.push(Op::Clear);
        for index in 0..arity {
            argument(self, index);
        }
        self.push(Op::HostCall { function, count: arity as u16 });
    }

    /// Target of calls by a name, if it is a function.
    fn callable(&mut self, symbol: SymbolId, count: u16) -> Option<Callable> {
        let known = self.known.symbol(symbol);
        if let Some(definition) = known.and_then(|symbol| symbol.function()) {
            let next = self.image.routines.len() as u32;
            let routine = *self.functions.entry(symbol).or_insert(next);
            if routine == next {
                let uses = highest_parameter(&definition.body);
                self.image.routines.push(Routine { entry: 0, uses: uses as u16 });
                self.pending.push(Pending::Function { routine, body: &definition.body });
            }
            return Some(Callable::Function(routine));
        }
        if let Some(builtin) = known.and_then(|symbol| symbol.builtin) {
            return Some(Callable::Function(self.wrapper(builtin, count)));
        }
        let (function, arity) = self.bindings.function(self.known.bare_name(symbol))?;
        Some(Callable::Function(self.host_wrapper(function, arity.max(usize::from(count)))))
    }

    /// A built-in function as a routine, for calls through an argument.
    fn wrapper(&mut self, builtin: Builtin, count: u16) -> u32 {
        let count = if matches!(builtin, Builtin::Select | Builtin::Min | Builtin::Max) { count } else { 0 };
        if let Some(&routine) = self.wrappers.get(&(builtin, count)) {
            return routine;
        }
        let uses = (builtin.arity() as u16).max(count);
        let routine = self.routine(uses, |linker| {
            linker.builtin(builtin, count, &mut |linker, index| {
                linker.push(Op::Parameter(index as u16));
            });
        });
        self.wrappers.insert((builtin, count), routine);
        routine
    }

    fn host_wrapper(&mut self, function: u16, arity: usize) -> u32 {
        if let Some(&routine) = self.host_wrappers.get(&(function, arity as u16)) {
            return routine;
        }
        let routine = self.routine(arity as u16, |linker| {
            linker.host_call(function, arity, &mut |linker, index| {
                linker.push(Op::Parameter(index as u16));
            });
        });
        self.host_wrappers.insert((function, arity as u16), routine);
        routine
    }

    /// Generates a routine within other code, which jumps over it.
    fn routine(&mut self, uses: u16, write: impl FnOnce(&mut Self)) -> u32 {
        let skip = self.push(Op::Jump(0));
        let entry = self.here();
        write(self);
        self.push(Op::Return);
        self.image.code[skip] = Op::Jump(self.here());
        self.image.routines.push(Routine { entry, uses });
        self.image.routines.len() as u32 - 1
    }

    /// Reserves the arguments of a call; their code follows later.
    fn arguments(&mut self, body: &'a Body, nodes: &'a [Node]) -> u32 {
        let first = self.image.arguments.len() as u32;
        for &node in nodes {
            let callable = match body.expr(node) {
                Expr::Parameter(index) => Some(Callable::Parameter(index)),
                Expr::Variable(symbol) => self.function_argument(symbol),
                _ => None,
            };
            let argument = self.image.arguments.len() as u32;
            self.image.arguments.push(Argument { entry: u32::MAX, callable });
            // A name that is only a function has no value.
            let function = matches!(callable, Some(Callable::Function(_) | Callable::Variadic(_)));
            if function && !self.has_value(body.expr(node)) {
                self.image.arguments[argument as usize].entry = FAIL_ENTRY;
            } else {
                self.pending.push(Pending::Argument { argument, body, node });
            }
        }
        first
    }

    fn function_argument(&mut self, symbol: SymbolId) -> Option<Callable> {
        let known = self.known.symbol(symbol).filter(|symbol| symbol.definition.is_none());
        match known.and_then(|symbol| symbol.builtin) {
            Some(builtin @ (Builtin::Select | Builtin::Min | Builtin::Max)) => Some(Callable::Variadic(builtin)),
            _ => self.callable(symbol, 0),
        }
    }

    fn has_value(&self, expr: Expr) -> bool {
        let Expr::Variable(symbol) = expr else { return true };
        self.known.symbol(symbol).is_some_and(|symbol| symbol.variable().is_some())
            || self.bindings.variable(self.known.bare_name(symbol)).is_some()
    }
}

/// Number of arguments that the body uses.
pub(crate) fn highest_parameter(body: &Body) -> usize {
    let index = |expr: &Expr| match expr {
        Expr::Parameter(index) | Expr::Call { callee: Callee::Parameter(index), .. } => usize::from(*index) + 1,
        _ => 0,
    };
    body.exprs().iter().map(index).max().unwrap_or(0)
}

/// Error about an unknown name.
pub(crate) fn unknown(known: &Known<'_>, bindings: &Bindings<'_>, symbol: SymbolId, wanted: &str) -> Diagnostic {
    let name = known.bare_name(symbol);
    let is_function = |symbol: &crate::names::Symbol| symbol.function().is_some() || symbol.builtin.is_some();
    let other = known.symbol(symbol).and_then(|symbol| match wanted {
        "variable" if is_function(symbol) => Some("a function, and needs arguments in parentheses"),
        "function" if symbol.variable().is_some() => Some("a variable, and takes no arguments"),
        _ => None,
    });
    if let Some(other) = other {
        return Diagnostic::error(format!("unknown {wanted} \"{name}\"")).hint(format!("\"{name}\" is {other}"));
    }
    let hint = match wanted {
        "function" => radsight_diag::hint_nearest(name, known.function_names(bindings)),
        _ => radsight_diag::hint_nearest(name, known.variable_names(bindings)),
    };
    Diagnostic::error(format!("unknown {wanted} \"{name}\"")).maybe_hint(hint)
}

/// Error about a call with too few arguments.
pub(crate) fn too_few_arguments(name: &str, given: u16, needed: usize) -> Diagnostic {
    let plural = if needed == 1 { "" } else { "s" };
    Diagnostic::error(format!("function \"{name}\" needs {needed} argument{plural}, {given} given"))
}
