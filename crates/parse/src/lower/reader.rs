//! Walks over the texts of a scene and passes each item to its handler.

use super::functions::Functions;
use super::include::{Inclusions, SceneLoader};
use super::log::Log;
use super::meshes::Meshes;
use super::modifiers::{ModifierTable, RawHandle};
use super::numbering::Numberer;
use super::octrees::Octrees;
use super::{BrdfReplacement, Input, KeepPrimitives, Purpose, Read, ReadOptions, Tolerance};
use crate::Role;
use crate::placement::Placement;
use crate::syntax::{Document, Item, Items, Place, SyntaxError, words};
use radsight_diag::{Diagnostic, Severity, SourceId, SourceMap, Span, hint_nearest};
use radsight_formats::Octree;
use radsight_ir::{BsdfData, DataGrid, Font, Handle, PictureData, Scene};
use radsight_loader::{FileKind, Loader};
use radsight_measured::MeasuredBsdf;
use radsight_picture::Header;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;
use std::sync::Arc;

/// The state of reading and its results so far.
pub(super) struct Reader<'a> {
    pub(super) loader: Rc<SceneLoader<'a>>,
    pub(super) options: &'a ReadOptions,
    pub(super) sources: SourceMap,
    pub(super) scene: Scene,
    pub(super) log: Log,
    pub(super) modifiers: ModifierTable,
    /// The modifier of each surface. Handles are assigned when all texts are read.
    pub(super) surface_modifiers: Vec<Option<RawHandle>>,
    pub(super) inclusions: Inclusions,
    pub(super) functions: Functions,
    /// Tables by file name; `None` for those that could not be read.
    pub(super) grids: HashMap<String, Option<Handle<DataGrid>>>,
    /// Pictures, likewise.
    pub(super) pictures: HashMap<String, Option<Handle<PictureData>>>,
    /// Fonts, likewise.
    pub(super) fonts: HashMap<String, Option<Handle<Font>>>,
    /// BSDFs, likewise.
    pub(super) bsdfs: HashMap<String, Option<Handle<BsdfData>>>,
    /// BSDF files of all scenes.
    pub(super) bsdf_files: HashMap<String, Option<Arc<MeasuredBsdf>>>,
    pub(super) meshes: Meshes,
    pub(super) octrees: Octrees,
    pub(super) numberer: Numberer,
    /// The headers of octrees among the inputs.
    pub(super) history: Header,
    pub(super) replacements: Vec<BrdfReplacement>,
    /// Indices of the replacements that found their material.
    pub(super) replaced: HashSet<usize>,
    /// The modifier being lowered has a mistake that is never tolerated: its type is not supported
    /// yet, or its file was never written.
    pub(super) is_inexcusable: bool,
    /// A limit was exceeded: reading stops.
    pub(super) is_stopped: bool,
    /// Long texts to be dropped at the end.
    pub(super) long_texts: Vec<SourceId>,
    /// Names of empty inputs that were refused.
    refused_empty: Vec<String>,
    /// Reused for the placed arguments of surfaces.
    pub(super) placed: Vec<f64>,
}

/// How the items of a text are placed.
pub(super) struct Context {
    pub(super) placement: Placement,
    /// Whether the placement changes no numbers.
    pub(super) is_plain: bool,
    /// The directory that commands search first.
    pub(super) directory: String,
}

impl Context {
    pub(super) fn new(placement: Placement, directory: String) -> Self {
        Context { is_plain: placement.keeps_numbers(), placement, directory }
    }
}

/// The text that is being read.
#[derive(Clone, Copy)]
pub(super) struct Here<'c> {
    pub(super) source: SourceId,
    pub(super) context: &'c Context,
}

impl Here<'_> {
    pub(super) fn span(&self, place: Place) -> Span {
        Span { source: self.source, start: place.start, end: place.end }
    }
}

