//! The bins of contributions.

use crate::disk::{Commands, DiskLoader};
use crate::failure::Failure;
use radsight_cal::{Bindings, Definitions, NoHost, Program, Root, Scope, Scratch};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_loader::{FileKind, Loader};
use radsight_render::Contribution;
use std::collections::HashMap;
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
    /// Definitions for this modifier alone, as in `MF=4,rNx=0`.
    pub(super) parameters: Option<String>,
}

/// The definitions of `-f` and `-e`.
#[derive(Debug)]
pub(super) struct Functions {
    definitions: Definitions,
    sources: SourceMap,
    scope: Scope,
}

impl Functions {
    pub(super) fn new() -> Functions {
        let definitions = Definitions::with_initial_library();
        Functions { definitions, sources: SourceMap::default(), scope: Scope::of_file("rcontrib") }
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

    fn load(&mut self, name: String, text: &[u8]) -> Result<(), Failure> {
        let source = self.sources.add(name, text, None);
        let loaded = self.definitions.load(source, text, &self.scope);
        loaded.map_err(|mistakes| Failure::diagnostics(&mistakes, &self.sources))
    }

    /// The value of an expression for the number of bins.
    pub(super) fn count(&mut self, text: &str, parameters: Option<&str>) -> Result<usize, Failure> {
        let program = self.program(text, parameters, "option -bn")?;
        let value = program.eval(0, &[], &NoHost, &mut Scratch::new()).unwrap_or(f64::NAN);
        match (value + 0.5) as usize {
            count @ 1..=MOST_BINS => Ok(count),
            _ => Err(Failure::usage(format!("rcontrib: \"-bn {text}\" is {value}, expected 1 to {MOST_BINS}"))),
        }
    }

    /// Compiles an expression with the parameters of one modifier.
    fn program(&self, text: &str, parameters: Option<&str>, what: &str) -> Result<Program, Failure> {
        let mut sources = self.sources.clone();
        let with_parameters;
        let definitions = match parameters {
            Some(parameters) => {
                let mut own = self.definitions.clone();
                let text = parameters.replace(',', ";");
                let source = sources.add("option -p", text.as_bytes(), None);
                let loaded = own.load(source, text.as_bytes(), &self.scope);
                loaded.map_err(|mistakes| Failure::diagnostics(&mistakes, &sources))?;
                with_parameters = own;
                &with_parameters
            }
            None => &self.definitions,
        };
        let source = sources.add(what, text.as_bytes(), None);
        let root = Root::Expression { text, span: sources.span(source, 0, text.len()) };
        let program = Program::compile(definitions, &self.scope, &[root], &Bindings::of_ray());
        program.map_err(|mistakes: Vec<Diagnostic>| Failure::diagnostics(&mistakes, &sources))
    }

    /// The bins of modifiers, by name.
    pub(super) fn compile<'a>(
        &self,
        requests: impl Iterator<Item = (&'a str, &'a BinRequest)>,
    ) -> Result<Bins, Failure> {
        let mut programs: HashMap<(String, Option<String>), Arc<Program>> = HashMap::new();
        let mut bins = Bins { of_modifier: Vec::new(), total: 0, ignored: AtomicU64::new(0) };
        for (name, request) in requests {
            let mut program = None;
            let mut count = 1;
            if let Some(expression) = &request.expression {
                let key = (expression.clone(), request.parameters.clone());
                let found = match programs.get(&key) {
                    Some(found) => Arc::clone(found),
                    None => {
                        let made = self.program(expression, request.parameters.as_deref(), "option -b")?;
                        programs.entry(key).or_insert(Arc::new(made)).clone()
                    }
                };
                match found.constant(0) {
                    Some(value) if (value + 0.5).floor() == 0.0 => {}
                    Some(value) => {
                        return Err(Failure::usage(format!(
                            "rcontrib: bin \"{expression}\" is always {value}, expected 0"
                        )));
                    }
                    None => (program, count) = (Some(found), request.count),
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
