//! Compiles function files and expressions, and reads the transforms after them.

use super::modifiers::{Raw, RawWord};
use super::reader::Reader;
use crate::transform_words::{self, begins_transform};
use radsight_cal::{Bindings, Definitions, Family, Program, Root, Scope};
use radsight_diag::{Diagnostic, Span};
use radsight_ir::{FunctionCall, Transform};
use radsight_loader::{FileKind, LoadError, Loader};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The compiled functions of the scene.
#[derive(Default)]
pub(super) struct Functions {
    definitions: Option<Definitions>,
    /// Files that could not be read. Each is reported once, and no program uses it.
    failed: HashSet<Scope>,
    programs: HashMap<FamilyKey, Programs>,
}

/// Everything that determines a program, besides the real arguments.
#[derive(PartialEq, Eq, Hash)]
struct FamilyKey {
    scope: Scope,
    roots: Vec<(RootWord, String)>,
    real_count: usize,
}

impl FamilyKey {
    fn new(raw: &Raw, roots: &[RootWord], scope: &Scope) -> Self {
        let roots = roots.iter().map(|root| (*root, raw.strings[root.index()].text.clone())).collect();
        FamilyKey { scope: scope.clone(), roots, real_count: raw.reals.len() }
    }
}

/// The programs of a family.
#[derive(Default)]
struct Programs {
    family: Family,
    /// By the real arguments, as bits. Copies of a modifier in an array share one program, since
    /// they differ only in their transform.
    compiled: HashMap<Box<[u64]>, Arc<Program>>,
}

/// A string argument to compile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum RootWord {
    /// An expression, by the index of the string.
    Expression(usize),
    /// A function with this many arguments, by the index of its name.
    Function(usize, u16),
    /// A function of red, green and blue, by index and band. The functions of green and blue may
    /// take one argument instead: their own band.
    Band(usize, usize),
    /// A function, or `0` for none.
    FunctionOrZero(usize, u16),
}

impl RootWord {
    fn index(self) -> usize {
        match self {
            RootWord::Expression(index)
            | RootWord::Function(index, _)
            | RootWord::Band(index, _)
            | RootWord::FunctionOrZero(index, _) => index,
        }
    }
}

/// The layout of the string arguments of a modifier with functions.
pub(super) struct CallForm<'a> {
    /// Index of the function file.
    pub(super) file: usize,
    pub(super) roots: &'a [RootWord],
}

