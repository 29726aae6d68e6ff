//! `rtrace`: rays on standard input, what they meet on standard output.

mod options;
mod rays;
mod record;

use crate::failure::{Failure, Outcome};
use crate::input::{Planned, conclude, history, plan, use_threads};
use options::Options;
use radsight_render::{Ray, Renderer};
use rays::RayReader;
use record::Writer;
use std::io::{self, BufWriter, Write};

/// Rays that are traced at a time: enough for all threads, small enough to stream.
const RAYS_AT_A_TIME: usize = 1 << 15;

/// Runs the program.
pub(crate) fn run(words: &[String]) -> Outcome {
    let options = Options::parse(words)?;
    use_threads(options.threads)?;
    let Planned { plan, registry, sources } = plan(&options.scenes, None, &options.reading, options.render.clone())?;
    let mut renderer = Renderer::new(plan);
    let failed = |error: io::Error| Failure::write("standard output", &error);
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    let writer = Writer::new(&options.output, options.output_format);
    if options.header {
        out.write_all(&header(&writer)).map_err(failed)?;
    }
    let mut reader = RayReader::new(io::stdin().lock(), options.input_format);
    let mut rays = Vec::new();
    let mut first_index = 0;
    let mut bytes = Vec::new();
    loop {
        // A wrong ray ends the stream; the rays before it are answered first.
        let ended = reader.read(if options.unbuffered { 1 } else { RAYS_AT_A_TIME }, &mut rays);
        let to_trace: Vec<Option<Ray>> = rays.iter().map(|ray| ray.ray).collect();
        renderer.gather_irradiance(&to_trace);
        let traced = renderer.trace_all(first_index, &to_trace);
        first_index += rays.len() as u64;
        bytes.clear();
        for (ray, traced) in rays.iter().zip(traced) {
            writer.write(renderer.plan(), ray, traced.as_ref(), &mut bytes);
        }
        out.write_all(&bytes).map_err(failed)?;
        if options.unbuffered || rays.iter().any(|ray| ray.ray.is_none()) {
            out.flush().map_err(failed)?;
        }
        ended?;
        if rays.is_empty() {
            out.flush().map_err(failed)?;
            return conclude(renderer.plan(), registry.as_ref(), &sources);
        }
    }
}

fn header(writer: &Writer<'_>) -> Vec<u8> {
    let mut header = history();
    header.push_variable("SOFTWARE", concat!("radsight ", env!("CARGO_PKG_VERSION")));
    header.push_variable("NCOMP", &writer.numbers().to_string());
    if cfg!(target_endian = "big") && !writer.is_text() {
        header.push_variable("BigEndian", "1");
    }
    header.push_variable("FORMAT", writer.format_name());
    header.to_bytes()
}
