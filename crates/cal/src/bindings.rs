//! Bindings: what the host of a program provides at compile time.

use crate::channel;
use crate::definitions::Definitions;
use crate::names::{Symbol, SymbolId, bare};
use radsight_diag::Diagnostic;

/// Values known at compile time, and channels and functions offered at run time.
///
/// Real arguments and constant channels are folded into the program, so that expressions of them
/// alone cost nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bindings<'a> {
    /// The values of `arg(1)`, `arg(2)`, …; `arg(0)` is their number.
    pub real_arguments: &'a [f64],
    /// Channels of constant value: (number, value). For example, the axes of a modifier's frame.
    pub constant_channels: &'a [(u32, f64)],
    /// Highest channel that the host provides; a higher one is an error. `None`: no limit.
    pub highest_channel: Option<u32>,
    /// Variables that the host provides as channels, for names without a definition: (name,
    /// channel).
    pub variables: &'a [(&'a str, u32)],
    /// Functions that the host computes, for names without a definition: (name, number of
    /// arguments). [`Host::call`](crate::Host::call) gets their index in this list.
    pub functions: &'a [(&'a str, usize)],
}

impl Bindings<'_> {
    /// Bindings of a ray for a modifier: the channels of [`channel`](crate::channel), no functions.
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

/// The definitions, and names that occur in the roots but have no definition.
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

    /// Adds a symbol for a name without a definition.
    pub(crate) fn stranger(&mut self, name: &str) -> SymbolId {
        let index = self.strangers.iter().position(|known| known == name).unwrap_or_else(|| {
            self.strangers.push(name.to_owned());
            self.strangers.len() - 1
        });
        SymbolId(u32::try_from(self.definitions.symbols.len() + index).unwrap_or(u32::MAX))
    }

    /// Names of functions that may have been intended.
    pub(crate) fn function_names(&self, bindings: &Bindings<'a>) -> impl Iterator<Item = &str> {
        let is_function = |symbol: &&Symbol| symbol.function().is_some() || symbol.builtin.is_some();
        let defined = self.definitions.symbols.iter().filter(is_function).map(Symbol::bare);
        defined.chain(bindings.functions.iter().map(|(name, _)| *name))
    }

    /// Names of variables that may have been intended.
    pub(crate) fn variable_names(&self, bindings: &Bindings<'a>) -> impl Iterator<Item = &str> {
        let defined = self.definitions.symbols.iter().filter(|symbol| symbol.variable().is_some()).map(Symbol::bare);
        defined.chain(bindings.variables.iter().map(|(name, _)| *name))
    }
}
