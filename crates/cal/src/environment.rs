//! Definitions that change between evaluations, as in `rcalc` and `gensurf`.

use crate::bindings::{Bindings, Known};
use crate::definitions::{Definitions, Dialect};
use crate::fault::{Place, Warning};
use crate::limits::LISTED_WARNINGS;
use crate::names::{Assignment, Definition, Scope, SymbolId};
use crate::program::{Host, Program, ReadRoot, Scratch};
use crate::syntax::Body;
use radsight_diag::{Diagnostic, SourceId};
use std::collections::BTreeMap;
use std::sync::Arc;

/// First channel for variables that are set to numbers.
const FIRST_SLOT: u32 = 0x4000_0000;

/// A root of an [`Environment`] that can be evaluated repeatedly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Handle(usize);

/// A variable of an [`Environment`] that is set to numbers again and again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Slot(usize);

/// A program, with memory of its own if a variable is defined recursively.
#[derive(Clone, Debug)]
struct Compiled {
    program: Program,
    memory: Option<Scratch>,
}

#[derive(Clone, Debug)]
enum Request {
    Expression(Arc<Body>),
    Variable(SymbolId),
    Function(SymbolId, u16),
}

/// Definitions from `-e` and `-f` options, variables set for each record, and output channels.
///
/// All names are global. A changed definition takes effect at the next evaluation, which recompiles
/// what depends on it; setting a variable to another number recompiles nothing. As in `rcalc`,
/// mathematical faults are not errors: evaluation continues with the value that Radiance would use,
/// and [`Environment::warnings`] lists the faults. A variable that depends on itself uses its value
/// of the previous evaluation, initially 0, so that `sum=sum+$1` accumulates.
///
/// ```
/// use radsight_cal::{Environment, NoHost};
/// use radsight_diag::SourceMap;
/// let mut sources = SourceMap::default();
/// let mut environment = Environment::new();
/// environment.set_constant("PI", std::f64::consts::PI);
///
/// let option = b"area(r) = PI*r^2; x = k*area($1); $2 = x+recno; cond = 5-recno";
/// let source = sources.add("-e", &option[..], None);
/// environment.define(source, option).unwrap();
/// environment.set_variable("k", 2.0);
/// environment.set_variable("recno", 1.0);
///
/// let area = environment.function("area", 1);
/// assert_eq!(environment.eval(area, &[1.0], &NoHost), Ok(std::f64::consts::PI));
/// let condition = environment.variable("cond");
/// for record in [[1.0], [2.0]] {
///     let channels = &record[..]; // $1
///     assert!(environment.eval(condition, &[], channels).unwrap() > 0.0);
///     let x = 2.0 * std::f64::consts::PI * record[0] * record[0];
///     assert_eq!(environment.eval_outputs(channels), Ok(&[(2, x + 1.0)][..]));
/// }
/// ```
#[derive(Debug)]
pub struct Environment {
    definitions: Definitions,
    requests: Vec<Request>,
    programs: Vec<Option<Compiled>>,
    outputs: BTreeMap<u32, Handle>,
    output_program: Option<Compiled>,
    /// The channel and the last value of each output.
    output_values: Vec<(u32, f64)>,
    /// Memory for the values of an evaluation.
    output_buffer: Vec<f64>,
    /// Variables that are set to numbers, with their values.
    slots: Vec<(SymbolId, f64)>,
    scratch: Scratch,
}

impl Default for Environment {
    fn default() -> Self {
        Environment::new()
    }
}

impl Environment {
    /// The built-in functions of the language alone; not even `PI` is defined.
    #[must_use]
    pub fn new() -> Environment {
        Environment::over(Definitions::new())
    }

    /// An environment on top of other definitions, for example
    /// [`Definitions::with_initial_library`].
    #[must_use]
    pub fn over(definitions: Definitions) -> Environment {
        Environment {
            definitions,
            requests: Vec::new(),
            programs: Vec::new(),
            outputs: BTreeMap::new(),
            output_program: None,
            output_values: Vec::new(),
            output_buffer: Vec::new(),
            slots: Vec::new(),
            scratch: Scratch::new(),
        }
    }

