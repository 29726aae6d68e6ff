//! `obj2rad [-o obj] [-m mapping] [-n] [-f] [file.obj]`: converts Wavefront text to Radiance
//! polygons.
//!
//! Faces with normals become smoothed triangles unless `-f` is given; flat faces stay polygons.
//! Materials come from `usemtl`, else from the group, else `white`; a mapping file (`-m`) can
//! select them by material, map, group, object and face. `-o` names faces without a group. `-n`
//! lists the names that a mapping can use instead of converting.

mod mapping;
pub(crate) mod wavefront;

use std::collections::{BTreeSet, VecDeque};
use std::fmt::Write;

use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::facets::{Barycentric, cross, dot, normalize, subtract};
use crate::text::{Quoted, Text, wide};
use crate::{Error, Invocation, Output};
use mapping::{Mapping, Situation};
use wavefront::{Corner, Statements, Vertices};

const TINY: f64 = 1e-6;
/// Normals whose cosine exceeds this are equal.
const SAME_DIRECTION: f64 = 0.999_995;
/// Longest name made of groups, bytes.
const LONGEST_GROUP_NAME: usize = 62;

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let (mut object, mut mapping, mut list_names, mut flat) = ("unnamed", None, false, false);
    while let Some(option) = arguments.option_before_files()? {
        match option.name {
            "-o" => object = arguments.required("object name (-o)")?,
            "-m" => mapping = Some(read_mapping(&mut arguments, invocation)?),
            "-n" => list_names = true,
            "-f" => flat = true,
            _ => return Err(arguments.unknown()),
        }
    }
    let name = arguments.word().unwrap_or("-");
    if arguments.word().is_some() {
        return Err(arguments.unknown());
    }
    let source_name = if name == "-" { "<stdin>" } else { name };
    let bytes = invocation.input(name, FileKind::Mesh)?;
    let content = String::from_utf8_lossy(&bytes);
    let mut text = Text::default();
    if list_names {
        write_names(&mut text, source_name, &content)?;
    } else {
        text.write_str("# ")?;
        write_words(&mut text, invocation.argv.iter().map(String::as_str))?;
        let mut converter = Converter { flat, ..Converter::new(text, object, mapping) };
        let statements = Statements::new(&content);
        converter.convert(source_name, statements).map_err(|mistake| match mistake {
            Mistake::Text(mistake) => {
                Error::Input { program: arguments.program().to_owned(), source_name: source_name.to_owned(), mistake }
            }
            Mistake::Other(error) => error,
        })?;
        text = converter.text;
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

fn read_mapping(arguments: &mut Arguments<'_>, invocation: &Invocation<'_>) -> Result<Mapping, Error> {
    let name = arguments.required("mapping file (-m)")?;
    let loaded = invocation.loader.load(name, FileKind::Input)?;
    Mapping::read(&String::from_utf8_lossy(&loaded.bytes)).map_err(|mistake| Error::Input {
        program: arguments.program().to_owned(),
        source_name: name.to_owned(),
        mistake,
    })
}

/// Words of a comment, quoted where necessary.
fn write_words<'a>(text: &mut Text, words: impl Iterator<Item = &'a str>) -> Result<(), Error> {
    let words: Vec<String> = words.map(|word| Quoted(&word.replace(['\n', '\r'], " ")).to_string()).collect();
    Ok(writeln!(text, "{}", words.join(" "))?)
}

/// A mistake of the input, or another error.
enum Mistake {
    Text(String),
    Other(Error),
}

impl From<Error> for Mistake {
    fn from(error: Error) -> Self {
        Mistake::Other(error)
    }
}

impl From<std::fmt::Error> for Mistake {
    fn from(error: std::fmt::Error) -> Self {
        Mistake::Other(error.into())
    }
}

struct Converter<'a> {
    text: Text,
    default_object: &'a str,
    mapping: Option<Mapping>,
    flat: bool,
    vertices: Vertices,
    material: String,
    map: String,
    object: String,
    groups: Vec<String>,
    face: usize,
    degenerate: usize,
}

/// The relation of the corner normals to the triangle.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum CornerNormals {
    Flat,
    FlatReversed,
    Smooth,
    SmoothReversed,
}

impl<'a> Converter<'a> {
    fn new(text: Text, default_object: &'a str, mapping: Option<Mapping>) -> Self {
        Converter {
            text,
            default_object,
            mapping,
            flat: false,
            vertices: Vertices::default(),
            material: String::new(),
            map: String::new(),
            object: String::new(),
            groups: Vec::new(),
            face: 0,
            degenerate: 0,
        }
    }

