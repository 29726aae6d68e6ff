//! Names, their scopes, and their definitions.
//!
//! A name defined in a function file is local to that file: `x` is stored as ``x`file``. A use
//! refers to the innermost name known at that moment: the file's own, otherwise the global one. A
//! name known nowhere becomes a local name of the file, to be defined later. ``x` `` (trailing
//! mark) is always the global `x`, and `` `x`` (leading mark) always the file's.

use crate::builtin::Builtin;
use crate::lexer::SCOPE_MARK;
use crate::syntax::Body;
use radsight_diag::Span;
use std::collections::HashMap;
use std::sync::Arc;

/// Maximum length of a scope, bytes.
const LONGEST_SCOPE: usize = 1023;

/// Index of a symbol in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct SymbolId(pub(crate) u32);

/// Scope in which names are looked up first: a function file, or none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Scope(String);

impl Scope {
    /// The global scope.
    #[must_use]
    pub fn global() -> Scope {
        Scope::default()
    }

    /// Scope of a function file, by its name in a primitive. `.` means no file; the suffix `.cal`
    /// is removed; characters that are invalid in names become `_`.
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

    /// Qualified form of a name that is defined in this scope.
    pub(crate) fn qualify(&self, name: &str) -> String {
        let mark = char::from(SCOPE_MARK);
        let name = name.strip_prefix(mark).unwrap_or(name);
        match name.strip_suffix(mark) {
            Some(global) => global.to_owned(),
            None => format!("{name}{}", self.0),
        }
    }

    /// Qualified names to which `name` may refer in this scope, innermost first.
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

/// Kind of an assignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Assignment {
    /// `:`; uses are replaced by the value when they are read.
    Constant,
    /// `=`.
    Variable,
}

/// Definition of a name.
#[derive(Debug)]
pub(crate) struct Definition {
    pub(crate) assignment: Assignment,
    /// Number of arguments of a function; `None` for a variable.
    pub(crate) arity: Option<u16>,
    pub(crate) body: Body,
    /// Position of the name.
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

    /// Whether a call with constant arguments is constant.
    pub(crate) fn is_constant_function(&self) -> bool {
        match &self.definition {
            Some(definition) => definition.arity.is_some() && definition.assignment == Assignment::Constant,
            None => self.builtin.is_some_and(Builtin::is_constant),
        }
    }
}

/// A qualified name without its scope.
pub(crate) fn bare(name: &str) -> &str {
    name.split(char::from(SCOPE_MARK)).next().unwrap_or(name)
}

/// Symbol table.
#[derive(Clone, Debug)]
pub(crate) struct Symbols {
    by_name: HashMap<Box<str>, SymbolId>,
    symbols: Vec<Symbol>,
}

impl Symbols {
    /// Table of the built-in functions.
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

    /// Symbol of exactly this qualified name.
    pub(crate) fn exact(&self, name: &str) -> Option<SymbolId> {
        self.by_name.get(name).copied()
    }

    /// Innermost symbol to which `name` refers in a scope.
    pub(crate) fn find(&self, name: &str, scope: &Scope) -> Option<SymbolId> {
        scope.candidates(name).find_map(|full| self.exact(&full))
    }

    /// The same, or a new symbol local to the scope.
    pub(crate) fn find_or_insert(&mut self, name: &str, scope: &Scope) -> SymbolId {
        self.find(name, scope).unwrap_or_else(|| self.insert(scope.qualify(name)))
    }

    /// Symbol of this qualified name, added if necessary.
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