    /// Initial definitions of Radiance's generators: `PI`, and the curves `hermite`, `bezier` and
    /// `bspline`.
    #[must_use]
    pub fn for_generators() -> Environment {
        let mut environment = Environment::new();
        environment.set_constant("PI", std::f64::consts::PI);
        environment.definitions.load_builtin(crate::library::CURVES);
        environment
    }

    /// Registers a function that the host computes, for a name without a definition. [`Host::call`]
    /// gets the returned index and all arguments of the call, at least `arity`.
    pub fn offer_function(&mut self, name: &str, arity: usize) -> u32 {
        self.definitions.host_functions.push((name.to_owned(), arity));
        self.forget_programs();
        self.definitions.host_functions.len() as u32 - 1
    }

    /// Reads definitions and output channels from a file or an option.
    ///
    /// # Errors
    /// Every syntax error of the text; correct statements are defined.
    pub fn define(&mut self, source: SourceId, text: &[u8]) -> Result<(), Vec<Diagnostic>> {
        self.forget_programs();
        self.publish_slots();
        let outputs = self.definitions.read(Some(source), text, &Scope::global(), Dialect::Records)?;
        for (channel, body) in outputs {
            let handle = self.request(Request::Expression(Arc::new(body)));
            self.outputs.insert(channel, handle);
        }
        Ok(())
    }

    /// Sets a variable to a number, which recompiles nothing if it was set before and not redefined
    /// since. To set it for every record, take its [`Environment::slot`].
    pub fn set_variable(&mut self, name: &str, value: f64) {
        let slot = self.slot(name);
        self.set(slot, value);
    }

    /// The variable with this name, for [`Environment::set`].
    pub fn slot(&mut self, name: &str) -> Slot {
        let symbol = self.definitions.symbols.insert(Scope::global().qualify(name));
        let known = self.slots.iter().position(|(known, _)| *known == symbol);
        Slot(known.unwrap_or_else(|| {
            self.slots.push((symbol, 0.0));
            self.slots.len() - 1
        }))
    }

    /// The variable with this name if definitions mention it and do not define it.
    pub fn slot_if_needed(&mut self, name: &str) -> Option<Slot> {
        let is_needed = self.is_mentioned(name) && !self.is_variable(name);
        is_needed.then(|| self.slot(name))
    }

    /// Sets a variable to a number, as [`Environment::set_variable`] does, without looking for it.
    ///
    /// # Panics
    /// If the slot is that of another environment with more variables.
    pub fn set(&mut self, slot: Slot, value: f64) {
        let (symbol, current) = &mut self.slots[slot.0];
        *current = value;
        let symbol = *symbol;
        if !self.serves(symbol, slot.0) {
            self.serve(symbol, slot.0);
        }
    }

    /// Sets a constant, which is folded into texts that are read afterwards.
    pub fn set_constant(&mut self, name: &str, value: f64) {
        let name = Scope::global().qualify(name);
        let body = Body::number(value);
        self.definitions.define(name, Definition { assignment: Assignment::Constant, arity: None, body, span: None });
        self.forget_programs();
    }

    /// Removes a definition.
    pub fn remove(&mut self, name: &str) {
        if let Some(symbol) = self.definitions.symbols.find(name, &Scope::global()) {
            self.definitions.symbols.define(symbol, None);
            self.forget_programs();
        }
    }

    /// Number of arguments of the function with this name.
    #[must_use]
    pub fn function_arity(&self, name: &str) -> Option<usize> {
        let defined = self.definitions.function_arity(name, &Scope::global());
        let offered =
            || self.definitions.host_functions.iter().find(|(known, _)| known == name).map(|(_, arity)| *arity);
        defined.or_else(offered)
    }

    /// Whether the name is defined as a variable or constant.
    #[must_use]
    pub fn is_variable(&self, name: &str) -> bool {
        self.definitions.is_variable(name, &Scope::global())
    }

    /// Whether the name is defined as a constant.
    #[must_use]
    pub fn is_constant(&self, name: &str) -> bool {
        let found = self.definitions.symbols.find(name, &Scope::global());
        let variable = found.and_then(|symbol| self.definitions.symbols.get(symbol).variable());
        variable.is_some_and(|definition| definition.assignment == Assignment::Constant)
    }

