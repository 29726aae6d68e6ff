//! Converts the Materials and Geometry Format (MGF), version 2, to Radiance text.
//!
//! Greg Ward, "The Materials and Geometry Format", Lawrence Berkeley Laboratory, 1995. A text of
//! statements, one per line: contexts (`c` colour, `m` material, `v` vertex) and statements that
//! modify them, surfaces that use them, `o` names, `xf` transforms with arrays, `i` included files.

mod color;
mod luminaire;
mod material;
mod shapes;
mod transform;

use std::collections::HashMap;

use radsight_loader::{FileKind, Loader};

use crate::Error;
use crate::number_text::{leading_integer, whole_number};
use crate::text::Text;
use color::Color;
pub(crate) use luminaire::Luminaires;
pub(crate) use material::MaterialWriter;
use material::{Material, Part};
use transform::Transform;

/// Largest nesting depth of included files.
const MAX_INCLUDE_DEPTH: usize = 32;
/// Largest nesting depth of transforms.
const MAX_TRANSFORM_DEPTH: usize = 1000;
/// Largest number of arrays in one transform.
const MAX_ARRAY_DIMENSIONS: usize = 8;
/// Largest number of statements; those in arrays count once per copy.
const MOST_STATEMENTS: usize = 2_000_000;

/// A point with a normal, which is zero if undefined.
#[derive(Clone, Copy, Debug, Default)]
struct Vertex {
    point: [f64; 3],
    normal: [f64; 3],
}

/// Named entities of one kind, and the current one.
struct Context<T> {
    named: HashMap<String, T>,
    unnamed: T,
    current: Option<String>,
}

impl<T: Clone + Default> Default for Context<T> {
    fn default() -> Self {
        Context { named: HashMap::new(), unnamed: T::default(), current: None }
    }
}

impl<T: Clone + Default> Context<T> {
    /// Executes `c`, `c name`, `c name =` or `c name = template`.
    fn select(&mut self, words: &[String]) -> Result<(), String> {
        let lookup = |named: &HashMap<String, T>, name: &str| {
            named.get(name).cloned().ok_or_else(|| format!("\"{name}\" is not defined"))
        };
        match words {
            [_] => {
                self.unnamed = T::default();
                self.current = None;
            }
            [_, name] => {
                lookup(&self.named, name)?;
                self.current = Some(name.clone());
            }
            [_, name, equals, template @ ..] if equals == "=" && template.len() < 2 => {
                if !is_name(name) {
                    return Err(format!("\"{name}\" is not a name: names begin with a letter"));
                }
                if template.first() != Some(name) {
                    let start = template.first().map_or(Ok(T::default()), |from| lookup(&self.named, from))?;
                    self.named.insert(name.clone(), start);
                }
                lookup(&self.named, name)?;
                self.current = Some(name.clone());
            }
            [keyword, ..] => {
                return Err(format!("expected \"{keyword}\", \"{keyword} name\" or \"{keyword} name = template\""));
            }
            [] => {}
        }
        Ok(())
    }

    fn current(&mut self) -> &mut T {
        match self.current.as_ref().and_then(|name| self.named.get_mut(name)) {
            Some(value) => value,
            None => &mut self.unnamed,
        }
    }
}

/// An open transform.
struct Placement {
    /// This transform combined with all outer ones.
    total: Transform,
    outer: Transform,
    arguments: Vec<String>,
    /// Index in `arguments`, current and total count of each array.
    arrays: Vec<(usize, i64, i64)>,
    /// Start of the statements that an array repeats: file number and line number.
    start: (usize, usize),
}

/// An open file.
struct Source {
    number: usize,
    name: String,
    lines: Vec<String>,
    next: usize,
    /// Number of open transforms before that of the `i` statement; `None` without one.
    outer_transforms: Option<usize>,
}

/// Reads MGF and writes Radiance text.
pub(crate) struct Converter<'a> {
    loader: &'a dyn Loader,
    pub(crate) text: Text,
    /// The text of the materials, if it is not `text`.
    pub(crate) material_text: Option<Text>,
    pub(crate) materials: MaterialWriter,
    pub(crate) warnings: Vec<String>,
    /// Converted luminaires; `None` leaves luminaires out, since the geometry of a luminaire holds no
    /// others.
    pub(crate) luminaires: Option<Luminaires>,
    /// Number of unknown statements.
    pub(crate) unknown: usize,
    colors: Context<Color>,
    material: Context<Material>,
    vertices: Context<Vertex>,
    objects: Vec<String>,
    placements: Vec<Placement>,
    sources: Vec<Source>,
    opened: usize,
    statements: usize,
    counters: shapes::Counters,
}