impl<'a> Reader<'a> {
    pub(super) fn new(loader: &'a dyn Loader, options: &'a ReadOptions) -> Self {
        let modifiers = (options.primitives == KeepPrimitives::Yes).then(HashMap::new);
        Reader {
            loader: Rc::new(SceneLoader::new(loader)),
            options,
            sources: SourceMap::default(),
            scene: Scene::default(),
            log: Log::default(),
            modifiers: ModifierTable::default(),
            surface_modifiers: Vec::new(),
            inclusions: Inclusions::default(),
            functions: Functions::default(),
            grids: HashMap::new(),
            pictures: HashMap::new(),
            fonts: HashMap::new(),
            bsdfs: HashMap::new(),
            bsdf_files: HashMap::new(),
            meshes: Meshes::default(),
            octrees: Octrees::default(),
            numberer: Numberer { modifiers, ..Numberer::default() },
            history: Header::default(),
            replacements: options.brdf.clone(),
            replaced: HashSet::new(),
            is_inexcusable: false,
            is_stopped: false,
            long_texts: Vec::new(),
            refused_empty: Vec::new(),
            placed: Vec::new(),
        }
    }

    pub(super) fn read_input(&mut self, input: &Input) {
        let context = Context::new(Placement::default(), String::new());
        match input {
            Input::Text { name, text } => self.read_whole(name, text),
            Input::File(line) if line.starts_with('!') => {
                let source = self.sources.add("command line", line.as_bytes(), None);
                self.command(0..line.len() as u32, Here { source, context: &context });
            }
            Input::File(name) => match self.loader.load(name, FileKind::Scene) {
                Ok(loaded) => self.read_whole(&loaded.path, &loaded.bytes.into()),
                Err(error) => self.log.push(Diagnostic::error(error.to_string())),
            },
        }
    }

    /// Reads a whole file: scene text or an octree.
    fn read_whole(&mut self, name: &str, bytes: &Arc<[u8]>) {
        if Octree::is_octree(bytes) {
            return self.read_octree(name, bytes);
        }
        let context = Context::new(Placement::default(), String::new());
        let source = self.sources.add(name, Arc::clone(bytes), None);
        self.walk(Here { source, context: &context });
    }

    /// Reports empty inputs of a renderer: they are what a failed `oconv` leaves behind. Call it before
    /// they are read, so that they are not reported twice.
    pub(super) fn refuse_empty_files(&mut self, inputs: &[Input]) {
        if self.options.purpose != Purpose::Render {
            return;
        }
        let is_octree = |name: &str| name.ends_with(".oct");
        let empty: Vec<&str> = inputs
            .iter()
            .filter_map(|input| match input {
                Input::Text { name, text } if text.is_empty() => Some(&**name),
                _ => None,
            })
            .collect();
        let is_all = empty.len() == inputs.len();
        for name in empty.into_iter().filter(|name| is_all || is_octree(name)) {
            let error = Diagnostic::error(format!("\"{name}\" is empty: neither an octree nor a scene"));
            self.log.push(error.hint("the program that should have written it has failed"));
            self.refused_empty.push(name.to_owned());
        }
    }

    /// Reads a text from start to end.
    pub(super) fn walk(&mut self, here: Here<'_>) {
        let text = Arc::clone(self.sources.text(here.source));
        if text.len() > self.options.longest_kept_text {
            self.long_texts.push(here.source);
        }
        let mut items = match Items::new(&text) {
            Ok(items) => items,
            Err(error) => return self.log.push(error.diagnostic(here.source)),
        };
        let mut is_empty = true;
        while let Some(item) = items.advance() {
            is_empty &= matches!(item, Ok(Item::Comment(_)));
            self.item(item, here);
            if self.is_stopped {
                return;
            }
        }
        if is_empty {
            self.warn_of_empty(here);
        }
    }

    /// Reads a text that was parsed before.
    pub(super) fn walk_document(&mut self, document: &Document, here: Here<'_>) {
        let mut is_empty = true;
        for item in document.items() {
            is_empty &= matches!(item, Ok(Item::Comment(_)));
            self.item(item, here);
            if self.is_stopped {
                return;
            }
        }
        if is_empty {
            self.warn_of_empty(here);
        }
    }