    fn convert(&mut self, source_name: &str, mut statements: Statements<'_>) -> Result<(), Mistake> {
        let (mut count, mut unknown) = (0usize, 0usize);
        while let Some(words) = statements.next_statement() {
            count += 1;
            let line = statements.line();
            let outcome = self.statement(&words)?;
            match outcome {
                Ok(known) => unknown += usize::from(!known),
                Err(mistake) => return Err(Mistake::Text(format!("line {line}: {mistake}"))),
            }
        }
        let lines = statements.line();
        writeln!(self.text, "\n# Done processing file: {source_name}")?;
        writeln!(self.text, "# {lines} lines, {count} statements, {unknown} unrecognized")?;
        if self.degenerate > 0 {
            writeln!(self.text, "# {} degenerate faces", self.degenerate)?;
        }
        if self.vertices.zero_normals > 0 {
            writeln!(self.text, "# {} invalid (zero) normals", self.vertices.zero_normals)?;
        }
        Ok(())
    }

    /// Executes a statement. The value reports whether its kind is known; the inner error is a
    /// mistake of the input.
    fn statement(&mut self, words: &[String]) -> Result<Result<bool, String>, Mistake> {
        let name = |words: &[String]| words.get(1).cloned();
        match words[0].as_str() {
            "v" | "vn" | "vt" => return Ok(self.vertices.add(words)),
            "f" => return self.convert_face(&words[1..]),
            "usemtl" => self.material = name(words).unwrap_or_else(|| self.material.clone()),
            "usemap" => match words.get(1).map(String::as_str) {
                Some("off") => self.map.clear(),
                Some(map) => self.map = format!("{map}.hdr"),
                None => {}
            },
            "o" => self.object = name(words).unwrap_or_else(|| self.object.clone()),
            "g" => self.groups = words[1..].to_vec(),
            first if first.starts_with('#') => write_words(&mut self.text, words.iter().map(String::as_str))?,
            _ => return Ok(Ok(false)),
        }
        Ok(Ok(true))
    }

    fn convert_face(&mut self, words: &[String]) -> Result<Result<bool, String>, Mistake> {
        self.face += 1;
        let corners: Result<Vec<Corner>, String> = words.iter().map(|word| self.vertices.corner(word)).collect();
        let corners = match corners {
            Ok(corners) if corners.len() >= 3 => corners,
            Ok(corners) => return Ok(Err(format!("a face of {} corners", corners.len()))),
            Err(mistake) => return Ok(Err(mistake)),
        };
        let Some(material) = self.material() else { return Ok(Ok(true)) };
        if corners.len() == 3 {
            self.write_triangle(&material, [corners[0], corners[1], corners[2]])?;
        } else if self.needs_triangles(&corners) {
            let mut rest = VecDeque::from(corners);
            while rest.len() > 2 {
                self.write_triangle(&material, [rest[0], rest[1], rest[2]])?;
                // The second corner is removed, and the first becomes the last.
                rest.rotate_left(1);
                rest.pop_front();
            }
        } else {
            let name = format!("{}.{}", self.object_name(), self.face);
            self.text.primitive(&material, "polygon", name, 3 * corners.len()).map_err(Error::from)?;
            corners.iter().try_for_each(|corner| self.write_point(corner))?;
        }
        Ok(Ok(true))
    }

    /// The material of the current face; `None` if the mapping omits the face.
    fn material(&self) -> Option<String> {
        match &self.mapping {
            Some(mapping) => mapping.material(&Situation {
                material: &self.material,
                map: &self.map,
                groups: &self.groups,
                object: &self.object,
                face: self.face,
            }),
            None if !self.material.is_empty() => Some(self.material.clone()),
            None => Some(self.groups.first().cloned().unwrap_or_else(|| "white".to_owned())),
        }
    }

    fn object_name(&self) -> String {
        if !self.object.is_empty() {
            return self.object.clone();
        }
        if self.groups.is_empty() {
            return self.default_object.to_owned();
        }
        let mut name = self.groups.join(".");
        let end = (0..=LONGEST_GROUP_NAME.min(name.len())).rev().find(|end| name.is_char_boundary(*end)).unwrap_or(0);
        name.truncate(end);
        name
    }

