//! Reads the inputs of commands: camera files, scenes, standard input.

use crate::args::Reading;
use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome, reason, render, say};
use crate::plugins::{Models, PluginOptions, report_faults};
use crate::read_once;
use crate::trust::{Trust, shell};
use radsight_brdf_host::Registry;
use radsight_camera::{CameraFile, place_of};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_ir::{Material, Modifier, ModifierKind, Scene, ValidScene};
use radsight_loader::Loader;
use radsight_output::inputs;
use radsight_parse::{BrdfReplacement, Input, Read, ReadOptions, Tolerance, read_scene};
use radsight_picture::Header;
use radsight_pinhole::{BandWeights, BandWeightsError};
use radsight_render::{ModelSource, NoModels, RenderOptions, RenderPlan, check_materials};
use std::io::{self, Read as _};
use std::path::Path;
use std::process::Stdio;
use std::sync::{Arc, Once};

/// Reads a camera file and prints its warnings.
pub(crate) fn read_camera(path: &str) -> Result<CameraFile, Failure> {
    let loader = DiskLoader::new(Commands::Refused);
    let bytes = read_file(path, "camera file")?;
    let mut sources = SourceMap::default();
    match CameraFile::read(path, &bytes, &mut sources, &loader) {
        Ok(file) => {
            say(&render(&file.warnings, &sources));
            Ok(file)
        }
        Err(errors) => Err(Failure::diagnostics(&errors, &sources)),
    }
}

/// The failure for a key of a camera file that does not fit the scene.
pub(crate) fn camera_mistake(path: &str, key: &[&str], mistake: Diagnostic) -> Failure {
    let mut sources = SourceMap::default();
    let placed = read_file(path, "camera file").ok().and_then(|text| {
        let file = sources.add(path, text, None);
        place_of(file, key, &sources)
    });
    let mistake = match placed {
        Some(place) => mistake.at(place),
        None => mistake,
    };
    Failure::diagnostics(&[mistake], &sources)
}

/// The weights of the bands of a scene, as the camera file gives them.
pub(crate) fn band_weights(path: &str, camera: &CameraFile, bands: usize) -> Result<BandWeights, Failure> {
    camera.band_weights_for(bands).map_err(|error| {
        let key = match error {
            BandWeightsError::Wavelengths { .. } => ["camera", "band_wavelengths_nm"],
            _ => ["sensor", "band_weights"],
        };
        camera_mistake(path, &key, Diagnostic::error(error.to_string()))
    })
}

/// The bytes of a file named on the command line.
pub(crate) fn read_file(path: &str, what: &str) -> Result<Vec<u8>, Failure> {
    read_once::owned(Path::new(path)).map_err(|error| Failure::read(&format!("{what} \"{path}\""), &error))
}

/// The bytes of a scene file, read without a copy, since it may be large.
fn read_scene_file(path: &str) -> Result<Arc<[u8]>, Failure> {
    read_once::shared(Path::new(path)).map_err(|error| Failure::read(&format!("scene file \"{path}\""), &error))
}

/// All of standard input.
pub(crate) fn read_standard_input() -> Result<Vec<u8>, Failure> {
    if inputs::is_standard_input_standard_output() {
        return Err(Failure::usage("cannot read standard input: standard output goes to the same file"));
    }
    let mut bytes = Vec::new();
    io::stdin()
        .lock()
        .read_to_end(&mut bytes)
        .map_err(|error| Failure::input(format!("cannot read standard input: {}", reason(&error))))?;
    Ok(bytes)
}

/// The output of a command after `!` in place of a file, as in Radiance's programs.
fn read_command(command: &str, commands: Commands) -> Result<Vec<u8>, Failure> {
    let failed = |what: String| Failure::input(format!("command \"{command}\": {what}"));
    let output = shell(commands.permit(command)?, command).stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| failed(reason(&error)))?;
    if !output.status.success() {
        return Err(failed(output.status.to_string()));
    }
    Ok(output.stdout)
}

/// The content of an input on the command line: standard input (`-`), the output of a command after
/// `!`, or a file, which `read` reads.
pub(crate) fn read_source<B: From<Vec<u8>>>(
    source: &str,
    commands: Commands,
    read: impl FnOnce(&str) -> Result<B, Failure>,
) -> Result<B, Failure> {
    match (source, source.strip_prefix('!')) {
        ("-", _) => read_standard_input().map(B::from),
        (_, Some(command)) => read_command(command, commands).map(B::from),
        (path, None) => read(path),
    }
}

