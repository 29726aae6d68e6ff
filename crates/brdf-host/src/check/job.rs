//! A single check, as the child process runs it.

use super::CHECK_BANDS;
use super::example::{Example, generated};
use super::probe::{self, Origin};
use crate::sample_kind_check::unknown_kind;
use crate::self_check::{SelfCheck, check_options, self_check};
use crate::{Band, Label, Library, PluginBrdf, Request as Instantiation};
use radsight_brdf::check::{self, Check, CheckLevel};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// Subject of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// The file is a plugin of the right version, and its tables follow the rules.
    Load,
    /// Wrong indices, counts and numbers are rejected without a crash.
    Arguments,
    /// Repeated create and destroy lose no memory.
    Lifecycle,
    /// The quick check that runs in every scene.
    SelfCheck,
    /// Values are finite and not negative.
    Finite,
    /// Values do not depend on batch, order or thread.
    Purity,
    /// Values do not depend on the frame's azimuth, unless declared.
    Isotropy,
    /// `f(o, i) = f(i, o)`, if declared.
    Reciprocity,
    /// Directional albedo is at most 1 at 0…89.9°.
    Energy,
    /// Samples have the density of `eval_pdf`.
    Sampling,
}

impl Stage {
    /// Checks of one model, in the order of the report.
    pub const OF_A_MODEL: [Stage; 9] = [
        Stage::Arguments,
        Stage::Lifecycle,
        Stage::Finite,
        Stage::Purity,
        Stage::Isotropy,
        Stage::Reciprocity,
        Stage::Energy,
        Stage::Sampling,
        Stage::SelfCheck,
    ];

    /// Name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Stage::Load => "load",
            Stage::Arguments => "bad arguments",
            Stage::Lifecycle => "create and destroy",
            Stage::SelfCheck => "self-check at load",
            Stage::Finite => "finite values",
            Stage::Purity => "batch, order, threads",
            Stage::Isotropy => "isotropy",
            Stage::Reciprocity => "reciprocity",
            Stage::Energy => "energy",
            Stage::Sampling => "sampling",
        }
    }
}

/// A request to a child.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Request {
    pub(super) library: PathBuf,
    pub(super) stage: Stage,
    pub(super) model: String,
    pub(super) examples: Vec<Example>,
    pub(super) seed: u64,
    /// Memory limit of the plugin, bytes.
    pub(super) memory: Option<u64>,
}

/// Answer of a child.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Response {
    /// Violated requirements.
    pub(super) findings: Vec<String>,
    /// Notes for the user.
    pub(super) notes: Vec<String>,
    /// Why the check was skipped.
    pub(super) skipped: Option<String>,
    /// Names of the library's models.
    pub(super) models: Vec<String>,
    /// Whether no instance can be made, which makes further checks pointless.
    pub(super) unusable: bool,
}

impl Response {
    pub(super) fn skip(reason: &str) -> Self {
        Response { skipped: Some(reason.to_owned()), ..Response::default() }
    }

    pub(super) fn failure(finding: impl Into<String>) -> Self {
        Response { findings: vec![finding.into()], ..Response::default() }
    }
}

/// Maximum number of generated parameter sets; those of the user are all checked.
const MOST_GENERATED: usize = 6;

/// Runs one check in this process.
pub(super) fn perform(request: &Request) -> Response {
    let library = match Library::load(&request.library) {
        Ok(library) => Arc::new(library),
        Err(error) => return Response::failure(error.to_string()),
    };
    if request.stage == Stage::Load {
        return describe(&library);
    }
    let Ok((index, model)) = library.model(&request.model) else {
        return Response {
            unusable: true,
            ..Response::failure(format!("the library has no model \"{}\"", request.model))
        };
    };
    let given = !request.examples.is_empty();
    let examples = if given { request.examples.clone() } else { generated(model, request.seed) };
    if examples.is_empty() {
        let usage = model.usage(library.name());
        let reason = format!("its words cannot be generated: give parameters for \"{usage}\"");
        return Response { skipped: Some(reason), unusable: true, ..Response::default() };
    }
    let most = if given { usize::MAX } else { MOST_GENERATED };
    let mut response = match request.stage {
        Stage::Arguments => {
            let origin = if given { Origin::User } else { Origin::Generator };
            probe::arguments(&library, index, &examples, origin)
        }
        Stage::Lifecycle => probe::lifecycle(&library, &examples),
        Stage::SelfCheck => at_load(&library, &examples, most),
        stage => physics(&library, stage, &examples, most, request.seed),
    };
    response
        .notes
        .extend(library.take_messages().into_iter().map(|message| format!("the plugin logged: {}", message.text)));
    response
}

