//! Names, the scopes they belong to, and what they mean.
//!
//! A name defined in a function file belongs to that file: inside, `x` is stored as ``x`file``. A name that is used means the
//! innermost one that is known at that moment: the file's own, else the global one; a name that is nowhere known becomes the
//! file's own, to be defined later. ``x` `` (mark behind) is always the global `x`, and `` `x`` (mark before) always the file's.

use crate::builtin::Builtin;
use crate::lexer::SCOPE_MARK;
use crate::syntax::Body;
use radsight_diag::Span;
use std::collections::HashMap;
use std::sync::Arc;

/// The longest scope, in bytes.
const LONGEST_SCOPE: usize = 1023;

/// A symbol of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct SymbolId(pub(crate) u32);

/// Where names are looked up first: a function file, or nowhere but among the global names.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Scope(String);

impl Scope {
    /// No file: only global names.
    #[must_use]
    pub fn global() -> Scope {
        Scope::default()
    }

    /// The scope of a function file, by the name that a primitive gives. `.` means no file; a suffix `.cal` goes; whatever
    /// cannot stand in a name becomes `_`.
    #[must_use]
    pub fn of_file(name: &str) -> Scope {
        if name == "." {
            return Scope::global();
        }
        let suffix = name.len().checked_sub(4).filter(|&at| at > 0).and_then(|at| name.get(at..));
        let stem = match suffix {
            Some(suffix) if suffix.eq_ignore_ascii_case(".cal") => &name[..name.len() - 4],
            _ => name,
        };
        let stem = stem.trim_matches(char::from(SCOPE_MARK));
        if stem.is_empty() {
            return Scope::global();
        }
        let mut path = String::with_capacity(stem.len() + 1);
        path.push(char::from(SCOPE_MARK));
        for byte in stem.bytes().take(LONGEST_SCOPE) {
            let stands = byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.' | SCOPE_MARK);
            path.push(if stands { char::from(byte) } else { '_' });
        }
        Scope(path)
    }

    /// The full name of `name` as it is defined in this scope.
    pub(crate) fn qualify(&self, name: &str) -> String {
        let mark = char::from(SCOPE_MARK);
        let name = name.strip_prefix(mark).unwrap_or(name);
        match name.strip_suffix(mark) {
            Some(global) => global.to_owned(),
            None => format!("{name}{}", self.0),
        }
    }

    /// The full names that `name` may mean in this scope, innermost first.
    fn candidates(&self, name: &str) -> impl Iterator<Item = String> {
        let mark = char::from(SCOPE_MARK);
        let first = self.qualify(name);
        let only = name.starts_with(mark) || name.ends_with(mark);
        let outer = self.0.char_indices().skip(1).filter(move |(_, c)| *c == mark).map(|(at, _)| at);
        let levels = outer.chain((!self.0.is_empty()).then_some(self.0.len()));
        let rest = levels.filter(move |_| !only).map(move |at| format!("{name}{}", &self.0[at..])).collect::<Vec<_>>();
        std::iter::once(first).chain(rest)
    }
}

/// How a name was defined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Assignment {
    /// `:`; uses of it are replaced by its value as they are read.
    Constant,
    /// `=`.
    Variable,
}

/// What a name means.
#[derive(Debug)]
pub(crate) struct Definition {
    pub(crate) assignment: Assignment,
    /// How many arguments a function takes; `None` for a variable.
    pub(crate) arity: Option<u16>,
    pub(crate) body: Body,
    /// Where the name stands.
    pub(crate) span: Option<Span>,
}

/// A name of the table.
#[derive(Clone, Debug)]
pub(crate) struct Symbol {
    pub(crate) name: Box<str>,
    pub(crate) builtin: Option<Builtin>,
    pub(crate) definition: Option<Arc<Definition>>,
}

impl Symbol {
    /// The name without its scope.
    pub(crate) fn bare(&self) -> &str {
        bare(&self.name)
    }

    pub(crate) fn variable(&self) -> Option<&Arc<Definition>> {
        self.definition.as_ref().filter(|definition| definition.arity.is_none())
    }

    pub(crate) fn function(&self) -> Option<&Arc<Definition>> {
        self.definition.as_ref().filter(|definition| definition.arity.is_some())
    }

    /// Whether a call with constant arguments is a constant.
    pub(crate) fn is_constant_function(&self) -> bool {
        match &self.definition {
            Some(definition) => definition.arity.is_some() && definition.assignment == Assignment::Constant,
            None => self.builtin.is_some_and(Builtin::is_constant),
        }
    }
}

/// A full name without its scope.
pub(crate) fn bare(name: &str) -> &str {
    name.split(char::from(SCOPE_MARK)).next().unwrap_or(name)
}

/// All names.
#[derive(Clone, Debug)]
pub(crate) struct Symbols {
    by_name: HashMap<Box<str>, SymbolId>,
    symbols: Vec<Symbol>,
}

impl Symbols {
    /// The library functions.
    pub(crate) fn new() -> Symbols {
        let mut symbols = Symbols { by_name: HashMap::new(), symbols: Vec::new() };
        for (name, builtin) in Builtin::all() {
            let id = symbols.insert(name.to_owned());
            symbols.symbols[id.0 as usize].builtin = Some(builtin);
        }
        symbols
    }

    pub(crate) fn get(&self, id: SymbolId) -> &Symbol {
        &self.symbols[id.0 as usize]
    }

    pub(crate) fn define(&mut self, id: SymbolId, definition: Option<Arc<Definition>>) {
        self.symbols[id.0 as usize].definition = definition;
    }

    pub(crate) fn len(&self) -> usize {
        self.symbols.len()
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Symbol> {
        self.symbols.iter()
    }

    /// The symbol with exactly this full name.
    pub(crate) fn exact(&self, name: &str) -> Option<SymbolId> {
        self.by_name.get(name).copied()
    }

    /// The innermost symbol that `name` means in a scope.
    pub(crate) fn find(&self, name: &str, scope: &Scope) -> Option<SymbolId> {
        scope.candidates(name).find_map(|full| self.exact(&full))
    }

    /// The same, or a new one that belongs to the scope.
    pub(crate) fn find_or_insert(&mut self, name: &str, scope: &Scope) -> SymbolId {
        self.find(name, scope).unwrap_or_else(|| self.insert(scope.qualify(name)))
    }

    /// The symbol with this full name, which is added if need be.
    pub(crate) fn insert(&mut self, name: String) -> SymbolId {
        if let Some(id) = self.exact(&name) {
            return id;
        }
        let id = SymbolId(u32::try_from(self.symbols.len()).expect("a text of 4 GiB holds fewer names"));
        let name = name.into_boxed_str();
        self.by_name.insert(name.clone(), id);
        self.symbols.push(Symbol { name, builtin: None, definition: None });
        id
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_becomes_a_scope() {
        assert_eq!(Scope::of_file("lib/my sky.CAL").0, "`lib_my_sky");
        assert_eq!(Scope::of_file("."), Scope::global());
        assert_eq!(Scope::of_file(".cal").0, "`.cal");
    }

    #[test]
    fn marks_choose_between_global_and_local() {
        let scope = Scope::of_file("a.cal");
        assert_eq!(scope.candidates("x").collect::<Vec<_>>(), ["x`a", "x"]);
        assert_eq!(scope.candidates("x`").collect::<Vec<_>>(), ["x"]);
        assert_eq!(scope.candidates("`x").collect::<Vec<_>>(), ["x`a"]);
        assert_eq!(scope.candidates("x`b").collect::<Vec<_>>(), ["x`b`a", "x`b"]);
    }
}
