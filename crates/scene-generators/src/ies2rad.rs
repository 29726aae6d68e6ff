//! `ies2rad [options] [file …]`: converts IES luminaire files to Radiance luminaires.
//!
//! Writes for a luminaire LUM the files `LUM.rad` (a light with the shape of the luminous opening),
//! `LUM.dat` (candela), and `LUM%.dat` if the lamp's output depends on tilt. With `-s` the scene
//! text goes to standard output. `-o` names the luminaire, `-l` and `-p` prepend folders, `-d` sets
//! the scene's unit (`-dm/10`: tenths of a metre), `-m` multiplies the output, `-i` puts the light
//! on a sphere of this radius, `-t` `-u` `-c` set the lamp, the default lamp and the colour, `-f`
//! the lamp table. With `-g` the luminaire's own geometry stands in the scene text all the same, not
//! in an octree. Formats: ANSI/IES LM-63 of 1986, 1991, 1995, 2002, 2019; photometry of types B
//! and C.

mod luminaire;
mod opening;

use std::fmt::Write;

use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::lamps::{BUILT_IN, Lamp, Lamps};
use crate::mgf::{Converter, MaterialWriter};
use crate::number_text::{leading_number, whole_number};
use crate::text::{Text, general};
use crate::{Error, Invocation, Output};
use luminaire::{Luminaire, Photometry, Tilt};
use opening::{Opening, Shape};
use radsight_units::photometry::WHITE_EFFICACY;

/// Metres in a foot.
const FOOT: f64 = 0.3048;
const TINY: f64 = 1e-6;

struct Options {
    output_name: Option<String>,
    library_folder: Option<String>,
    prefix_folder: Option<String>,
    /// Scene units per metre, and the unit's name.
    units_per_metre: f64,
    units: String,
    to_standard_output: bool,
    /// Radius of an `illum` sphere in scene units.
    illum_radius: Option<f64>,
    /// Whether an octree of the luminaire's geometry is requested.
    wants_octree: bool,
    multiplier: f64,
    lamp_file: Option<String>,
    lamp: Option<String>,
    default_lamp: Option<String>,
    default_color: [f64; 3],
}

/// The source of the lamp's colour.
struct LampChoice {
    lamps: Lamps,
    /// The colour if the file names no lamp.
    default_color: [f64; 3],
    /// Whether the file's lamp is ignored.
    is_fixed: bool,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let options = read(&mut arguments)?;
    let header = invocation.argv[..arguments.position()].join(" ").replace(['\n', '\r'], " ");
    let inputs = arguments.rest();
    if options.output_name.is_none() && inputs.is_empty() {
        return Err(arguments.mistake(arguments.position(), "neither an input file nor an output name (-o) is given"));
    }
    if (options.output_name.is_some() || options.to_standard_output) && inputs.len() > 1 {
        return Err(arguments.mistake(arguments.position() + 1, "one output takes a single input file"));
    }
    let mut output = Output { warnings: std::mem::take(&mut arguments.warnings), ..Output::default() };
    let choice = choose_lamp(&options, invocation, &mut output.warnings)?;
    let standard_input = [String::new()];
    for input in if inputs.is_empty() { &standard_input[..] } else { inputs } {
        let (source_name, bytes) = match input.as_str() {
            "" => ("standard input", invocation.standard_input()?.to_vec()),
            name => (name, invocation.loader.load(name, FileKind::Input)?.bytes),
        };
        let name = options.output_name.clone().unwrap_or_else(|| stem_of(input).to_owned());
        let mut conversion =
            Conversion { options: &options, choice: &choice, invocation, source_name, name, output: &mut output };
        conversion.convert(&header, &bytes)?;
    }
    Ok(output)
}