/// The texts of scenes: files, `-` for standard input, commands after `!`, and the light ring of a
/// camera file.
pub(crate) fn scene_inputs(
    paths: &[String],
    camera: Option<&CameraFile>,
    trust: &Trust,
) -> Result<Vec<Input>, Failure> {
    let mut inputs = Vec::new();
    for path in paths {
        let bytes = read_source(path, trust.own_commands(), read_scene_file)?;
        let name = if path == "-" { "<standard input>" } else { path };
        inputs.push(Input::Text { name: name.to_owned(), text: bytes });
    }
    inputs.extend(camera.and_then(ring_input));
    Ok(inputs)
}

/// The light ring of a camera file.
pub(crate) fn ring_input(camera: &CameraFile) -> Option<Input> {
    let rig = camera.rig.as_ref()?;
    Some(Input::Text { name: "<light ring>".to_owned(), text: rig.scene_text().into_bytes().into() })
}

/// The text of a source as in [`read_source`], with commands expanded by `xform`; comments are
/// kept.
pub(crate) fn expanded_scene_text(program: &str, path: &str, trust: &Trust) -> Result<Vec<u8>, Failure> {
    let text: Vec<u8> = read_source(path, trust.own_commands(), |path| read_file(path, "scene file"))?;
    let has_commands = text.split(|byte| *byte == b'\n').any(|line| line.trim_ascii_start().starts_with(b"!"));
    if !has_commands {
        return Ok(text);
    }
    let loader = DiskLoader::new(trust.commands());
    let made = radsight_parse::xform(&["xform".to_owned()], &text, &loader);
    made.map(|made| made.standard_output).map_err(|error| Failure::input(format!("{program}: \"{path}\": {error}")))
}

/// Reads scenes and returns the complete result.
pub(crate) fn read(inputs: Vec<Input>, commands: Commands, options: &ReadOptions) -> Read {
    let loader: &dyn Loader = &DiskLoader::new(commands);
    read_scene(&inputs, loader, options)
}

impl Reading {
    /// Whether unknown commands may run.
    pub(crate) fn commands(&self) -> Commands {
        self.trust.commands()
    }

    /// The options for the parser.
    pub(crate) fn read_options(&self) -> Result<ReadOptions, Failure> {
        let brdf: Result<Vec<_>, _> =
            self.trust.replacements().iter().map(|text| BrdfReplacement::parse(text)).collect();
        let brdf = brdf.map_err(|reason| Failure::usage(format!("option \"--brdf\": {reason}")))?;
        let tolerance = if self.strict { Tolerance::Strict } else { Tolerance::AsRadiance };
        let definitions = self.definitions.clone();
        Ok(ReadOptions { brdf, tolerance, definitions, ..ReadOptions::default() })
    }

    /// The identity of the scene, if an irradiance cache is kept in a file.
    fn fingerprint(&self, scene: &Scene) -> Option<u64> {
        (self.ambient_file.is_some() || self.irradiance_cache.is_some()).then(|| scene.fingerprint())
    }

    fn plugin_options(&self) -> PluginOptions {
        PluginOptions { trust: self.trust.clone(), strict: self.strict, guard: self.plugin_guard.clone() }
    }
}

/// A scene ready to be rendered.
pub(crate) struct Planned {
    pub(crate) plan: RenderPlan,
    /// The plugins in use; their faults are reported at the end.
    pub(crate) registry: Option<Registry>,
    /// The sources for messages about the scene.
    pub(crate) sources: SourceMap,
    /// The identity of the scene, if an irradiance cache is kept in a file.
    pub(crate) fingerprint: Option<u64>,
}

/// Prints the messages after all rays were traced: faults of plugins and functions. Returns the
/// error of an unusable material.
pub(crate) fn conclude(
    plan: &RenderPlan,
    registry: Option<&Registry>,
    sources: &SourceMap,
    reading: &Reading,
) -> Outcome {
    conclude_all([plan], registry, sources, reading)
}

/// The same for several plans of one scene.
pub(crate) fn conclude_all<'p>(
    plans: impl IntoIterator<Item = &'p RenderPlan>,
    registry: Option<&Registry>,
    sources: &SourceMap,
    reading: &Reading,
) -> Outcome {
    report_faults(registry);
    let plans: Vec<&RenderPlan> = plans.into_iter().collect();
    if let Some(error) = plans.iter().copied().find_map(RenderPlan::fatal_fault) {
        return Err(Failure::diagnostics(&[error], sources));
    }
    let mut faults: Vec<Diagnostic> = Vec::new();
    // Plans of one scene share its functions.
    plans.iter().flat_map(|plan| plan.function_faults().into_iter().chain(plan.unbounded_radiance())).for_each(
        |fault| {
            if !faults.contains(&fault) {
                faults.push(fault);
            }
        },
    );
    match faults.is_empty() {
        false if reading.strict => Err(Failure::diagnostics(&faults, sources)),
        false if !reading.no_warnings => {
            say(&render(&faults, sources));
            Ok(())
        }
        _ => Ok(()),
    }
}

