//! Reading BSDF files.

use crate::basis::AngleBasis;
use crate::data::{MeasuredBsdf, Side};
use crate::matrix::Matrix;
use crate::mistake::{Mistake, Place};
use crate::scattering::{Data, Scattering};
use crate::tensor::Tensor;
use crate::tree::{Rank, Tree};
use crate::tree_text::{Numbers, Token, read_tree, scattering_value};
use crate::xml::{Element, Text, Xml};
use std::sync::Arc;

/// Data of a file, with warnings.
#[derive(Debug)]
pub struct Reading {
    /// The data.
    pub bsdf: MeasuredBsdf,
    /// Warnings about ignored data.
    pub warnings: Vec<Mistake>,
}

/// A scattering function with a smaller total is left out.
const LEAST_TOTAL: f64 = 0.001;

impl MeasuredBsdf {
    /// Reads a file.
    ///
    /// # Errors
    /// The first error that makes the data unusable, with its position.
    pub fn read(bytes: &[u8]) -> Result<Reading, Mistake> {
        read(bytes)
    }
}

fn read(bytes: &[u8]) -> Result<Reading, Mistake> {
    let source = Text::decode(bytes)?;
    let result = Xml::parse(&source).and_then(|xml| {
        let mut reader = Reader { warnings: Vec::new(), bases: known_bases(), directions: Default::default() };
        let bsdf = reader.window_element(xml.root())?;
        Ok(Reading { bsdf, warnings: reader.warnings })
    });
    match result {
        Ok(mut reading) => {
            reading.warnings.iter_mut().for_each(|mistake| source.in_bytes(mistake));
            Ok(reading)
        }
        Err(mut mistake) => {
            source.in_bytes(&mut mistake);
            Err(mistake)
        }
    }
}

fn known_bases() -> Vec<Arc<AngleBasis>> {
    AngleBasis::known().into_iter().map(Arc::new).collect()
}

struct Reader {
    warnings: Vec<Mistake>,
    bases: Vec<Arc<AngleBasis>>,
    /// Reflection from the front and from the back, then transmission of light incident on each.
    directions: [Channels; 4],
}

/// Channels of one direction: luminance, and two more for colour (X and Z, or u′ and v′).
#[derive(Default)]
struct Channels([Option<Block>; 3]);

enum Block {
    Matrix { incident: Arc<AngleBasis>, exit: Arc<AngleBasis>, values: Vec<f32> },
    Tree(Tree),
}

/// Layout of the data.
#[derive(Clone, Copy, PartialEq)]
enum Structure {
    /// One row per incident direction.
    Rows,
    /// One column per incident direction.
    Columns,
    Tree(Rank),
}

/// Names of a block's direction, and its index in [`Reader::directions`]. WINDOW's front is the
/// back here.
const DIRECTIONS: [(&str, usize); 4] =
    [("Reflection Back", 0), ("Reflection Front", 1), ("Transmission Back", 2), ("Transmission Front", 3)];

impl Reader {
    fn window_element(&mut self, root: Element<'_, '_>) -> Result<MeasuredBsdf, Mistake> {
        if root.name() != "WindowElement" {
            let place = root.tag_place();
            return Err(Mistake::unexpected("the top element", root.name(), "\"WindowElement\"", place));
        }
        if let Some(kind) = root.child("FileType") {
            kind.word_among("<FileType>", &["BSDF"])?;
        }
        let layer = root.need("Optical")?.need("Layer")?;
        let mut bsdf = MeasuredBsdf::default();
        if let Some(material) = layer.child("Material") {
            self.material(material, &mut bsdf)?;
        }
        bsdf.geometry = geometry(layer)?;
        let definition = layer.need("DataDefinition")?;
        let structure = definition.need("IncidentDataStructure")?;
        let layouts = ["Columns", "Rows", "TensorTree3", "TensorTree4"];
        let structure = match structure.word_among("<IncidentDataStructure>", &layouts)? {
            0 => Structure::Columns,
            1 => Structure::Rows,
            2 => Structure::Tree(Rank::Isotropic),
            _ => Structure::Tree(Rank::Anisotropic),
        };
        for basis in definition.children("AngleBasis").filter(|_| !matches!(structure, Structure::Tree(_))) {
            self.angle_basis(basis)?;
        }
        for data in layer.children("WavelengthData") {
            self.wavelength(data, structure)?;
        }
        if self.directions.iter().all(|channels| channels.0[0].is_none()) {
            let place = layer.tag_place();
            self.warnings.push(Mistake::Missing { element: "Visible", inside: "WavelengthData".to_owned(), place });
        }
        self.finish(&mut bsdf);
        Ok(bsdf)
    }

