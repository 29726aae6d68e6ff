//! `replmarks [-e] [-s size] [-m modout] {-x objfile | -i octree | -I mesh} modname … [file …]`:
//! replaces markers by objects.
//!
//! A marker is a polygon with the modifier `modname`. Its longest edge is ignored (a hypotenuse),
//! the second longest is the new x axis, the third longest points towards the new y axis; both
//! start at their shared corner. `-s` is the length of the x edge of a marker that leaves the
//! object's size unchanged. With `-e`, commands in the file and the `xform` commands that replace
//! markers are run at once. Everything else is copied.

use std::fmt::Write;

use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::facets::{cross, dot, subtract};
use crate::scene_words::SceneWords;
use crate::shell_words;
use crate::text::{Quoted, Text};
use crate::{Error, Invocation, Output};

/// Largest number of corners of a marker.
const MAX_CORNERS: usize = 6;
/// Largest nesting depth of commands with `-e`.
const MAX_COMMAND_DEPTH: usize = 32;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Replacement {
    Transform,
    Instance,
    Mesh,
}

struct Marker<'a> {
    /// Modifier of the polygons to be replaced.
    modifier: &'a str,
    kind: Replacement,
    object: &'a str,
    new_modifier: Option<&'a str>,
    /// Object size divided by marker size; zero for no scaling.
    scale: f64,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let (markers, expand) = read_markers(&mut arguments)?;
    let mut text = Text::default();
    text.plain_command_comment(&invocation.argv[..arguments.position()])?;
    let files = arguments.rest();
    let (warnings, written) = (std::mem::take(&mut arguments.warnings), Vec::new());
    let mut replacer = Replacer { markers, expand, invocation, text, warnings, written, depth: 0 };
    if files.is_empty() {
        replacer.convert("standard input", invocation.standard_input()?)?;
    }
    for name in files {
        let loaded = invocation.loader.load(name, FileKind::Scene)?;
        replacer.convert(name, &loaded.bytes)?;
    }
    let Replacer { text, warnings, written: files, .. } = replacer;
    Ok(Output { standard_output: text.into_bytes(), warnings, files, ..Output::default() })
}

fn read_markers<'a>(arguments: &mut Arguments<'a>) -> Result<(Vec<Marker<'a>>, bool), Error> {
    let (mut markers, mut expand, mut scale) = (Vec::new(), false, 0.0);
    let is_option = |word: &str| word.starts_with('-');
    while arguments.peek().is_some_and(is_option) {
        let (mut replacement, mut new_modifier) = (None, None);
        while let Some(option) = arguments.option()? {
            match option.name {
                "-x" => replacement = Some((Replacement::Transform, arguments.required("object file (-x)")?)),
                "-i" => replacement = Some((Replacement::Instance, arguments.required("octree (-i)")?)),
                "-I" => replacement = Some((Replacement::Mesh, arguments.required("mesh (-I)")?)),
                "-e" => expand = true,
                "-m" => new_modifier = Some(arguments.required("new modifier (-m)")?),
                "-s" => scale = arguments.number("marker size (-s)")?,
                _ => return Err(arguments.unknown()),
            }
        }
        let position = arguments.position();
        let modifier = arguments.required("modifier of the markers")?;
        let Some((kind, object)) = replacement else {
            return Err(arguments.mistake(
                position,
                format!("nothing to replace the markers \"{modifier}\" with: -x, -i or -I is missing"),
            ));
        };
        markers.push(Marker { modifier, kind, object, new_modifier, scale });
    }
    match markers.is_empty() {
        true => Err(arguments.mistake(arguments.position(), "no modifier of markers is named")),
        false => Ok((markers, expand)),
    }
}

struct Replacer<'a> {
    markers: Vec<Marker<'a>>,
    expand: bool,
    invocation: &'a Invocation<'a>,
    text: Text,
    warnings: Vec<String>,
    written: Vec<(String, Vec<u8>)>,
    depth: usize,
}