impl Reader<'_> {
    /// Compiles the functions of a modifier. `None` after a mistake, which was reported.
    pub(super) fn call(&mut self, raw: &Raw, form: &CallForm<'_>) -> Option<FunctionCall> {
        let last = form.roots.iter().map(|root| root.index()).max().unwrap_or(0).max(form.file);
        if last >= raw.strings.len() {
            let name = self.scene.names.get(raw.name);
            let (kind, found) = (raw.kind, raw.strings.len());
            let message = format!("{kind} \"{name}\" has {found} string arguments, expected at least {}", last + 1);
            self.log.push(Diagnostic::error(message).at(raw.counts[0]));
            return None;
        }
        let (words, to_scene) = self.split_transform(raw, last + 1)?;
        let scope = self.function_file(&raw.strings[form.file])?;
        let program = self.program(raw, form.roots, &scope)?;
        Some(FunctionCall { program, to_scene, words, numbers: raw.reals.clone() })
    }

    /// The program of a modifier, compiled if necessary.
    fn program(&mut self, raw: &Raw, roots: &[RootWord], scope: &Scope) -> Option<Arc<Program>> {
        let key = FamilyKey::new(raw, roots, scope);
        let reals: Box<[u64]> = raw.reals.iter().map(|value| value.to_bits()).collect();
        let mut programs = self.functions.programs.remove(&key).unwrap_or_default();
        let program = match programs.compiled.get(&reals) {
            Some(program) => Some(Arc::clone(program)),
            None => self.compile(raw, roots, scope, &mut programs.family).map(|program| {
                let program = Arc::new(program);
                programs.compiled.insert(reals, Arc::clone(&program));
                program
            }),
        };
        self.functions.programs.insert(key, programs);
        program
    }

    /// Splits the string arguments into those before the transform and the transform, combined with
    /// the placement of the including files.
    pub(super) fn split_transform(&mut self, raw: &Raw, from: usize) -> Option<(Vec<String>, Transform)> {
        let rest = &raw.strings[from.min(raw.strings.len())..];
        let at = rest.iter().position(|word| begins_transform(&word.text)).unwrap_or(rest.len());
        if let [first, ..] = &rest[..at] {
            let last = &rest[at - 1];
            let message = format!("{} ignores \"{}\"", raw.kind, first.text);
            self.log.push(Diagnostic::warning(message).at(first.span.to(last.span)));
        }
        let words: Vec<&str> = rest[at..].iter().map(|word| &*word.text).collect();
        let read = transform_words::read(&words);
        if read.taken < words.len() {
            let (index, mistake) = match read.stopped {
                Some(stopped) => (stopped.index, stopped.mistake),
                None => (read.taken, format!("expected a transform option, found \"{}\"", words[read.taken])),
            };
            let span = rest[at..].get(index).or(rest.last()).map_or(raw.span, |word| word.span);
            self.log.push(Diagnostic::error(mistake).at(span).hint("a transform ends the string arguments"));
            return None;
        }
        let kept = raw.strings[..from + at].iter().map(|word| word.text.clone()).collect();
        Some((kept, read.transform.then(&raw.transform)))
    }

    /// Loads the definitions from [`super::ReadOptions::definitions`].
    fn define_given(&mut self) {
        let options = self.options;
        let mut definitions = Definitions::with_initial_library();
        for (name, text) in &options.definitions {
            let source = self.sources.add(name, Arc::clone(text), None);
            if let Err(mistakes) = definitions.load(source, text, &Scope::global()) {
                self.log.extend(mistakes);
            }
            self.log.extend(definitions.take_warnings());
        }
        self.functions.definitions = Some(definitions);
    }

    /// The scope of a function file, loaded at its first use.
    fn function_file(&mut self, file: &RawWord) -> Option<Scope> {
        let scope = Scope::of_file(&file.text);
        if self.functions.failed.contains(&scope) {
            return None;
        }
        if self.functions.definitions.is_none() {
            self.define_given();
        }
        let definitions = self.functions.definitions.get_or_insert_with(Definitions::with_initial_library);
        if definitions.is_loaded(&scope) {
            return Some(scope);
        }
        let built_in = radsight_cal::library::file(&file.text);
        let loaded = match (self.loader.load(&file.text, FileKind::Function), built_in) {
            (Ok(loaded), _) => Ok((loaded.path, loaded.bytes)),
            (Err(LoadError::NotFound { .. }), Some(text)) => Ok((file.text.clone(), text.as_bytes().to_vec())),
            (Err(error), _) => Err(Diagnostic::error(error.to_string()).at(file.span)),
        };
        let mistakes = match loaded {
            Ok((path, bytes)) => {
                let source = self.sources.add(path, bytes, Some(file.span));
                let text = Arc::clone(self.sources.text(source));
                let result = definitions.load(source, &text, &scope);
                self.log.extend(definitions.take_warnings());
                result.err().unwrap_or_default()
            }
            Err(error) => vec![error],
        };
        if mistakes.is_empty() {
            return Some(scope);
        }
        self.log.extend(mistakes);
        self.functions.failed.insert(scope);
        None
    }

    fn compile(&mut self, raw: &Raw, roots: &[RootWord], scope: &Scope, family: &mut Family) -> Option<Program> {
        for root in roots {
            if let RootWord::Band(index, band) = *root {
                self.define_band(&raw.strings[index], band, scope);
            }
        }
        let definitions =
            self.functions.definitions.as_ref().expect("the scope of a function file was returned a moment ago");
        let wrappers: Vec<Option<String>> = roots
            .iter()
            .map(|root| match *root {
                RootWord::Band(index, band) => {
                    let wrapper = band_name(&raw.strings[index].text, band);
                    definitions.function_arity(&wrapper, scope).map(|_| wrapper)
                }
                _ => None,
            })
            .collect();
        let compiled: Vec<Root<'_>> = roots
            .iter()
            .zip(&wrappers)
            .map(|(root, wrapper)| {
                let word = &raw.strings[root.index()];
                match *root {
                    RootWord::FunctionOrZero(..) if word.text == "0" => self.expression(word),
                    RootWord::Expression(_) => self.expression(word),
                    RootWord::Function(_, arity) | RootWord::FunctionOrZero(_, arity) => {
                        Root::Function { name: &word.text, arity, span: word.span }
                    }
                    RootWord::Band(..) => {
                        Root::Function { name: wrapper.as_deref().unwrap_or(&word.text), arity: 3, span: word.span }
                    }
                }
            })
            .collect();
        let bindings = Bindings { real_arguments: &raw.reals, ..Bindings::of_ray() };
        match family.program(definitions, scope, &compiled, &bindings) {
            Ok(program) => Some(program),
            Err(mistakes) => {
                let at_least =
                    |mistake: Diagnostic| if mistake.span.is_some() { mistake } else { mistake.at(raw.span) };
                self.log.extend(mistakes.into_iter().map(at_least));
                None
            }
        }
    }

    fn expression<'w>(&self, word: &'w RawWord) -> Root<'w> {
        // The text of a quoted word begins after its quote.
        let text = self.sources.text(word.span.source);
        let is_quoted = matches!(text.get(word.span.start as usize), Some(b'"' | b'\''));
        let span = Span { start: word.span.start + u32::from(is_quoted), ..word.span };
        Root::Expression { text: &word.text, span }
    }

    /// The functions of green and blue may take one argument, their own band, instead of three. All
    /// root functions of a picture or table take three, so this wraps a one-argument function.
    fn define_band(&mut self, word: &RawWord, band: usize, scope: &Scope) {
        let Some(definitions) = &mut self.functions.definitions else { return };
        let is_narrow = definitions.function_arity(&word.text, scope).is_some_and(|arity| arity < 3);
        let name = band_name(&word.text, band);
        if band == 0 || !is_narrow || definitions.function_arity(&name, scope).is_some() {
            return;
        }
        let text = format!("{name}(r,g,b) = {}({});", word.text, ["r", "g", "b"][band]);
        let source = self.sources.add("colour function", text.as_bytes(), Some(word.span));
        if let Err(mistakes) = definitions.load(source, text.as_bytes(), scope) {
            self.log.extend(mistakes);
        }
    }
}

fn band_name(function: &str, band: usize) -> String {
    format!("radsight_band{band}_{function}")
}
