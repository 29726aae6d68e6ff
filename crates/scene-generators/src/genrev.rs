//! `genrev material name z(t) r(t) nseg [-e expr] [-f file] [-s]`: a surface of revolution about
//! the z axis.
//!
//! The functions give height and radius, in scene units, for t from 0 to 1; `nseg` is the number of
//! rings, tubes and cones. The surface faces outwards where z increases, inwards where it
//! decreases. `-s` smooths it with a `texfunc` of `rev.cal`.

use std::fmt::Write;

use radsight_cal::Handle;

use crate::arguments::Arguments;
use crate::functions::Functions;
use crate::text::{Text, wide};
use crate::{Error, Invocation, Output};

/// Shorter steps are ignored, scene units.
const TINY: f64 = 1e-9;

/// A point of the profile.
#[derive(Clone, Copy)]
struct Station {
    z: f64,
    r: f64,
}

/// A unit vector in the plane of the profile.
#[derive(Clone, Copy, Default)]
struct Normal {
    z: f64,
    r: f64,
}

impl Normal {
    /// Perpendicular to the profile between two points; zero if they coincide.
    fn between(from: Station, to: Station) -> Normal {
        let (z, r) = (from.r - to.r, to.z - from.z);
        let length = (z * z + r * r).sqrt();
        if length > 0.0 { Normal { z: z / length, r: r / length } } else { Normal::default() }
    }
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let mut functions = Functions::for_generators(&arguments);
    let [material, name, ..] = arguments.take::<5>(["material", "name", "z(t)", "r(t)", "nseg"])?;
    let mut smooth = false;
    while let Some(option) = arguments.last_options()? {
        match option.name {
            "-e" => functions.take_definitions(&mut arguments)?,
            "-f" => functions.take_file(&mut arguments, invocation.loader)?,
            "-s" => smooth = true,
            _ => return Err(arguments.unknown()),
        }
    }
    let mut outline = arguments.again_from(3);
    let z = functions.take_function(&mut outline, "z", "t")?;
    let r = functions.take_function(&mut outline, "r", "t")?;
    let segments = functions.take_count(&mut outline, "nseg")?;

    let mut text = Text::default();
    text.command_comment(invocation.argv)?;
    text.expect_room(segments as f64, 80.0)?;
    let mut station = |index: usize| station(&mut functions, z, r, index as f64 / segments as f64);
    let (mut from, mut to) = (station(0)?, station(1)?);
    let (mut before, mut own) = (Normal::default(), Normal::between(from, to));
    for index in 1..=segments {
        let next = if index < segments { Some(station(index + 1)?) } else { None };
        let after = next.map_or(Normal::default(), |next| Normal::between(to, next));
        let modifier = if smooth { "Phong" } else { material };
        if let Some(step) = Step::new(from, to) {
            if smooth {
                step.write_texture(&mut text, material, before, after)?;
            }
            step.write(&mut text, modifier, format_args!("{name}.{index}"))?;
        }
        (before, own) = (own, after);
        (from, to) = (to, next.unwrap_or(to));
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: functions.all_warnings(arguments), ..Output::default() })
}

fn station(functions: &mut Functions, z: Handle, r: Handle, t: f64) -> Result<Station, Error> {
    Ok(Station { z: functions.coordinate(z, "z", &[t])?, r: functions.coordinate(r, "r", &[t])? })
}

/// A segment of non-zero length.
struct Step {
    from: Station,
    to: Station,
    /// −1, 0, 1: whether z decreases, stays or increases.
    rise: i8,
    /// −1, 0, 1: whether the radius decreases, stays or increases.
    widening: i8,
}

impl Step {
    fn new(from: Station, to: Station) -> Option<Step> {
        let sign = |from: f64, to: f64| i8::from(to > from + TINY) - i8::from(to < from - TINY);
        let (rise, widening) = (sign(from.z, to.z), sign(from.r, to.r));
        (rise != 0 || widening != 0).then_some(Step { from, to, rise, widening })
    }

    fn write(&self, text: &mut Text, modifier: &str, name: std::fmt::Arguments<'_>) -> Result<(), Error> {
        let Step { from, to, rise, widening } = self;
        let axis_point = |text: &mut Text, z: f64| writeln!(text, "\t0\t0\t{}", wide(z));
        if *rise == 0 {
            text.primitive(modifier, "ring", name, 8)?;
            axis_point(text, to.z)?;
            axis_point(text, if *widening < 0 { 1.0 } else { -1.0 })?;
            return Ok(writeln!(text, "\t{}\t{}", wide(from.r), wide(to.r))?);
        }
        let (kind, numbers) = match (*widening == 0, *rise < 0) {
            (true, true) => ("tube", 7),
            (true, false) => ("cylinder", 7),
            (false, true) => ("cup", 8),
            (false, false) => ("cone", 8),
        };
        text.primitive(modifier, kind, name, numbers)?;
        axis_point(text, from.z)?;
        axis_point(text, to.z)?;
        match numbers {
            7 => writeln!(text, "\t{}", wide(to.r))?,
            _ => writeln!(text, "\t{}\t{}", wide(from.r), wide(to.r))?,
        }
        Ok(())
    }

    /// The normal's components as linear functions of z and of the radius, interpolated between
    /// neighbours.
    fn write_texture(&self, text: &mut Text, material: &str, before: Normal, after: Normal) -> Result<(), Error> {
        let Step { from, to, rise, widening } = self;
        write!(text, "\n{material} texfunc Phong\n4 rev_dx rev_dy rev_dz rev.cal\n0\n4\n")?;
        let line = |text: &mut Text, slope: f64, constant: f64| writeln!(text, "\t{}\t{}", wide(slope), wide(constant));
        if *rise != 0 {
            let slope = (after.z - before.z) / (to.z - from.z);
            line(text, slope, before.z - slope * from.z)?;
        } else {
            writeln!(text, "\t0\t{}", if *widening < 0 { 1 } else { -1 })?;
        }
        if *widening != 0 {
            let slope = (after.r - before.r) / (to.r - from.r);
            line(text, slope, before.r - slope * from.r)?;
        } else {
            writeln!(text, "\t0\t{}", if *rise > 0 { 1 } else { -1 })?;
        }
        Ok(())
    }
}