impl Replacer<'_> {
    fn convert(&mut self, source: &str, bytes: &[u8]) -> Result<(), Error> {
        let mut words = SceneWords::new(bytes);
        while let Some(first) = words.peek() {
            match first {
                b'#' => self.text.push_bytes(words.line())?,
                b'!' => {
                    let line = words.continued_line();
                    self.command(&line)?;
                }
                _ => self.primitive(source, &mut words)?,
            }
        }
        Ok(())
    }

    fn command(&mut self, line: &str) -> Result<(), Error> {
        if !self.expand {
            return Ok(write!(self.text, "\n{line}\n")?);
        }
        let output = self.run_line(&line[1..])?;
        if self.depth == MAX_COMMAND_DEPTH {
            let mistake = format!("commands nest more than {MAX_COMMAND_DEPTH} deep");
            return Err(Error::Impossible { program: "replmarks".to_owned(), mistake });
        }
        self.depth += 1;
        self.convert(line, &output)?;
        self.depth -= 1;
        Ok(())
    }

    fn run_line(&mut self, line: &str) -> Result<Vec<u8>, Error> {
        let Invocation { loader, extra, .. } = self.invocation;
        let output = crate::pipeline(line, *loader, extra).map_err(|failed| failed.error)?;
        self.warnings.extend(output.warnings);
        self.written.extend(output.files);
        Ok(output.standard_output)
    }

    fn primitive(&mut self, source: &str, words: &mut SceneWords<'_>) -> Result<(), Error> {
        let (Some(modifier), Some(kind), Some(name)) = (words.word(), words.word(), words.word()) else {
            self.warnings.push(format!("{source}: the last primitive is incomplete"));
            return Ok(());
        };
        if kind == "polygon"
            && let Some(index) = self.markers.iter().position(|marker| marker.modifier == modifier)
        {
            return self.replace(source, index, &name, words);
        }
        write!(self.text, "\n{} {kind} {}\n", Quoted(&modifier), Quoted(&name))?;
        let complete = if kind == "alias" { self.alias(words)? } else { self.arguments(words)? };
        if !complete {
            self.warnings.push(format!("{source}: read error for {kind} \"{name}\""));
        }
        Ok(())
    }

    fn alias(&mut self, words: &mut SceneWords<'_>) -> Result<bool, Error> {
        let Some(original) = words.word() else { return Ok(false) };
        writeln!(self.text, "\t{}", Quoted(&original))?;
        Ok(true)
    }

    /// Copies the three argument lists of a primitive; false if they are incomplete.
    fn arguments(&mut self, words: &mut SceneWords<'_>) -> Result<bool, Error> {
        for _ in 0..3 {
            let Some(count) = words.count() else { return Ok(false) };
            write!(self.text, "{count}")?;
            for index in 0..count {
                let Some(word) = words.word() else { return Ok(false) };
                let before = if index % 3 == 0 { "\n\t" } else { "\t" };
                write!(self.text, "{before}{}", Quoted(&word))?;
            }
            self.text.write_str("\n")?;
        }
        Ok(true)
    }

    fn replace(&mut self, source: &str, index: usize, name: &str, words: &mut SceneWords<'_>) -> Result<(), Error> {
        let marker = &self.markers[index];
        let Some(transform) = read_corners(words).and_then(|corners| transform(&corners, marker.scale)) else {
            return Err(Error::Input {
                program: "replmarks".to_owned(),
                source_name: source.to_owned(),
                mistake: format!(
                    "marker \"{name}\" is not a polygon of 3 to {MAX_CORNERS} corners whose second and third longest edges meet"
                ),
            });
        };
        let (object, options) = (marker.object, transform.join(" "));
        if marker.kind == Replacement::Transform {
            let new_modifier = marker.new_modifier.map_or(String::new(), |modifier| format!(" -m {}", quote(modifier)));
            let command = format!("xform -n {}{new_modifier} {options} {object}", quote(name));
            if self.expand {
                let output = self.run_line(&command)?;
                return Ok(self.text.push_bytes(&output)?);
            }
            return Ok(write!(self.text, "\n!{command}\n")?);
        }
        let kind = if marker.kind == Replacement::Instance { "instance" } else { "mesh" };
        write!(self.text, "\n{} {kind} {name}\n", marker.new_modifier.unwrap_or("void"))?;
        Ok(write!(self.text, "{} {object} {options}\n0\n0\n", transform.len() + 1)?)
    }
}

