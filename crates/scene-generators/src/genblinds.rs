//! `genblinds mat name depth width height nslats angle [-r|+r rcurv]`: venetian blinds.
//!
//! Slats extend along y (`width`) and x (`depth`), and are distributed over `height` along z, all
//! in scene units. `angle` is the slats' inclination in degrees. `-r` curves them upwards and `+r`
//! downwards with a radius of curvature, in flat strips of at most 3°.

use std::f64::consts::PI;

use crate::arguments::Arguments;
use crate::text::Text;
use crate::{Error, Invocation, Output};

const DEGREE: f64 = PI / 180.0;
/// Largest angle of one strip of a curved slat, radians.
const STRIP_ANGLE: f64 = 3.0 * DEGREE;

/// The corners of one flat strip.
type Strip = [[f64; 3]; 4];

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let material = arguments.required("material")?;
    let name = arguments.required("name")?;
    let depth = arguments.number("depth")?;
    let width = arguments.number("width")?;
    let height = arguments.number("height")?;
    let slats = arguments.integer("nslats")?;
    let angle = arguments.number("angle")? * DEGREE;
    let radius = match arguments.last_options()?.map(|option| option.name) {
        None => 0.0,
        Some("-r") => arguments.number("radius of curvature (-r)")?,
        Some("+r") => -arguments.number("radius of curvature (+r)")?,
        Some(_) => return Err(arguments.unknown()),
    };
    if arguments.word().is_some() {
        return Err(arguments.unknown());
    }
    let strips = if radius == 0.0 {
        vec![strip(width, depth, angle, [0.0; 2])]
    } else if depth.abs() > 2.0 * radius.abs() {
        let diameter = 2.0 * radius.abs();
        return Err(
            arguments.impossible(format!("slats of depth {depth} cannot be curved to a circle of diameter {diameter}"))
        );
    } else {
        curved(width, depth, angle, radius)
    };
    let mut text = Text::default();
    text.command_comment(invocation.argv)?;
    text.expect_room(slats as f64 * strips.len() as f64, 250.0)?;
    for slat in 1..=slats {
        let up = height * (slat as f64 - 0.5) / slats as f64;
        for (index, corners) in strips.iter().enumerate() {
            text.primitive(material, "polygon", format_args!("{name}.{slat}.{index}"), 12)?;
            corners.iter().try_for_each(|[x, y, z]| text.vertex(*x, *y, z + up))?;
        }
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

/// A strip that starts at `[x, z]` and rises at an angle (radians) to the x axis.
fn strip(width: f64, depth: f64, angle: f64, [x, z]: [f64; 2]) -> Strip {
    let (far_x, far_z) = (depth * angle.cos() + x, depth * angle.sin() + z);
    [[x, 0.0, z], [x, width, z], [far_x, width, far_z], [far_x, 0.0, far_z]]
}

/// The strips of a slat curved to an arc over its depth: below its chord for a positive radius,
/// above for a negative one.
fn curved(width: f64, depth: f64, angle: f64, radius: f64) -> Vec<Strip> {
    let curvature = radius.signum();
    let radius = radius.abs();
    let arc = 2.0 * (depth / (2.0 * radius)).asin();
    let count = (arc / STRIP_ANGLE + 0.99999) as usize;
    let step = arc / count as f64;
    let strip_depth = 2.0 * radius * (step / 2.0).sin();
    // The angle of the arc's start, seen from its centre, to the x axis; reversed for an arc below
    // the chord.
    let start = (PI - arc) / 2.0 - angle;
    let point = |index: usize| -> [f64; 2] {
        let turn = index as f64 * step;
        let (sine, cosine) = if curvature < 0.0 { (start + turn).sin_cos() } else { (start + arc - turn).sin_cos() };
        [curvature * radius * cosine, -curvature * radius * sine]
    };
    let origin = point(0);
    (0..count)
        .map(|index| {
            let turn = index as f64 * step;
            let inclination = if curvature < 0.0 {
                (PI - step) / 2.0 - (start + turn)
            } else {
                (PI - (start + arc) + turn) - (PI - step) / 2.0
            };
            let here = point(index);
            strip(width, strip_depth, inclination, [here[0] - origin[0], here[1] - origin[1]])
        })
        .collect()
}
