//! Commands in scene text, and the texts that they include.

use super::reader::{Context, Here, Reader};
use crate::commands::{DirectoryLoader, command_line, directory_of};
use crate::placement::NewModifier;
use crate::syntax::{Document, Place};
use crate::xform::{Copy, Event, MAX_COPIES, is_xform, run_xform, visit_copies};
use radsight_diag::{Diagnostic, SourceId, Span};
use radsight_loader::{FileKind, LoadError, Loaded, Loader};
use radsight_scene_generators::shell_words::{Stage, Word, expanded, split};
use radsight_scene_generators::{Error, PipelineError};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;
use std::sync::{Arc, PoisonError, RwLock};

/// Largest depth of inclusion.
const MAX_DEPTH: usize = 64;

/// Depth of inclusion beyond which the number of readings is limited. Ordinary scenes stay below
/// it, however many copies they place.
const DEEP: usize = 8;

/// Largest number of readings beyond depth [`DEEP`]. Each reading may include others, so the work
/// could double at each level.
const MOST_DEEP_READINGS: usize = 1 << 16;

/// Serves the files that commands of the scene wrote, then those of the user's loader.
pub(super) struct SceneLoader<'a> {
    loader: &'a dyn Loader,
    written: RwLock<HashMap<String, Vec<u8>>>,
}

impl<'a> SceneLoader<'a> {
    pub(super) fn new(loader: &'a dyn Loader) -> Self {
        SceneLoader { loader, written: RwLock::default() }
    }

    fn write(&self, files: Vec<(String, Vec<u8>)>) {
        self.written.write().unwrap_or_else(PoisonError::into_inner).extend(files);
    }
}

impl Loader for SceneLoader<'_> {
    fn load(&self, name: &str, kind: FileKind) -> Result<Loaded, LoadError> {
        let written = self.written.read().unwrap_or_else(PoisonError::into_inner);
        match written.get(name) {
            Some(bytes) => Ok(Loaded { path: name.to_owned(), bytes: bytes.clone() }),
            None => self.loader.load(name, kind),
        }
    }

    fn written(&self, name: &str) -> Option<Vec<u8>> {
        let written = self.written.read().unwrap_or_else(PoisonError::into_inner);
        written.get(name).cloned().or_else(|| self.loader.written(name))
    }

    fn names_like(&self, pattern: &str) -> Vec<String> {
        self.loader.names_like(pattern)
    }

    fn run_program(&self, argv: &[String], standard_input: Option<&[u8]>) -> Option<Result<Vec<u8>, LoadError>> {
        self.loader.run_program(argv, standard_input)
    }

    fn run_command(&self, command: &str, standard_input: Option<&[u8]>) -> Result<Vec<u8>, LoadError> {
        self.loader.run_command(command, standard_input)
    }
}

/// Largest total size of all included texts, bytes.
const MOST_BYTES: usize = 4 << 30;

/// The included texts, and the stack of texts being read.
#[derive(Default)]
pub(super) struct Inclusions {
    texts: HashMap<TextKey, Text>,
    /// The texts being read, outermost first.
    active: Vec<TextKey>,
    /// Texts that include themselves. They are not read again, since the number of paths through a
    /// cycle is unbounded.
    cyclic: HashSet<TextKey>,
    readings: usize,
    deep_readings: usize,
    bytes: usize,
}

/// A file or a command, with the directory from which it was requested.
#[derive(Clone, PartialEq, Eq, Hash)]
struct TextKey {
    directory: String,
    /// A file's name, or a command after `!`.
    name: String,
}

struct Text {
    bytes: Arc<[u8]>,
    path: String,
    /// The source under which the text was first read.
    first: Option<SourceId>,
    document: Option<Rc<Document>>,
}

/// A command line and its position.
struct CommandLine {
    line: String,
    source: SourceId,
    /// Offset of the byte after the `!`.
    start: u32,
}

impl CommandLine {
    fn span(&self, range: Range<usize>) -> Span {
        let offset = |at: usize| self.start + at.min(self.line.len()) as u32;
        Span { source: self.source, start: offset(range.start), end: offset(range.end.max(range.start)) }
    }

    fn whole(&self) -> Span {
        self.span(0..self.line.len())
    }
}

/// How often a text is likely to be read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Readings {
    One,
    Many,
}

/// A call of `xform` at the end of a command line.
struct XformCall {
    words: Vec<Word>,
    /// The commands before it, whose output it reads.
    before: Option<String>,
    /// The file that it reads.
    input: Option<Word>,
}

