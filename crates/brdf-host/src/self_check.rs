//! The quick look at every instance before it is used.

use crate::PluginBrdf;

/// What the self-check at load does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SelfCheck {
    /// Findings are warnings.
    #[default]
    Warn,
    /// Findings are errors.
    Strict,
    /// It is left out.
    Off,
}

pub(crate) fn self_check(_brdf: &PluginBrdf, _mode: SelfCheck) -> Vec<String> {
    Vec::new()
}
