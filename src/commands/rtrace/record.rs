//! What is written for a ray.

use super::options::{Field, Options};
use crate::output_color::OutputColor;
use crate::output_format::OutputFormat;
use crate::ray_input::InputRay;
use glam::DVec3;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::{BandValues, FirstHit, RenderPlan, Sampling, Traced};
use std::io::Write;

/// What Radiance writes for a distance to nothing.
const NOWHERE: f64 = 1e10;

/// What was found out of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found {
    /// Everything.
    Traced(Traced),
    /// Only where it ends.
    Cast(Option<FirstHit>),
    /// That nothing is nearer than where it was to end.
    Clipped,
}

impl Found {
    /// The same, but nothing is seen beyond a distance.
    pub(super) fn clipped(self, distance: f64) -> Found {
        if self.hit().is_some_and(|hit| hit.distance <= distance) { self } else { Found::Clipped }
    }

    fn hit(&self) -> Option<FirstHit> {
        match self {
            Found::Traced(traced) => traced.first_hit,
            Found::Cast(hit) => *hit,
            Found::Clipped => None,
        }
    }

    fn value(&self) -> [f64; 3] {
        match self {
            Found::Traced(traced) => traced.value,
            Found::Cast(_) | Found::Clipped => [0.0; 3],
        }
    }

    fn spectrum(&self) -> Option<BandValues> {
        match self {
            Found::Traced(traced) => traced.spectrum,
            Found::Cast(_) | Found::Clipped => None,
        }
    }

    fn effective_distance(&self) -> Option<f64> {
        match self {
            Found::Traced(traced) => Some(traced.effective_distance),
            Found::Cast(_) | Found::Clipped => None,
        }
    }
}

/// Writes records of fields.
#[derive(Debug)]
pub(super) struct Writer<'o> {
    options: &'o Options,
    plan: &'o RenderPlan,
}

impl<'o> Writer<'o> {
    pub(super) fn new(options: &'o Options, plan: &'o RenderPlan) -> Self {
        Writer { options, plan }
    }

    /// Appends the record of one ray; of a ray without direction nothing was found.
    pub(super) fn write(&self, input: &InputRay, found: Option<&Found>, out: &mut Vec<u8>) {
        let mut bands = [0.0; Sampling::MOST_BANDS];
        let value = self.value(found, &mut bands);
        let format = self.options.output_format;
        if format == OutputFormat::Pixels {
            return format.put(value, out);
        }
        let hit = found.and_then(Found::hit);
        let vector = |value: Option<DVec3>| value.unwrap_or(DVec3::ZERO).to_array();
        for field in &self.options.output {
            match field {
                Field::Value | Field::Contribution => format.put(value, out),
                // The input ray is the whole of itself.
                Field::Coefficient => format.put(&[1.0; Sampling::MOST_BANDS][..value.len()], out),
                Field::Weight => format.put(&[1.0], out),
                Field::Direction => format.put(&vector(input.ray.map(|ray| ray.direction)), out),
                Field::Origin => format.put(&input.origin.to_array(), out),
                Field::EffectiveDistance => {
                    format.put(&[distance(found.and_then(Found::effective_distance))], out);
                }
                Field::FirstDistance => format.put(&[distance(hit.map(|hit| hit.distance))], out),
                Field::Local => format.put(&hit.map_or([0.0; 2], |hit| hit.local), out),
                Field::Point => format.put(&end(input, found).to_array(), out),
                Field::PerturbedNormal => format.put(&vector(hit.map(|hit| hit.perturbed_normal)), out),
                Field::Normal => format.put(&vector(hit.map(|hit| hit.normal)), out),
                Field::Surface => self.name_out(hit, 0, out),
                Field::Modifier => self.name_out(hit, 1, out),
                Field::Material => self.name_out(hit, 2, out),
                Field::Tilde => out.extend_from_slice(b"~\t"),
            }
        }
        if format == OutputFormat::Numbers(NumberFormat::Ascii) {
            out.push(b'\n');
        }
    }

    /// The components of what a ray brings; `bands` is where they are put.
    fn value<'b>(&self, found: Option<&Found>, bands: &'b mut [f64; Sampling::MOST_BANDS]) -> &'b [f64] {
        match found.and_then(Found::spectrum) {
            Some(spectrum) if self.options.color == OutputColor::Bands => {
                for (band, value) in bands.iter_mut().zip(spectrum.as_slice()) {
                    *band = f64::from(*value);
                }
            }
            _ => bands[..3].copy_from_slice(&self.options.color.of(found.map_or([0.0; 3], Found::value))),
        }
        &bands[..self.options.components()]
    }

    fn name_out(&self, hit: Option<FirstHit>, which: usize, out: &mut Vec<u8>) {
        let _ = write!(out, "{}\t", hit.map_or("*", |hit| self.plan.names_at(&hit)[which]));
    }
}

/// The point where a ray ends. What is infinitely far away has no place; Radiance gives the ray's origin.
fn end(input: &InputRay, found: Option<&Found>) -> DVec3 {
    match (found, input.ray) {
        (Some(Found::Clipped), Some(ray)) => ray.at(input.length),
        _ => {
            let near = found.and_then(Found::hit).filter(|hit| hit.distance < NOWHERE);
            near.map_or(input.origin, |hit| hit.point)
        }
    }
}

fn distance(value: Option<f64>) -> f64 {
    value.unwrap_or(NOWHERE).min(NOWHERE)
}
