//! `rtrace`: traces rays from standard input.

mod answers;
mod defaults;
mod options;
mod record;
mod tree;

use crate::ambient_file::AmbientFile;
use crate::clock::push_date;
use crate::failure::{Failure, Outcome, say, say_in};
use crate::input::{Planned, conclude, plan, program_history, use_threads};
use crate::output::standard_output;
use crate::output_color::OutputColor;
use crate::ray_input::{InputRay, RayReader};
use crate::trust::Trust;
pub(crate) use answers::RayAnswers;
use options::Options;
use radsight_film::{SamplingBudget, average};
use radsight_picture::Resolution;
use radsight_render::{Ray, RaySpacing, Renderer};
use rayon::prelude::*;
use record::{Found, Writer};
use std::io::{self, BufWriter, Write};

/// Number of rays traced at a time: enough for all threads, few enough to stream.
const RAYS_AT_A_TIME: usize = 1 << 15;

/// Number of records that a thread writes at a time.
const RECORDS_AT_A_TIME: usize = 1 << 10;

/// Runs the program; `words[0]` is its name.
pub(crate) fn run(words: &[String], trust: &Trust) -> Outcome {
    let options = Options::parse(words, trust)?;
    if let Some(path) = &options.error_file {
        say_in(path, words)?;
    }
    use_threads(options.threads)?;
    let planned = plan(&options.scenes, None, &options.reading, options.render.clone())?;
    let Planned { plan, registry, sources, fingerprint } = planned;
    let mut renderer = Renderer::new(plan);
    let command = (options.command.as_slice(), options.scenes.as_slice());
    let mut ambient = AmbientFile::open(&options.reading, command, fingerprint, &mut renderer)?;
    trace(&options, &mut renderer, &mut ambient)?;
    ambient.settle(&mut renderer)?;
    conclude(renderer.plan(), registry.as_ref(), &sources, &options.reading)
}

fn trace(options: &Options, renderer: &mut Renderer, ambient: &mut AmbientFile) -> Outcome {
    let failed = |error: io::Error| Failure::write("standard output", &error);
    let mut out = BufWriter::with_capacity(1 << 16, standard_output());
    out.write_all(&start(options)).map_err(failed)?;
    let pace = Pace::new(options);
    let mut left = pace.total;
    let mut reader = RayReader::new("rtrace", io::stdin().lock(), options.input_format);
    let mut rays = Vec::new();
    let mut first_index = 0;
    loop {
        // An invalid ray ends the stream; the rays before it are traced first.
        let most = left.map_or(pace.at_a_time, |left| left.min(pace.at_a_time as u64) as usize);
        let ended = reader.read(most, &mut rays);
        for bytes in answers(options, renderer, ambient, (first_index, &rays))? {
            out.write_all(&bytes).map_err(failed)?;
        }
        first_index += rays.len() as u64;
        if pace.flushes || rays.iter().any(|ray| ray.ray.is_none()) {
            out.flush().map_err(failed)?;
        }
        ended?;
        if let Some(left) = &mut left {
            *left -= rays.iter().filter(|ray| ray.ray.is_some()).count() as u64;
        }
        if rays.is_empty() || left == Some(0) {
            if left.is_some_and(|left| left > 0) && !options.reading.no_warnings {
                say("rtrace: warning - unexpected EOF on input\n");
            }
            return out.flush().map_err(failed);
        }
    }
}

/// Number of rays read before their records are written.
struct Pace {
    at_a_time: usize,
    flushes: bool,
    /// Number of rays after which the work ends, whatever the input holds.
    total: Option<u64>,
}

impl Pace {
    fn new(options: &Options) -> Pace {
        let [columns, rows] = options.size;
        let interval = if rows == 0 || columns <= 1 { columns } else { 0 };
        let total = if columns > 1 { columns.saturating_mul(rows) } else { rows };
        Pace {
            at_a_time: if interval > 0 { (interval as usize).min(RAYS_AT_A_TIME) } else { RAYS_AT_A_TIME },
            flushes: interval > 0,
            total: (total > 0).then_some(total),
        }
    }
}

