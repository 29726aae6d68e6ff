//! `rcontrib`: the contributions of named modifiers to each ray of standard input, in bins.
//!
//! For coefficients (`-V-`) each tracked emitter gets a radiance of 1, so its contribution is its
//! coefficient; for contributions (`-V+`) it keeps its own radiance.

mod bins;
mod defaults;
mod options;
mod record;
mod recover;
mod streams;
mod tracked;

use crate::expand::CommandWords;
use crate::failure::{Failure, Outcome, say};
use crate::input::{Planned, conclude, plan_changed, use_threads};
use crate::ray_input::{InputRay, RayReader};
use crate::trust::{Existing, Trust};
use bins::Bins;
use options::{Options, Wanted};
use radsight_render::{Renderer, TrackedValue};
use record::{Batch, Earlier, Records};
use recover::Reopened;
use std::io::{self, Read};
use streams::Streams;

/// Runs the program; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Outcome {
    let mut options = Options::parse(CommandWords::new(words, trust.origin()), trust)?;
    options.existing_of_files = if options.overwrites { Existing::Replaced } else { Existing::Kept };
    run_with(options, io::stdin().lock())
}

/// Runs it on rays from another source, in the format of the options. `existing` are the files that
/// words of files may overwrite.
pub(crate) fn run_on(words: CommandWords, trust: &Trust, existing: Existing<'static>, input: impl Read) -> Outcome {
    let mut options = Options::parse(words, trust)?;
    options.existing_of_files = existing;
    run_with(options, input)
}

fn run_with(options: Options, input: impl Read) -> Outcome {
    use_threads(options.threads)?;
    let bins = options.bins()?;
    let mut render = options.render.clone();
    render.tracked_modifiers = options.tracked.iter().map(|tracked| tracked.name.clone()).collect();
    render.tracked_value = match options.wanted {
        Wanted::Coefficients => TrackedValue::Share,
        Wanted::Contributions => TrackedValue::Radiance,
    };
    let change = |scene: &mut _| {
        tracked::prepare(scene, &options);
        Ok(())
    };
    let Planned { plan, registry, sources, .. } =
        plan_changed(&options.scenes, None, &options.reading, render, change)?;
    let renderer = Renderer::new(plan);
    let reopened = if options.recovers { recover::reopen(&options, &bins)? } else { Reopened::Nothing };
    let (mut streams, earlier) = match reopened {
        Reopened::Nothing => (Streams::open(&options, &bins)?, Earlier::Nothing),
        Reopened::Everything => return Ok(()),
        Reopened::Some(streams, earlier) => (streams, earlier),
    };
    trace(&options, &renderer, &bins, (&mut streams, earlier), input)?;
    streams.finish()?;
    conclude(renderer.plan(), registry.as_ref(), &sources, &options.reading)
}

fn trace(
    options: &Options,
    renderer: &Renderer,
    bins: &Bins,
    (streams, earlier): (&mut Streams<'_>, Earlier),
    input: impl Read,
) -> Outcome {
    let mut reader = RayReader::new("rcontrib", input, options.input_format);
    let mut records = Records::new(options, bins.len());
    let mut left = options.expected_rays();
    let mut rays = Vec::new();
    if let Earlier::Rays(answered) = earlier {
        pass_over(&mut reader, answered, &mut rays)?;
        left = left.map(|left| left.saturating_sub(answered));
    }
    records.go_on(earlier);
    loop {
        let at_a_time = records.rays_at_a_time();
        let most = left.map_or(at_a_time, |left| left.min(at_a_time as u64) as usize);
        let ended = reader.read(most, &mut rays);
        let flushes = options.flush_interval().is_some() || rays.iter().any(|ray| ray.ray.is_none());
        let batch = Batch { renderer, bins, rays: &rays };
        records.add(&batch, |values| streams.put(values))?;
        if flushes {
            streams.flush()?;
        }
        ended?;
        if let Some(left) = &mut left {
            *left -= rays.len() as u64;
        }
        if rays.is_empty() || left == Some(0) {
            break;
        }
    }
    if let Some(values) = records.rest() {
        if options.accumulate > 1 && !options.reading.no_warnings {
            say("rcontrib: warning - partial accumulation in final record\n");
        }
        streams.put(&values)?;
    }
    if bins.ignored() > 0 && !options.reading.no_warnings {
        say(&format!("rcontrib: warning - {} contributions with a bin beyond the last were ignored\n", bins.ignored()));
    }
    match left {
        Some(left) if left > 0 => {
            streams.finish()?;
            Err(Failure::input(format!(
                "rcontrib: standard input ends {left} rays before the number given by -x and -y"
            )))
        }
        _ => Ok(()),
    }
}

/// Skips rays that an earlier run has traced.
fn pass_over<R: Read>(reader: &mut RayReader<R>, count: u64, rays: &mut Vec<InputRay>) -> Outcome {
    let mut left = count;
    while left > 0 {
        reader.read(left.min(1 << 15) as usize, rays)?;
        if rays.is_empty() {
            return Err(Failure::input(format!(
                "rcontrib: standard input ends {left} rays before the {count} that the output already has"
            )));
        }
        left -= rays.len() as u64;
    }
    Ok(())
}
