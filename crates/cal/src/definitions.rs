//! A set of definitions, read from function files.

use crate::bindings::{Bindings, Known};
use crate::lexer::Token;
use crate::limits::MOST_FOLDING_STEPS;
use crate::link::Linker;
use crate::machine::{Entry, Machine, Stacks};
use crate::names::{Assignment, Definition, Scope, SymbolId, Symbols};
use crate::program::NoHost;
use crate::syntax::{Body, Callee, Expr, Names, Node, Reader, is_parameter_name};
use crate::{FaultKind, library};
use radsight_diag::{Diagnostic, SourceId, Span};
use std::collections::HashSet;
use std::sync::Arc;

/// Definitions of constants, variables and functions, each global or local to a file.
///
/// A file is loaded once; [`Program::compile`](crate::Program::compile) then compiles programs from
/// the definitions. Cloning is cheap enough to be done once per scene.
#[derive(Clone, Debug)]
pub struct Definitions {
    pub(crate) symbols: Symbols,
    scopes: HashSet<Scope>,
    warnings: Vec<Diagnostic>,
    /// Channels with a value while constants are evaluated.
    pub(crate) fixed_channels: Vec<(u32, f64)>,
    /// Names and numbers of arguments of the functions that the program computes.
    pub(crate) host_functions: Vec<(String, usize)>,
}

impl Default for Definitions {
    fn default() -> Self {
        Definitions::new()
    }
}

/// One statement of a function file.
pub(crate) enum Statement {
    /// A definition of a qualified name, with the names of its arguments if it is a function.
    Define(String, Definition),
    /// `$n = expression`.
    Output(u32, Body),
}

/// Kinds of statements that a text may contain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dialect {
    /// Definitions of names only, as in function files.
    Functions,
    /// Output channels as well, as in `rcalc`.
    Records,
}

impl Definitions {
    /// The built-in functions of the language alone.
    #[must_use]
    pub fn new() -> Definitions {
        Definitions {
            symbols: Symbols::new(),
            scopes: HashSet::new(),
            warnings: Vec::new(),
            fixed_channels: Vec::new(),
            host_functions: Vec::new(),
        }
    }

    /// Definitions for the function files of a scene: the variables of the ray (`Dx`, `Nx`, `Px`, …
    /// on the channels of [`channel`](crate::channel)) and those of Radiance's `rayinit.cal`.
    #[must_use]
    pub fn with_initial_library() -> Definitions {
        let mut definitions = Definitions::new();
        for text in [library::RAY_VARIABLES, library::RAYINIT] {
            definitions.load_builtin(text);
        }
        definitions
    }

    /// Loads definitions of this crate. An error in them is a bug, which tests find.
    pub(crate) fn load_builtin(&mut self, text: &str) {
        let statements = self.read(None, text.as_bytes(), &Scope::global(), Dialect::Functions);
        debug_assert!(statements.is_ok(), "{statements:?}", statements = statements.err());
    }

    /// Loads a function file into a scope. Correct statements are defined even if others are wrong.
    ///
    /// # Errors
    /// Every syntax error of the text. An unknown name is an error only where it is used.
    pub fn load(&mut self, source: SourceId, text: &[u8], scope: &Scope) -> Result<(), Vec<Diagnostic>> {
        self.scopes.insert(scope.clone());
        self.read(Some(source), text, scope, Dialect::Functions).map(|_| ())
    }

    /// Whether a file was loaded into this scope. The global scope needs no file.
    #[must_use]
    pub fn is_loaded(&self, scope: &Scope) -> bool {
        *scope == Scope::global() || self.scopes.contains(scope)
    }