impl<'a> Converter<'a> {
    pub(crate) fn new(loader: &'a dyn Loader, materials: MaterialWriter, text: Text) -> Self {
        Converter {
            loader,
            text,
            material_text: None,
            materials,
            warnings: Vec::new(),
            luminaires: None,
            unknown: 0,
            colors: Context::default(),
            material: Context::default(),
            vertices: Context::default(),
            objects: Vec::new(),
            placements: Vec::new(),
            sources: Vec::new(),
            opened: 0,
            statements: 0,
            counters: shapes::Counters::default(),
        }
    }

    /// Converts a whole text.
    pub(crate) fn convert(&mut self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        self.open(name, bytes, None);
        while let Some(source) = self.sources.last_mut() {
            let at = source.next;
            if at == source.lines.len() {
                self.close()?;
                continue;
            }
            source.next += 1;
            let words: Vec<String> = source.lines[at].split_ascii_whitespace().map(str::to_owned).collect();
            self.statements += 1;
            let outcome = match self.statements > MOST_STATEMENTS {
                true => Ok(Err(format!("more than {MOST_STATEMENTS} statements, including copies"))),
                false => self.statement(&words),
            };
            if let Err(mistake) = outcome? {
                return Err(self.error(&mistake));
            }
        }
        Ok(())
    }

    /// An error at the current line.
    fn error(&self, mistake: &str) -> Error {
        let (name, line) = self.sources.last().map_or(("", 0), |source| (source.name.as_str(), source.next));
        let mistake = format!("line {line}: {mistake}");
        Error::Input { program: "mgf2rad".to_owned(), source_name: name.to_owned(), mistake }
    }

    fn open(&mut self, name: &str, bytes: &[u8], outer_transforms: Option<usize>) {
        let text = String::from_utf8_lossy(bytes).replace("\\\r\n", " ").replace("\\\n", " ");
        let lines = text.lines().map(str::to_owned).collect();
        self.opened += 1;
        self.sources.push(Source { number: self.opened, name: name.to_owned(), lines, next: 0, outer_transforms });
    }

    /// At the end of a file: closes its transform, or starts the next copy of an array.
    fn close(&mut self) -> Result<(), Error> {
        if let Some(outer) = self.sources.last().and_then(|source| source.outer_transforms)
            && self.placements.len() > outer
        {
            return match self.end_transform() {
                Ok(()) => Ok(()),
                Err(mistake) => Err(self.error(&mistake)),
            };
        }
        self.sources.pop();
        Ok(())
    }

    /// Executes a statement. The inner error is a mistake of the input.
    fn statement(&mut self, words: &[String]) -> Result<Result<(), String>, Error> {
        use std::fmt::Write;
        let Some(keyword) = words.first() else { return Ok(Ok(())) };
        Ok(match keyword.as_str() {
            "#" => {
                writeln!(self.text, "# {}", words[1..].join(" "))?;
                Ok(())
            }
            "c" => self.colors.select(words),
            "m" => self.select_material(words),
            "v" => self.vertices.select(words),
            "cxy" | "cspec" | "cct" | "cmix" => self.change_color(words),
            "rd" | "td" | "rs" | "ts" | "ed" | "ir" | "sides" => self.change_material(words),
            "p" | "n" => self.change_vertex(words),
            "o" => self.object(words),
            "xf" if words.len() == 1 => self.end_transform(),
            "xf" => self.begin_transform(&words[1..]),
            "i" => return self.include(words),
            "f" | "fh" | "sph" | "cyl" | "cone" | "ring" | "prism" | "torus" => return self.shape(words),
            "ies" => return self.luminaire(words),
            _ => {
                if self.unknown == 0 {
                    self.warnings.push(format!("unknown entity: {keyword}"));
                }
                self.unknown += 1;
                Ok(())
            }
        })
    }

    fn select_material(&mut self, words: &[String]) -> Result<(), String> {
        self.material.select(words)?;
        if words.len() > 2 || words.len() == 1 {
            self.material.current().is_new = true;
        }
        Ok(())
    }