    fn warn_of_empty(&mut self, here: Here<'_>) {
        let name = self.sources.name(here.source).to_owned();
        if self.refused_empty.contains(&name) {
            return;
        }
        let warning = Diagnostic::warning(format!("\"{name}\" is empty"));
        self.log.push(match self.sources.included_at(here.source) {
            Some(span) => warning.at(span),
            None => warning,
        });
    }

    pub(super) fn item(&mut self, item: Result<Item<'_>, SyntaxError>, here: Here<'_>) {
        match item {
            Ok(Item::Primitive(primitive)) => {
                self.number_primitive(&primitive, here);
                match primitive.kind.role() {
                    Role::Surface => self.surface(&primitive, here),
                    Role::Volume => self.volume(&primitive, here),
                    _ => self.define(&primitive, here),
                }
            }
            Ok(Item::Alias(alias)) => {
                self.number_alias(&alias);
                self.define_alias(&alias, here);
            }
            Ok(Item::Command(place)) => self.command(place, here),
            Ok(Item::Comment(place)) => self.comment(place, here),
            Err(error) => self.log.push(error.diagnostic(here.source)),
        }
    }

    /// Reads a directive: a comment that begins with `#@radsight`.
    fn comment(&mut self, place: Place, here: Here<'_>) {
        const MARK: &[u8] = b"#@radsight";
        let text = Arc::clone(self.sources.text(here.source));
        let Some(rest) = text[place.start as usize..place.end as usize].strip_prefix(MARK) else { return };
        let start = place.end - rest.len() as u32;
        let words: Vec<(String, Span)> = words(rest, start)
            .map(|word| (String::from_utf8_lossy(&word.of(&text)).into_owned(), here.span(word.place())))
            .collect();
        let span = here.span(place);
        match words.split_first() {
            Some(((verb, _), arguments)) if verb == "brdf" => self.replace_material(arguments, span),
            other => {
                let verb = other.map_or("", |((verb, _), _)| verb);
                let warning = Diagnostic::warning(format!("unknown directive \"{verb}\" is ignored")).at(span);
                self.log.push(warning.maybe_hint(hint_nearest(verb, ["brdf"])));
            }
        }
    }

    /// `#@radsight brdf material library model numbers…`
    fn replace_material(&mut self, arguments: &[(String, Span)], span: Span) {
        let texts = arguments.iter().map(|(text, _)| &**text);
        match BrdfReplacement::from_words(texts) {
            Ok(replacement) => {
                // The same line comes again when its file is read again.
                let asks_the_same = |other: &BrdfReplacement| {
                    BrdfReplacement { span: None, tokens: Vec::new(), ..other.clone() } == replacement
                };
                if !self.replacements.iter().any(asks_the_same) {
                    let tokens = arguments.iter().skip(1).map(|(_, span)| *span).collect();
                    self.replacements.push(BrdfReplacement { span: Some(span), tokens, ..replacement });
                }
            }
            Err(mistake) => {
                let form = "the form is: #@radsight brdf material library model numbers…";
                self.log.push(Diagnostic::error(mistake).at(span).hint(form));
            }
        }
    }

    /// Reports an error that real Radiance only warns of, or does not find before a ray meets it.
    pub(super) fn push_tolerated(&mut self, mut error: Diagnostic) {
        if self.options.tolerance == Tolerance::AsRadiance {
            error.severity = error.severity.min(Severity::Warning);
        }
        self.log.push(error);
    }

    /// Stops reading after a limit was exceeded.
    pub(super) fn stop(&mut self, diagnostic: Diagnostic) {
        if !self.is_stopped {
            self.log.push(diagnostic);
        }
        self.is_stopped = true;
    }

    pub(super) fn finish(mut self) -> Read {
        self.lower_modifiers();
        let Log { diagnostics, omitted, .. } = self.log;
        for source in self.long_texts {
            if !diagnostics.iter().any(|diagnostic| diagnostic.span.is_some_and(|span| span.source == source)) {
                self.sources.forget_text(source);
            }
        }
        let numbering = self.numberer.numbering;
        Read { scene: self.scene, sources: self.sources, numbering, history: self.history, diagnostics, omitted }
    }
}