    /// Whether a polygon has normals to interpolate, or is not planar.
    fn needs_triangles(&self, corners: &[Corner]) -> bool {
        if !self.flat && corners[0].normal.is_some() {
            return true;
        }
        let origin = self.vertices.point(&corners[0]);
        let spoke = |index: usize| subtract(self.vertices.point(&corners[index]), origin);
        let mut sum = [0.0; 3];
        for index in 2..corners.len() {
            let parts = (index - 2) as f64;
            let Some(normal) = normalize(cross(spoke(index - 1), spoke(index))) else {
                if index == 2 {
                    return true;
                }
                sum = sum.map(|value| value + value / parts);
                continue;
            };
            let along = dot(normal, sum);
            if along.abs() < (1.0 - TINY) * parts {
                return true;
            }
            let sign = if along >= 0.0 { 1.0 } else { -1.0 };
            sum = std::array::from_fn(|axis| sum[axis] + sign * normal[axis]);
        }
        false
    }

    fn write_triangle(&mut self, material: &str, corners: [Corner; 3]) -> Result<(), Error> {
        let points = corners.map(|corner| self.vertices.point(&corner));
        let normals = corners.map(|corner| corner.normal.map(|normal| self.vertices.normal(normal)));
        let normals_kind = match normals {
            [Some(a), Some(b), Some(c)] => match classify_normals(points, [a, b, c]) {
                Some(normals_kind) => normals_kind,
                None => {
                    self.degenerate += 1;
                    return Ok(());
                }
            },
            _ => CornerNormals::Flat,
        };
        let mut modifier = material;
        if let (CornerNormals::Smooth | CornerNormals::SmoothReversed, false, [Some(a), Some(b), Some(c)]) =
            (normals_kind, self.flat, normals)
            && let Some(barycentric) = Barycentric::new(&points)
        {
            write!(self.text, "\n{material} texfunc Phong\n4 dx dy dz tmesh.cal\n0\n")?;
            barycentric.write_interpolation(&mut self.text, &[a, b, c])?;
            modifier = "Phong";
        }
        let name = format!("{}.{}", self.object_name(), self.face);
        self.text.primitive(modifier, "polygon", name, 9)?;
        let [a, b, c] = corners;
        let reversed = matches!(normals_kind, CornerNormals::FlatReversed | CornerNormals::SmoothReversed);
        let corners = if reversed { [c, b, a] } else { [a, b, c] };
        corners.iter().try_for_each(|corner| self.write_point(corner))
    }

    fn write_point(&mut self, corner: &Corner) -> Result<(), Error> {
        let [x, y, z] = self.vertices.point(corner);
        Ok(writeln!(self.text, " {} {} {}", wide(x), wide(y), wide(z))?)
    }
}

/// `None` for a degenerate triangle.
pub(crate) fn classify_normals(points: [[f64; 3]; 3], normals: [[f64; 3]; 3]) -> Option<CornerNormals> {
    let [a, b, c] = points;
    let normal = normalize(cross(subtract(b, a), subtract(c, b)))?;
    let cosines = normals.map(|corner| dot(normal, corner));
    Some(if cosines.iter().all(|cosine| *cosine < 0.0) {
        let is_smooth = cosines.iter().any(|cosine| *cosine > -SAME_DIRECTION);
        if is_smooth { CornerNormals::SmoothReversed } else { CornerNormals::FlatReversed }
    } else {
        let is_smooth = cosines.iter().any(|cosine| *cosine < SAME_DIRECTION);
        if is_smooth { CornerNormals::Smooth } else { CornerNormals::Flat }
    })
}

/// Lists the names that a mapping file can use.
fn write_names(text: &mut Text, source_name: &str, content: &str) -> Result<(), Error> {
    let mut names: [BTreeSet<String>; 4] = Default::default();
    let [materials, maps, groups, objects] = &mut names;
    let mut faces = 0;
    let mut statements = Statements::new(content);
    while let Some(words) = statements.next_statement() {
        match (words[0].as_str(), words.get(1)) {
            ("f", _) => faces += 1,
            ("usemtl", Some(name)) => drop(materials.insert(name.clone())),
            ("usemap", Some(name)) if name != "off" => drop(maps.insert(name.clone())),
            ("o", Some(name)) => drop(objects.insert(name.clone())),
            ("g", _) => groups.extend(words[1..].iter().cloned()),
            _ => {}
        }
    }
    writeln!(text, "filename \"{source_name}\"\nfiletype \"Wavefront\"")?;
    for (kind, names) in
        ["Material", "Map", "Group", "Object"].into_iter().zip(&names).filter(|(_, names)| !names.is_empty())
    {
        writeln!(text, "qualifier {kind} begin")?;
        names.iter().try_for_each(|name| writeln!(text, "\"{name}\""))?;
        writeln!(text, "end")?;
    }
    Ok(writeln!(text, "qualifier Face begin\n[1:{faces}]\nend")?)
}
