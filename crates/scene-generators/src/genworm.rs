//! `genworm material name x(t) y(t) z(t) r(t) nseg [-e expr] [-f file]`: a worm of spheres,
//! cylinders and cones.
//!
//! The functions give centre line and radius, in scene units, for t from 0 to 1; `nseg` is the
//! number of segments. Each cone is tangent to the spheres at its ends, so that the surface is
//! smooth.

use std::fmt::Write;

use crate::arguments::Arguments;
use crate::facets::{dot, subtract};
use crate::functions::Functions;
use crate::text::{Text, wide};
use crate::{Error, Invocation, Output};

/// Radii that differ by less make a cylinder.
const TINY: f64 = 1e-6;

/// A point of the centre line.
struct Joint {
    centre: [f64; 3],
    radius: f64,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let mut functions = Functions::for_generators(&arguments);
    let [material, name, ..] = arguments.take::<7>(["material", "name", "x(t)", "y(t)", "z(t)", "r(t)", "nseg"])?;
    while let Some(option) = arguments.last_options()? {
        match option.name {
            "-e" => functions.take_definitions(&mut arguments)?,
            "-f" => functions.take_file(&mut arguments, invocation.loader)?,
            _ => return Err(arguments.unknown()),
        }
    }
    let mut curve = arguments.again_from(3);
    let x = functions.take_function(&mut curve, "x", "t")?;
    let y = functions.take_function(&mut curve, "y", "t")?;
    let z = functions.take_function(&mut curve, "z", "t")?;
    let r = functions.take_function(&mut curve, "r", "t")?;
    let segments = functions.take_count(&mut curve, "nseg")?;

    let mut text = Text::default();
    text.command_comment(invocation.argv)?;
    text.expect_room(segments as f64, 150.0)?;
    let mut last: Option<Joint> = None;
    for index in 0..=segments {
        let t = [index as f64 / segments as f64];
        let centre =
            [functions.coordinate(x, "x", &t)?, functions.coordinate(y, "y", &t)?, functions.coordinate(z, "z", &t)?];
        let joint = Joint { centre, radius: functions.coordinate(r, "r", &t)? };
        if let Some(last) = &last {
            write_segment(&mut text, material, format_args!("{name}.c{index}"), last, &joint)?;
        }
        let ([x, y, z], r) = (joint.centre, joint.radius);
        write!(text, "\n{material} sphere {name}.s{index}\n0\n0\n")?;
        writeln!(text, "4 {} {} {} {}", wide(x), wide(y), wide(z), wide(r))?;
        last = Some(joint);
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: functions.all_warnings(arguments), ..Output::default() })
}

fn write_segment(
    text: &mut Text,
    material: &str,
    name: std::fmt::Arguments<'_>,
    from: &Joint,
    to: &Joint,
) -> Result<(), Error> {
    let row = |text: &mut Text, [x, y, z]: [f64; 3]| writeln!(text, "{} {} {}", wide(x), wide(y), wide(z));
    if (from.radius - to.radius).abs() <= TINY {
        text.primitive(material, "cylinder", name, 7)?;
        row(text, from.centre)?;
        row(text, to.centre)?;
        return Ok(writeln!(text, "{}", wide(to.radius))?);
    }
    let axis = subtract(to.centre, from.centre);
    let length_squared = dot(axis, axis);
    if length_squared == 0.0 {
        // Concentric spheres need no segment between them.
        return Ok(());
    }
    let narrowing = from.radius - to.radius;
    // The circle of tangency is offset from the sphere's centre along the axis by this factor times
    // the radius.
    let shift = narrowing / length_squared;
    let moved = |joint: &Joint| std::array::from_fn(|i| joint.centre[i] + shift * joint.radius * axis[i]);
    let shrink = (1.0 - narrowing * shift).max(0.0).sqrt();
    text.primitive(material, "cone", name, 8)?;
    row(text, moved(from))?;
    row(text, moved(to))?;
    Ok(writeln!(text, "{} {}", wide(shrink * from.radius), wide(shrink * to.radius))?)
}
