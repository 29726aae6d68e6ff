//! `radsight plugin check`: runs every check in a child process with a time limit, so that a crash
//! or a hang is a finding like any other.
//!
//! The program starts itself: [`run`] starts [`CheckOptions::child`] for each check, writes the
//! request to its standard input and reads the findings from its standard output; the child calls
//! [`child_main`].

mod child;
mod example;
mod job;
mod probe;
mod report;

pub use crate::ChildCommand;
pub use child::child_main;
pub use example::Example;
pub use job::Stage;
pub use report::{Outcome, Report, Verdict};

use crate::Band;
use job::{Request, Response};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options of a check.
#[derive(Clone, Debug)]
pub struct CheckOptions {
    /// File of the library.
    pub library: PathBuf,
    /// Parameter sets for the models. For models not listed here they are generated from the
    /// parameter tables.
    pub examples: Vec<Example>,
    /// Check only this model.
    pub model: Option<String>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Time limit of each check. Default 60 s.
    pub time_limit: Duration,
    /// Memory limit of a plugin, bytes. Default half of the machine's memory.
    pub memory: Option<u64>,
    /// The program that calls [`child_main`].
    pub child: ChildCommand,
}

impl CheckOptions {
    /// Options for all models of a library, with generated parameters, seed 1 and 60 s per check.
    #[must_use]
    pub fn new(library: impl Into<PathBuf>, child: ChildCommand) -> Self {
        CheckOptions {
            library: library.into(),
            examples: Vec::new(),
            model: None,
            seed: 1,
            time_limit: Duration::from_secs(60),
            memory: crate::Limits::default().memory,
            child,
        }
    }
}

/// Bands in which models are checked, metres: red, green and blue, with Radiance's limits.
pub const CHECK_BANDS: [Band; 3] = [
    Band { centre_m: 684e-9, low_m: 588e-9, high_m: 780e-9 },
    Band { centre_m: 534e-9, low_m: 480e-9, high_m: 588e-9 },
    Band { centre_m: 430e-9, low_m: 380e-9, high_m: 480e-9 },
];

/// Checks a library, each check in a child process.
#[must_use]
pub fn run(options: &CheckOptions) -> Report {
    check_with(options, |request| child::run_in_child(options, request))
}

/// Checks a library in this process, for tests of a plugin that does not crash. `examples` as in
/// [`CheckOptions`].
#[must_use]
pub fn run_in_process(library: &Path, examples: Vec<Example>, seed: u64) -> Report {
    let nobody = ChildCommand { program: PathBuf::new(), arguments: Vec::new() };
    let options = CheckOptions { examples, seed, ..CheckOptions::new(library, nobody) };
    check_with(&options, |request| (job::perform(request), Duration::ZERO))
}

fn check_with(options: &CheckOptions, mut perform: impl FnMut(&Request) -> (Response, Duration)) -> Report {
    let library = options.library.clone();
    let mut report = Report { library, seed: options.seed, outcomes: Vec::new() };
    let request = |stage, model: &str| Request {
        library: options.library.clone(),
        stage,
        model: model.to_owned(),
        examples: options.examples.iter().filter(|example| example.model == model).cloned().collect(),
        seed: options.seed,
        memory: options.memory,
    };
    let (loaded, duration) = perform(&request(Stage::Load, ""));
    let models: Vec<String> = loaded.models.clone();
    let chosen: Vec<&String> = models.iter().filter(|name| options.model.as_ref().is_none_or(|m| m == *name)).collect();
    let mut first = Outcome::new(Stage::Load, None, loaded, duration);
    if let (Some(model), true) = (&options.model, chosen.is_empty() && first.verdict == Verdict::Passed) {
        first.verdict = Verdict::Failed;
        first.messages.push(format!("the library has no model \"{model}\"; it has {}", models.join(", ")));
    }
    report.outcomes.push(first);
    for model in chosen {
        let mut finite = true;
        for stage in Stage::OF_A_MODEL {
            let (response, duration) = match finite || !stage.needs_finite_values() {
                true => perform(&request(stage, model)),
                false => (Response::skip("values are not finite"), Duration::ZERO),
            };
            let unusable = response.unusable;
            finite &= stage != Stage::Finite || response.findings.is_empty();
            report.outcomes.push(Outcome::new(stage, Some(model), response, duration));
            if unusable {
                // No instance can be made: every further check would report the same.
                break;
            }
        }
    }
    report
}

/// The library `name` that cargo built next to the test program `test_program`, for a plugin's
/// tests.
#[must_use]
pub fn library_beside(test_program: &Path, name: &str) -> PathBuf {
    let file = format!("{}{name}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let folders = test_program.ancestors().skip(1).take(2);
    let mut candidates = folders.map(|folder| folder.join(&file));
    candidates.find(|path| path.is_file()).unwrap_or_else(|| PathBuf::from(file))
}
