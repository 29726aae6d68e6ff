//! The bins of contributions.

use crate::disk::{Commands, DiskLoader};
use crate::failure::Failure;
use radsight_cal::{Bindings, Definitions, NoHost, Program, Root, Scope, Scratch};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_loader::{FileKind, Loader};
use radsight_render::Contribution;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Largest number of bins of a modifier.
const MOST_BINS: usize = 1 << 24;
/// Largest number of bins of all modifiers.
const MOST_IN_ALL: usize = 1 << 26;

/// The requested bins.
#[derive(Clone, Debug, Default)]
pub(super) struct BinRequest {
    /// The bin number from 0, as an expression; `None` for a single bin.
    pub(super) expression: Option<String>,
    /// Number of bins; 0 if not given.
    pub(super) count: usize,
    /// Numbers of variables for this modifier, as definitions.
    pub(super) parameters: Option<String>,
}

/// The definitions of `-f`, `-e` and `-p`, in their order.
#[derive(Debug)]
pub(super) struct Functions {
    definitions: Definitions,
    sources: SourceMap,
    scope: Scope,
    /// The last parameters, as definitions.
    parameters: Option<String>,
}

/// A compiled expression.
struct Expression {
    program: Arc<Program>,
    /// Its value, if it is a constant.
    constant: Option<f64>,
}

impl Functions {
    pub(super) fn new() -> Functions {
        let definitions = Definitions::with_initial_library();
        let scope = Scope::of_file("rcontrib");
        Functions { definitions, sources: SourceMap::default(), scope, parameters: None }
    }

    /// Reads a file of definitions from `RAYPATH` or the built-in ones.
    pub(super) fn load_file(&mut self, name: &str) -> Result<(), Failure> {
        let loaded = DiskLoader::new(Commands::Refused).load(name, FileKind::Function);
        let loaded = loaded.map_err(|error| Failure::input(format!("rcontrib: {error}")))?;
        self.load(loaded.path, &loaded.bytes)
    }

    /// Reads the definitions of an option.
    pub(super) fn define(&mut self, text: &str) -> Result<(), Failure> {
        if !text.contains(['=', ':']) {
            return Err(Failure::usage(format!("rcontrib: \"{text}\" is not a definition, expected for example MF:4")));
        }
        self.load("option -e".to_owned(), text.as_bytes())
    }

    /// Sets variables to numbers, as in `MF=4,rNx=0`, from here on; returns the definitions.
    pub(super) fn set_parameters(&mut self, text: &str) -> Result<String, Failure> {
        let definitions = parameters(text).ok_or_else(|| {
            Failure::usage(format!(
                "rcontrib: \"-p {text}\" is no list of parameters, expected variables with numbers, as in MF=4,rNx=0"
            ))
        })?;
        // As in Radiance, the same parameters again change nothing.
        if self.parameters.as_ref() != Some(&definitions) {
            self.load("option -p".to_owned(), definitions.as_bytes())?;
            self.parameters = Some(definitions.clone());
        }
        Ok(definitions)
    }

    fn load(&mut self, name: String, text: &[u8]) -> Result<(), Failure> {
        let source = self.sources.add(name, text, None);
        let loaded = self.definitions.load(source, text, &self.scope);
        loaded.map_err(|mistakes| Failure::diagnostics(&mistakes, &self.sources))
    }

    /// The value of an expression for the number of bins.
    pub(super) fn count(&mut self, text: &str) -> Result<usize, Failure> {
        let Expression { program, .. } = self.expression(text, None, "option -bn")?;
        let value = program.eval(0, &[], &NoHost, &mut Scratch::new()).unwrap_or(f64::NAN);
        match (value + 0.5) as usize {
            count @ 1..=MOST_BINS => Ok(count),
            _ => Err(Failure::usage(format!("rcontrib: \"-bn {text}\" is {value}, expected 1 to {MOST_BINS}"))),
        }
    }

    /// Compiles an expression, with the parameters of one modifier if they are given.
    fn expression(&self, text: &str, parameters: Option<&str>, what: &str) -> Result<Expression, Failure> {
        let mut sources = self.sources.clone();
        let with_parameters;
        let definitions = match parameters {
            Some(text) => {
                let mut own = self.definitions.clone();
                let source = sources.add("option -p", text.as_bytes(), None);
                let loaded = own.load(source, text.as_bytes(), &self.scope);
                loaded.map_err(|mistakes| Failure::diagnostics(&mistakes, &sources))?;
                with_parameters = own;
                &with_parameters
            }
            None => &self.definitions,
        };
        let source = sources.add(what, text.as_bytes(), None);
        let span = sources.span(source, 0, text.len());
        let root = Root::Expression { text, span };
        let program = Program::compile(definitions, &self.scope, &[root], &Bindings::of_ray())
            .map_err(|mistakes: Vec<Diagnostic>| Failure::diagnostics(&mistakes, &sources))?;
        let constant = Program::constant_expression(definitions, &self.scope, text, span);
        Ok(Expression { program: Arc::new(program), constant })
    }

