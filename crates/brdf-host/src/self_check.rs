//! The quick self-check of every instance before it is used.

use crate::PluginBrdf;
use crate::faults::FaultCounts;
use crate::sample_kind_check::unknown_kind;
use radsight_brdf::check::{self, Check, CheckLevel, CheckOptions};
use radsight_brdf_abi::flags;

/// Mode of the self-check at load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SelfCheck {
    /// Findings are warnings.
    #[default]
    Warn,
    /// Findings are errors.
    Strict,
    /// No self-check.
    Off,
}

/// Options of the statistical checks, from the properties that a model declares.
pub(crate) fn check_options(brdf: &PluginBrdf, level: CheckLevel, seed: u64) -> CheckOptions {
    CheckOptions {
        bands: brdf.bands(),
        seed,
        level,
        reciprocal: brdf.model().claims_reciprocity(),
        isotropic: brdf.model().flags & flags::ANISOTROPIC == 0,
    }
}

/// Findings as text. A model that returns invalid values is not checked further: other findings
/// would follow from them.
pub(crate) fn self_check(brdf: &PluginBrdf, mode: SelfCheck) -> Vec<String> {
    if mode == SelfCheck::Off {
        return Vec::new();
    }
    let findings = findings(brdf);
    crate::guard::after_call(brdf.in_self_check());
    findings
}

fn findings(brdf: &PluginBrdf) -> Vec<String> {
    if let Some(finding) = unknown_kind(brdf) {
        return vec![finding];
    }
    let options = check_options(brdf, CheckLevel::Quick, 1);
    let raw = brdf.unfiltered();
    let checks: [Check; 5] = [check::finite, check::isotropy, check::reciprocity, check::energy, check::sampling];
    let found = checks.iter().map(|check| check(&raw, &options)).find(|findings| !findings.is_empty());
    debug_assert_eq!(brdf.faults(), FaultCounts::default(), "checks use unfiltered numbers");
    found.into_iter().flatten().map(|finding| finding.message).collect()
}
