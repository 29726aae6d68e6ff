//! `rcontrib`: what each ray of standard input owes to the modifiers that are named, in bins.
//!
//! Coefficients (`-V-`) are found by letting each tracked emitter shine with a radiance of 1, so that what arrives is the share of its
//! radiance; contributions (`-V+`) with its own.

mod bins;
mod defaults;
mod options;
mod record;
mod streams;
mod tracked;

use crate::failure::{Failure, Outcome, say};
use crate::input::{Planned, conclude, plan_changed, use_threads};
use crate::output::write_standard_output;
use crate::ray_input::RayReader;
use bins::Bins;
use options::Options;
use radsight_render::Renderer;
use record::{Batch, Records};
use std::io;
use streams::Streams;

/// Runs the program; `words[0]` is its name.
pub(crate) fn run(words: &[String]) -> Outcome {
    let options = Options::parse(words)?;
    if options.print_defaults {
        return write_standard_output(defaults::text(&options).as_bytes());
    }
    use_threads(options.threads)?;
    let bins = options.bins()?;
    let mut render = options.render.clone();
    render.tracked_modifiers = options.tracked.iter().map(|tracked| tracked.name.clone()).collect();
    let change = |scene: &mut _| tracked::prepare(scene, &options);
    let Planned { plan, registry, sources } = plan_changed(&options.scenes, None, &options.reading, render, change)?;
    let renderer = Renderer::new(plan);
    let mut streams = Streams::open(&options, &bins)?;
    trace(&options, &renderer, &bins, &mut streams)?;
    streams.finish()?;
    conclude(renderer.plan(), registry.as_ref(), &sources)
}

fn trace(options: &Options, renderer: &Renderer, bins: &Bins, streams: &mut Streams<'_>) -> Outcome {
    let mut reader = RayReader::new("rcontrib", io::stdin().lock(), options.input_format);
    let mut records = Records::new(options, bins.len());
    let mut left = options.expected_rays();
    let mut rays = Vec::new();
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
        say(&format!(
            "rcontrib: warning - {} contributions with a bin beyond the last were left out\n",
            bins.ignored()
        ));
    }
    match left {
        Some(left) if left > 0 => {
            streams.finish()?;
            Err(Failure::input(format!("rcontrib: standard input ends {left} rays early, expected what -x and -y say")))
        }
        _ => Ok(()),
    }
}
