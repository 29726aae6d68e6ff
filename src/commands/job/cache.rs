//! `radsight job cache`.

use super::inputs::Inputs;
use super::{Cache, failure};
use crate::ambient_file::FORMAT;
use crate::failure::{Failure, Outcome};
use crate::input::{Planned, conclude, history, use_threads};
use crate::output::{reserve_output, write_file};
use crate::progress::Bar;
use crate::trust::{Existing, Trust};
use radsight_output::interrupt;
use radsight_render::Renderer;

/// Runs the command.
pub(super) fn run(arguments: &Cache, trust: &Trust) -> Outcome {
    let output = trust.output(&arguments.output, Existing::Kept)?;
    reserve_output(&output)?;
    use_threads(arguments.threads)?;
    let mut inputs = Inputs::read(&arguments.job)?;
    // The file exists when the job reads it.
    inputs.job.irradiance_cache.get_or_insert_with(|| arguments.output.clone());
    let (Planned { plan, registry, sources, fingerprint }, reading) = inputs.plan(&arguments.plugin_guard, trust)?;
    let mut renderer = Renderer::new(plan);
    let bar = Bar::new("gathering irradiance");
    let postponed = interrupt::postpone();
    let filled = inputs.job.fill_irradiance_cache(&mut renderer, &inputs.rays, &bar);
    bar.finish();
    postponed.end();
    let filled = filled.map_err(failure)?;
    conclude(renderer.plan(), registry.as_ref(), &sources, &reading)?;
    let cache = fingerprint.and_then(|scene| renderer.save_irradiance_cache(scene));
    let Some(cache) = cache.filter(|_| filled.is_some()) else {
        return Err(Failure::fault("interrupted: the irradiance cache is not written"));
    };
    let mut header = history();
    header.push_variable("SOFTWARE", concat!(" radsight ", env!("CARGO_PKG_VERSION")));
    header.push_variable("FORMAT", FORMAT);
    write_file(&output, &[header.to_bytes(), cache].concat())
}
