//! `genprism material name { - | vfile | N v1 v2 … vN } [-l lvect] [-r radius] [-c] [-e]`: a prism
//! over a polygon.
//!
//! The polygon's corners are given in the xy plane, in scene units, as arguments, in a file, or on
//! standard input. It is extruded along `-l` (default 0 0 1). `-r` rounds the edges, `-e` omits the
//! ends, `-c` leaves the last corner unconnected to the first.

use std::fmt::Write;

use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::number_text::leading_number;
use crate::text::{Text, wide};
use crate::{Error, Invocation, Output, source_name};

/// Lengths below this count as zero, in scene units.
const TINY: f64 = 1e-6;

struct Prism<'a> {
    material: &'a str,
    name: &'a str,
    corners: Vec<[f64; 2]>,
    /// The extrusion vector, from the bottom to the top.
    extrusion: [f64; 3],
    /// 1 if the extrusion points up, −1 if down.
    direction: f64,
    ends: bool,
    closed: bool,
    radius: f64,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let prism = read(&mut arguments, invocation)?;
    let mut text = Text::default();
    text.command_comment(invocation.argv)?;
    if prism.radius > TINY {
        Rounded::new(&prism, &arguments)?.write(&mut text)?;
    } else {
        prism.write(&mut text)?;
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

fn read<'a>(arguments: &mut Arguments<'a>, invocation: &Invocation<'a>) -> Result<Prism<'a>, Error> {
    let material = arguments.required("material")?;
    let name = arguments.required("name")?;
    let source = arguments.position();
    let corners = read_corners(arguments, invocation)?;
    if corners.len() < 3 {
        return Err(arguments.mistake(source, format!("{} vertices, expected at least 3", corners.len())));
    }
    let (extrusion, direction) = ([0.0, 0.0, 1.0], 1.0);
    let mut prism = Prism { material, name, corners, extrusion, direction, ends: true, closed: true, radius: 0.0 };
    while let Some(option) = arguments.last_options()? {
        match option.name {
            "-l" => {
                prism.extrusion = arguments.vector("extrusion (-l)")?;
                if prism.extrusion[2].abs() <= TINY {
                    let z = prism.extrusion[2];
                    return Err(arguments.mistake(
                        arguments.position() - 1,
                        format!("the extrusion's z is {z}, expected it to leave the xy plane"),
                    ));
                }
                prism.direction = prism.extrusion[2].signum();
            }
            "-r" => prism.radius = arguments.number("radius (-r)")?,
            "-e" => prism.ends = !prism.ends,
            "-c" => prism.closed = !prism.closed,
            _ => return Err(arguments.unknown()),
        }
    }
    if prism.radius > TINY && prism.radius > prism.extrusion[2].abs() {
        let (radius, height) = (prism.radius, prism.extrusion[2].abs());
        return Err(arguments.impossible(format!("rounding by {radius} is greater than the height {height}")));
    }
    Ok(prism)
}

fn read_corners(arguments: &mut Arguments<'_>, invocation: &Invocation<'_>) -> Result<Vec<[f64; 2]>, Error> {
    let position = arguments.position();
    match arguments.peek() {
        Some(word) if !word.starts_with(|first: char| first.is_ascii_digit()) => {
            arguments.word();
            corners_of(arguments, &invocation.input(word, FileKind::Input)?, source_name(word))
        }
        _ => {
            let count = arguments.count("number of vertices")?;
            let given = arguments.rest().len() / 2;
            if given < count {
                let mistake = format!("{count} vertices are declared, but coordinates are given for {given}");
                return Err(arguments.mistake(position, mistake));
            }
            let coordinate = |axis: &str, index: usize| format!("{axis} of vertex {}", index + 1);
            (0..count)
                .map(|index| {
                    Ok([arguments.number(&coordinate("x", index))?, arguments.number(&coordinate("y", index))?])
                })
                .collect()
        }
    }
}

/// Parses pairs of numbers up to the end of the text, or to the first word that is not a number,
/// with a warning.
fn corners_of(arguments: &mut Arguments<'_>, bytes: &[u8], source: &str) -> Result<Vec<[f64; 2]>, Error> {
    let text = String::from_utf8_lossy(bytes);
    let mut rest: &str = &text;
    let mut numbers = Vec::new();
    while let Some((value, end)) = leading_number(rest) {
        if !value.is_finite() {
            let mistake = format!("number {} is not finite", numbers.len() + 1);
            return Err(Error::Input {
                program: arguments.program().to_owned(),
                source_name: source.to_owned(),
                mistake,
            });
        }
        numbers.push(value);
        rest = &rest[end..];
    }
    if let Some(word) = rest.split_ascii_whitespace().next() {
        arguments.warnings.push(format!("{source}: reading ends at \"{word}\", which is not a number"));
    } else if numbers.len() % 2 == 1 {
        arguments.warnings.push(format!("{source}: the last vertex lacks its y"));
    }
    Ok(numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())
}

impl Prism<'_> {
    fn write(&self, text: &mut Text) -> Result<(), Error> {
        let (Prism { material, name, .. }, [lx, ly, lz]) = (self, self.extrusion);
        if self.ends {
            text.primitive(material, "polygon", format_args!("{name}.b"), 3 * self.corners.len())?;
            self.corners.iter().try_for_each(|[x, y]| text.vertex(*x, *y, 0.0))?;
            text.primitive(material, "polygon", format_args!("{name}.t"), 3 * self.corners.len())?;
            self.corners.iter().rev().try_for_each(|[x, y]| text.vertex(x + lx, y + ly, lz))?;
        }
        for (from, to) in self.sides() {
            let ([x0, y0], [x1, y1]) = (self.corners[from], self.corners[to]);
            text.primitive(material, "polygon", format_args!("{name}.{}", from + 1), 12)?;
            text.vertex(x0, y0, 0.0)?;
            text.vertex(x0 + lx, y0 + ly, lz)?;
            text.vertex(x1 + lx, y1 + ly, lz)?;
            text.vertex(x1, y1, 0.0)?;
        }
        Ok(())
    }

    /// Pairs of neighbouring corners.
    fn sides(&self) -> impl Iterator<Item = (usize, usize)> {
        let count = self.corners.len();
        let sides = if self.closed { count } else { count - 1 };
        (0..sides).map(move |from| (from, (from + 1) % count))
    }
}

