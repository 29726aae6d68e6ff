//! Modifiers as written, kept until all texts are read and the used ones are known.

use super::materials::Lowered;
use super::reader::{Here, Reader};
use super::{Purpose, Tolerance, UnusedModifiers};
use crate::Kind;
use crate::signature::{Count, signature};
use crate::syntax::{Alias, Primitive, Word, words};
use radsight_diag::{Diagnostic, Severity, Span, hint_nearest};
use radsight_ir::{Material, Modifier, ModifierHandle, ModifierKind, NameId, Transform};
use std::collections::{HashMap, HashSet};

/// Identifies a modifier as written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct RawHandle(u32);

/// A modifier as written. Its names are resolved as they stood at that point of the text.
#[derive(Clone, Debug)]
pub(super) struct Raw {
    pub(super) kind: Kind,
    pub(super) name: NameId,
    /// The span of the whole primitive.
    pub(super) span: Span,
    /// The span of the type.
    pub(super) kind_span: Span,
    pub(super) parent: Option<RawHandle>,
    pub(super) strings: Vec<RawWord>,
    /// The real arguments after placement.
    pub(super) reals: Vec<f64>,
    /// The spans of the three counts.
    pub(super) counts: [Span; 3],
    /// For types that take a transform: the transform of the including texts.
    pub(super) transform: Transform,
    /// The modifiers named by string arguments, in order.
    pub(super) references: Vec<Reference>,
    /// The name of an alias's target.
    pub(super) original: Option<NameId>,
}

impl Raw {
    /// Whether it equals another definition, wherever that stands. Like Radiance, we keep the first
    /// of equal definitions: an array of files that define their own materials has each material
    /// once.
    fn does_the_same(&self, other: &Raw) -> bool {
        self.kind == other.kind
            && self.parent == other.parent
            && self.reals == other.reals
            && self.transform == other.transform
            && self.references == other.references
            && self.strings.iter().map(|word| &word.text).eq(other.strings.iter().map(|word| &word.text))
    }
}

/// A string argument.
#[derive(Clone, Debug)]
pub(super) struct RawWord {
    pub(super) text: String,
    pub(super) span: Span,
}

/// The modifier that a string argument names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reference {
    Void,
    /// `inherit`: the modifier of the primitive itself.
    Inherit,
    To(RawHandle),
    Undefined,
}

/// All modifiers, and the current meaning of each name.
#[derive(Default)]
pub(super) struct ModifierTable {
    raws: Vec<Raw>,
    names: HashMap<Vec<u8>, RawHandle>,
    /// Names that were undefined where they were used.
    undefined: Vec<(String, Span)>,
    /// The meanings of names before the open scope redefined them.
    hidden: Option<Vec<(Vec<u8>, Option<RawHandle>)>>,
    /// The last name looked up; neighbours in a file often share a modifier.
    last: Option<(Vec<u8>, RawHandle)>,
}

impl ModifierTable {
    pub(super) fn find(&mut self, name: &[u8]) -> Option<RawHandle> {
        if let Some((last, handle)) = &self.last
            && last == name
        {
            return Some(*handle);
        }
        let handle = *self.names.get(name)?;
        self.last = Some((name.to_vec(), handle));
        Some(handle)
    }

    fn set(&mut self, name: &[u8], handle: RawHandle) {
        let before = self.names.insert(name.to_vec(), handle);
        self.last = None;
        if let Some(hidden) = &mut self.hidden {
            hidden.push((name.to_vec(), before));
        }
    }

    /// Opens a scope: [`Self::close_scope`] forgets names defined from here on.
    pub(super) fn open_scope(&mut self) {
        self.hidden = Some(Vec::new());
    }

    /// Closes the scope: names mean again what they meant before.
    pub(super) fn close_scope(&mut self) {
        for (name, before) in self.hidden.take().into_iter().flatten().rev() {
            match before {
                Some(handle) => self.names.insert(name, handle),
                None => self.names.remove(&name),
            };
        }
        self.last = None;
    }