/// A name as a word of a command.
fn quote(name: &str) -> String {
    shell_words::join(&[name.to_owned()])
}

/// The corners of a marker, after its name.
fn read_corners(words: &mut SceneWords<'_>) -> Option<Vec<[f64; 3]>> {
    let (_, _, count) = (words.count()?, words.count()?, words.count()?);
    if count % 3 != 0 || !(3..=MAX_CORNERS).contains(&(count / 3)) {
        return None;
    }
    (0..count / 3).map(|_| Some([words.number()?, words.number()?, words.number()?])).collect()
}

/// The `xform` options that transform an object into the marker's coordinate system.
fn transform(corners: &[[f64; 3]], scale: f64) -> Option<Vec<String>> {
    let (origin, x_end, y_end) = axes(corners)?;
    let (x_axis, x_length) = unit(subtract(x_end, origin))?;
    let (z_axis, _) = unit(cross(x_axis, subtract(y_end, origin)))?;
    let y_axis = cross(z_axis, x_axis);
    let mut options = Vec::new();
    let mut push = |option: &str, value: f64| options.extend([option.to_owned(), format!("{value:.6}")]);
    if scale > 0.0 {
        push("-s", x_length * scale);
    }
    rotations(x_axis, y_axis, z_axis, &mut push);
    push("-t", origin[0]);
    options.extend(origin[1..].iter().map(|value| format!("{value:.6}")));
    Some(options)
}

/// The shared corner of the second and third longest edges, and their other ends.
fn axes(corners: &[[f64; 3]]) -> Option<([f64; 3], [f64; 3], [f64; 3])> {
    let count = corners.len();
    // Squared lengths are compared in single precision, and equal edges keep their order, as in
    // Radiance.
    let mut edges: Vec<(usize, usize, f32)> = (0..count)
        .map(|end| {
            let begin = (end + count - 1) % count;
            let edge = subtract(corners[begin], corners[end]);
            (begin, end, dot(edge, edge) as f32)
        })
        .collect();
    edges.sort_by(|a, b| b.2.total_cmp(&a.2));
    let (mut x_edge, mut y_edge) = ((edges[1].0, edges[1].1), (edges[2].0, edges[2].1));
    if x_edge.1 == y_edge.0 || x_edge.1 == y_edge.1 {
        x_edge = (x_edge.1, x_edge.0);
    }
    if y_edge.1 == x_edge.0 {
        y_edge = (y_edge.1, y_edge.0);
    }
    (x_edge.0 == y_edge.0).then(|| (corners[x_edge.0], corners[x_edge.1], corners[y_edge.1]))
}

/// Rotations about x, y and z, in degrees, that map the coordinate axes to the given unit vectors.
fn rotations(x_axis: [f64; 3], y_axis: [f64; 3], z_axis: [f64; 3], push: &mut dyn FnMut(&str, f64)) {
    const TINY: f64 = 1e-6;
    let is_zero = |angle: f64| angle.abs() <= TINY;
    if y_axis[2] * y_axis[2] + z_axis[2] * z_axis[2] < 2.0 * TINY * TINY {
        // The new x axis is the old z axis, so two rotations suffice.
        push("-ry", if x_axis[2] < 0.0 { 90.0 } else { -90.0 });
        push("-rz", -y_axis[0].atan2(y_axis[1]).to_degrees());
        return;
    }
    let angles = [y_axis[2].atan2(z_axis[2]), (-x_axis[2]).clamp(-1.0, 1.0).asin(), x_axis[1].atan2(x_axis[0])];
    for (option, angle) in ["-rx", "-ry", "-rz"].into_iter().zip(angles) {
        if !is_zero(angle) {
            push(option, angle.to_degrees());
        }
    }
}

/// The unit vector and the length, unless that is zero or not a number.
fn unit(vector: [f64; 3]) -> Option<([f64; 3], f64)> {
    let length = dot(vector, vector).sqrt();
    (length > 0.0 && length.is_finite()).then(|| (vector.map(|value| value / length), length))
}