fn read(arguments: &mut Arguments<'_>) -> Result<Options, Error> {
    let mut options = Options {
        output_name: None,
        library_folder: None,
        prefix_folder: None,
        units_per_metre: 1.0,
        units: "meters".to_owned(),
        to_standard_output: false,
        illum_radius: None,
        wants_octree: false,
        multiplier: 1.0,
        lamp_file: None,
        lamp: None,
        default_lamp: None,
        default_color: [1.0; 3],
    };
    while let Some(option) = arguments.option()? {
        match option.name {
            "-d" => read_units(&mut options, option.text).ok_or_else(|| arguments.unknown())?,
            "-l" => options.library_folder = Some(arguments.required("library folder (-l)")?.to_owned()),
            "-p" => options.prefix_folder = Some(arguments.required("prefix folder (-p)")?.to_owned()),
            "-f" => options.lamp_file = Some(arguments.required("lamp table (-f)")?.to_owned()),
            "-o" => options.output_name = Some(arguments.required("output name (-o)")?.to_owned()),
            "-s" => options.to_standard_output = !options.to_standard_output,
            "-i" => {
                let radius = arguments.number("illum radius (-i)")?;
                options.illum_radius = (radius != 0.0).then_some(radius);
            }
            "-t" => options.lamp = Some(arguments.required("lamp (-t)")?.to_owned()),
            "-u" => options.default_lamp = Some(arguments.required("default lamp (-u)")?.to_owned()),
            "-c" => options.default_color = arguments.vector("default colour (-c)")?,
            "-m" => options.multiplier = arguments.number("multiplier (-m)")?,
            "-g" => options.wants_octree = !options.wants_octree,
            _ => return Err(arguments.unknown()),
        }
    }
    Ok(options)
}

/// Parses `-dX` or `-dX/N`: units of 1/N metre, centimetre, foot or inch.
fn read_units(options: &mut Options, text: &str) -> Option<()> {
    let letter = text.chars().next()?;
    let tail = &text[letter.len_utf8()..];
    let parts = match tail.strip_prefix('/') {
        Some(number) => leading_number(number).map(|(value, _)| value).filter(|value| *value > TINY)?,
        None if tail.is_empty() => 1.0,
        None => return None,
    };
    let is = |value: f64| (parts - value).abs() <= TINY;
    let (units, per_metre) = match letter {
        'c' if is(10.0) => ("millimeters".to_owned(), 100.0 * parts),
        'c' => (format!("centimeters{tail}"), 100.0 * parts),
        'm' if is(1000.0) => ("millimeters".to_owned(), parts),
        'm' if is(100.0) => ("centimeters".to_owned(), parts),
        'm' => (format!("meters{tail}"), parts),
        'i' => (format!("inches{tail}"), parts * 12.0 / FOOT),
        'f' if is(12.0) => ("inches".to_owned(), parts / FOOT),
        'f' => (format!("feet{tail}"), parts / FOOT),
        _ => return None,
    };
    (options.units, options.units_per_metre) = (units, per_metre);
    Some(())
}

fn choose_lamp(
    options: &Options,
    invocation: &Invocation<'_>,
    warnings: &mut Vec<String>,
) -> Result<LampChoice, Error> {
    let is_default = options.lamp.as_deref() == Some("default");
    let mut choice =
        LampChoice { lamps: Lamps::default(), default_color: options.default_color, is_fixed: options.lamp.is_some() };
    if is_default && options.default_lamp.is_none() {
        return Ok(choice);
    }
    let table_name = options.lamp_file.as_deref().unwrap_or("lamp.tab");
    let table = match invocation.loader.load(table_name, FileKind::Other) {
        Ok(loaded) => String::from_utf8_lossy(&loaded.bytes).into_owned(),
        Err(_) if options.lamp_file.is_none() => BUILT_IN.to_owned(),
        Err(error) => {
            warnings.push(format!("no lamp data: {error}"));
            return Ok(LampChoice { is_fixed: true, ..choice });
        }
    };
    choice.lamps = Lamps::read(&table).map_err(|mistake| Error::Input {
        program: "ies2rad".to_owned(),
        source_name: table_name.to_owned(),
        mistake,
    })?;
    for name in [&options.default_lamp, &options.lamp].into_iter().flatten().filter(|name| *name != "default") {
        match choice.lamps.find(name) {
            Some(lamp) => choice.default_color = lamp.rgb(),
            None => warnings.push(format!("unknown lamp type \"{name}\"")),
        }
    }
    Ok(choice)
}

