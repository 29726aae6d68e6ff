//! Reading what commands need: camera files, scenes, standard input.

use crate::disk::{Commands, DiskLoader};
use crate::failure::{Failure, Outcome, reason, render};
use radsight_camera::CameraFile;
use radsight_diag::{Diagnostic, SourceMap};
use radsight_ir::ValidScene;
use radsight_loader::Loader;
use radsight_parse::{Input, Read, ReadOptions, read_scene};
use radsight_picture::Header;
use radsight_render::{RenderOptions, RenderPlan};
use std::io::{self, Read as _};

/// Reads a camera file and prints its warnings.
pub(crate) fn read_camera(path: &str) -> Result<CameraFile, Failure> {
    let loader = DiskLoader::new(Commands::Refused);
    let bytes = read_file(path, "camera file")?;
    let mut sources = SourceMap::default();
    match CameraFile::read(path, &bytes, &mut sources, &loader) {
        Ok(file) => {
            eprint!("{}", render(&file.warnings, &sources));
            Ok(file)
        }
        Err(errors) => Err(Failure::diagnostics(&errors, &sources)),
    }
}

/// The bytes of a file that the command line names.
pub(crate) fn read_file(path: &str, what: &str) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| Failure::input(format!("cannot read {what} \"{path}\": {}", reason(&error))))
}

/// All of standard input.
pub(crate) fn read_standard_input() -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    io::stdin()
        .lock()
        .read_to_end(&mut bytes)
        .map_err(|error| Failure::input(format!("cannot read standard input: {}", reason(&error))))?;
    Ok(bytes)
}

/// The texts of scenes: files, `-` for standard input, and the light ring of a camera file.
pub(crate) fn scene_inputs(paths: &[String], camera: Option<&CameraFile>) -> Result<Vec<Input>, Failure> {
    let mut inputs = Vec::new();
    for path in paths {
        let bytes = match path.as_str() {
            "-" => read_standard_input()?,
            path => read_file(path, "scene file")?,
        };
        let name = if path == "-" { "<standard input>" } else { path };
        inputs.push(Input::Text { name: name.to_owned(), text: bytes.into() });
    }
    if let Some(rig) = camera.and_then(|file| file.rig.as_ref()) {
        inputs.push(Input::Text { name: "<light ring>".to_owned(), text: rig.scene_text().into_bytes().into() });
    }
    Ok(inputs)
}

/// Reads scenes and gives everything that was found.
pub(crate) fn read(inputs: Vec<Input>, commands: Commands, options: &ReadOptions) -> Read {
    let loader: &dyn Loader = &DiskLoader::new(commands);
    read_scene(&inputs, loader, options)
}

/// Reads and validates a scene and plans its rendering. Warnings are printed, errors end the work.
pub(crate) fn plan(
    paths: &[String],
    camera: Option<&CameraFile>,
    commands: Commands,
    render_options: RenderOptions,
) -> Result<RenderPlan, Failure> {
    let inputs = scene_inputs(paths, camera)?;
    let (scene, sources) = valid_scene(inputs, commands)?;
    RenderPlan::new(scene, render_options, &radsight_render::NoModels)
        .map_err(|errors| Failure::diagnostics(&errors, &sources))
}

fn valid_scene(inputs: Vec<Input>, commands: Commands) -> Result<(ValidScene, SourceMap), Failure> {
    let read = read(inputs, commands, &ReadOptions::default());
    if read.has_errors() {
        return Err(Failure::diagnostics(&read.diagnostics, &read.sources));
    }
    let Read { scene, sources, diagnostics, .. } = read;
    match scene.validate() {
        Ok(valid) => {
            let warnings: Vec<Diagnostic> = diagnostics.into_iter().chain(valid.warnings).collect();
            eprint!("{}", render(&warnings, &sources));
            Ok((valid.scene, sources))
        }
        Err(errors) => Err(Failure::diagnostics(&errors, &sources)),
    }
}

/// Sets the number of threads for everything that follows.
pub(crate) fn use_threads(threads: Option<usize>) -> Outcome {
    let Some(threads) = threads else { return Ok(()) };
    if threads == 0 {
        return Err(Failure::usage("option \"--threads\" is 0, expected at least 1"));
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|error| Failure::fault(format!("cannot start {threads} threads: {error}")))
}

/// A header that says how the output was made.
pub(crate) fn history() -> Header {
    let mut header = Header::new("#?RADIANCE");
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    header.push_command(words.iter().map(String::as_str));
    header
}
