//! `pkgBSDF [-i] [-s] input.xml …`: the surfaces that represent BSDF files in a scene.
//!
//! Writes a polygon of the size of the measured sample, with a `BSDF` material of its thickness,
//! and the sample's geometry if the file has one. The scene of `NAME.xml` is the file `NAME.rad`, or
//! standard output with `-s`. `-i` makes the geometry an instance of the octree `NAME.oct`.

use std::fmt::Write;

use radsight_loader::FileKind;
use roxmltree::{Document, Node, ParsingOptions};

use crate::arguments::Arguments;
use crate::mgf::{Converter, MaterialWriter};
use crate::text::{Exponential, Quoted, Text, general};
use crate::{Error, Invocation, Output};

const TINY: f64 = 1e-6;
/// Reflection below this, in excess of the part common to all directions, is omitted (1/sr).
const LEAST_REFLECTION: f64 = 0.001;

/// Where the geometry of a sample stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Geometry {
    InScene,
    InOctree,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let (mut to_standard_output, mut geometry) = (false, Geometry::InScene);
    while let Some(option) = arguments.option()? {
        match option.name {
            "-s" => to_standard_output = true,
            "-i" => geometry = Geometry::InOctree,
            _ => return Err(arguments.unknown()),
        }
    }
    let first = arguments.required("BSDF file")?;
    if to_standard_output && arguments.word().is_some() {
        return Err(arguments.impossible("-s writes the scene of one BSDF file"));
    }
    let mut output = Output::default();
    for name in std::iter::once(first).chain(arguments.rest().iter().map(String::as_str)) {
        let scene = scene(invocation, name, geometry, &mut output)?;
        match to_standard_output {
            true => output.standard_output = scene,
            false => output.files.push((format!("{}.rad", stem_of(name)), scene)),
        }
    }
    output.warnings.splice(..0, arguments.warnings);
    Ok(output)
}

/// The name of a file without its folder.
fn file_of(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// A word of a comment, which ends with its line.
fn in_a_line(word: &str) -> String {
    word.replace(['\n', '\r'], " ")
}

/// The name of a BSDF file without its folder and ending.
fn stem_of(name: &str) -> &str {
    let file = file_of(name);
    file.strip_suffix(".xml").or_else(|| file.strip_suffix(".XML")).unwrap_or(file)
}

/// The scene text of a BSDF file. Its octree and warnings go to the output.
fn scene(invocation: &Invocation<'_>, name: &str, place: Geometry, output: &mut Output) -> Result<Vec<u8>, Error> {
    let loaded = invocation.loader.load(name, FileKind::Bsdf)?;
    let mistake =
        |mistake: String| Error::Input { program: "pkgBSDF".to_owned(), source_name: name.to_owned(), mistake };
    let xml = radsight_measured::xml_text(&loaded.bytes).map_err(|error| mistake(error.to_string()))?;
    // Document types allow entity expansion attacks; BSDF files have none.
    let options = ParsingOptions { allow_dtd: false, ..ParsingOptions::default() };
    let document = Document::parse_with_options(&xml, options).map_err(|error| mistake(error.to_string()))?;
    let sample = Sample::read(&document).map_err(mistake)?;

    let stem = stem_of(name);
    let mut text = Text::default();
    writeln!(text, "# Produced by: pkgBSDF {}", in_a_line(file_of(name)))?;
    if !sample.material.is_empty() && !sample.maker.is_empty() {
        writeln!(text, "# Material '{}' by '{}'\n", in_a_line(&sample.material), in_a_line(&sample.maker))?;
    }
    let Some(geometry) = &sample.geometry else {
        write_face(&mut text, stem, &sample, 0.0)?;
        return Ok(text.into_bytes());
    };
    write_face(&mut text, stem, &sample, sample.thickness)?;
    if sample.reflects_in_front {
        write_face(&mut text, stem, &sample, -sample.thickness)?;
    }
    if place == Geometry::InScene {
        return translated(invocation, name, geometry, text, output);
    }
    let geometry = translated(invocation, name, geometry, Text::default(), output)?;
    let argv = ["oconv", "-f", "-"].map(str::to_owned);
    let octree = match invocation.loader.run_program(&argv, Some(&geometry)) {
        Some(made) => made?,
        None => return Err(mistake("option -i makes an octree, which needs the program oconv".to_owned())),
    };
    output.files.push((format!("{stem}.oct"), octree));
    let [instance, octree] = [format!("{stem}_g"), format!("{stem}.oct")];
    write!(text, "void instance {}\n1 {}\n0\n0\n\n", Quoted(&instance), Quoted(&octree))?;
    Ok(text.into_bytes())
}

/// Text with the translation of the geometry after it.
fn translated(
    invocation: &Invocation<'_>,
    name: &str,
    geometry: &str,
    mut text: Text,
    output: &mut Output,
) -> Result<Vec<u8>, Error> {
    writeln!(text, "## Translated from MGF Version 2.0\n## mgf2rad -s")?;
    let mut materials = MaterialWriter::default();
    materials.spectral = true;
    let mut converter = Converter::new(invocation.loader, materials, text);
    converter.convert(name, geometry.as_bytes())?;
    output.warnings.extend(converter.warnings);
    Ok(converter.text.into_bytes())
}

/// The measured sample as described in the file; lengths in metres.
struct Sample {
    material: String,
    maker: String,
    width: f64,
    height: f64,
    thickness: f64,
    /// Geometry in Materials and Geometry Format.
    geometry: Option<String>,
    /// Whether reflection at the front (in the file's terms) depends on direction.
    reflects_in_front: bool,
}

impl Sample {
    fn read(document: &Document<'_>) -> Result<Sample, String> {
        let root = document.root_element();
        if root.tag_name().name() != "WindowElement" {
            return Err(format!("the top element is \"{}\", expected \"WindowElement\"", root.tag_name().name()));
        }
        let layer =
            child(root, "Optical").and_then(|optical| child(optical, "Layer")).ok_or("there is no optical layer")?;
        let material = child(layer, "Material");
        let words = |name: &str| material.and_then(|node| child(node, name)).map_or("", text_of).to_owned();
        let length = |name: &str| -> Result<f64, String> {
            match material.and_then(|node| child(node, name)) {
                Some(node) => {
                    let value = crate::number_text::leading_number(text_of(node)).map_or(0.0, |(value, _)| value);
                    Ok(value * metres(node.attribute("unit"))?)
                }
                None => Ok(0.0),
            }
        };
        let (width, height, thickness) = (length("Width")?, length("Height")?, length("Thickness")?);
        if width <= TINY || height <= TINY || thickness < 0.0 {
            return Err(format!("the sample is {width} m wide, {height} m high and {thickness} m thick"));
        }
        let reflects_in_front =
            layer.descendants().filter(|node| node.has_tag_name_locally("WavelengthDataBlock")).any(|block| {
                let is_front = child(block, "WavelengthDataDirection")
                    .is_some_and(|node| text_of(node).eq_ignore_ascii_case("Reflection Front"));
                is_front && child(block, "ScatteringData").is_some_and(|node| depends_on_direction(text_of(node)))
            });
        let (material, maker, geometry) = (words("Name"), words("Manufacturer"), geometry(layer)?);
        Ok(Sample { material, maker, width, height, thickness, geometry, reflects_in_front })
    }
}

fn geometry(layer: Node<'_, '_>) -> Result<Option<String>, String> {
    let Some(node) = child(layer, "Geometry") else { return Ok(None) };
    if let Some(format) = node.attribute("format")
        && !format.eq_ignore_ascii_case("MGF")
    {
        return Err(format!("the geometry's format is \"{format}\", expected \"MGF\""));
    }
    let Some(block) = child(node, "MGFblock") else { return Ok(None) };
    let text = text_of(block);
    if text.is_empty() {
        return Ok(None);
    }
    let scale = metres(block.attribute("unit"))?;
    Ok(Some(if (0.99..=1.01).contains(&scale) { text.to_owned() } else { format!("xf -s {scale:.5}\n{text}\nxf\n") }))
}

/// Whether the numbers differ by more than the omitted reflection.
fn depends_on_direction(data: &str) -> bool {
    let separators =
        |character: char| character == ',' || character.is_whitespace() || character == '{' || character == '}';
    let numbers = data.split(separators).filter_map(crate::number_text::whole_number);
    let (low, high) =
        numbers.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), value| (low.min(value), high.max(value)));
    high - low > LEAST_REFLECTION
}