/// A prism with rounded edges.
struct Rounded<'a> {
    prism: &'a Prism<'a>,
    /// Radius with the sign of the extrusion direction.
    radius: f64,
    /// Unit vector along the side that ends at each corner, against the order of corners.
    along: Vec<[f64; 2]>,
    /// How far each side is cut back at each corner, in radii; negative at a reflex corner.
    trim: Vec<f64>,
}

impl<'a> Rounded<'a> {
    fn new(prism: &'a Prism<'a>, arguments: &Arguments<'_>) -> Result<Self, Error> {
        let count = prism.corners.len();
        let mut along = Vec::with_capacity(count);
        for (index, [x, y]) in prism.corners.iter().enumerate() {
            let [before_x, before_y] = prism.corners[(index + count - 1) % count];
            let (dx, dy) = (before_x - x, before_y - y);
            let length = (dx * dx + dy * dy).sqrt();
            if length <= TINY {
                return Err(arguments
                    .impossible(format!("vertex {} repeats the one before, so its side has no length", index + 1)));
            }
            along.push([dx / length, dy / length]);
        }
        let mut trim = vec![0.0; count];
        for index in 0..count {
            let ([x0, y0], [x1, y1]) = (along[index], along[(index + 1) % count]);
            let cosine = x0 * x1 + y0 * y1;
            if 1.0 + cosine <= TINY {
                return Err(arguments.impossible(format!("the sides at vertex {} coincide", index + 1)));
            }
            if 1.0 - cosine > 0.0 {
                // The tangent of half the turning angle at the corner.
                let tangent = ((1.0 - cosine) / (1.0 + cosine)).sqrt();
                trim[index] = if x1 * y0 - y1 * x0 < 0.0 { -tangent } else { tangent };
            }
        }
        Ok(Rounded { prism, radius: prism.direction * prism.radius, along, trim })
    }

    fn write(&self, text: &mut Text) -> Result<(), Error> {
        if self.prism.ends {
            self.write_ends(text)?;
        }
        self.prism.sides().try_for_each(|(from, to)| self.write_side(text, from, to))
    }