    fn add(&mut self, raw: Raw) -> RawHandle {
        self.raws.push(raw);
        RawHandle(self.raws.len() as u32 - 1)
    }

    fn undefined(&mut self, name: &[u8], span: Span) -> Diagnostic {
        const MOST_NAMES: usize = 20_000;
        // The search for similar names is slow, and a user reads few hints.
        const MOST_HINTS: usize = 100;
        let name = String::from_utf8_lossy(name);
        if self.undefined.len() < MOST_NAMES {
            self.undefined.push((name.clone().into_owned(), span));
        }
        let error = Diagnostic::error(format!("undefined modifier \"{name}\"")).at(span);
        if self.undefined.len() > MOST_HINTS {
            return error;
        }
        let known = self.names.keys().filter_map(|name| std::str::from_utf8(name).ok());
        let mut known: Vec<&str> = known.take(MOST_NAMES).collect();
        known.push("void");
        known.sort_unstable();
        error.maybe_hint(hint_nearest(&name, known))
    }
}

impl Reader<'_> {
    /// The modifier of a surface, after `-m`.
    pub(super) fn surface_modifier(&mut self, primitive: &Primitive<'_>, here: Here<'_>) -> Option<RawHandle> {
        match &here.context.placement.modifier {
            None => self.parent(&primitive.text(primitive.modifier), here.span(primitive.modifier.place())),
            Some(new) => {
                let span = new.span.unwrap_or(here.span(primitive.modifier.place()));
                self.parent(new.name.as_bytes(), span)
            }
        }
    }

    /// The modifier named before a type. Mistakes are reported and count as `void`.
    fn parent(&mut self, name: &[u8], span: Span) -> Option<RawHandle> {
        match name {
            b"void" => None,
            b"inherit" => {
                self.log.push(Diagnostic::error("\"inherit\" stands only before \"alias\"").at(span));
                None
            }
            _ => {
                let found = self.modifiers.find(name);
                if found.is_none() {
                    self.report_undefined(name, span, Severity::Error);
                }
                found
            }
        }
    }

    /// Defines a modifier other than an alias.
    pub(super) fn define(&mut self, primitive: &Primitive<'_>, here: Here<'_>) {
        let parent = self.parent(&primitive.text(primitive.modifier), here.span(primitive.modifier.place()));
        let name = primitive.text(primitive.name);
        if !self.is_good_name(&name, here.span(primitive.name.place())) || self.has_integers(primitive, here) {
            return;
        }
        let mut raw = self.raw(primitive, parent, here);
        raw.references = self.references(raw.kind, &raw.strings);
        if let Some(known) = self.modifiers.find(&name)
            && self.modifiers.raws[known.0 as usize].does_the_same(&raw)
        {
            return;
        }
        let handle = self.modifiers.add(raw);
        self.modifiers.set(&name, handle);
    }

    /// A primitive as written, after placement, with its string references unresolved.
    pub(super) fn raw(&mut self, primitive: &Primitive<'_>, parent: Option<RawHandle>, here: Here<'_>) -> Raw {
        let placement = &here.context.placement;
        let mut reals = Vec::with_capacity(primitive.reals.len());
        placement.reals(primitive.kind, primitive.reals, &mut reals);
        let strings = primitive.strings.iter().map(|&word| {
            let text = String::from_utf8_lossy(&primitive.text(word)).into_owned();
            let text = if primitive.kind == Kind::Mist { placement.mist_source(&text) } else { text };
            RawWord { text, span: here.span(word.place()) }
        });
        Raw {
            kind: primitive.kind,
            name: self.scene.names.add(&String::from_utf8_lossy(&primitive.text(primitive.name))),
            span: here.span(primitive.place()),
            kind_span: here.span(primitive.kind_word.place()),
            parent,
            strings: strings.collect(),
            reals,
            counts: primitive.counts.map(|count| here.span(count.place())),
            transform: if primitive.kind.takes_transform_words() { placement.transform } else { Transform::IDENTITY },
            references: Vec::new(),
            original: None,
        }
    }

    /// Defines another name: a copy of the target under the alias's modifier or the target's own.
    /// The copy has its own position in the order of modifiers, which decides between coincident
    /// surfaces.
    pub(super) fn define_alias(&mut self, alias: &Alias<'_>, here: Here<'_>) {
        let name = alias.text(alias.name);
        let target_name = alias.text(alias.target);
        let target_span = here.span(alias.target.place());
        let Some(target) = self.modifiers.find(&target_name) else {
            return self.report_undefined(&target_name, target_span, Severity::Error);
        };
        if !self.is_good_name(&name, here.span(alias.name.place())) {
            return;
        }
        let modifier = alias.text(alias.modifier);
        let parent = match &*modifier {
            b"inherit" => self.modifiers.raws[target.0 as usize].parent,
            other => self.parent(other, here.span(alias.modifier.place())),
        };
        let original = &self.modifiers.raws[target.0 as usize];
        let raw = Raw {
            name: self.scene.names.add(&String::from_utf8_lossy(&name)),
            span: here.span(alias.modifier.start..alias.target.end),
            parent,
            original: Some(original.original.unwrap_or(original.name)),
            ..original.clone()
        };
        let handle = self.modifiers.add(raw);
        self.modifiers.set(&name, handle);
    }

    fn is_good_name(&mut self, name: &[u8], span: Span) -> bool {
        let mistake = match name {
            b"void" | b"inherit" => {
                format!("a modifier cannot be called \"{}\"", String::from_utf8_lossy(name))
            }
            _ if name.contains(&b'\t') => "a name cannot hold a tab".to_owned(),
            _ => return true,
        };
        self.log.push(Diagnostic::error(mistake).at(span));
        false
    }

    /// Reports integer arguments, which no type takes.
    pub(super) fn has_integers(&mut self, primitive: &Primitive<'_>, here: Here<'_>) -> bool {
        let [_, count, _] = primitive.counts;
        if primitive.integers.is_empty() {
            return false;
        }
        let (kind, found) = (primitive.kind, primitive.integers.len());
        let message = format!("{kind} takes no integer arguments, found {found}");
        self.log.push(Diagnostic::error(message).at(here.span(count.place())));
        true
    }

    fn references(&mut self, kind: Kind, strings: &[RawWord]) -> Vec<Reference> {
        let naming: &[usize] = match kind {
            Kind::Illum | Kind::Mirror => &[0],
            Kind::MixFunc | Kind::MixData | Kind::MixPict | Kind::MixText => &[0, 1],
            Kind::WgmdFunc => &[0, 4, 8],
            Kind::Antimatter => return (0..strings.len()).map(|at| self.reference(kind, &strings[at])).collect(),
            _ => &[],
        };
        naming.iter().filter_map(|&at| strings.get(at)).map(|word| self.reference(kind, word)).collect()
    }

    fn reference(&mut self, kind: Kind, word: &RawWord) -> Reference {
        match &*word.text {
            "void" => return Reference::Void,
            "inherit" if kind == Kind::WgmdFunc => return Reference::Inherit,
            _ => {}
        }
        if let Some(handle) = self.modifiers.find(word.text.as_bytes()) {
            return Reference::To(handle);
        }
        // Radiance ignores a missing modifier in these types.
        let is_needless = matches!(kind, Kind::Illum | Kind::Mirror | Kind::Antimatter);
        let severity = if is_needless { Severity::Warning } else { Severity::Error };
        self.report_undefined(word.text.as_bytes(), word.span, severity);
        Reference::Undefined
    }

    /// Reports an undefined name, where it matters.
    fn report_undefined(&mut self, name: &[u8], span: Span, severity: Severity) {
        if self.options.purpose != Purpose::Bounds {
            let mut diagnostic = self.modifiers.undefined(name, span);
            diagnostic.severity = severity;
            self.log.push(diagnostic);
        }
    }

    /// Adds a hint where a name is defined after its use.
    fn explain_forward_references(&mut self) {
        let undefined: HashMap<Span, &String> =
            self.modifiers.undefined.iter().map(|(name, span)| (*span, name)).collect();
        for diagnostic in &mut self.log.diagnostics {
            let name = diagnostic.span.and_then(|span| undefined.get(&span));
            if let Some(name) = name.filter(|name| self.modifiers.names.contains_key(name.as_bytes())) {
                diagnostic.hints = vec![format!("\"{name}\" is defined further on, but must stand before its use")];
            }
        }
    }

    /// Puts the used modifiers into the scene and sets the handles of the surfaces.
    pub(super) fn lower_modifiers(&mut self) {
        self.explain_forward_references();
        let raws = std::mem::take(&mut self.modifiers.raws);
        let used = match (self.options.purpose, self.options.unused) {
            (Purpose::Octree | Purpose::Bounds, _) => vec![false; raws.len()],
            (Purpose::Render, UnusedModifiers::Lower) => vec![true; raws.len()],
            (Purpose::Render, UnusedModifiers::Skip) => self.used(&raws),
        };
        let replaced = self.find_replaced(&raws);
        let mut handles: Vec<Option<ModifierHandle>> = vec![None; raws.len()];
        for (index, raw) in raws.iter().enumerate() {
            if !used[index] {
                self.check_counts(raw, Severity::Warning);
                continue;
            }
            let at = |handle: RawHandle| handles[handle.0 as usize];
            let replacement = replaced.get(&index).map(|&at| self.replacements[at].clone());
            let kind = match replacement {
                Some(new) => Some(ModifierKind::Material(Material::Plugin {
                    library: new.library,
                    model: new.model,
                    words: new.words,
                    numbers: new.numbers,
                    tokens: new.tokens,
                })),
                None => self.lower_modifier(raw, &at),
            };
            handles[index] = kind.map(|kind| {
                let modifier = raw.parent.and_then(at);
                self.scene.modifiers.add(Modifier { name: raw.name, span: Some(raw.span), modifier, kind })
            });
            if let (Some(handle), Some(original)) = (handles[index], raw.original) {
                self.scene.originals.insert(handle, original);
            }
        }
        for (surface, raw) in self.scene.surfaces.items_mut().iter_mut().zip(&self.surface_modifiers) {
            surface.modifier = raw.and_then(|raw| handles[raw.0 as usize]);
        }
        self.finish_meshes(&|raw| handles[raw.0 as usize]);
    }

    /// Lowers one modifier. A tolerated mistake makes it [`radsight_ir::Material::Unusable`].
    fn lower_modifier(&mut self, raw: &Raw, at: &Lowered<'_>) -> Option<ModifierKind> {
        let messages = self.log.diagnostics.len();
        self.is_inexcusable = false;
        let kind = if self.check_counts(raw, Severity::Error) {
            self.check_ranges(raw);
            self.lower_kind(raw, at)
        } else {
            None
        };
        if kind.is_some() || self.is_inexcusable || self.options.tolerance == Tolerance::Strict {
            return kind;
        }
        let reason = self.log.tolerate_since(messages).unwrap_or_else(|| "a file it needs cannot be read".to_owned());
        Some(ModifierKind::Material(Material::Unusable { reason }))
    }

    /// Which modifiers are used by a surface, directly or through others. A modifier always stands
    /// after those it uses.
    fn used(&self, raws: &[Raw]) -> Vec<bool> {
        let mut used = vec![false; raws.len()];
        for handle in self.surface_modifiers.iter().flatten().chain(&self.materials_of_meshes()) {
            used[handle.0 as usize] = true;
        }
        for index in (0..raws.len()).rev() {
            if !used[index] {
                continue;
            }
            let raw = &raws[index];
            let references = raw.references.iter().filter_map(|reference| match reference {
                Reference::To(handle) => Some(handle),
                _ => None,
            });
            for handle in raw.parent.iter().chain(references) {
                used[handle.0 as usize] = true;
            }
        }
        used
    }

    /// Which modifiers `#@radsight brdf` and `--brdf` replace: from modifier index to replacement
    /// index.
    fn find_replaced(&mut self, raws: &[Raw]) -> HashMap<usize, usize> {
        let mut replaced = HashMap::new();
        for (at, replacement) in self.replacements.iter().enumerate() {
            let mut names = HashSet::new();
            for (index, raw) in raws.iter().enumerate() {
                let name = self.scene.names.get(raw.name);
                let original = raw.original.map(|original| self.scene.names.get(original));
                let is_meant = name == replacement.material || original == Some(&replacement.material);
                if is_meant && raw.kind.role() == crate::Role::Material {
                    replaced.insert(index, at);
                    self.replaced.insert(at);
                } else if raw.kind.role() == crate::Role::Material {
                    names.insert(name);
                }
            }
            if !self.replaced.contains(&at) && self.is_outermost() {
                let mut names: Vec<&str> = names.into_iter().collect();
                names.sort_unstable();
                let message = format!("no material \"{}\" to replace", replacement.material);
                let error = Diagnostic::error(message).maybe_hint(hint_nearest(&replacement.material, names));
                self.log.push(match replacement.span {
                    Some(span) => error.at(span),
                    None => error,
                });
            }
        }
        replaced
    }

    fn check_counts(&mut self, raw: &Raw, severity: Severity) -> bool {
        let expected = signature(raw.kind);
        let name = self.scene.names.get(raw.name);
        let mut is_right = true;
        let groups = [
            ("string", expected.strings, raw.strings.len(), raw.counts[0]),
            ("real", expected.reals, raw.reals.len(), raw.counts[2]),
        ];
        for (group, right, found, span) in groups {
            let (kind, plural) = (raw.kind, if found == 1 { "" } else { "s" });
            if !right.allows(found) {
                let message = format!("{kind} \"{name}\" has {found} {group} argument{plural}, expected {right}");
                let error = Diagnostic::error(message).at(span);
                let mut error = error.maybe_hint(expected.hint().filter(|_| group == "real"));
                error.severity = severity;
                self.log.push(error);
                is_right = false;
            } else if right == Count::Ignored && found > 0 && !takes_some_strings(raw.kind, found) {
                let message = format!("{kind} \"{name}\" ignores its {found} {group} argument{plural}");
                self.log.push(Diagnostic::warning(message).at(span));
            }
        }
        is_right
    }

    fn check_ranges(&mut self, raw: &Raw) {
        for (index, (argument, value)) in signature(raw.kind).arguments.iter().zip(&raw.reals).enumerate() {
            if !argument.range.holds(*value) {
                let (name, kind) = (self.scene.names.get(raw.name), raw.kind);
                let message = format!(
                    "the {} of {kind} \"{name}\" is {value}, expected {}",
                    argument.name,
                    argument.range.words()
                );
                let span = self.real_span(raw, index);
                self.log.push(Diagnostic::warning(message).at(span));
            }
        }
    }

    /// The span of a real argument.
    pub(super) fn real_span(&self, raw: &Raw, index: usize) -> Span {
        let count = raw.counts[2];
        let text = self.sources.text(count.source);
        let rest = text.get(count.end as usize..).unwrap_or_default();
        let word: Option<Word> = words(rest, count.end).nth(index);
        word.map_or(count, |word| Span { source: count.source, start: word.start, end: word.end })
    }
}

/// Types whose string arguments may be omitted but have a meaning.
fn takes_some_strings(kind: Kind, found: usize) -> bool {
    matches!(kind, Kind::Illum | Kind::Mirror) && found == 1
}