/// The records of some rays, in pieces.
fn answers(
    options: &Options,
    renderer: &mut Renderer,
    ambient: &mut AmbientFile,
    (first_index, rays): (u64, &[InputRay]),
) -> Result<Vec<Vec<u8>>, Failure> {
    if options.tree.is_some() {
        return Ok(tree::answers(options, renderer, first_index, rays));
    }
    let to_trace: Vec<Option<Ray>> = rays.iter().map(|ray| ray.ray).collect();
    let found: Vec<Option<Found>> = if options.output.iter().any(|field| field.needs_tracing()) {
        ambient.gather(renderer, &to_trace, RaySpacing::UNKNOWN)?;
        if options.render.ray_tree.is_some() {
            return Ok(tree::answers(options, renderer, first_index, rays));
        }
        let limits = options.limits_distance.then(|| rays.iter().map(|ray| ray.length).collect());
        trace_all(renderer, first_index, &to_trace, limits, options.sampling_budget())
    } else {
        let cast = |ray: &Option<Ray>| ray.as_ref().map(|ray| Found::Cast(renderer.plan().cast(ray)));
        to_trace.par_iter().with_min_len(RECORDS_AT_A_TIME).map(cast).collect()
    };
    let limits = options.limits_rays();
    let writer = Writer::new(options, renderer.plan());
    let pieces = rays.par_chunks(RECORDS_AT_A_TIME).zip(found.par_chunks(RECORDS_AT_A_TIME));
    let written = pieces.map(|(rays, found)| {
        let mut bytes = Vec::new();
        for (ray, found) in rays.iter().zip(found) {
            let found = if limits { found.map(|found| found.clipped(ray.length)) } else { *found };
            writer.write(ray, found.as_ref(), None, &mut bytes);
        }
        bytes
    });
    Ok(written.collect())
}

/// Traces rays. `limits` gives the largest distance of each, if limited.
fn trace_all(
    renderer: &Renderer,
    first_index: u64,
    rays: &[Option<Ray>],
    limits: Option<Vec<f64>>,
    sampling_budget: SamplingBudget,
) -> Vec<Option<Found>> {
    if sampling_budget == SamplingBudget::Samples(1) && limits.is_none() {
        let traced = renderer.trace_all(first_index, rays);
        return traced.into_iter().map(|traced| traced.map(Found::Traced)).collect();
    }
    rays.par_iter()
        .enumerate()
        .map_init(
            || renderer.worker(),
            |worker, (place, ray)| {
                let number = first_index + place as u64;
                if let Some(limits) = &limits {
                    worker.limit_distance(limits[place]);
                }
                ray.as_ref().map(|ray| Found::Traced(average(worker, number, ray, sampling_budget)))
            },
        )
        .collect()
}

/// The header before the records.
fn start(options: &Options) -> Vec<u8> {
    let mut bytes = if options.header { header(options) } else { Vec::new() };
    let [columns, rows] = options.size;
    if columns > 0 && rows > 0 {
        bytes.extend_from_slice(format!("{}\n", Resolution::standard(columns as usize, rows as usize)).as_bytes());
    }
    bytes
}

fn header(options: &Options) -> Vec<u8> {
    let mut header = program_history(&options.scenes, &options.command);
    push_date(&mut header);
    if options.tree.is_none() {
        header.push_variable("NCOMP", &options.numbers().to_string());
    }
    if options.color == OutputColor::Bands {
        let splits = options.render.sampling.splits_nm().map(|split| split.to_string());
        header.push_variable("WAVELENGTH_SPLITS", &format!(" {}", splits.join(" ")));
    }
    if let Some(primaries) = options.color.primaries() {
        header.push_variable("PRIMARIES", &primaries.to_header_value());
    }
    let pixels = match options.color {
        OutputColor::Xyz(_) => "32-bit_rle_xyze",
        OutputColor::Bands if options.components() > 3 => "Radiance_spectra",
        _ => "32-bit_rle_rgbe",
    };
    options.output_format.end_header(&mut header, pixels);
    header.to_bytes()
}