fn metres(unit: Option<&str>) -> Result<f64, String> {
    let Some(unit) = unit else { return Ok(1.0) };
    match unit.to_ascii_lowercase().as_str() {
        "meter" => Ok(1.0),
        "foot" => Ok(0.3048),
        "inch" => Ok(0.0254),
        "centimeter" => Ok(0.01),
        "millimeter" => Ok(0.001),
        _ => Err(format!("unknown unit \"{unit}\", expected Meter, Foot, Inch, Centimeter or Millimeter")),
    }
}

/// A child by its local name.
fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.has_tag_name_locally(name))
}

fn text_of<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or("").trim()
}

trait LocalName {
    fn has_tag_name_locally(&self, name: &str) -> bool;
}

impl LocalName for Node<'_, '_> {
    fn has_tag_name_locally(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

/// A rectangle with the file's BSDF, which passes rays through to `offset` metres behind it.
fn write_face(text: &mut Text, stem: &str, sample: &Sample, offset: f64) -> Result<(), Error> {
    let suffix = if offset > TINY {
        "_f"
    } else if offset < -TINY {
        "_b"
    } else {
        ""
    };
    let [material, face, file] = [format!("m_{stem}{suffix}"), format!("{stem}{suffix}"), format!("{stem}.xml")];
    let [material, face, file] = [&material, &face, &file].map(|name| Quoted(name));
    writeln!(text, "void BSDF {material}\n6 {} {file} 0 1 0 .\n0\n0\n", general(offset * 1.00004, 6))?;
    writeln!(text, "{material} polygon {face}\n0\n0\n12")?;
    let z = if offset < 0.0 { offset * 1.00002 } else { offset * 0.00002 };
    let (x, y) = (0.5 * sample.width, 0.5 * sample.height);
    for [x, y] in [[-x, -y], [x, -y], [x, y], [-x, y]] {
        let [x, y, z] = [x, y, z].map(|value| Exponential(value, 6));
        writeln!(text, "\t{x}\t{y}\t{z}")?;
    }
    Ok(writeln!(text)?)
}