fn describe(library: &Library) -> Response {
    let models: Vec<String> = library.models().iter().map(|model| model.name.clone()).collect();
    let (major, minor) = library.abi_version();
    let note = format!("interface {major}.{minor}; models: {}", models.join(", "));
    Response { notes: vec![note], models, ..Response::default() }
}

/// An instance for a parameter set and some bands.
pub(super) fn instantiate(
    library: &Arc<Library>,
    example: &Example,
    bands: &[Band],
) -> Result<PluginBrdf, crate::Error> {
    let label = Label { material: example.to_string(), place: "plugin check".to_owned() };
    let (index, model) = library.model(&example.model)?;
    let asked = Instantiation {
        library: library.name(),
        model: &example.model,
        words: &example.words,
        numbers: &example.numbers,
        bands,
        label: &label,
        folder: None,
    };
    let arguments = model.arguments(asked.words, asked.numbers, asked.bands, asked.folder)?;
    PluginBrdf::create(Arc::clone(library), index, &arguments, bands, label)
}

/// Runs a statistical check with every parameter set that the plugin accepts.
fn physics(library: &Arc<Library>, stage: Stage, examples: &[Example], most: usize, seed: u64) -> Response {
    let check: Check = match stage {
        Stage::Finite => check::finite,
        Stage::Purity => check::purity,
        Stage::Isotropy => check::isotropy,
        Stage::Reciprocity => check::reciprocity,
        Stage::Energy => check::energy,
        _ => check::sampling,
    };
    let mut response = Response::default();
    for (example, brdf) in accepted(library, examples, most) {
        let options = check_options(&brdf, CheckLevel::Thorough, seed);
        response.skipped = not_claimed(stage, &options);
        if response.skipped.is_some() {
            return response;
        }
        // An unknown kind has no density, which `check` would call NaN.
        if stage == Stage::Finite
            && let Some(finding) = unknown_kind(&brdf)
        {
            response.findings.push(format!("{example}: {finding}"));
            continue;
        }
        let findings = check(&brdf.unfiltered(), &options);
        response.findings.extend(findings.into_iter().map(|finding| format!("{example}: {}", finding.message)));
    }
    response
}

/// Instances of the first parameter sets that the plugin accepts. `probe::arguments` checks plugins
/// that reject three bands or generated combinations.
fn accepted<'a>(
    library: &'a Arc<Library>,
    examples: &'a [Example],
    most: usize,
) -> impl Iterator<Item = (&'a Example, PluginBrdf)> + 'a {
    let in_bands = |example, count: usize| instantiate(library, example, &CHECK_BANDS[..count]).ok();
    let instances = examples.iter().filter_map(move |example| {
        Some((example, in_bands(example, CHECK_BANDS.len()).or_else(|| in_bands(example, 1))?))
    });
    instances.take(most)
}

/// Findings of the self-check when a scene loads these parameters.
fn at_load(library: &Arc<Library>, examples: &[Example], most: usize) -> Response {
    let mut response = Response::default();
    for (example, brdf) in accepted(library, examples, most) {
        let findings = self_check(&brdf, SelfCheck::Warn);
        response.findings.extend(findings.into_iter().map(|finding| format!("{example}: {finding}")));
    }
    response
}

impl Stage {
    /// Whether the check is meaningless if values are not finite.
    pub(super) fn needs_finite_values(self) -> bool {
        matches!(self, Stage::Isotropy | Stage::Reciprocity | Stage::Energy | Stage::Sampling | Stage::SelfCheck)
    }
}

fn not_claimed(stage: Stage, options: &check::CheckOptions) -> Option<String> {
    match stage {
        Stage::Isotropy if !options.isotropic => Some("the model declares that it is anisotropic".to_owned()),
        Stage::Reciprocity if !options.reciprocal => Some("the model does not declare reciprocity".to_owned()),
        _ => None,
    }
}
