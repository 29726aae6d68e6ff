//! The output record of a ray.

use super::options::{Field, Options};
use crate::output_color::OutputColor;
use crate::output_format::OutputFormat;
use crate::ray_input::InputRay;
use glam::DVec3;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::{FirstHit, RayValue, RenderPlan, Sampling, Traced, TreeRay};
use std::io::Write;

/// Radiance's value for the distance to nothing.
const NOWHERE: f64 = 1e10;

/// The result of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found {
    /// The traced radiance.
    Traced(Traced),
    /// The first hit only.
    Cast(Option<FirstHit>),
    /// No surface is nearer than the limit of the ray.
    Clipped,
}

impl Found {
    /// The result with a limited distance.
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
}

/// The data of a ray that can be written.
#[derive(Clone, Copy, Debug)]
struct Record<'t> {
    origin: DVec3,
    direction: DVec3,
    hit: Option<FirstHit>,
    /// End point. A distant source has no position; Radiance writes the ray's origin.
    end: DVec3,
    value: RayValue,
    effective_distance: f64,
    /// Data of the ray tree, if requested.
    node: Option<&'t TreeRay>,
}

const BLACK: RayValue = RayValue { color: [0.0; 3], spectrum: None };

impl<'t> Record<'t> {
    /// The record of an input ray; one without direction has no result.
    fn of_input(input: &InputRay, found: Option<&Found>, node: Option<&'t TreeRay>) -> Record<'t> {
        let hit = found.and_then(Found::hit);
        let near = hit.filter(|hit| hit.distance < NOWHERE);
        let end = match (found, input.ray) {
            (Some(Found::Clipped), Some(ray)) => ray.at(input.length),
            _ => near.map_or(input.origin, |hit| hit.point),
        };
        let (value, effective_distance) = match found {
            Some(Found::Traced(traced)) => {
                (RayValue { color: traced.value, spectrum: traced.spectrum }, traced.effective_distance)
            }
            _ => (BLACK, NOWHERE),
        };
        let direction = input.ray.map_or(DVec3::ZERO, |ray| ray.direction);
        let node = node.filter(|_| matches!(found, Some(Found::Traced(_))));
        Record { origin: input.origin, direction, hit, end, value, effective_distance, node }
    }

    /// The record of a secondary ray.
    fn of_node(node: &'t TreeRay) -> Record<'t> {
        let near = node.hit.filter(|hit| hit.distance < NOWHERE);
        Record {
            origin: node.ray.origin,
            direction: node.ray.direction,
            hit: node.hit,
            end: near.map_or(node.ray.origin, |hit| hit.point),
            value: node.value,
            effective_distance: node.effective_distance,
            node: Some(node),
        }
    }

    /// Its coefficient; 1 for an input ray.
    fn coefficient(&self) -> RayValue {
        self.node.map_or(RayValue { color: [1.0; 3], spectrum: None }, |node| node.coefficient)
    }

    /// Its contribution to the input ray.
    fn contribution(&self) -> RayValue {
        let Some(node) = self.node else { return self.value };
        let RayValue { color, spectrum } = node.coefficient;
        let color = std::array::from_fn(|band| color[band] * self.value.color[band]);
        let spectrum = match (spectrum, self.value.spectrum) {
            (Some(coefficient), Some(value)) => Some(coefficient.times(&value)),
            (None, value) => value,
            (_, None) => None,
        };
        RayValue { color, spectrum }
    }

    fn mirrored(&self) -> [RayValue; 2] {
        self.node.map_or([BLACK; 2], |node| [node.mirrored, node.unmirrored])
    }

    fn mirrored_distances(&self) -> [f64; 2] {
        let distances = self.node.map(|node| [node.mirrored_distance, node.unmirrored_distance]);
        distances.unwrap_or([NOWHERE; 2]).map(|distance| distance.min(NOWHERE))
    }
}

/// Writes the fields of records.
#[derive(Debug)]
pub(super) struct Writer<'o> {
    options: &'o Options,
    plan: &'o RenderPlan,
}

impl<'o> Writer<'o> {
    pub(super) fn new(options: &'o Options, plan: &'o RenderPlan) -> Self {
        Writer { options, plan }
    }