    /// Whether the name occurs anywhere, so that setting it has an effect.
    #[must_use]
    pub fn is_mentioned(&self, name: &str) -> bool {
        self.definitions.symbols.find(name, &Scope::global()).is_some()
    }

    /// Reads an expression, which is evaluated with the definitions current at each evaluation.
    ///
    /// # Errors
    /// The syntax error of the text.
    pub fn expression(&mut self, source: SourceId, text: &[u8]) -> Result<Handle, Diagnostic> {
        self.publish_slots();
        let body = self.definitions.read_expression(source, text)?;
        Ok(self.request(Request::Expression(Arc::new(body))))
    }

    /// Handle of a variable by name.
    pub fn variable(&mut self, name: &str) -> Handle {
        let symbol = self.definitions.symbols.find_or_insert(name, &Scope::global());
        self.request(Request::Variable(symbol))
    }

    /// Handle of a function by name and number of arguments.
    pub fn function(&mut self, name: &str, arity: u16) -> Handle {
        let symbol = self.definitions.symbols.find_or_insert(name, &Scope::global());
        self.request(Request::Function(symbol, arity))
    }

    /// Defined output channels, in ascending order.
    #[must_use]
    pub fn outputs(&self) -> Vec<(u32, Handle)> {
        self.outputs.iter().map(|(channel, handle)| (*channel, *handle)).collect()
    }

    /// Evaluates all output channels for one record: (channel, value), in ascending order. Common
    /// subexpressions are computed once.
    ///
    /// # Errors
    /// Names without a definition, missing arguments, and evaluations that do not terminate.
    pub fn eval_outputs<H: Host + ?Sized>(&mut self, host: &H) -> Result<&[(u32, f64)], Vec<Diagnostic>> {
        let compiled = match &mut self.output_program {
            Some(compiled) => compiled,
            None => {
                let compiled = self.build(self.outputs.values().map(|handle| self.root(*handle)).collect())?;
                self.output_values = self.outputs.keys().map(|channel| (*channel, 0.0)).collect();
                self.output_buffer = vec![0.0; self.outputs.len()];
                self.output_program.insert(compiled)
            }
        };
        self.scratch.forget_warnings();
        let values = &mut self.output_buffer;
        let host = WithSlots { host, slots: &self.slots };
        let result = match &mut compiled.memory {
            None => compiled.program.eval_all(&[], &host, &mut self.scratch, values),
            Some(memory) => {
                let result = compiled.program.eval_all(&[], &host, memory, values);
                self.scratch.copy_warnings(memory);
                result
            }
        };
        if let Err(fault) = result
            && fault.kind.is_fatal()
        {
            return Err(vec![Diagnostic::error(fault.to_string())]);
        }
        for ((_, shown), value) in self.output_values.iter_mut().zip(&self.output_buffer) {
            *shown = *value;
        }
        Ok(&self.output_values)
    }

    /// Evaluates a root. `arguments` are those of a function.
    ///
    /// # Errors
    /// Names without a definition, missing arguments, and evaluations that do not terminate.
    pub fn eval<H: Host + ?Sized>(
        &mut self,
        handle: Handle,
        arguments: &[f64],
        host: &H,
    ) -> Result<f64, Vec<Diagnostic>> {
        if self.programs[handle.0].is_none() {
            self.programs[handle.0] = Some(self.build(vec![self.root(handle)])?);
        }
        let Some(compiled) = &mut self.programs[handle.0] else { return Err(Vec::new()) };
        self.scratch.forget_warnings();
        let host = WithSlots { host, slots: &self.slots };
        let result = match &mut compiled.memory {
            None => compiled.program.eval(0, arguments, &host, &mut self.scratch),
            Some(memory) => {
                let result = compiled.program.eval(0, arguments, &host, memory);
                self.scratch.copy_warnings(memory);
                result
            }
        };
        match result {
            Ok(value) => Ok(value),
            Err(fault) if fault.kind.is_fatal() => Err(vec![Diagnostic::error(fault.to_string())]),
            Err(fault) => Ok(fault.value),
        }
    }

