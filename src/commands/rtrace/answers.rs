//! Traces rays of other programs as `rtrace` would.

use super::options::Options;
use crate::failure::{Failure, Outcome};
use crate::input::{Planned, conclude, plan};
use crate::trust::Trust;
use radsight_brdf_host::Registry;
use radsight_diag::SourceMap;
use radsight_film::average;
use radsight_render::{Ray, RaySpacing, Renderer, Traced};

/// A ray tracer with the options and the scene of a command line.
pub(crate) struct RayAnswers {
    options: Options,
    renderer: Renderer,
    registry: Option<Registry>,
    sources: SourceMap,
    next: u64,
}

impl RayAnswers {
    /// `words` are those of `rtrace`, its name first.
    pub(crate) fn new(words: &[String], trust: &Trust) -> Result<RayAnswers, Failure> {
        let options = Options::parse(words, trust)?;
        if options.scenes.is_empty() {
            return Err(Failure::usage("rtrace: no scene is given, expected scene files after the options"));
        }
        let Planned { plan, registry, sources, .. } =
            plan(&options.scenes, None, &options.reading, options.render.clone())?;
        Ok(RayAnswers { options, renderer: Renderer::new(plan), registry, sources, next: 0 })
    }

    /// Fills the irradiance cache for rays like these.
    pub(crate) fn prepare(&mut self, rays: &[Option<Ray>]) {
        self.renderer.gather_irradiance(rays, RaySpacing::UNKNOWN);
    }

    /// Traces a ray.
    pub(crate) fn trace(&mut self, ray: Ray) -> Traced {
        let number = self.next;
        self.next += 1;
        average(&mut self.renderer.worker(), number, &ray, self.options.sampling_budget())
    }

    /// Prints the final messages.
    pub(crate) fn conclude(&self) -> Outcome {
        conclude(self.renderer.plan(), self.registry.as_ref(), &self.sources, &self.options.reading)
    }
}