    fn change_color(&mut self, words: &[String]) -> Result<(), String> {
        let color = match words[0].as_str() {
            "cxy" => {
                let [x, y] = numbers(words)?;
                if x < 0.0 || y < 0.0 || x + y > 1.0 {
                    return Err(format!("({x}, {y}) is not a chromaticity"));
                }
                Color::of_chromaticity([x, y])
            }
            "cct" => {
                let [kelvin] = numbers(words)?;
                Color::of_black_body(kelvin).ok_or_else(|| format!("{kelvin} K is below 1000 K"))?
            }
            "cspec" => {
                let values: Vec<f64> = words[1..].iter().map(|word| number(word)).collect::<Result<_, _>>()?;
                let [first, last, samples @ ..] = &values[..] else {
                    return Err("a spectrum needs two wavelengths and values".to_owned());
                };
                Color::of_samples(*first, *last, samples).ok_or("nothing of the spectrum is visible")?
            }
            _ => self.mixed_color(words)?,
        };
        let name = self.colors.current.clone();
        let current = self.colors.current();
        *current = color;
        if matches!(words[0].as_str(), "cspec" | "cct") {
            current.spectrum_name = name;
        }
        Ok(())
    }

    fn mixed_color(&self, words: &[String]) -> Result<Color, String> {
        if words.len() < 5 || words.len().is_multiple_of(2) {
            return Err("a mixture needs pairs of a weight and a colour".to_owned());
        }
        let mut mixture: Option<(f64, Color)> = None;
        for pair in words[1..].chunks(2) {
            let weight = number(&pair[0])?;
            let color = self.colors.named.get(&pair[1]).ok_or_else(|| format!("\"{}\" is not defined", pair[1]))?;
            mixture = Some(match mixture {
                None => (weight, color.clone()),
                Some((sum, mixed)) => (sum + weight, mixed.mixed(sum, color, weight)),
            });
        }
        match mixture {
            Some((sum, color)) if sum > 0.0 => Ok(color),
            _ => Err("the weights add up to zero".to_owned()),
        }
    }

    fn change_material(&mut self, words: &[String]) -> Result<(), String> {
        let color = self.colors.current().clone();
        let material = self.material.current();
        material.is_new = true;
        let share = |level: f64| match (0.0..=1.0).contains(&level) {
            true => Ok(level as f32),
            false => Err(format!("{level} is not a number from 0 to 1")),
        };
        let above_zero = |value: f64| match value >= 0.0 {
            true => Ok(value as f32),
            false => Err(format!("{value} is below zero")),
        };
        match words[0].as_str() {
            "ir" => {
                let [real, _] = numbers(words)?;
                if real <= 1e-6 {
                    return Err(format!("{real} is not a refractive index"));
                }
                material.index = real as f32;
            }
            "sides" => match words {
                [_, sides] if sides == "1" || sides == "2" => material.one_sided = sides == "1",
                _ => return Err("a surface has 1 or 2 sides".to_owned()),
            },
            "rs" | "ts" => {
                let [level, roughness] = numbers(words)?;
                let part = Part { level: share(level)?, color, roughness: above_zero(roughness)? };
                match words[0].as_str() {
                    "rs" => material.specular_reflected = part,
                    _ => material.specular_transmitted = part,
                }
            }
            "ed" => {
                let [level] = numbers(words)?;
                material.emitted = Part { level: above_zero(level)?, color, roughness: 0.0 };
            }
            keyword => {
                let [level] = numbers(words)?;
                let part = Part { level: share(level)?, color, roughness: 0.0 };
                match keyword {
                    "rd" => material.diffuse_reflected = part,
                    _ => material.diffuse_transmitted = part,
                }
            }
        }
        Ok(())
    }

    fn change_vertex(&mut self, words: &[String]) -> Result<(), String> {
        let values = numbers(words)?;
        let vertex = self.vertices.current();
        match words[0].as_str() {
            "p" => vertex.point = values,
            _ => vertex.normal = crate::facets::normalize(values).unwrap_or_default(),
        }
        Ok(())
    }

    fn object(&mut self, words: &[String]) -> Result<(), String> {
        match words {
            [_] => self.objects.pop().map(drop).ok_or_else(|| "no object is open".to_owned()),
            [_, name] if is_name(name) => {
                self.objects.push(name.clone());
                Ok(())
            }
            [_, name] => Err(format!("\"{name}\" is not a name: names begin with a letter")),
            _ => Err("an object has one name".to_owned()),
        }
    }