    fn material(&mut self, material: Element<'_, '_>, bsdf: &mut MeasuredBsdf) -> Result<(), Mistake> {
        let words = |name: &str| material.child(name).map_or(String::new(), |element| element.text().trim().to_owned());
        (bsdf.material, bsdf.maker) = (words("Name"), words("Manufacturer"));
        for (size, name) in bsdf.size_m.iter_mut().zip(["Width", "Height", "Thickness"]) {
            let Some(element) = material.child(name) else { continue };
            let text = element.text();
            let what = format!("<{name}>");
            let mistake = |expected| Mistake::unexpected(&*what, &text, expected, element.text_place());
            match text.trim().parse::<f64>() {
                Ok(length) if length >= 0.0 && length.is_finite() => *size = length * metres(element)?,
                Ok(_) => return Err(mistake("a length not below zero")),
                Err(_) if text.trim().is_empty() => {}
                Err(_) => self.warnings.push(mistake("a length")),
            }
        }
        Ok(())
    }

    fn angle_basis(&mut self, element: Element<'_, '_>) -> Result<(), Mistake> {
        let name = element.need("AngleBasisName")?.text().trim().to_owned();
        if self.bases.iter().any(|known| known.name.eq_ignore_ascii_case(&name)) {
            return Ok(());
        }
        let mut rings: Vec<(f64, usize)> = Vec::new();
        for block in element.children("AngleBasisBlock") {
            let begun = rings.last().map_or(0.0, |ring| ring.0);
            let bounds = block.need("ThetaBounds")?;
            let (upper, place) = bounds.need("UpperTheta")?.number("<UpperTheta>")?;
            if !(upper > begun && upper <= 90.0) {
                let expected = format!("degrees above {begun} up to 90");
                return Err(Mistake::unexpected("<UpperTheta>", &upper.to_string(), expected, place));
            }
            if let Some(lower) = bounds.child("LowerTheta").filter(|_| !rings.is_empty()) {
                let (lower, place) = lower.number("<LowerTheta>")?;
                if (lower - begun).abs() > 1e-6 * begun {
                    let expected = format!("{begun}, where the ring before ends");
                    return Err(Mistake::unexpected("<LowerTheta>", &lower.to_string(), expected, place));
                }
            }
            let (patches, place) = block.need("nPhis")?.number("<nPhis>")?;
            let least = if rings.is_empty() { 1.0 } else { 2.0 };
            if !(patches >= least && patches <= MOST_PATCHES && patches.fract() == 0.0) {
                let expected = format!("an integer from {least} to {MOST_PATCHES}");
                return Err(Mistake::unexpected("<nPhis>", &patches.to_string(), expected, place));
            }
            rings.push((upper, patches as usize));
        }
        self.bases.push(Arc::new(AngleBasis::new(name, &rings)));
        Ok(())
    }

    /// Reads visible data; data of the solar spectrum or of single wavelengths are ignored.
    fn wavelength(&mut self, data: Element<'_, '_>, structure: Structure) -> Result<(), Mistake> {
        let Some(wavelength) = data.child("Wavelength") else { return Ok(()) };
        let names = match structure {
            Structure::Tree(_) => ["Visible", "CIE-u", "CIE-v"],
            _ => ["Visible", "CIE-X", "CIE-Z"],
        };
        let text = wavelength.text();
        let Some(channel) = names.iter().position(|name| name.eq_ignore_ascii_case(text.trim())) else { return Ok(()) };
        for block in data.children("WavelengthDataBlock") {
            let Some(direction) = block.child("WavelengthDataDirection") else { continue };
            let text = direction.text();
            let known = DIRECTIONS.iter().find(|(name, _)| name.eq_ignore_ascii_case(text.trim()));
            let Some((_, index)) = known else {
                let expected = DIRECTIONS.map(|(name, _)| format!("\"{name}\"")).join(", ");
                let place = direction.text_place();
                self.warnings.push(Mistake::unexpected("<WavelengthDataDirection>", &text, expected, place));
                continue;
            };
            self.directions[*index].0[channel] = Some(self.block(block, structure)?);
        }
        Ok(())
    }