/// The conversion of one luminaire.
struct Conversion<'a> {
    options: &'a Options,
    choice: &'a LampChoice,
    invocation: &'a Invocation<'a>,
    source_name: &'a str,
    /// Name of the luminaire, with folders.
    name: String,
    output: &'a mut Output,
}

impl Conversion<'_> {
    fn convert(&mut self, header: &str, bytes: &[u8]) -> Result<(), Error> {
        let text = String::from_utf8_lossy(bytes);
        let mut words = luminaire::Words::default();
        let head = luminaire::read_head(&text, &mut words).map_err(|mistake| self.error(mistake))?;
        let mut scene = Text::default();
        writeln!(scene, "# {header}\n# Dimensions in {}", self.options.units)?;
        for line in &head.lines {
            writeln!(scene, "#<{line}")?;
        }
        let color = self.lamp_color(&head, &mut scene)?;
        let tilt_name = self.write_tilt(&head.tilt, &mut words, &mut scene)?;
        let luminaire = Luminaire::read(&mut words, head.version).map_err(|mistake| self.error(mistake))?;
        let mut opening = self.opening(&luminaire)?;
        opening.is_illum |= head.geometry.is_some();
        if let Some(warning) = opening.warning {
            self.output.warnings.push(warning.replace('\n', "; "));
        }
        let data = luminaire.data_file(WHITE_EFFICACY)?;
        self.keep(".dat", data);
        self.write_light(&luminaire, &opening, &tilt_name, color, &mut scene)?;
        if let Some(geometry) = &head.geometry {
            self.write_geometry(geometry, &luminaire, &opening, &mut scene)?;
        }
        if self.options.to_standard_output {
            self.output.standard_output.extend(scene.into_bytes());
        } else {
            self.keep(".rad", scene.into_bytes());
        }
        Ok(())
    }

    fn error(&self, mistake: impl Into<String>) -> Error {
        let (program, source_name) = ("ies2rad".to_owned(), self.source_name.to_owned());
        Error::Input { program, source_name, mistake: mistake.into() }
    }

    /// Outputs a file of the luminaire.
    fn keep(&mut self, suffix: &str, bytes: Vec<u8>) {
        let name = self.stored(self.referred(&self.name, suffix));
        self.output.files.push((name, bytes));
    }

    /// The path of the file to which the scene refers by this name: in the library's folder, which
    /// must be in `RAYPATH` when the scene is read, unless the name says another place.
    fn stored(&self, referred: String) -> String {
        match &self.options.library_folder {
            Some(folder) if !folder.is_empty() && !referred.starts_with(['/', '.']) => {
                format!("{}/{referred}", folder.trim_end_matches('/'))
            }
            _ => referred,
        }
    }

    /// The name by which the scene refers to a file: with the prefix, without the library's folder.
    fn referred(&self, name: &str, suffix: &str) -> String {
        match &self.options.prefix_folder {
            Some(folder) if !folder.is_empty() && !name.starts_with(['/', '.']) => {
                format!("{}/{name}{suffix}", folder.trim_end_matches('/'))
            }
            _ => format!("{name}{suffix}"),
        }
    }

    fn lamp_color(&mut self, head: &luminaire::Head, scene: &mut Text) -> Result<[f64; 3], Error> {
        if self.choice.is_fixed {
            return Ok(self.choice.default_color);
        }
        match head.lamp_descriptions.iter().find_map(|text| self.choice.lamps.find(text)) {
            Some(lamp) => {
                let Lamp { chromaticity: [x, y], depreciation } = lamp;
                let [x, y, percent] = [x, y, depreciation].map(|value| f64::from(value as f32));
                writeln!(scene, "# CIE(x,y) = ({x:.6},{y:.6})\n# Depreciation = {:.1}%", 100.0 * percent)?;
                Ok(lamp.rgb())
            }
            None => {
                self.output.warnings.push(format!("{}: no lamp type", self.source_name));
                writeln!(scene, "# Unknown lamp type (used default)")?;
                Ok(self.choice.default_color)
            }
        }
    }

    /// Writes the tilt dependence, if any; returns the modifier for what follows.
    fn write_tilt(&mut self, tilt: &str, words: &mut luminaire::Words, scene: &mut Text) -> Result<String, Error> {
        let (name, tilt) = match tilt {
            "NONE" => return Ok("void".to_owned()),
            "INCLUDE" => (self.name.clone(), Tilt::read(words)),
            file => {
                let path = match self.source_name.rsplit_once('/') {
                    Some((folder, _)) if !file.starts_with('/') => format!("{folder}/{file}"),
                    _ => file.to_owned(),
                };
                let loaded = self.invocation.loader.load(&path, FileKind::Other)?;
                let mut words = luminaire::Words::of(&String::from_utf8_lossy(&loaded.bytes));
                (stem_of(file).to_owned(), Tilt::read(&mut words))
            }
        };
        let tilt = tilt.map_err(|mistake| self.error(format!("tilt: {mistake}")))?;
        let file = self.referred(&name, "%.dat");
        let modifier = format!("{}_tilt", file_name(&name));
        let past_horizontal = tilt.last_angle() > 90.0 + TINY;
        let (function, transform) = match (tilt.mounting, past_horizontal) {
            (1, true) => ("tilt_ang", ""),
            (1, false) => ("tilt_ang2", ""),
            (2, true) => ("tilt_xang", " -rz 90"),
            (2, false) => ("tilt_xang2", " -rz 90"),
            (_, true) => ("tilt_xang", ""),
            (_, false) => ("tilt_xang2", ""),
        };
        let count = 4 + transform.split_whitespace().count();
        write!(scene, "\nvoid brightdata {modifier}\n{count} noop {file} tilt.cal {function}{transform}\n0\n0\n")?;
        let file = self.stored(file);
        self.output.files.push((file, tilt.data_file()?));
        Ok(modifier)
    }

    fn opening(&self, luminaire: &Luminaire) -> Result<Opening, Error> {
        if let Some(radius) = self.options.illum_radius {
            let metres = radius / self.options.units_per_metre;
            if metres < opening::SMALLEST / 2.0 {
                return Err(self.error(format!("the illum radius (-i) of {radius} is less than half a millimetre")));
            }
            return Ok(Opening::illum(2.0 * metres));
        }
        Opening::of(luminaire).map_err(|mistake| self.error(mistake))
    }

    fn write_light(
        &self,
        luminaire: &Luminaire,
        opening: &Opening,
        modifier: &str,
        color: [f64; 3],
        scene: &mut Text,
    ) -> Result<(), Error> {
        let g = |value: f64| general(value, 6);
        let name = file_name(&self.name);
        writeln!(
            scene,
            "\n# {} watt luminaire, lamp*ballast factor = {}",
            g(luminaire.watts),
            g(luminaire.ballast_factor)
        )?;
        match opening.described {
            Some(words) => writeln!(scene, "# IES file shape = {words}")?,
            None => writeln!(scene, "# IES file shape overridden")?,
        }
        writeln!(scene, "# Radiance geometry shape = {}", opening.shape.words())?;
        for line in opening.warning.unwrap_or_default().lines() {
            writeln!(scene, "# {line}")?;
        }
        let (lower, upper) = (luminaire.vertical[0] < 90.0 - TINY, luminaire.last_vertical() > 90.0 + TINY);
        let has_sides = lower && upper && opening.height > opening::SMALLEST;
        let luminous = if has_sides { LuminousParts::EndsAndSides } else { LuminousParts::Ends };
        let (correction, coordinates) = (correction(opening.shape, luminous), coordinates(luminaire));
        let count = 3 + coordinates.split_whitespace().count();
        writeln!(scene, "\n'{modifier}' brightdata '{name}_dist'")?;
        writeln!(scene, "{count} {correction} '{}' source.cal {coordinates} ", self.referred(&self.name, ".dat"))?;
        let multiplier = self.options.multiplier * luminaire.multiplier;
        let [width, length, height] = [opening.width, opening.length, opening.height].map(g);
        match (opening.shape, luminous) {
            (Shape::Cylinder, LuminousParts::EndsAndSides) => {
                writeln!(scene, "0\n3 {} {width} {height}", g(multiplier))?
            }
            (Shape::Box, LuminousParts::EndsAndSides) => {
                writeln!(scene, "0\n4 {} {length} {width} {height}", g(multiplier))?
            }
            _ => writeln!(scene, "0\n1 {}", g(multiplier / opening.area()))?,
        }
        let kind = if opening.is_illum { "illum" } else { "light" };
        let [red, green, blue] = color.map(g);
        write!(scene, "\n'{name}_dist' {kind} '{name}_light'\n0\n0\n3 {red} {green} {blue}\n")?;
        opening.write(scene, name, self.options.units_per_metre, [lower, upper, has_sides])
    }

    /// Appends the geometry named in the luminaire's file, in Materials and Geometry Format.
    fn write_geometry(
        &mut self,
        file: &str,
        luminaire: &Luminaire,
        opening: &Opening,
        scene: &mut Text,
    ) -> Result<(), Error> {
        let path = match self.source_name.rsplit_once('/') {
            Some((folder, _)) => format!("{folder}/{file}"),
            None => file.to_owned(),
        };
        let loaded = self.invocation.loader.load(&path, FileKind::Other)?;
        if self.options.wants_octree {
            self.output.warnings.push(format!("-g: the scene holds the geometry of \"{path}\" itself, not an octree"));
        }
        let scale = self.options.units_per_metre;
        let size = (opening.width.powi(2) + opening.length.powi(2) + opening.height.powi(2)).sqrt();
        let mut materials = MaterialWriter::default();
        materials.emitter_multiplier = self.options.multiplier * luminaire.multiplier;
        materials.glow_distance = Some(size * scale);
        let mut text = Text::default();
        writeln!(text)?;
        let mut converter = Converter::new(self.invocation.loader, materials, text);
        let whole = format!("xf -s {scale}\n{}\nxf\n", String::from_utf8_lossy(&loaded.bytes));
        converter.convert(&path, whole.as_bytes())?;
        self.output.warnings.extend(converter.warnings);
        Ok(scene.push_bytes(&converter.text.into_bytes())?)
    }
}