impl XformCall {
    fn find(line: &str) -> Option<XformCall> {
        let mut script = split(line).ok()?;
        let mut pipeline = script.pipelines.pop().filter(|_| script.pipelines.is_empty())?;
        let Some(Stage::Command(last)) = pipeline.stages.pop() else { return None };
        let name = last.words.first().filter(|name| is_xform(&name.text))?;
        let before = (!pipeline.stages.is_empty()).then(|| before_pipe(&line[..name.range.start]).to_owned());
        Some(XformCall { words: last.words, before, input: last.input })
    }

    /// How often the files are likely to be read.
    fn readings(&self) -> Readings {
        let is_array = self.words.iter().any(|word| word.text == "-a" || word.text == "-f");
        if is_array { Readings::Many } else { Readings::One }
    }
}

impl Reader<'_> {
    /// Reads the output of a `!` line in its place.
    pub(super) fn command(&mut self, place: Place, here: Here<'_>) {
        let text = Arc::clone(self.sources.text(here.source));
        let line = command_line(&text[place.start as usize..place.end as usize]);
        let command = CommandLine { line, source: here.source, start: place.start + 1 };
        if let Some(call) = XformCall::find(&command.line) {
            return self.place_copies(call, &command, here);
        }
        let key = TextKey { directory: here.context.directory.clone(), name: format!("!{}", command.line) };
        if self.run(&key, &command.line, &command) {
            let source = self.source_of(&key, &format!("!{}", command.line.trim()), command.whole());
            self.include(&key, source, here.context, command.whole(), Readings::One);
        }
    }

    /// Applies `xform` without writing and parsing text.
    fn place_copies(&mut self, call: XformCall, command: &CommandLine, here: Here<'_>) {
        let directory = here.context.directory.clone();
        let shared = Rc::clone(&self.loader);
        let loader = DirectoryLoader { directory: directory.clone(), loader: &*shared };
        let call = &XformCall { words: expanded(&call.words, &loader), ..call };
        let standard_input = match (&call.before, &call.input) {
            (_, Some(file)) => {
                let key = TextKey { directory, name: file.text.clone() };
                self.load(&key, &loader, command.span(file.range.clone())).then_some(key)
            }
            (Some(before), None) => {
                let key = TextKey { directory, name: format!("!{before}") };
                self.run(&key, before, command).then_some(key)
            }
            (None, None) => None,
        };
        if standard_input.is_none() && (call.before.is_some() || call.input.is_some()) {
            return;
        }
        let bytes = standard_input.as_ref().map(|key| Arc::clone(&self.inclusions.texts[key].bytes));
        let argv: Vec<String> = call.words.iter().map(|word| word.text.clone()).collect();
        let mut readings = HashMap::new();
        let result = visit_copies(&argv, &bytes.as_deref().unwrap_or_default(), &loader, &mut |event| {
            let Event::Copy(copy) = event else { return Ok(()) };
            let placed = PlacedCopy { copy, call, command, standard_input: standard_input.as_ref() };
            self.place_copy(&placed, &loader, here, &mut readings)
        });
        if let Err(error) = result
            && !is_already_reported(&error)
        {
            let range = word_range(&call.words, error.argument());
            self.report_failure(&error, command.span(range));
        }
    }

    /// Reports a failed command. Its output is empty and reading continues; a command that is not
    /// permitted is an error.
    fn report_failure(&mut self, error: &Error, span: Span) {
        let may_not_run = match error {
            Error::Load(error) => matches!(error, LoadError::CommandRefused { .. }),
            Error::Syntax(_) => true,
            _ => error.is_limit(),
        };
        let diagnostic = command_error(error, span);
        if may_not_run { self.log.push(diagnostic) } else { self.push_tolerated(diagnostic) }
    }

    /// Places one copy of all the files. An error ends the array.
    fn place_copy(
        &mut self,
        placed: &PlacedCopy<'_>,
        loader: &DirectoryLoader<'_>,
        here: Here<'_>,
        readings: &mut HashMap<TextKey, SourceId>,
    ) -> Result<(), Error> {
        let PlacedCopy { copy, call, command, standard_input } = placed;
        let mut placement = copy.placement.clone();
        if let (Some(NewModifier { span, .. }), Some(origin)) = (&mut placement.modifier, copy.modifier_origin) {
            *span = Some(command.span(word_range(&call.words, Some(origin))));
        }
        let placement = placement.then(&here.context.placement);
        let expected = call.readings();
        if copy.files.is_empty() {
            let Some(key) = standard_input else {
                let missing = "xform names no file to read";
                self.push_tolerated(Diagnostic::error(missing).at(command.whole()));
                return Err(already_reported());
            };
            let context = Context::new(placement, here.context.directory.clone());
            self.include_reading(key, &context, command.whole(), expected, readings);
            return self.unless_stopped();
        }
        for (name, origin) in &copy.files {
            let span = command.span(word_range(&call.words, Some(*origin)));
            let key = TextKey { directory: here.context.directory.clone(), name: name.clone() };
            if !self.load(&key, loader, span) {
                return Err(already_reported());
            }
            let path = &self.inclusions.texts[&key].path;
            let directory = if copy.runs_commands { directory_of(path) } else { here.context.directory.clone() };
            let context = Context::new(placement.clone(), directory);
            self.include_reading(&key, &context, span, expected, readings);
        }
        self.unless_stopped()
    }

    fn unless_stopped(&self) -> Result<(), Error> {
        if self.is_stopped { Err(already_reported()) } else { Ok(()) }
    }

    /// Includes a text. All copies of one array share a source.
    fn include_reading(
        &mut self,
        key: &TextKey,
        context: &Context,
        span: Span,
        expected: Readings,
        readings: &mut HashMap<TextKey, SourceId>,
    ) {
        let source = match readings.get(key) {
            Some(source) => *source,
            None => {
                let name = self.inclusions.texts[key].path.clone();
                let source = self.source_of(key, &name, span);
                readings.insert(key.clone(), source);
                source
            }
        };
        self.include(key, source, context, span, expected);
    }

    /// Reads a text in place of the line that requested it.
    fn include(&mut self, key: &TextKey, source: SourceId, context: &Context, span: Span, expected: Readings) {
        if self.inclusions.active.contains(key) {
            let message = format!("\"{}\" includes itself", key.name);
            self.inclusions.cyclic.extend(self.inclusions.active.iter().skip_while(|other| *other != key).cloned());
            return self.log.push(Diagnostic::error(message).at(span));
        }
        if self.inclusions.cyclic.contains(key) {
            return;
        }
        self.inclusions.readings += 1;
        if self.inclusions.readings > MAX_COPIES {
            let message = format!("the scene includes files and commands more than {MAX_COPIES} times");
            return self.stop(Diagnostic::error(message).at(span));
        }
        if self.inclusions.active.len() >= MAX_DEPTH {
            let message = format!("files and commands include each other more than {MAX_DEPTH} deep");
            return self.stop(Diagnostic::error(message).at(span));
        }
        self.inclusions.deep_readings += usize::from(self.inclusions.active.len() >= DEEP);
        if self.inclusions.deep_readings > MOST_DEEP_READINGS {
            let message = format!(
                "files and commands that include each other more than {DEEP} deep are read more than {MOST_DEEP_READINGS} times"
            );
            return self.stop(Diagnostic::error(message).at(span));
        }
        let Some(text) = self.inclusions.texts.get_mut(key) else { return };
        let is_again = text.first != Some(source);
        if text.document.is_none() && (expected == Readings::Many || is_again) {
            text.document = Some(Rc::new(Document::parse(Arc::clone(&text.bytes))));
        }
        let document = text.document.clone();
        self.inclusions.active.push(key.clone());
        let here = Here { source, context };
        match document {
            Some(document) => self.walk_document(&document, here),
            None => self.walk(here),
        }
        self.inclusions.active.pop();
    }

    /// A new source for another reading of a text.
    fn source_of(&mut self, key: &TextKey, name: &str, span: Span) -> SourceId {
        let text = self.inclusions.texts.get_mut(key).expect("the text was loaded just before");
        let source = self.sources.add(name, Arc::clone(&text.bytes), Some(span));
        match text.first {
            Some(first) => self.log.same_text(source, first),
            None => text.first = Some(source),
        }
        source
    }

    /// Reads a file that an octree names. Unlike a failed command, a missing file is an error: the
    /// octree would not be the one that was compiled.
    pub(super) fn include_file(&mut self, name: &str, context: &Context, span: Span) {
        let key = TextKey { directory: context.directory.clone(), name: name.to_owned() };
        if !self.inclusions.texts.contains_key(&key) {
            let is_kept = match self.loader.load(name, FileKind::Scene) {
                Ok(loaded) => self.keep(&key, loaded.bytes, loaded.path, span),
                Err(error) => {
                    self.log.push(load_error(&error, span));
                    false
                }
            };
            if !is_kept {
                return;
            }
        }
        let path = self.inclusions.texts[&key].path.clone();
        let source = self.source_of(&key, &path, span);
        self.include(&key, source, context, span, Readings::One);
    }

    /// Counts bytes of included texts. Reading stops when the limit is exceeded.
    pub(super) fn count_bytes(&mut self, count: usize, span: Option<Span>) -> bool {
        self.inclusions.bytes = self.inclusions.bytes.saturating_add(count);
        let is_right = self.inclusions.bytes <= MOST_BYTES;
        if !is_right {
            let message = format!("the files and commands of the scene yield more than {MOST_BYTES} bytes");
            let error = Diagnostic::error(message);
            self.stop(span.map_or(error.clone(), |span| error.at(span)));
        }
        is_right
    }

    /// Loads a file unless it was loaded before.
    fn load(&mut self, key: &TextKey, loader: &dyn Loader, span: Span) -> bool {
        if self.inclusions.texts.contains_key(key) {
            return true;
        }
        match loader.load(&key.name, FileKind::Scene) {
            Ok(loaded) => self.keep(key, loaded.bytes, loaded.path, span),
            Err(error) => {
                self.report_failure(&Error::Load(error), span);
                false
            }
        }
    }

    /// Runs a command unless it was run before.
    fn run(&mut self, key: &TextKey, line: &str, command: &CommandLine) -> bool {
        if self.inclusions.texts.contains_key(key) {
            return true;
        }
        let shared = Rc::clone(&self.loader);
        let loader = DirectoryLoader { directory: key.directory.clone(), loader: &*shared };
        let result = radsight_scene_generators::pipeline(line, &loader, &|argv, standard_input| {
            is_xform(&argv[0]).then(|| run_xform(argv, &standard_input.unwrap_or_default(), &loader, 1))
        });
        match result {
            Ok(output) => {
                let warn = |warning: String| Diagnostic::warning(warning).at(command.whole());
                self.log.extend(output.warnings.into_iter().map(warn));
                self.loader.write(output.files);
                self.keep(key, output.standard_output, key.name.clone(), command.whole())
            }
            Err(PipelineError { range, error }) => {
                self.report_failure(&error, command.span(range));
                false
            }
        }
    }

    fn keep(&mut self, key: &TextKey, bytes: Vec<u8>, path: String, span: Span) -> bool {
        if !self.count_bytes(bytes.len(), Some(span)) {
            return false;
        }
        let text = Text { bytes: Arc::from(bytes), path, first: None, document: None };
        self.inclusions.texts.insert(key.clone(), text);
        true
    }
}