/// Reads, validates and compiles a scene. Warnings are printed; errors end the work.
pub(crate) fn plan(
    paths: &[String],
    camera: Option<&CameraFile>,
    reading: &Reading,
    render_options: RenderOptions,
) -> Result<Planned, Failure> {
    plan_changed(paths, camera, reading, render_options, |_| Ok(()))
}

/// The same for a scene that is changed after reading.
pub(crate) fn plan_changed(
    paths: &[String],
    camera: Option<&CameraFile>,
    reading: &Reading,
    render_options: RenderOptions,
    change: impl FnOnce(&mut Scene) -> Outcome,
) -> Result<Planned, Failure> {
    plan_inputs(scene_inputs(paths, camera, &reading.trust)?, paths, reading, render_options, change)
}

/// The same for a scene with separately rendered parts, all with the same plugins: `split` leaves
/// one part in the scene and returns the others.
pub(crate) fn plan_split<T>(
    paths: &[String],
    camera: Option<&CameraFile>,
    reading: &Reading,
    render_options: &RenderOptions,
    split: impl FnOnce(&mut Scene) -> Result<Vec<(Scene, T)>, Failure>,
) -> Result<(Planned, Vec<(RenderPlan, T)>), Failure> {
    let mut parts = Vec::new();
    let change = |scene: &mut Scene| {
        parts = split(scene)?;
        Ok(())
    };
    let (scene, sources) = valid_scene(scene_inputs(paths, camera, &reading.trust)?, reading, change)?;
    let planner = Planner::new(&scene, paths, reading, &sources)?;
    let fingerprint = reading.fingerprint(&scene);
    let plan = planner.plan(scene, render_options.clone())?;
    let mut others = Vec::new();
    for (part, of_part) in parts {
        // Warnings were printed for the whole scene.
        let valid = part.validate().map_err(|errors| Failure::diagnostics(&errors, &sources))?;
        others.push((planner.plan(valid.scene, render_options.clone())?, of_part));
    }
    let registry = planner.models.map(Models::into_registry);
    Ok((Planned { plan, registry, sources, fingerprint }, others))
}

/// Compiles scene text; `name` denotes it in messages.
pub(crate) fn plan_text(
    name: &str,
    text: Vec<u8>,
    reading: &Reading,
    render_options: RenderOptions,
) -> Result<Planned, Failure> {
    let input = Input::Text { name: name.to_owned(), text: text.into() };
    plan_inputs(vec![input], &[], reading, render_options, |_| Ok(()))
}

fn plan_inputs(
    inputs: Vec<Input>,
    paths: &[String],
    reading: &Reading,
    render_options: RenderOptions,
    change: impl FnOnce(&mut Scene) -> Outcome,
) -> Result<Planned, Failure> {
    let (scene, sources) = valid_scene(inputs, reading, change)?;
    let planner = Planner::new(&scene, paths, reading, &sources)?;
    let fingerprint = reading.fingerprint(&scene);
    let plan = planner.plan(scene, render_options)?;
    let registry = planner.models.map(Models::into_registry);
    Ok(Planned { plan, registry, sources, fingerprint })
}

/// Reads and validates a scene for a [`Planner`]. Warnings are printed; errors end the work.
pub(crate) fn read_valid_scene(paths: &[String], reading: &Reading) -> Result<(ValidScene, SourceMap), Failure> {
    valid_scene(scene_inputs(paths, None, &reading.trust)?, reading, |_| Ok(()))
}

/// Compiles several plans of a scene, all with the same plugins.
pub(crate) struct Planner<'s> {
    /// The models of plugins, if a material uses one.
    models: Option<Models<'s>>,
    sources: &'s SourceMap,
}

impl<'s> Planner<'s> {
    /// Fails if a plugin is used and the environment gives it a limit that is none.
    pub(crate) fn new(
        scene: &Scene,
        paths: &[String],
        reading: &Reading,
        sources: &'s SourceMap,
    ) -> Result<Planner<'s>, Failure> {
        let is_plugin = |modifier: &Modifier| matches!(&modifier.kind, ModifierKind::Material(Material::Plugin { library, .. }) if !radsight_render::is_native_library(library));
        let has_plugins = scene.modifiers.items().iter().any(is_plugin);
        if has_plugins {
            reading.plugin_guard.check()?;
        }
        let models = has_plugins.then(|| Models::new(&reading.plugin_options(), paths, sources));
        Ok(Planner { models, sources })
    }

    fn models(&self) -> &dyn ModelSource {
        self.models.as_ref().map_or(&NoModels, |models| models)
    }

    /// The mistakes of a scene's materials.
    pub(crate) fn check_materials(&self, scene: &ValidScene) -> Vec<Diagnostic> {
        check_materials(scene, self.models())
    }

    pub(crate) fn plan(&self, scene: ValidScene, options: RenderOptions) -> Result<RenderPlan, Failure> {
        RenderPlan::new(scene, options, self.models()).map_err(|errors| Failure::diagnostics(&errors, self.sources))
    }

    /// The plugins in use; their faults are reported at the end.
    pub(crate) fn registry(&self) -> Option<&Registry> {
        self.models.as_ref().map(Models::registry)
    }
}