    /// The bins of modifiers, by name. Where modifiers have different parameters, each has its own again;
    /// otherwise the last definition of a variable counts, as in Radiance.
    pub(super) fn compile<'a>(
        &self,
        requests: impl Iterator<Item = (&'a str, &'a BinRequest)> + Clone,
    ) -> Result<Bins, Failure> {
        let mut given = requests.clone().filter_map(|(_, request)| request.parameters.as_deref());
        let first = given.next();
        let differ = given.any(|parameters| Some(parameters) != first);
        let mut expressions: HashMap<(&str, Option<&str>), Expression> = HashMap::new();
        let mut bins = Bins { of_modifier: Vec::new(), total: 0, ignored: AtomicU64::new(0) };
        for (name, request) in requests {
            let mut program = None;
            let mut count = 1;
            if let Some(expression) = &request.expression {
                let parameters = request.parameters.as_deref().filter(|_| differ);
                let found = match expressions.entry((expression, parameters)) {
                    Entry::Occupied(compiled) => compiled.into_mut(),
                    Entry::Vacant(free) => free.insert(self.expression(expression, parameters, "option -b")?),
                };
                // Without a number of bins, a value that is always the same is taken as a constant.
                match found.constant.or_else(|| found.program.constant(0).filter(|_| request.count == 0)) {
                    Some(value) if (value + 0.5).floor() == 0.0 => {}
                    Some(value) => {
                        return Err(Failure::usage(format!(
                            "rcontrib: bin \"{expression}\" is the constant {value}, expected 0"
                        )));
                    }
                    None => (program, count) = (Some(Arc::clone(&found.program)), request.count),
                }
            }
            if count == 0 {
                return Err(Failure::usage(format!(
                    "rcontrib: the number of bins of \"{name}\" is missing, expected -bn"
                )));
            }
            bins.of_modifier.push(ModifierBins { first: bins.total, count, program });
            bins.total += count;
            if bins.total > MOST_IN_ALL {
                return Err(Failure::usage(format!("rcontrib: more than {MOST_IN_ALL} bins in all")));
            }
        }
        Ok(bins)
    }
}

/// Definitions of the variables of `MF=4,rNx=0`; `None` if it is no such list. Variables are separated by
/// spaces or one of `,`, `;` and `:`.
fn parameters(text: &str) -> Option<String> {
    let mut definitions = String::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let (name, after) = rest.split_once('=')?;
        let name = name.trim_end();
        let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '.'));
        let after = after.trim_start();
        let end = after.find(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | ':')).unwrap_or(after.len());
        let value: f64 = after[..end].parse().ok()?;
        if !(is_name && value.is_finite()) {
            return None;
        }
        definitions += &format!("{name}={value};");
        rest = after[end..].trim_start();
        rest = rest.strip_prefix([',', ';', ':']).unwrap_or(rest).trim_start();
    }
    Some(definitions)
}

/// The bins of all modifiers, concatenated.
#[derive(Debug)]
pub(super) struct Bins {
    of_modifier: Vec<ModifierBins>,
    total: usize,
    /// Number of contributions without a bin.
    ignored: AtomicU64,
}

#[derive(Debug)]
struct ModifierBins {
    first: usize,
    count: usize,
    program: Option<Arc<Program>>,
}

impl Bins {
    pub(super) fn len(&self) -> usize {
        self.total
    }

    /// Number of bins of a modifier.
    pub(super) fn of_modifier(&self, modifier: usize) -> usize {
        self.of_modifier[modifier].count
    }

    /// The index of a contribution's bin; `None` if it is negative or cannot be computed.
    pub(super) fn of(&self, contribution: &Contribution, scratch: &mut Scratch) -> Option<usize> {
        let bins = &self.of_modifier[contribution.modifier];
        let Some(program) = &bins.program else { return Some(bins.first) };
        let value = program.eval(0, &[], contribution, scratch).ok()?;
        if value.is_nan() || value <= -0.5 {
            return None;
        }
        let bin = (value + 0.5) as usize;
        if bin >= bins.count {
            self.ignored.fetch_add(1, Ordering::Relaxed);
            return None;
        }
        Some(bins.first + bin)
    }

    /// Number of contributions with a bin beyond the last.
    pub(super) fn ignored(&self) -> u64 {
        self.ignored.load(Ordering::Relaxed)
    }
}