    fn begin_transform(&mut self, words: &[String]) -> Result<(), String> {
        if self.placements.len() == MAX_TRANSFORM_DEPTH {
            return Err(format!("more than {MAX_TRANSFORM_DEPTH} transforms are open"));
        }
        let mut arguments = words.to_vec();
        let mut arrays = Vec::new();
        for index in 0..arguments.len() {
            if arguments[index] == "-a" && index + 1 < arguments.len() {
                let count = leading_integer(&arguments[index + 1]).map_or(0, |(count, _)| count);
                arrays.push((index + 1, 0, count));
                arguments[index] = "-i".to_owned();
                arguments[index + 1] = "0".to_owned();
            }
        }
        if arrays.len() > MAX_ARRAY_DIMENSIONS {
            return Err(format!("more than {MAX_ARRAY_DIMENSIONS} arrays in a transform"));
        }
        let outer = self.placements.last().map_or(Transform::default(), |placement| placement.total);
        let start = self.sources.last().map_or((0, 0), |source| (source.number, source.next));
        let total = Transform::read(&arguments)?.then(&outer);
        self.objects.extend(array_name(&arrays));
        self.placements.push(Placement { total, outer, arguments, arrays, start });
        Ok(())
    }

    /// Closes the innermost transform, or starts the next copy of an array.
    fn end_transform(&mut self) -> Result<(), String> {
        let Some(placement) = self.placements.last_mut() else { return Err("no transform is open".to_owned()) };
        let Some(source) = self.sources.last_mut() else { return Ok(()) };
        if !placement.arrays.is_empty() {
            self.objects.pop();
        }
        let Some(place) = placement.arrays.iter().rposition(|(_, index, count)| index + 1 < *count) else {
            self.placements.pop();
            return Ok(());
        };
        if placement.start.0 != source.number {
            return Err("an array ends in another file than it begins".to_owned());
        }
        source.next = placement.start.1;
        placement.arrays[place].1 += 1;
        placement.arrays[place + 1..].iter_mut().for_each(|array| array.1 = 0);
        for (argument, index, _) in &placement.arrays {
            placement.arguments[*argument] = index.to_string();
        }
        placement.total = Transform::read(&placement.arguments)?.then(&placement.outer);
        self.objects.extend(array_name(&placement.arrays));
        Ok(())
    }

    fn include(&mut self, words: &[String]) -> Result<Result<(), String>, Error> {
        let [_, name, transform @ ..] = words else { return Ok(Err("an included file needs a name".to_owned())) };
        if self.sources.len() == MAX_INCLUDE_DEPTH {
            return Ok(Err(format!("included files are nested more than {MAX_INCLUDE_DEPTH} deep")));
        }
        let path = self.beside_source(name);
        let loaded = self.loader.load(&path, FileKind::Other)?;
        let outer = self.placements.len();
        self.open(&path, &loaded.bytes, (!transform.is_empty()).then_some(outer));
        Ok(if transform.is_empty() { Ok(()) } else { self.begin_transform(transform) })
    }

    /// The path of a file whose name is relative to the file that names it.
    fn beside_source(&self, name: &str) -> String {
        let folder = self.sources.last().and_then(|source| source.name.rsplit_once('/')).map(|(folder, _)| folder);
        match folder {
            Some(folder) if !name.starts_with('/') => format!("{folder}/{name}"),
            _ => name.to_owned(),
        }
    }

    /// The names of open objects, each followed by a dot; at most four, and 62 bytes.
    fn object_prefix(&self) -> String {
        let mut prefix = String::new();
        for name in &self.objects[self.objects.len().saturating_sub(4)..] {
            if prefix.len() + name.len() >= 63 {
                break;
            }
            prefix.push_str(name);
            prefix.push('.');
        }
        prefix
    }

    fn transform(&self) -> Transform {
        self.placements.last().map_or(Transform::default(), |placement| placement.total)
    }
}

/// The object name of a copy in an array, such as `a1.0`.
fn array_name(arrays: &[(usize, i64, i64)]) -> Option<String> {
    let indices: Vec<String> = arrays.iter().map(|(_, index, _)| index.to_string()).collect();
    (!indices.is_empty()).then(|| format!("a{}", indices.join(".")))
}

fn is_name(word: &str) -> bool {
    let word = word.trim_start_matches('_');
    word.starts_with(|first: char| first.is_ascii_alphabetic()) && word.bytes().all(|byte| byte.is_ascii_graphic())
}

fn number(word: &str) -> Result<f64, String> {
    whole_number(word).filter(|value| value.is_finite()).ok_or_else(|| format!("\"{word}\" is not a number"))
}

/// The numbers after the keyword.
fn numbers<const COUNT: usize>(words: &[String]) -> Result<[f64; COUNT], String> {
    let values: Vec<f64> = words[1..].iter().map(|word| number(word)).collect::<Result<_, _>>()?;
    let found = values.len();
    values.try_into().map_err(|_| format!("{} is followed by {found} numbers, expected {COUNT}", words[0]))
}