    /// Mathematical faults of the last evaluation.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        self.scratch.warnings()
    }

    /// Adds the mathematical faults of the last evaluation to a list of messages, each once. The list ends
    /// after a few.
    pub fn list_warnings(&self, list: &mut Vec<String>) {
        for warning in self.warnings() {
            if list.len() >= LISTED_WARNINGS {
                return;
            }
            let message = self.in_words(warning);
            if !list.contains(&message) {
                list.push(message);
            }
        }
    }

    /// A warning in words, as Radiance prints it: `ri(): domain error`.
    fn in_words(&self, warning: &Warning) -> String {
        match warning.place {
            Place::HostFunction(index) => match self.definitions.host_functions.get(usize::from(index)) {
                Some((name, _)) => format!("{name}(): {}", warning.kind),
                None => warning.to_string(),
            },
            _ => warning.to_string(),
        }
    }

    fn root(&self, handle: Handle) -> ReadRoot {
        match &self.requests[handle.0] {
            Request::Expression(body) => ReadRoot::Expression(Arc::clone(body)),
            Request::Variable(symbol) => ReadRoot::Expression(Arc::new(Body::variable(*symbol))),
            Request::Function(symbol, arity) => ReadRoot::Function { symbol: *symbol, arity: *arity, span: None },
        }
    }

    fn build(&self, roots: Vec<ReadRoot>) -> Result<Compiled, Vec<Diagnostic>> {
        let functions = self.definitions.host_functions();
        let bindings = Bindings { functions: &functions, ..Bindings::default() };
        let (program, circles) = Program::build(&Known::new(&self.definitions), &roots, &bindings)?;
        Ok(Compiled { program, memory: circles.map(|_| Scratch::new()) })
    }

    fn request(&mut self, request: Request) -> Handle {
        self.requests.push(request);
        self.programs.push(None);
        Handle(self.requests.len() - 1)
    }

    fn forget_programs(&mut self) {
        self.programs.fill(None);
        self.output_program = None;
    }

    fn slot_channel(slot: usize) -> u32 {
        FIRST_SLOT.saturating_add(u32::try_from(slot).unwrap_or(u32::MAX))
    }

    /// Whether the variable is still served by the slot and was not redefined.
    fn serves(&self, symbol: SymbolId, slot: usize) -> bool {
        let variable = self.definitions.symbols.get(symbol).variable();
        variable.is_some_and(|definition| definition.body.as_channel() == Some(Self::slot_channel(slot)))
    }

    fn serve(&mut self, symbol: SymbolId, slot: usize) {
        let body = Body::channel(Self::slot_channel(slot));
        let definition = Definition { assignment: Assignment::Variable, arity: None, body, span: None };
        self.definitions.symbols.define(symbol, Some(Arc::new(definition)));
        self.forget_programs();
    }

    /// Makes the current numbers available to constants that are read.
    fn publish_slots(&mut self) {
        let numbered = self.slots.iter().enumerate();
        self.definitions.fixed_channels =
            numbered.map(|(slot, (_, value))| (Self::slot_channel(slot), *value)).collect();
    }
}

/// The caller's host, extended by the variables that are set to numbers.
struct WithSlots<'h, H: ?Sized> {
    host: &'h H,
    slots: &'h [(SymbolId, f64)],
}