    /// Appends the record of one input ray, if any field is requested.
    pub(super) fn write(&self, input: &InputRay, found: Option<&Found>, node: Option<&TreeRay>, out: &mut Vec<u8>) {
        if !self.options.output.is_empty() {
            self.put_record(&Record::of_input(input, found, node), &self.options.output, out);
        }
    }

    /// Appends the record of a secondary ray.
    pub(super) fn write_node(&self, node: &TreeRay, fields: &[Field], out: &mut Vec<u8>) {
        self.put_record(&Record::of_node(node), fields, out);
    }

    fn put_record(&self, record: &Record<'_>, fields: &[Field], out: &mut Vec<u8>) {
        let format = self.options.output_format;
        let vector = |value: Option<DVec3>| value.unwrap_or(DVec3::ZERO).to_array();
        let hit = record.hit;
        for field in fields {
            match field {
                Field::Value => self.put_value(&record.value, out),
                Field::Contribution => self.put_value(&record.contribution(), out),
                Field::Coefficient => self.put_share(&record.coefficient(), out),
                Field::Mirrored => self.put_value(&record.mirrored()[0], out),
                Field::Unmirrored => self.put_value(&record.mirrored()[1], out),
                Field::Weight => format.put(&[record.node.map_or(1.0, |node| node.weight)], out),
                Field::Direction => format.put(&record.direction.to_array(), out),
                Field::Origin => format.put(&record.origin.to_array(), out),
                Field::EffectiveDistance => format.put(&[record.effective_distance.min(NOWHERE)], out),
                Field::MirroredDistance => format.put(&record.mirrored_distances()[..1], out),
                Field::UnmirroredDistance => format.put(&record.mirrored_distances()[1..], out),
                Field::FirstDistance => format.put(&[hit.map_or(NOWHERE, |hit| hit.distance.min(NOWHERE))], out),
                Field::Local => format.put(&hit.map_or([0.0; 2], |hit| hit.local), out),
                Field::Point => format.put(&record.end.to_array(), out),
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

    /// Appends the components of a value.
    fn put_value(&self, value: &RayValue, out: &mut Vec<u8>) {
        let mut components = [0.0; Sampling::MOST_BANDS];
        match value.spectrum {
            Some(spectrum) if self.options.color == OutputColor::Bands => {
                for (component, band) in components.iter_mut().zip(spectrum.as_slice()) {
                    *component = f64::from(*band);
                }
            }
            _ => components[..3].copy_from_slice(&self.options.color.of(value.color)),
        }
        let sampling = &self.options.render.sampling;
        if let Some(response) = value.spectrum.and_then(|s| self.options.color.of_spectrum(s.as_slice(), sampling)) {
            components[0] = response;
        }
        self.options.output_format.put(&components[..self.options.components()], out);
    }

    /// Appends the components of a coefficient, which has no unit; that of an input ray is 1.
    fn put_share(&self, share: &RayValue, out: &mut Vec<u8>) {
        match share.spectrum {
            None if share.color == [1.0; 3] => {
                let ones = [1.0; Sampling::MOST_BANDS];
                self.options.output_format.put(&ones[..self.options.components()], out);
            }
            _ => {
                let unit = self.options.color.unit();
                let scaled = RayValue { color: share.color.map(|band| band / unit), ..*share };
                self.put_value(&scaled, out);
            }
        }
    }

    fn name_out(&self, hit: Option<FirstHit>, which: usize, out: &mut Vec<u8>) {
        let _ = write!(out, "{}\t", hit.map_or("*", |hit| self.plan.names_at(&hit)[which]));
    }
}
