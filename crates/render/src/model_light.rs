//! Direct light on a reflectance model from a plugin: all light samples are evaluated in one batch.
//!
//! A call of a plugin costs as much as a small model itself; one call per hit makes this
//! negligible.

use crate::direct::DirectSampler;
use crate::model_batch::BatchSample;
use crate::trace::PathIntegrator;
use radsight_brdf::Brdf;
use radsight_bsdf::{Bsdf, BsdfValue, model_bands, of_model};

impl DirectSampler<'_> {
    /// Radiance reflected and transmitted by the point from all lights.
    pub(crate) fn sample_all_of_model<const BANDS: usize>(
        &self,
        tracer: &mut PathIntegrator<'_, BANDS>,
        point: &Bsdf<'_, BANDS>,
        model: &dyn Brdf,
        first_set: u32,
    ) -> [f64; BANDS] {
        let mut batch = std::mem::take(&mut tracer.workspace.batch);
        batch.samples.clear();
        batch.incident.clear();
        self.for_each_light(tracer, first_set, |tracer, light, _, u| {
            let Some(sample) = self.light_sample(tracer, &light.sampler, u) else { return };
            batch.samples.push(BatchSample { light: light.index, sample, of: light.samples });
            batch.incident.push(point.frame.to_local(sample.direction));
        });
        batch.values.clear();
        batch.values.resize(batch.incident.len() * model_bands::<BANDS>(), 0.0);
        batch.pdfs.clear();
        batch.pdfs.resize(batch.incident.len(), 0.0);
        let mut sum = [0.0; BANDS];
        if !batch.samples.is_empty() {
            let outgoing = point.frame.to_local(point.outgoing);
            model.eval_pdf(outgoing, &batch.incident, &mut batch.values, &mut batch.pdfs);
        }
        let answers = batch.incident.iter().zip(batch.values.chunks_exact(model_bands::<BANDS>())).zip(&batch.pdfs);
        for (light_sample, ((incident, values), pdf)) in batch.samples.iter().zip(answers) {
            let cosine = incident.z.abs();
            let bsdf_value = BsdfValue {
                highlight: of_model(values).map(|band: f64| band * cosine),
                highlight_pdf: if point.sides_agree(light_sample.sample.direction) { *pdf } else { 0.0 },
                ..BsdfValue::NONE
            };
            let light = &tracer.plan.lights[light_sample.light];
            let between = self.between(tracer.plan, light_sample.light);
            let given =
                self.gather(tracer, light, &light_sample.sample, between, f64::from(light_sample.of), &bsdf_value);
            for (sum, given) in sum.iter_mut().zip(given) {
                *sum += given;
            }
        }
        tracer.workspace.batch = batch;
        sum
    }
}
