//! What is written for a ray.

use super::options::Field;
use super::rays::InputRay;
use glam::DVec3;
use radsight_picture::scientific;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::{RenderPlan, Traced};
use std::io::Write;

/// Digits after the point of a number in text.
const DIGITS: usize = 6;

/// What Radiance writes for a distance to nothing.
const NOWHERE: f64 = 1e10;

/// Writes records of fields.
#[derive(Debug)]
pub(super) struct Writer<'o> {
    fields: &'o [Field],
    format: NumberFormat,
}

impl<'o> Writer<'o> {
    pub(super) fn new(fields: &'o [Field], format: NumberFormat) -> Self {
        Writer { fields, format }
    }

    /// Numbers in a record, names counted as one each.
    pub(super) fn numbers(&self) -> usize {
        self.fields
            .iter()
            .map(|field| match field {
                Field::Value
                | Field::Direction
                | Field::Origin
                | Field::Point
                | Field::PerturbedNormal
                | Field::Normal => 3,
                _ => 1,
            })
            .sum()
    }

    pub(super) fn is_text(&self) -> bool {
        self.format == NumberFormat::Ascii
    }

    pub(super) fn format_name(&self) -> &'static str {
        match self.format {
            NumberFormat::Ascii => "ascii",
            NumberFormat::Float => "float",
            NumberFormat::Double => "double",
        }
    }

    /// Appends the record of one ray.
    pub(super) fn write(&self, plan: &RenderPlan, input: &InputRay, traced: Option<&Traced>, out: &mut Vec<u8>) {
        let hit = traced.and_then(|traced| traced.first_hit);
        let vector = |value: Option<DVec3>| value.unwrap_or(DVec3::ZERO).to_array();
        for field in self.fields {
            match field {
                Field::Value => self.numbers_out(&traced.map_or([0.0; 3], |traced| traced.value), out),
                Field::Direction => self.numbers_out(&vector(input.ray.map(|ray| ray.direction)), out),
                Field::Origin => self.numbers_out(&input.origin.to_array(), out),
                Field::EffectiveDistance => {
                    self.numbers_out(&[distance(traced.map(|traced| traced.effective_distance))], out);
                }
                Field::FirstDistance => self.numbers_out(&[distance(hit.map(|hit| hit.distance))], out),
                Field::Point => {
                    // What is infinitely far away has no place; Radiance gives the ray's origin.
                    let near = hit.filter(|hit| hit.distance < NOWHERE);
                    self.numbers_out(&near.map_or(input.origin, |hit| hit.point).to_array(), out);
                }
                Field::PerturbedNormal => self.numbers_out(&vector(hit.map(|hit| hit.perturbed_normal)), out),
                Field::Normal => self.numbers_out(&vector(hit.map(|hit| hit.normal)), out),
                Field::Surface => name_out(hit.map(|hit| plan.names_at(&hit)[0]), out),
                Field::Modifier => name_out(hit.map(|hit| plan.names_at(&hit)[1]), out),
                Field::Weight => self.numbers_out(&[1.0], out),
            }
        }
        if self.is_text() {
            out.push(b'\n');
        }
    }

    fn numbers_out(&self, values: &[f64], out: &mut Vec<u8>) {
        match self.format {
            NumberFormat::Ascii => {
                for value in values {
                    out.extend_from_slice(scientific(*value, DIGITS).as_bytes());
                    out.push(b'\t');
                }
            }
            format => format.encode(values, out),
        }
    }
}

fn distance(value: Option<f64>) -> f64 {
    value.unwrap_or(NOWHERE).min(NOWHERE)
}

fn name_out(name: Option<&str>, out: &mut Vec<u8>) {
    let _ = write!(out, "{}\t", name.unwrap_or("*"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_look_as_c_prints_them() {
        assert_eq!(scientific(0.05, DIGITS), "5.000000e-02");
        assert_eq!(scientific(-1e10, DIGITS), "-1.000000e+10");
        assert_eq!(scientific(1e-123, DIGITS), "1.000000e-123");
    }
}