/// Reads and validates a scene that is changed after reading. Warnings are printed; errors end the
/// work.
pub(crate) fn valid_scene(
    inputs: Vec<Input>,
    reading: &Reading,
    change: impl FnOnce(&mut Scene) -> Outcome,
) -> Result<(ValidScene, SourceMap), Failure> {
    let read = read(inputs, reading.commands(), &reading.read_options()?);
    if read.has_errors() || (reading.strict && !read.diagnostics.is_empty()) {
        return Err(Failure::diagnostics(&read.diagnostics, &read.sources));
    }
    let Read { mut scene, sources, diagnostics, .. } = read;
    change(&mut scene)?;
    match scene.validate() {
        Ok(valid) => {
            let warnings: Vec<Diagnostic> = diagnostics.into_iter().chain(valid.warnings).collect();
            if reading.strict && !warnings.is_empty() {
                return Err(Failure::diagnostics(&warnings, &sources));
            }
            if !reading.no_warnings {
                say(&render(&warnings, &sources));
            }
            Ok((valid.scene, sources))
        }
        Err(errors) => Err(Failure::diagnostics(&errors, &sources)),
    }
}

/// Largest number of threads, whatever the number of processors.
const MOST_THREADS: usize = 4096;

/// Starts one thread per processor, for programs without a thread option, unless threads were
/// started before.
pub(crate) fn use_default_threads() -> Outcome {
    static STARTED: Once = Once::new();
    let mut outcome = Ok(());
    STARTED.call_once(|| outcome = use_threads(None));
    outcome
}

/// Sets the number of threads of the process; by default one per processor.
pub(crate) fn use_threads(threads: Option<usize>) -> Outcome {
    if threads == Some(0) {
        return Err(Failure::usage("option \"--threads\" is 0, expected at least 1"));
    }
    if let Some(threads) = threads.filter(|threads| *threads > MOST_THREADS) {
        return Err(Failure::fault(format!("cannot start {threads} threads: the limit is {MOST_THREADS}")));
    }
    radsight_memory::prepare_program();
    // Zero means one per processor. The main thread is one of them: the others wait for it anyway.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .use_current_thread()
        .start_handler(|_| radsight_memory::prepare_thread());
    pool.build_global().map_err(|error| {
        let number = threads.map_or_else(|| "one thread per processor".to_owned(), |n| format!("{n} threads"));
        Failure::fault(format!("cannot start {number}: {error}"))
    })
}

/// The header for output of a Radiance program made from a scene: the history of the octree, the
/// words of the command up to the scene, the software. `command[0]` is the program's name.
pub(crate) fn program_history(scenes: &[String], command: &[String]) -> Header {
    let mut header = scene_history(scenes);
    if header.is_empty() {
        header.push_line("#?RADIANCE");
    }
    header.push_command(command.iter().map(String::as_str));
    header.push_variable("SOFTWARE", concat!(" radsight ", env!("CARGO_PKG_VERSION")));
    header
}

/// The history in the header of an octree; empty for other files.
fn scene_history(paths: &[String]) -> Header {
    let [path] = paths else { return Header::default() };
    if let Some(command) = path.strip_prefix('!') {
        let mut header = Header::new("RADIANCE");
        header.push_line(command);
        return header;
    }
    let start = read_once::beginning(Path::new(path), LONGEST_HEADER);
    match start.ok().and_then(|start| Header::read(&start).ok()) {
        Some((header, _)) if header.format().is_some_and(|format| format == OCTREE_FORMAT) => header.history(),
        _ => Header::default(),
    }
}

/// Longest header of an octree, bytes.
const LONGEST_HEADER: u64 = 1 << 16;

const OCTREE_FORMAT: &str = "Radiance_octree";

/// A header with the command line of the process.
pub(crate) fn history() -> Header {
    let mut header = Header::new("RADIANCE");
    header.push_command(words_of_process().iter().map(String::as_str));
    header
}

/// The words of the process's command line.
pub(crate) fn words_of_process() -> Vec<String> {
    std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect()
}
