//! The quick look at every instance before it is used.

use crate::PluginBrdf;
use crate::faults::FaultCounts;
use radsight_brdf::check::{self, Check, CheckOptions, Effort};
use radsight_brdf_abi::flags;

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

/// What a model claims, as the statistical checks want it.
pub(crate) fn check_options(brdf: &PluginBrdf, effort: Effort, seed: u64) -> CheckOptions {
    CheckOptions {
        bands: brdf.bands(),
        seed,
        effort,
        reciprocal: brdf.model().claims_reciprocity(),
        isotropic: brdf.model().flags & flags::ANISOTROPIC == 0,
    }
}

/// Findings in words. A model that returns nonsense is not checked further: all else would follow from it.
pub(crate) fn self_check(brdf: &PluginBrdf, mode: SelfCheck) -> Vec<String> {
    if mode == SelfCheck::Off {
        return Vec::new();
    }
    let options = check_options(brdf, Effort::Quick, 1);
    let raw = brdf.unfiltered();
    let checks: [Check; 5] = [check::finite, check::isotropy, check::reciprocity, check::energy, check::sampling];
    let found = checks.iter().map(|check| check(&raw, &options)).find(|findings| !findings.is_empty());
    debug_assert_eq!(brdf.faults(), FaultCounts::default(), "checks look at unfiltered numbers");
    found.into_iter().flatten().map(|finding| finding.message).collect()
}
