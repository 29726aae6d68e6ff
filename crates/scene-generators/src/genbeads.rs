//! `genbeads material name p0 p1 r0 r1 rad inc`: a string of beads along a Hermite curve.
//!
//! The curve runs from `p0` to `p1` with the end tangents `r0` and `r1` (three numbers each).
//! Spheres of radius `rad` are spaced by approximately `inc`, in scene units.

use std::fmt::Write;

use crate::arguments::Arguments;
use crate::facets::{dot, subtract};
use crate::text::{Text, wide};
use crate::{Error, Invocation, Output};

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let material = arguments.required("material")?;
    let name = arguments.required("name")?;
    let ends = [arguments.vector("p0")?, arguments.vector("p1")?];
    let tangents = [arguments.vector("r0")?, arguments.vector("r1")?];
    let radius = arguments.number("rad")?;
    let spacing = arguments.positive("inc")?;
    if arguments.word().is_some() {
        return Err(arguments.unknown());
    }
    let curve = |weights: [f64; 4]| -> [f64; 3] {
        std::array::from_fn(|axis| {
            ends[0][axis] * weights[0]
                + ends[1][axis] * weights[1]
                + tangents[0][axis] * weights[2]
                + tangents[1][axis] * weights[3]
        })
    };
    let mut text = Text::default();
    let chord = subtract(ends[1], ends[0]);
    text.expect_room(dot(chord, chord).sqrt() / spacing, 80.0)?;
    let (mut t, mut bead) = (0.0, 0usize);
    while t <= 1.0 {
        let [x, y, z] = curve(hermite(t));
        write!(text, "\n{material} sphere {name}.{bead}\n0\n0\n")?;
        writeln!(text, "4 {} {} {} {}", wide(x), wide(y), wide(z), wide(radius))?;
        let [dx, dy, dz] = curve(hermite_slope(t));
        let speed = (dx * dx + dy * dy + dz * dz).sqrt();
        let next = t + spacing / speed;
        if next.partial_cmp(&t) != Some(std::cmp::Ordering::Greater) {
            return Err(arguments.impossible(format!("beads {spacing} apart never reach the end of the curve")));
        }
        (t, bead) = (next, bead + 1);
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

/// The Hermite basis functions at `t` (0 to 1): weights of the two ends and the two tangents.
pub(crate) fn hermite(t: f64) -> [f64; 4] {
    [(2.0 * t - 3.0) * t * t + 1.0, (-2.0 * t + 3.0) * t * t, ((t - 2.0) * t + 1.0) * t, (t - 1.0) * t * t]
}

/// The derivatives of the basis functions.
fn hermite_slope(t: f64) -> [f64; 4] {
    [(6.0 * t - 6.0) * t, (-6.0 * t + 6.0) * t, (3.0 * t - 4.0) * t + 1.0, (3.0 * t - 2.0) * t]
}
