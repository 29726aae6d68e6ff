//! `radsight job run`.

use super::inputs::Inputs;
use super::{Run, failure};
use crate::failure::{Failure, Outcome};
use crate::input::{Planned, conclude, use_threads};
use crate::output::{reserve_output, write_file};
use crate::progress::Bar;
use crate::read_once;
use crate::trust::{Existing, Trust};
use radsight::{JobTarget, RenderJob};
use radsight_output::{inputs, interrupt};
use radsight_render::Renderer;
use sha2::{Digest, Sha256};
use std::path::Path;

/// Runs the command.
pub(super) fn run(arguments: &Run, trust: &Trust) -> Outcome {
    let output = trust.output(&arguments.output, Existing::Kept)?;
    reserve_output(&output)?;
    use_threads(arguments.threads)?;
    let mut inputs = Inputs::read(&arguments.job)?;
    if let Some(part) = &arguments.part {
        inputs.job = part_of(&inputs.job, part, inputs.size)?;
    }
    let (Planned { plan, registry, sources, fingerprint }, reading) = inputs.plan(&arguments.plugin_guard, trust)?;
    let mut renderer = Renderer::new(plan);
    inputs.load_cache(&mut renderer, fingerprint)?;
    let bar = Bar::new("rendering");
    let postponed = interrupt::postpone();
    let result = match (&inputs.job.target, &inputs.camera) {
        (_, Some(camera)) => inputs.job.expose(&renderer, camera, &bar),
        (JobTarget::Trace { .. }, None) => inputs.job.trace(&renderer, &inputs.rays, &bar),
        (_, None) => inputs.job.render(&renderer, &bar),
    };
    bar.finish();
    postponed.end();
    let result = result.map_err(failure)?;
    conclude(renderer.plan(), registry.as_ref(), &sources, &reading)?;
    let Some(mut result) = result else {
        return Err(Failure::fault("interrupted: the part is not written; run the job again to get the same values"));
    };
    result.job.inputs = digest(&arguments.job, sources.texts())?;
    write_file(&output, &result.to_bytes().map_err(failure)?)
}

/// The part of a job that `K/N` says.
fn part_of(job: &RenderJob, part: &str, size: [usize; 2]) -> Result<RenderJob, Failure> {
    let numbers = part.split_once('/').and_then(|(part, parts)| Some((part.parse().ok()?, parts.parse().ok()?)));
    let wrong = || {
        Failure::usage(format!(
            "option \"--part\" is \"{part}\", expected a number from 0 and the number of parts, such as 0/4"
        ))
    };
    let (part, parts): (usize, usize) = numbers.filter(|(part, parts)| part < parts).ok_or_else(wrong)?;
    let of_job = job.split(parts, size).map_err(failure)?;
    let most = of_job.len();
    of_job.into_iter().nth(part).ok_or_else(|| {
        Failure::usage(format!("option \"--part\" is \"{part}/{parts}\", but the job has only {most} rows or rays"))
    })
}

/// Tells inputs apart: what stands in the scene's texts and in all files that were read, but for
/// the job's own.
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