    /// Warnings about the files loaded so far: constants that were redefined with another value.
    pub fn take_warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.warnings)
    }

    /// Number of arguments of the function with this name in this scope; `None` if there is no such
    /// function.
    #[must_use]
    pub fn function_arity(&self, name: &str, scope: &Scope) -> Option<usize> {
        let symbol = self.symbols.get(self.symbols.find(name, scope)?);
        match &symbol.definition {
            Some(definition) => definition.arity.map(usize::from),
            None => symbol.builtin.map(crate::builtin::Builtin::arity),
        }
    }

    /// Whether the name is a variable or constant in this scope.
    #[must_use]
    pub fn is_variable(&self, name: &str, scope: &Scope) -> bool {
        self.symbols.find(name, scope).is_some_and(|id| self.symbols.get(id).variable().is_some())
    }

    /// The functions that the program computes, as [`Bindings`] name them.
    pub(crate) fn host_functions(&self) -> Vec<(&str, usize)> {
        self.host_functions.iter().map(|(name, arity)| (name.as_str(), *arity)).collect()
    }

    /// Reads statements and adds their definitions; returns the output channels.
    pub(crate) fn read(
        &mut self,
        source: Option<SourceId>,
        text: &[u8],
        scope: &Scope,
        dialect: Dialect,
    ) -> Result<Vec<(u32, Body)>, Vec<Diagnostic>> {
        let mut outputs = Vec::new();
        let mut mistakes = Vec::new();
        let mut loading = Loading { definitions: self, scope, steps: MOST_FOLDING_STEPS };
        let mut reader = match Reader::new(text, source, 0, &mut loading) {
            Ok(reader) => reader,
            Err(mistake) => return Err(vec![mistake]),
        };
        while reader.lexer.token != Token::End {
            let result = statement(&mut reader, scope, dialect);
            match result {
                Ok(Some(Statement::Define(name, definition))) => reader.names.define(name, definition),
                Ok(Some(Statement::Output(channel, body))) => outputs.push((channel, body)),
                Ok(None) => {}
                Err(mistake) => {
                    mistakes.push(mistake);
                    if let Err(mistake) = reader.lexer.recover() {
                        mistakes.push(mistake);
                        break;
                    }
                }
            }
        }
        if mistakes.is_empty() { Ok(outputs) } else { Err(mistakes) }
    }

    /// Reads one expression in the global scope; unknown names are added, to be defined later.
    pub(crate) fn read_expression(&mut self, source: SourceId, text: &[u8]) -> Result<Body, Diagnostic> {
        let mut loading = Loading { definitions: self, scope: &Scope::global(), steps: MOST_FOLDING_STEPS };
        read_expression(&mut loading, text, source, 0)
    }

    /// Defines a name.
    pub(crate) fn define(&mut self, name: String, definition: Definition) {
        let id = self.symbols.insert(name);
        let symbol = self.symbols.get(id);
        if let Some(old) = &symbol.definition
            && old.assignment == Assignment::Constant
            && !old.body.same_as(&definition.body)
        {
            let warning = Diagnostic::warning(format!("constant \"{}\" is redefined", symbol.bare()));
            self.warnings.push(definition.span.into_iter().fold(warning, Diagnostic::at));
        }
        self.symbols.define(id, Some(Arc::new(definition)));
    }
}

/// Reads a text that is one expression; its first byte is at `base` of `source`.
pub(crate) fn read_expression<N: Names>(
    names: &mut N,
    text: &[u8],
    source: SourceId,
    base: u32,
) -> Result<Body, Diagnostic> {
    let mut reader = Reader::new(text, Some(source), base, names)?;
    let body = reader.body()?;
    match reader.lexer.token {
        Token::End => Ok(body),
        _ => Err(reader.lexer.unexpected("an operator or the end of the expression")),
    }
}

/// Reads one statement and the `;` after it.
fn statement<N: Names>(
    reader: &mut Reader<'_, '_, N>,
    scope: &Scope,
    dialect: Dialect,
) -> Result<Option<Statement>, Diagnostic> {
    if reader.lexer.take(b';')? {
        return Ok(None);
    }
    reader.parameters.clear();
    let statement = if dialect == Dialect::Records && reader.lexer.token == Token::Mark(b'$') {
        let channel = reader.channel()?;
        reader.lexer.expect(b'=')?;
        Statement::Output(channel, reader.body()?)
    } else {
        definition(reader, scope)?
    };
    if reader.lexer.token != Token::End {
        if reader.lexer.token != Token::Mark(b';') {
            return Err(reader.lexer.unexpected("\";\" or an operator"));
        }
        reader.lexer.advance()?;
    }
    Ok(Some(statement))
}

fn definition<N: Names>(reader: &mut Reader<'_, '_, N>, scope: &Scope) -> Result<Statement, Diagnostic> {
    let Token::Name(name) = reader.lexer.token else {
        return Err(reader.lexer.unexpected("the name of a definition"));
    };
    let span = reader.lexer.place(reader.lexer.token_start(), reader.lexer.token_end());
    reader.lexer.advance()?;
    let mut arity = None;
    if reader.lexer.token == Token::Mark(b'(') {
        parameters(reader)?;
        arity = Some(u16::try_from(reader.parameters.len()).unwrap_or(u16::MAX));
    }
    let assignment = match reader.lexer.token {
        Token::Mark(b'=') => Assignment::Variable,
        Token::Mark(b':') => Assignment::Constant,
        _ => return Err(reader.lexer.unexpected("\"=\" or \":\"")),
    };
    reader.lexer.advance()?;
    let body = reader.body()?;
    Ok(Statement::Define(scope.qualify(name), Definition { assignment, arity, body, span }))
}

