//! `radsight plugin`: creates, lists, checks and plots BRDF plugins.

use crate::args::{Plugin, PluginCheck, PluginList, PluginNew, PluginPlot};
use crate::failure::{Failure, Outcome, reason, say};
use crate::output::{write_file, write_standard_output};
use crate::plugin_guard::PluginGuard;
use crate::plugins::search_path;
use radsight_brdf_host::check::{self, CHECK_BANDS, CheckOptions, ChildCommand, Example};
use radsight_brdf_host::isolate;
use radsight_brdf_host::plot::{PlotOptions, svg};
use radsight_brdf_host::template::{Language, new_project, own_sources};
use radsight_brdf_host::{Label, Library, Registry, Request, SearchPath, SelfCheck};
use radsight_parse::BrdfReplacement;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The hidden words that start the child process of a check.
const CHILD_WORDS: [&str; 2] = ["plugin", "check-child"];

/// Runs the command.
pub(crate) fn run(arguments: &Plugin) -> Outcome {
    match arguments {
        Plugin::New(arguments) => new(arguments),
        Plugin::List(arguments) => list(arguments),
        Plugin::Check(arguments) => check(arguments),
        Plugin::Plot(arguments) => plot(arguments),
        Plugin::CheckChild => check::child_main().map_err(|error| Failure::write("the answer of a check", &error)),
        Plugin::IsolationChild => {
            isolate::child_main().map_err(|error| Failure::write("the answer of a plugin", &error))
        }
    }
}

fn new(arguments: &PluginNew) -> Outcome {
    let language = match (&arguments.sdk_path, arguments.c) {
        (_, true) => Language::C,
        (Some(folder), _) => Language::Rust { sources: absolute(folder)? },
        (None, _) => Language::Rust {
            sources: own_sources().ok_or_else(|| {
                Failure::usage(
                    "the sources of this program are not found\nhint: name their folder with --sdk-path, or use --c",
                )
            })?,
        },
    };
    let files = new_project(&arguments.name, &language).map_err(|error| Failure::usage(error.to_string()))?;
    let folder = Path::new(&arguments.name);
    if folder.exists() {
        return Err(Failure::input(format!("\"{}\" exists already", folder.display())));
    }
    for file in files {
        let path = folder.join(&file.path);
        let parent = path.parent().unwrap_or(folder);
        std::fs::create_dir_all(parent)
            .map_err(|error| Failure::fault(format!("cannot make \"{}\": {}", parent.display(), reason(&error))))?;
        write_file(&path.to_string_lossy(), file.text.as_bytes())?;
        println!("{}", path.display());
    }
    Ok(())
}

fn absolute(folder: &Path) -> Result<PathBuf, Failure> {
    folder
        .canonicalize()
        .map_err(|error| Failure::usage(format!("option \"--sdk-path\" \"{}\": {}", folder.display(), reason(&error))))
}

fn plot(arguments: &PluginPlot) -> Outcome {
    let library = library_file(&arguments.library, &arguments.plugin_path)?;
    let guard = guarded()?;
    let registry = guard.with_isolation(Registry::new(search(&arguments.plugin_path), SelfCheck::Off));
    let wrong = |error: radsight_brdf_host::Error| Failure::input(error.to_string());
    let library = registry.library_file(&library).map_err(wrong)?;
    let example = parse_model(&arguments.model)?;
    let label = Label { material: example.model.clone(), place: String::new() };
    let request = Request {
        library: library.name(),
        model: &example.model,
        words: &example.words,
        numbers: &example.numbers,
        bands: &CHECK_BANDS,
        label: &label,
        folder: None,
    };
    let made = registry.instantiate_from(library.clone(), &request).map_err(wrong)?;
    let title = format!("{}: {example}", library.name());
    write_standard_output(svg(made.brdf.as_ref(), &PlotOptions::new(title, CHECK_BANDS.len())).as_bytes())
}

fn list(arguments: &PluginList) -> Outcome {
    guarded()?;
    let search = search(&arguments.plugin_path);
    let mut text = String::new();
    for (name, path) in search.libraries() {
        // Folders may hold other shared libraries: only plugins are listed, and invalid plugins are
        // reported.
        match Library::load(&path) {
            Ok(library) => {
                text.push_str(&format!("{name}  ({})\n", path.display()));
                text.push_str(&library.describe());
            }
            Err(
                error @ (radsight_brdf_host::Error::WrongMajor { .. } | radsight_brdf_host::Error::WrongMagic { .. }),
            ) => {
                say(&format!("radsight: warning: {error}\n"));
            }
            Err(_) => {}
        }
    }
    if text.is_empty() {
        let folders: Vec<String> = search.folders().iter().map(|folder| folder.display().to_string()).collect();
        return Err(Failure::input(format!("no plugin in {}", folders.join(", "))));
    }
    write_standard_output(text.as_bytes())
}

fn check(arguments: &PluginCheck) -> Outcome {
    let library = library_file(&arguments.library, &arguments.plugin_path)?;
    let mut options = CheckOptions::new(library, ChildCommand::this_program(&CHILD_WORDS));
    options.seed = arguments.seed;
    options.memory = PluginGuard::default().limits().map_err(Failure::usage)?.memory;
    options.time_limit = Duration::from_secs(arguments.time_limit.max(1));
    if let Some(model) = &arguments.model {
        let example = parse_model(model)?;
        options.model = Some(example.model.clone());
        if !example.words.is_empty() || !example.numbers.is_empty() {
            options.examples.push(example);
        }
    }
    let report = check::run(&options);
    let text = if arguments.json { report.json() } else { report.text() };
    write_standard_output(text.as_bytes())?;
    if report.passed() {
        return Ok(());
    }
    let failures = report.failures();
    let (first, more) = (failures.first().copied().unwrap_or_default(), failures.len().saturating_sub(1));
    // The report on standard output has all of them.
    let more = if more == 0 { String::new() } else { format!("; and {more} more") };
    Err(Failure::input(format!("\"{}\" failed: {first}{more}", report.library.display())))
}

/// A model as typed: `MODEL` or `MODEL(number,…)`.
fn parse_model(text: &str) -> Result<Example, Failure> {
    let parsed = BrdfReplacement::parse(&format!("material=library:{text}"))
        .map_err(|_| Failure::usage(format!("\"{text}\" is not a model, expected MODEL or MODEL(number,…)")))?;
    Ok(Example { model: parsed.model, words: parsed.words, numbers: parsed.numbers })
}

/// The guard over plugins in this process, as configured by the environment.
fn guarded() -> Result<PluginGuard, Failure> {
    let guard = PluginGuard::default();
    guard.check()?;
    guard.guard_program().map_err(Failure::fault)?;
    Ok(guard)
}

fn search(folders: &[PathBuf]) -> SearchPath {
    search_path(folders, &SearchPath::default())
}

/// A file that exists, or a library found by its name.
fn library_file(name: &str, folders: &[PathBuf]) -> Result<PathBuf, Failure> {
    let path = Path::new(name);
    if path.is_file() {
        return Ok(PathBuf::from(name));
    }
    if path.is_dir() {
        return Err(Failure::input(format!("\"{name}\" is a folder, expected a plugin library")));
    }
    // Names of libraries have neither folders nor suffixes.
    if path.components().count() > 1 || path.extension().is_some() {
        return Err(Failure::input(format!("cannot find plugin library \"{name}\": there is no such file")));
    }
    search(folders).find(name).map_err(|error| Failure::input(error.to_string()))
}
