//! What the host of a program tells when the program is compiled.

use crate::channel;
use crate::definitions::Definitions;
use crate::names::{Symbol, SymbolId, bare};
use radsight_diag::Diagnostic;

/// What the host knows at compile time, and what it offers at run time.
///
/// Real arguments and constant channels are folded into the program, so that what depends on nothing else costs nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bindings<'a> {
    /// The values of `arg(1)`, `arg(2)`, …; `arg(0)` is their number.
    pub real_arguments: &'a [f64],
    /// Channels whose value never changes: (number, value). The axes of a modifier's frame, for instance.
    pub constant_channels: &'a [(u32, f64)],
    /// The highest channel that the host serves; a higher one is an error. `None`: any.
    pub highest_channel: Option<u32>,
    /// Variables that the host serves as channels, for names that no definition gives: (name, channel).
    pub variables: &'a [(&'a str, u32)],
    /// Functions that the host computes, for names that no definition gives: (name, number of arguments). Their index here is
    /// what [`Host::call`](crate::Host::call) gets.
    pub functions: &'a [(&'a str, usize)],
}

impl Bindings<'_> {
    /// What a ray offers to a modifier: the channels of [`channel`](crate::channel), no functions.
    #[must_use]
    pub fn of_ray() -> Bindings<'static> {
        Bindings { highest_channel: Some(channel::HIGHEST), ..Bindings::default() }
    }

    pub(crate) fn constant_channel(&self, channel: u32) -> Option<f64> {
        self.constant_channels.iter().find(|(number, _)| *number == channel).map(|(_, value)| *value)
    }

    pub(crate) fn variable(&self, name: &str) -> Option<u32> {
        self.variables.iter().find(|(known, _)| *known == name).map(|(_, channel)| *channel)
    }

    pub(crate) fn function(&self, name: &str) -> Option<(u16, usize)> {
        let index = self.functions.iter().position(|(known, _)| *known == name)?;
        Some((u16::try_from(index).ok()?, self.functions[index].1))
    }

    pub(crate) fn no_such_channel(&self, channel: u32) -> Diagnostic {
        let highest = self.highest_channel.unwrap_or(u32::MAX);
        let expected = if highest == 0 {
            "there are no channels here".to_owned()
        } else {
            format!("channels are $1 to ${highest}")
        };
        Diagnostic::error(format!("illegal channel ${channel}")).hint(expected)
    }
}

/// The definitions, and names that occur in the roots but not in the definitions.
#[derive(Debug)]
pub(crate) struct Known<'a> {
    pub(crate) definitions: &'a Definitions,
    pub(crate) strangers: Vec<String>,
}

impl<'a> Known<'a> {
    pub(crate) fn new(definitions: &'a Definitions) -> Known<'a> {
        Known { definitions, strangers: Vec::new() }
    }

    pub(crate) fn symbol(&self, id: SymbolId) -> Option<&'a Symbol> {
        let symbols = &self.definitions.symbols;
        ((id.0 as usize) < symbols.len()).then(|| symbols.get(id))
    }

    /// The name without its scope.
    pub(crate) fn bare_name(&self, id: SymbolId) -> &str {
        match self.symbol(id) {
            Some(symbol) => symbol.bare(),
            None => self.strangers.get(id.0 as usize - self.definitions.symbols.len()).map_or("?", |name| bare(name)),
        }
    }

    /// A new symbol for a name without a definition.
    pub(crate) fn stranger(&mut self, name: &str) -> SymbolId {
        let index = self.strangers.iter().position(|known| known == name).unwrap_or_else(|| {
            self.strangers.push(name.to_owned());
            self.strangers.len() - 1
        });
        SymbolId(u32::try_from(self.definitions.symbols.len() + index).unwrap_or(u32::MAX))
    }

    /// The names that could have been meant.
    pub(crate) fn candidates(&self, bindings: &Bindings<'a>, functions: bool) -> impl Iterator<Item = &str> {
        let defined = self.definitions.symbols.iter().filter(move |symbol| match functions {
            true => symbol.function().is_some() || symbol.builtin.is_some(),
            false => symbol.variable().is_some(),
        });
        let host_functions = bindings.functions.iter().filter(move |_| functions).map(|(name, _)| *name);
        let host_variables = bindings.variables.iter().filter(move |_| !functions).map(|(name, _)| *name);
        defined.map(Symbol::bare).chain(host_functions).chain(host_variables)
    }
}