/// The luminous parts of an opening that is no sphere.
#[derive(Clone, Copy)]
enum LuminousParts {
    Ends,
    EndsAndSides,
}

/// The function of `source.cal` that converts candela to radiance over the opening.
fn correction(shape: Shape, luminous: LuminousParts) -> &'static str {
    match (shape, luminous) {
        (Shape::Sphere, _) => "corr",
        (_, LuminousParts::Ends) => "flatcorr",
        (Shape::Cylinder, LuminousParts::EndsAndSides) => "cylcorr",
        (Shape::Box, LuminousParts::EndsAndSides) => "boxcorr",
    }
}

/// The coordinates into the data, with the symmetry implied by the horizontal angles.
fn coordinates(luminaire: &Luminaire) -> &'static str {
    let equal = |a: f64, b: f64| (a - b).abs() <= TINY;
    let (first, last) = (luminaire.horizontal[0], luminaire.last_horizontal());
    let around_y = equal(first, 90.0) && equal(last, 270.0);
    match luminaire.photometry {
        Photometry::B if equal(first, 0.0) => "srcB_horiz2 srcB_vert",
        Photometry::B => "srcB_horiz srcB_vert",
        Photometry::C if luminaire.horizontal.len() < 2 => "src_theta",
        Photometry::C if last - first <= 90.0 + TINY => "src_phi4 src_theta",
        Photometry::C if around_y => "src_phi2+90 src_theta -rz -90",
        Photometry::C if last - first <= 180.0 + TINY && equal(first, 90.0) => "src_phi2+90 src_theta",
        Photometry::C if last - first <= 180.0 + TINY => "src_phi2 src_theta",
        Photometry::C => "src_phi src_theta",
    }
}

/// The last component of a path.
fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// The last component of a path without its extension.
fn stem_of(path: &str) -> &str {
    let name = file_name(path);
    let leading = name.len() - name.trim_start_matches('.').len();
    match name[leading..].rfind('.') {
        Some(dot) => &name[..leading + dot],
        None => name,
    }
}

/// A word of a luminaire file as a number.
fn number(word: &str) -> Result<f64, String> {
    whole_number(word).filter(|value| value.is_finite()).ok_or_else(|| format!("\"{word}\" is not a number"))
}