    /// A corner moved inwards to one radius from both of its sides.
    fn inner(&self, index: usize) -> [f64; 2] {
        let ([x, y], [ux, uy], trim) = (self.prism.corners[index], self.along[index], self.trim[index]);
        [x + self.radius * (trim * ux - uy), y + self.radius * (trim * uy + ux)]
    }

    fn write_ends(&self, text: &mut Text) -> Result<(), Error> {
        let Prism { material, name, extrusion: [lx, ly, lz], .. } = self.prism;
        let inner: Vec<[f64; 2]> = (0..self.trim.len()).map(|index| self.inner(index)).collect();
        text.primitive(material, "polygon", format_args!("{name}.b"), 3 * inner.len())?;
        inner.iter().try_for_each(|[x, y]| text.vertex(*x, *y, 0.0))?;
        text.primitive(material, "polygon", format_args!("{name}.t"), 3 * inner.len())?;
        inner.iter().rev().try_for_each(|[x, y]| text.vertex(x + lx, y + ly, *lz))?;
        let bottom: Vec<[f64; 3]> = inner.iter().map(|[x, y]| [*x, *y, self.radius]).collect();
        self.write_rim(text, "b", &bottom)?;
        let top: Vec<[f64; 3]> = inner.iter().map(|[x, y]| [x + lx, y + ly, lz - self.radius]).collect();
        self.write_rim(text, "t", &top)
    }

    /// Spheres at the corners and cylinders along the edges of one end.
    fn write_rim(&self, text: &mut Text, end: &str, corners: &[[f64; 3]]) -> Result<(), Error> {
        let Prism { material, name, direction, radius, .. } = self.prism;
        let mut before = corners[corners.len() - 1];
        for (index, corner) in corners.iter().enumerate() {
            let ([x, y, z], number) = (*corner, index + 1);
            if direction * self.trim[index] > 0.0 {
                write!(text, "\n{material} sphere {name}.{end}c{number}\n0\n0\n")?;
                writeln!(text, "4 {} {} {} {}", wide(x), wide(y), wide(z), wide(*radius))?;
            }
            text.primitive(material, "cylinder", format_args!("{name}.{end}e{number}"), 7)?;
            text.vertex(before[0], before[1], before[2])?;
            text.vertex(x, y, z)?;
            writeln!(text, "\t{}", wide(*radius))?;
            before = *corner;
        }
        Ok(())
    }

    /// A side between the rounded edges, and the rounded edge that joins it to the next side.
    fn write_side(&self, text: &mut Text, from: usize, to: usize) -> Result<(), Error> {
        let Prism { material, name, extrusion: [lx, ly, lz], direction, .. } = self.prism;
        let [ux, uy] = self.along[to];
        let length = (lx * lx + ly * ly + lz * lz).sqrt();
        // An oblique extrusion touches the rounded rim at a point turned by this angle from its
        // widest point.
        let sine = direction * (ly * ux - lx * uy) / length;
        let [tx, ty, tz] = if sine.abs() > TINY {
            let cosine = (1.0 - sine * sine).sqrt();
            [(cosine - 1.0) * uy, (1.0 - cosine) * ux, sine]
        } else {
            [0.0; 3]
        };
        let ([x0, y0], [x1, y1], r) = (self.prism.corners[from], self.prism.corners[to], self.radius);
        let (a0, a1) = (self.trim[from], self.trim[to]);
        text.primitive(material, "polygon", format_args!("{name}.{}", from + 1), 12)?;
        text.vertex(x0 + r * (tx - a0 * ux), y0 + r * (ty - a0 * uy), r * (tz + 1.0))?;
        text.vertex(x0 + lx + r * (tx - a0 * ux), y0 + ly + r * (ty - a0 * uy), lz + r * (tz - 1.0))?;
        text.vertex(x1 + lx + r * (tx + a1 * ux), y1 + ly + r * (ty + a1 * uy), lz + r * (tz - 1.0))?;
        text.vertex(x1 + r * (tx + a1 * ux), y1 + r * (ty + a1 * uy), r * (tz + 1.0))?;
        if direction * a1 < 0.0 {
            return Ok(());
        }
        let [x, y] = self.inner(to);
        text.primitive(material, "cylinder", format_args!("{name}.e{}", from + 1), 7)?;
        text.vertex(x, y, r)?;
        text.vertex(x + lx, y + ly, lz - r)?;
        Ok(writeln!(text, "\t{}", wide(direction * r))?)
    }
}