    fn block(&mut self, block: Element<'_, '_>, structure: Structure) -> Result<Block, Mistake> {
        if let Structure::Tree(rank) = structure {
            block.need("AngleBasis")?.word_among("<AngleBasis>", &["LBNL/Shirley-Chiu"])?;
            let data = block.need("ScatteringData")?;
            return read_tree(&data.text(), rank).map(Block::Tree).map_err(|mistake| data.within(mistake));
        }
        let incident = self.basis(block, "ColumnAngleBasis")?;
        let exit = self.basis(block, "RowAngleBasis")?;
        let data = block.need("ScatteringData")?;
        let text = data.text();
        let values = read_matrix(&text, incident.len().saturating_mul(exit.len()), &mut self.warnings, &data)
            .map_err(|mistake| data.within(mistake))?;
        let values = match structure {
            Structure::Rows => transposed(&values, incident.len(), exit.len()),
            _ => values,
        };
        Ok(Block::Matrix { incident, exit, values })
    }

    fn basis(&self, block: Element<'_, '_>, element: &'static str) -> Result<Arc<AngleBasis>, Mistake> {
        let element = block.need(element)?;
        let text = element.text();
        let found = self.bases.iter().rev().find(|basis| basis.name.eq_ignore_ascii_case(text.trim()));
        found.cloned().ok_or_else(|| {
            let known: Vec<String> = self.bases.iter().take(8).map(|basis| format!("\"{}\"", basis.name)).collect();
            let what = format!("<{}>", element.name());
            Mistake::unexpected(what, &text, known.join(", "), element.text_place())
        })
    }

    /// Splits off the Lambertian parts.
    fn finish(&mut self, bsdf: &mut MeasuredBsdf) {
        let [front, back, through_front, through_back] = std::mem::take(&mut self.directions);
        let sides = [Side::Front, Side::Back];
        let mut is_given = [false; 2];
        for (at, channels) in [front, back].into_iter().enumerate() {
            if let Some((diffuse, data)) = channels.split() {
                bsdf.diffuse_reflectance[at] = diffuse;
                bsdf.reflection[at] = significant(data, diffuse, sides[at], sides[at]);
            }
        }
        for (at, channels) in [through_front, through_back].into_iter().enumerate() {
            if let Some((diffuse, data)) = channels.split() {
                is_given[at] = true;
                bsdf.diffuse_transmittance[at] = diffuse;
                bsdf.transmission[at] = significant(data, diffuse, sides[at], sides[at].opposite());
            }
        }
        match is_given {
            [false, true] => bsdf.diffuse_transmittance[0] = bsdf.diffuse_transmittance[1],
            [true, false] => bsdf.diffuse_transmittance[1] = bsdf.diffuse_transmittance[0],
            _ => {}
        }
    }
}

/// Maximum number of patches in a ring.
const MOST_PATCHES: f64 = 1e6;

impl Channels {
    /// Splits off the Lambertian part; colour is used only if all three channels have the same
    /// structure.
    fn split(self) -> Option<([f64; 3], Data)> {
        let [luminance, second, third] = self.0;
        match luminance? {
            Block::Matrix { incident, exit, values } => {
                let same = |block: Option<Block>| match block {
                    Some(Block::Matrix { values: other, .. }) if other.len() == values.len() => Some(other),
                    _ => None,
                };
                let x_and_z = same(second).zip(same(third)).map(<[Vec<f32>; 2]>::from);
                let mut matrix = Matrix::new(incident, exit, values, x_and_z.as_ref());
                Some((matrix.split_diffuse(x_and_z), Data::Matrix(matrix)))
            }
            Block::Tree(tree) => {
                let other = |block: Option<Block>| match block {
                    Some(Block::Tree(other)) => Some(other),
                    _ => None,
                };
                let chromaticity = other(second).zip(other(third)).map(<[Tree; 2]>::from);
                let mut tensor = Tensor::new(tree, chromaticity);
                Some((tensor.split_diffuse(), Data::Tensor(Box::new(tensor))))
            }
        }
    }
}