fn parameters<N: Names>(reader: &mut Reader<'_, '_, N>) -> Result<(), Diagnostic> {
    loop {
        reader.lexer.advance()?;
        match reader.lexer.token {
            Token::Name(name) if is_parameter_name(name) => reader.parameters.push(name),
            _ => return Err(reader.lexer.unexpected("the name of an argument")),
        }
        reader.lexer.advance()?;
        if reader.lexer.token != Token::Mark(b',') {
            break;
        }
    }
    reader.lexer.expect(b')')
}

/// Resolution of names while a file is read.
struct Loading<'d> {
    definitions: &'d mut Definitions,
    scope: &'d Scope,
    /// Remaining steps for folding constants.
    steps: u64,
}

impl Loading<'_> {
    fn define(&mut self, name: String, definition: Definition) {
        self.definitions.define(name, definition);
    }
}

impl Names for Loading<'_> {
    fn resolve(&mut self, name: &str) -> Result<SymbolId, Diagnostic> {
        Ok(self.definitions.symbols.find_or_insert(name, self.scope))
    }

    fn fold(&mut self, body: &Body, node: Node) -> Result<Option<f64>, Diagnostic> {
        fold(&Known::new(self.definitions), body, node, &mut self.steps)
    }
}

/// The value of a variable or call, if it is a constant that reading alone decides. One that needs a
/// function of the program has its value later.
pub(crate) fn fold(known: &Known<'_>, body: &Body, node: Node, steps: &mut u64) -> Result<Option<f64>, Diagnostic> {
    match body.expr(node) {
        Expr::Variable(symbol) => {
            let Some(definition) = known.symbol(symbol).and_then(|symbol| symbol.variable()) else { return Ok(None) };
            if definition.assignment != Assignment::Constant {
                return Ok(None);
            }
            if let Some(value) = definition.body.as_number() {
                return Ok(Some(value));
            }
        }
        Expr::Call { callee: Callee::Symbol(symbol), first, count } => {
            let constant = |symbol| known.symbol(symbol).is_some_and(|symbol| symbol.is_constant_function());
            let fixed = |node: &Node| match body.expr(*node) {
                Expr::Number(_) => true,
                Expr::Variable(symbol) => constant(symbol),
                _ => false,
            };
            if !constant(symbol) || !body.arguments(first, count).iter().all(fixed) {
                return Ok(None);
            }
        }
        _ => return Ok(None),
    }
    evaluate_constant(known, body, node, steps)
}

fn evaluate_constant(known: &Known<'_>, body: &Body, node: Node, steps: &mut u64) -> Result<Option<f64>, Diagnostic> {
    let fixed = &known.definitions.fixed_channels;
    let functions = known.definitions.host_functions();
    let bindings =
        Bindings { highest_channel: Some(0), constant_channels: fixed, functions: &functions, ..Bindings::default() };
    let mut linker = Linker::new(known, &bindings);
    let entry = linker.expression_root(body, node);
    let (image, problems) = linker.finish();
    if problems.is_empty() && image.calls_host() {
        return Ok(None);
    }
    let mut stacks = Stacks::default();
    let mut machine = Machine::new(&image, &[], &mut stacks, &NoHost, *steps);
    let result = machine.run(Entry::Expression(entry), &[]);
    let fault = machine.fault;
    *steps = machine.steps_left().saturating_sub(image.code.len() as u64);
    let place = |message: String, span: Option<Span>| span.into_iter().fold(Diagnostic::error(message), Diagnostic::at);
    match (result, fault) {
        (Ok(value), None) => Ok(Some(value)),
        (Err(FaultKind::Undefined), _) if !problems.is_empty() => {
            Err(unfoldable(problems, constant_name(known, body, node)))
        }
        (Ok(_), Some(kind)) | (Err(kind), _) => {
            let because = machine_warning(&stacks).unwrap_or_else(|| kind.to_string());
            Err(place(format!("bad constant expression: {because}"), body.span(node)))
        }
    }
}

fn machine_warning(stacks: &Stacks) -> Option<String> {
    stacks.warnings.last().map(ToString::to_string)
}

/// Name of the constant or function for a message.
fn constant_name<'k>(known: &'k Known<'_>, body: &Body, node: Node) -> &'k str {
    match body.expr(node) {
        Expr::Variable(symbol) | Expr::Call { callee: Callee::Symbol(symbol), .. } => known.bare_name(symbol),
        _ => "",
    }
}

/// The error of an expression that is not constant.
fn unfoldable(mut problems: Vec<Diagnostic>, name: &str) -> Diagnostic {
    let mut first = problems.swap_remove(0);
    if let Some(channel) = first.message.strip_prefix("illegal channel ") {
        first.message = format!("constant \"{name}\" depends on {channel}, which changes from ray to ray");
        first.hints = vec!["define it with \"=\" in place of \":\"".to_owned()];
    }
    first
}