impl<H: Host + ?Sized> Host for WithSlots<'_, H> {
    fn channel(&self, channel: u32) -> f64 {
        match channel.checked_sub(FIRST_SLOT) {
            Some(slot) => self.slots.get(slot as usize).map_or(0.0, |(_, value)| *value),
            None => self.host.channel(channel),
        }
    }

    fn call(&self, function: u32, arguments: &[f64]) -> f64 {
        self.host.call(function, arguments)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NoHost;
    use radsight_diag::SourceMap;

    fn environment(text: &str) -> Environment {
        let mut environment = Environment::for_generators();
        let source = SourceMap::default().add("-e", text.as_bytes(), None);
        environment.define(source, text.as_bytes()).unwrap();
        environment
    }

    fn value(environment: &mut Environment, name: &str) -> Result<f64, Vec<Diagnostic>> {
        let handle = environment.variable(name);
        environment.eval(handle, &[], &NoHost)
    }

    #[test]
    fn a_definition_may_come_after_its_use_and_change() {
        let mut environment = environment("y = 2*x");
        assert!(value(&mut environment, "y").is_err());
        environment.set_variable("x", 3.0);
        assert_eq!(value(&mut environment, "y"), Ok(6.0));
        environment.set_variable("x", 4.0);
        assert_eq!(value(&mut environment, "y"), Ok(8.0));
        let source = SourceMap::default().add("-e", &b""[..], None);
        environment.define(source, b"x = 5; y = x").unwrap();
        assert_eq!(value(&mut environment, "y"), Ok(5.0));
        environment.set_variable("x", 7.0);
        assert_eq!(value(&mut environment, "y"), Ok(7.0));
    }

    #[test]
    fn a_constant_is_folded_when_it_is_read() {
        let mut environment = environment("a : 1; b = a + 1; a : 5; c = a");
        assert_eq!(value(&mut environment, "b"), Ok(2.0));
        assert_eq!(value(&mut environment, "c"), Ok(5.0));
    }

    #[test]
    fn a_constant_function_sees_the_number_a_variable_has_now() {
        let mut environment = environment("f(x) : x*y");
        environment.set_variable("y", 3.0);
        let source = SourceMap::default().add("-e", &b""[..], None);
        environment.define(source, b"z = f(2)").unwrap();
        environment.set_variable("y", 4.0);
        assert_eq!(value(&mut environment, "z"), Ok(6.0));
    }

    #[test]
    fn output_channels_come_in_order_and_the_last_definition_holds() {
        let mut environment = environment("$3=1; $1=2; $3=5");
        assert_eq!(environment.outputs().iter().map(|(channel, _)| *channel).collect::<Vec<_>>(), [1, 3]);
        assert_eq!(environment.eval_outputs(&NoHost), Ok(&[(1, 2.0), (3, 5.0)][..]));
    }

    #[test]
    fn a_variable_defined_by_itself_adds_up() {
        let mut environment = environment("sum = sum + $1; $1 = sum; $2 = sum");
        for (record, expected) in [(1.0, 1.0), (4.0, 5.0), (2.0, 7.0)] {
            assert_eq!(environment.eval_outputs(&[record][..]), Ok(&[(1, expected), (2, expected)][..]));
        }
    }

    #[test]
    fn a_mathematical_fault_is_a_warning() {
        let mut environment = environment("x = 1 + acos(y)");
        environment.set_variable("y", 2.0);
        assert_eq!(value(&mut environment, "x"), Ok(1.0));
        assert_eq!(environment.warnings()[0].to_string(), "acos(): domain error");
        environment.set_variable("y", 1.0);
        assert_eq!(value(&mut environment, "x"), Ok(1.0));
        assert!(environment.warnings().is_empty());
    }

    #[test]
    fn the_host_computes_functions_it_offers() {
        struct Doubling;
        impl Host for Doubling {
            fn channel(&self, channel: u32) -> f64 {
                f64::from(channel)
            }
            fn call(&self, function: u32, arguments: &[f64]) -> f64 {
                f64::from(function) + 2.0 * arguments[0] + 100.0 * arguments.get(1).unwrap_or(&0.0)
            }
        }
        let mut environment = environment("x = in($3); more = in(1, $2)");
        environment.offer_function("other", 2);
        assert_eq!(environment.offer_function("in", 1), 1);
        let x = environment.variable("x");
        assert_eq!(environment.eval(x, &[], &Doubling), Ok(7.0));
        let more = environment.variable("more");
        assert_eq!(environment.eval(more, &[], &Doubling), Ok(203.0));
        let source = SourceMap::default().add("-e", &b""[..], None);
        environment.define(source, b"k : in(3); f(x) : x*in(1); y = k+f(2)").unwrap();
        let y = environment.variable("y");
        assert_eq!(environment.eval(y, &[], &Doubling), Ok(13.0));
    }

    #[test]
    fn curves_of_the_generators_pass_through_their_ends() {
        let mut environment = environment("a = hermite(1,2,0,0,0); b = hermite(1,2,9,9,1); c = bezier(1,0,0,4,1)");
        for (name, expected) in [("a", 1.0), ("b", 2.0), ("c", 4.0)] {
            assert_eq!(value(&mut environment, name), Ok(expected), "{name}");
        }
    }
}