fn significant(data: Data, diffuse: [f64; 3], incident: Side, exit: Side) -> Option<Scattering> {
    Some(Scattering::new(data, diffuse, incident, exit)).filter(|scattering| scattering.largest_total() > LEAST_TOTAL)
}

/// Reads one number per pair of patches; further numbers are ignored with a warning.
fn read_matrix(
    text: &str,
    count: usize,
    warnings: &mut Vec<Mistake>,
    data: &Element<'_, '_>,
) -> Result<Vec<f32>, Mistake> {
    // A number takes at least one byte and a separator.
    if count > text.len() / 2 + 1 {
        let found = text.split([',', ' ', '\n', '\t', '\r']).filter(|word| !word.is_empty()).count();
        return Err(Mistake::Count { found, expected: count.to_string(), place: 0..text.len() });
    }
    let mut numbers = Numbers::new(text);
    let mut values = Vec::with_capacity(count);
    loop {
        match numbers.next() {
            (Token::Word(word), at) if values.len() < count => values.push(scattering_value(word, at)?),
            (Token::Word(_), at) => {
                let expected = count.to_string();
                let mistake = Mistake::Count { found: count + 1, expected, place: at..text.len() };
                warnings.push(data.within(mistake));
                return Ok(values);
            }
            (Token::End, _) if values.len() == count => return Ok(values),
            (Token::End, at) => {
                return Err(Mistake::Count { found: values.len(), expected: count.to_string(), place: at..at });
            }
            (Token::Open | Token::Close, at) => {
                return Err(Mistake::unexpected("a scattering value", &text[at..=at], "a finite number", at..at + 1));
            }
        }
    }
}

/// Transposes from one row per incident direction to one column each.
fn transposed(values: &[f32], incident: usize, exit: usize) -> Vec<f32> {
    (0..values.len()).map(|at| values[at % incident * exit + at / incident]).collect()
}

fn geometry(layer: Element<'_, '_>) -> Result<Option<String>, Mistake> {
    let Some(geometry) = layer.child("Geometry") else { return Ok(None) };
    if let Some(format) = geometry.attribute("format").filter(|format| !format.eq_ignore_ascii_case("MGF")) {
        return Err(Mistake::unexpected("the geometry's format", format, "\"MGF\"", geometry.tag_place()));
    }
    let Some(block) = geometry.child("MGFblock") else { return Ok(None) };
    let text = block.text();
    if text.trim().is_empty() {
        return Ok(None);
    }
    let scale = metres(block)?;
    let is_one = (0.99..=1.01).contains(&scale);
    let text = text.trim_start();
    Ok(Some(if is_one { text.to_owned() } else { format!("xf -s {scale:.5}\n{text}\nxf\n") }))
}

/// Metres per unit of an element; without a unit, one metre.
fn metres(element: Element<'_, '_>) -> Result<f64, Mistake> {
    const UNITS: [(&str, f64); 5] =
        [("Meter", 1.0), ("Foot", 0.3048), ("Inch", 0.0254), ("Centimeter", 0.01), ("Millimeter", 0.001)];
    let Some(unit) = element.attribute("unit") else { return Ok(1.0) };
    let known = UNITS.iter().find(|(name, _)| name.eq_ignore_ascii_case(unit));
    known.map(|(_, metres)| *metres).ok_or_else(|| {
        let expected = UNITS.map(|(name, _)| format!("\"{name}\"")).join(", ");
        let what = format!("the unit of <{}>", element.name());
        Mistake::unexpected(what, unit, expected, element.tag_place())
    })
}

impl Element<'_, '_> {
    /// Index of the text among some words.
    fn word_among(&self, what: &str, words: &[&str]) -> Result<usize, Mistake> {
        let text = self.text();
        words.iter().position(|word| word.eq_ignore_ascii_case(text.trim())).ok_or_else(|| {
            let expected: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
            Mistake::unexpected(what, &text, expected.join(", "), self.text_place())
        })
    }

    fn number(&self, what: &str) -> Result<(f64, Place), Mistake> {
        let (text, place) = (self.text(), self.text_place());
        match text.trim().parse::<f64>().ok().filter(|value| value.is_finite()) {
            Some(value) => Ok((value, place)),
            None => Err(Mistake::unexpected(what, &text, "a number", place)),
        }
    }
}