/// The data needed to place one copy.
struct PlacedCopy<'a> {
    copy: &'a Copy,
    call: &'a XformCall,
    command: &'a CommandLine,
    standard_input: Option<&'a TextKey>,
}

/// A command line up to its last pipe, if only white space and continuation lines follow that.
fn before_pipe(line: &str) -> &str {
    let without_blank = |text| {
        let mut text: &str = text;
        loop {
            let shorter = text.trim_end();
            let is_continued = shorter.ends_with('\\') && text[shorter.len()..].starts_with('\n');
            text = if is_continued { &shorter[..shorter.len() - 1] } else { shorter };
            if !is_continued {
                return text;
            }
        }
    };
    let text = without_blank(line);
    without_blank(text.strip_suffix('|').unwrap_or(text))
}

/// An error that ends an array and is not printed, because it was reported already.
fn already_reported() -> Error {
    Error::Impossible { program: "xform".to_owned(), mistake: String::new() }
}

fn is_already_reported(error: &Error) -> bool {
    matches!(error, Error::Impossible { mistake, .. } if mistake.is_empty())
}

/// The range of a word, or of the last word if the index is missing.
fn word_range(words: &[Word], index: Option<usize>) -> Range<usize> {
    let index = index.unwrap_or(0);
    match (words.get(index), words.last()) {
        (Some(word), _) | (None, Some(word)) => word.range.clone(),
        (None, None) => 0..0,
    }
}

fn command_error(error: &Error, span: Span) -> Diagnostic {
    match error {
        Error::Load(error) => load_error(error, span),
        Error::Syntax(error) if error.needs_shell() => {
            Diagnostic::error(error.to_string()).at(span).hint(ALLOW_COMMANDS)
        }
        _ => {
            let text = error.to_string();
            let (message, usage) = text.split_once('\n').map_or((&*text, None), |(first, rest)| (first, Some(rest)));
            Diagnostic::error(message).at(span).maybe_hint(usage.map(str::to_owned))
        }
    }
}

const ALLOW_COMMANDS: &str = "external commands run only with --allow-commands";

fn load_error(error: &LoadError, span: Span) -> Diagnostic {
    let diagnostic = Diagnostic::error(error.to_string()).at(span);
    match error {
        LoadError::CommandRefused { command } => {
            let program = command.split_whitespace().next().unwrap_or_default();
            let nearest = radsight_diag::hint_nearest(
                program,
                radsight_scene_generators::names().iter().copied().chain(["xform"]),
            );
            diagnostic.maybe_hint(nearest).hint(ALLOW_COMMANDS)
        }
        _ => diagnostic,
    }
}
