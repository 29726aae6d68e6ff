//! `radsight job run`.

use super::{Run, camera, failure, picture_size, read_job};
use crate::args::Reading;
use crate::failure::{Failure, Outcome};
use crate::input::{Planned, conclude, plan, use_threads};
use crate::output::{check_writable, write_file};
use crate::progress::Bar;
use crate::read_once;
use crate::trust::{Existing, Trust};
use radsight::RenderJob;
use radsight_output::{inputs, interrupt};
use radsight_render::Renderer;
use sha2::{Digest, Sha256};
use std::path::Path;

/// Runs the command.
pub(super) fn run(arguments: &Run, trust: &Trust) -> Outcome {
    let output = trust.output(&arguments.output, Existing::Kept)?;
    check_writable(&output)?;
    use_threads(arguments.threads)?;
    let job = read_job(&arguments.job)?;
    let camera = camera(&job)?;
    let [_, rows] = picture_size(&job, camera.as_ref())?;
    let job = match &arguments.part {
        Some(part) => part_of(&job, part, rows)?,
        None => job,
    };
    if job.scenes.is_empty() {
        return Err(Failure::input(format!("\"{}\" names no scene, expected \"scenes\": [\"FILE\"]", arguments.job)));
    }
    let mut reading = Reading::trusted(&trust.for_file());
    reading.plugin_guard = arguments.plugin_guard.clone();
    let options = job.render_options().map_err(failure)?;
    let Planned { plan, registry, sources, .. } = plan(&job.scenes, camera.as_ref(), &reading, options)?;
    let renderer = Renderer::new(plan);
    let bar = Bar::new("rendering");
    let postponed = interrupt::postpone();
    let result = match &camera {
        Some(camera) => job.expose(&renderer, camera, &bar),
        None => job.render(&renderer, &bar),
    };
    bar.finish();
    postponed.end();
    let result = result.map_err(failure)?;
    conclude(renderer.plan(), registry.as_ref(), &sources, &reading)?;
    let Some(mut result) = result else {
        return Err(Failure::fault("interrupted: the part is not written; the same job gives the same values again"));
    };
    result.job.inputs = digest(&arguments.job, sources.texts())?;
    write_file(&output, &result.to_bytes().map_err(failure)?)
}

/// The part of a job that `K/N` says.
fn part_of(job: &RenderJob, part: &str, rows: usize) -> Result<RenderJob, Failure> {
    let numbers = part.split_once('/').and_then(|(part, parts)| Some((part.parse().ok()?, parts.parse().ok()?)));
    let wrong = || {
        Failure::usage(format!(
            "option \"--part\" is \"{part}\", expected a number from 0 and the number of parts, such as 0/4"
        ))
    };
    let (part, parts): (usize, usize) = numbers.filter(|(part, parts)| part < parts).ok_or_else(wrong)?;
    let of_job = job.split(parts, rows).map_err(failure)?;
    let rows = of_job.len();
    of_job.into_iter().nth(part).ok_or_else(|| {
        Failure::usage(format!(
            "option \"--part\" is \"{part}/{parts}\", but the job has only {rows} rows to be parted"
        ))
    })
}

/// Tells inputs apart: what stands in the scene's texts and in all files that were read, but for the job's own.
fn digest<'t>(job: &str, texts: impl Iterator<Item = &'t [u8]>) -> Result<String, Failure> {
    let mut digest = Sha256::new();
    texts.for_each(|text| digest.update(Sha256::digest(text)));
    let mut files: Vec<[u8; 32]> = Vec::new();
    for name in inputs::names().into_iter().filter(|name| name != job) {
        let bytes = read_once::owned(Path::new(&name));
        let bytes = bytes.map_err(|error| Failure::read(&format!("\"{name}\" again"), &error))?;
        files.push(Sha256::digest(bytes).into());
    }
    files.sort_unstable();
    files.iter().for_each(|file| digest.update(file));
    Ok(digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}
