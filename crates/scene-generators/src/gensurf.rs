//! `gensurf material name x(s,t) y(s,t) z(s,t) m n [-s] [-o] [-i] [-e expr] [-f file]`: a surface
//! over a grid.
//!
//! The functions give a point, in scene units, for s and t from 0 to 1, in `m` and `n` steps.
//! Instead of z, a file (or `-` for standard input) can hold the values at the grid points or at
//! the cell centres; instead of all three, one file holds all coordinates. The surface faces by the
//! right-hand rule for (s,t); `-i` reverses it. A function `valid(s,t)` that is not above zero
//! omits a point. `-s` smooths by a `texfunc` of `surf.cal`. `-o` writes Wavefront text.

use std::fmt::Write;

use radsight_cal::Handle;
use radsight_loader::FileKind;

use crate::arguments::Arguments;
use crate::facets::{cross, dot, normalize, subtract};
use crate::functions::Functions;
use crate::grid_data::GridData;
use crate::text::{Text, general, wide};
use crate::{Error, Invocation, Output, source_name};

/// Lengths and squared lengths below this are zero.
const TINY: f64 = 1e-6;

/// The source of a coordinate.
enum Coordinate {
    Function(Handle),
    /// A component of the file's points.
    Data(usize),
}

/// A point of the grid.
#[derive(Clone, Copy, Default)]
struct Point {
    valid: bool,
    position: [f64; 3],
    /// The mean normal, a unit vector; zero when there is none.
    normal: [f64; 3],
    /// s and t.
    parameters: [f64; 2],
    /// Number in Wavefront output, from 1.
    vertex_number: usize,
    normal_number: Option<usize>,
}

/// Points with the same s. An additional point at either end is used for smoothing, so `row[1]` is
/// at t = 0.
type Row = Vec<Point>;

struct Surface<'a> {
    material: &'a str,
    name: &'a str,
    functions: Functions,
    coordinates: [Coordinate; 3],
    data: Option<GridData>,
    valid: Option<Handle>,
    /// Steps in s and in t.
    steps: [usize; 2],
    smooth: bool,
    reversed: bool,
    wavefront: bool,
    text: Text,
    /// Number of faces, vertices and normals written.
    faces: usize,
    vertices: usize,
    normals: usize,
    last_normal: [f64; 3],
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let mut surface = read(&mut arguments, invocation)?;
    surface.text.command_comment(invocation.argv)?;
    surface.write()?;
    let (bytes, warnings) = (surface.text.into_bytes(), surface.functions.all_warnings(arguments));
    Ok(Output { standard_output: bytes, warnings, ..Output::default() })
}

fn read<'a>(arguments: &mut Arguments<'a>, invocation: &Invocation<'a>) -> Result<Surface<'a>, Error> {
    let mut functions = Functions::for_generators(arguments);
    let [material, name, x, y, z, ..] =
        arguments.take::<7>(["material", "name", "x(s,t)", "y(s,t)", "z(s,t)", "m", "n"])?;
    let (mut smooth, mut reversed, mut wavefront) = (false, false, false);
    while let Some(option) = arguments.last_options()? {
        match option.name {
            "-e" => functions.take_definitions(arguments)?,
            "-f" => functions.take_file(arguments, invocation.loader)?,
            "-s" => smooth = true,
            "-o" => wavefront = true,
            "-i" => reversed = true,
            _ => return Err(arguments.unknown()),
        }
    }
    let mut sizes = arguments.again_from(6);
    let steps = [functions.take_count(&mut sizes, "m")?, functions.take_count(&mut sizes, "n")?];
    let text = Text::default();
    // The smallest output is two short lines per point; the rows take more for few points in many
    // steps.
    text.expect_room(steps[0] as f64 * steps[1] as f64, 120.0)?;
    text.expect_room(steps[0] as f64 + steps[1] as f64, 400.0)?;

    let mut bodies = arguments.again_from(3);
    let data_bytes = match z {
        "-" => Some(invocation.standard_input()?.to_vec()),
        name => invocation.loader.load(name, FileKind::Data).ok().map(|loaded| loaded.bytes),
    };
    let is_triplets = data_bytes.is_some() && x == z && y == z;
    let components = if is_triplets { 3 } else { 1 };
    let data = match data_bytes {
        Some(bytes) => Some(GridData::read(&bytes, steps, components).map_err(|mistake| {
            let source_name = source_name(z).to_owned();
            Error::Input { program: arguments.program().to_owned(), source_name, mistake }
        })?),
        None => None,
    };
    let coordinates = if is_triplets {
        [0, 1, 2].map(Coordinate::Data)
    } else {
        let x = Coordinate::Function(functions.take_function(&mut bodies, "x", "s,t")?);
        let y = Coordinate::Function(functions.take_function(&mut bodies, "y", "s,t")?);
        let z = match data {
            Some(_) => Coordinate::Data(0),
            None => Coordinate::Function(functions.take_function(&mut bodies, "z", "s,t")?),
        };
        [x, y, z]
    };
    let valid =
        (functions.environment.function_arity("valid") == Some(2)).then(|| functions.environment.function("valid", 2));
    Ok(Surface {
        material,
        name,
        functions,
        coordinates,
        data,
        valid,
        steps,
        smooth,
        reversed,
        wavefront,
        text,
        faces: 0,
        vertices: 0,
        normals: 0,
        last_normal: [0.0; 3],
    })
}

impl Surface<'_> {
    fn write(&mut self) -> Result<(), Error> {
        let [m, n] = self.steps;
        let row = || vec![Point::default(); n + 3];
        let (mut before, mut current, mut after) = (row(), row(), row());
        let s = |index: i64| index as f64 / m as f64;
        self.compute(s(-1), &mut before)?;
        self.compute(s(0), &mut current)?;
        self.compute(s(1), &mut after)?;
        self.find_normals(&before, &mut current, &after);
        if self.wavefront {
            write!(self.text, "\nusemtl {}\n\no {}\n\n", self.material, self.name)?;
            self.write_vertices(&mut current)?;
        }
        for index in 0..m {
            (before, current, after) = (current, after, before);
            self.compute(s(index as i64 + 2), &mut after)?;
            self.find_normals(&before, &mut current, &after);
            if self.wavefront {
                self.write_vertices(&mut current)?;
            }
            for t in 0..n {
                let (low, low_next, high, high_next) =
                    (&before[t + 1], &before[t + 2], &current[t + 1], &current[t + 2]);
                // The diagonal alternates, but avoids omitted points.
                let falling = if !(low.valid && high_next.valid) {
                    true
                } else if !(high.valid && low_next.valid) {
                    false
                } else {
                    t % 2 == 1
                };
                let square = if falling { [low, high, low_next, high_next] } else { [high, high_next, low, low_next] };
                self.write_square(square)?;
            }
        }
        Ok(())
    }

    /// Computes a row. Rows and points outside the grid are used for smoothing only.
    fn compute(&mut self, s: f64, row: &mut Row) -> Result<(), Error> {
        let n = self.steps[1];
        let indices = if self.smooth {
            -1..=n as i64 + 1
        } else if (-TINY..=1.0 + TINY).contains(&s) {
            0..=n as i64
        } else {
            return Ok(());
        };
        for index in indices {
            let parameters = [s, index as f64 / n as f64];
            let is_valid = match self.valid {
                Some(valid) => self.functions.value(valid, &parameters, &radsight_cal::NoHost)? > 0.0,
                None => true,
            };
            let mut point = Point::default();
            if is_valid {
                point.valid = true;
                point.parameters = parameters;
                for axis in 0..3 {
                    point.position[axis] = match &self.coordinates[axis] {
                        Coordinate::Function(function) => {
                            self.functions.coordinate(*function, ["x", "y", "z"][axis], &parameters)?
                        }
                        Coordinate::Data(component) => match &self.data {
                            Some(data) => data.value(parameters, *component),
                            None => 0.0,
                        },
                    };
                }
            }
            row[(index + 1) as usize] = point;
        }
        Ok(())
    }

    /// Mean normals of the middle row, from the differences between its neighbours.
    fn find_normals(&self, before: &Row, current: &mut Row, after: &Row) {
        if !self.smooth {
            return;
        }
        let difference = |low: &Point, own: &Point, high: &Point| match (low.valid, high.valid) {
            (false, false) => None,
            (false, true) => Some(subtract(high.position, own.position)),
            (true, false) => Some(subtract(own.position, low.position)),
            (true, true) => Some(subtract(high.position, low.position)),
        };
        for index in 1..=self.steps[1] + 1 {
            let own = current[index];
            if !own.valid {
                continue;
            }
            let along_s = difference(&before[index], &own, &after[index]);
            let along_t = difference(&current[index - 1], &own, &current[index + 1]);
            let normal = match (along_s, along_t) {
                (Some(s), Some(t)) if self.reversed => normalize(cross(t, s)),
                (Some(s), Some(t)) => normalize(cross(s, t)),
                _ => None,
            };
            current[index].normal = normal.unwrap_or_default();
        }
    }

    /// Writes a row's vertices with their parameters as texture coordinates, and the new normals.
    fn write_vertices(&mut self, row: &mut Row) -> Result<(), Error> {
        for point in row.iter_mut().skip(1).take(self.steps[1] + 1).filter(|point| point.valid) {
            self.vertices += 1;
            point.vertex_number = self.vertices;
            let [x, y, z] = point.position.map(wide);
            writeln!(self.text, "v {x} {y} {z}")?;
            let [s, t] = point.parameters.map(|value| general(value, 9));
            writeln!(self.text, "\tvt {s} {t}")?;
            let normal = point.normal;
            if !self.smooth || dot(normal, normal) <= TINY * TINY {
                point.normal_number = None;
                continue;
            }
            let same = (0..3).all(|axis| (normal[axis] - self.last_normal[axis]).abs() <= TINY);
            if !same {
                let [x, y, z] = normal.map(|value| general(value, 9));
                writeln!(self.text, "\tvn {x} {y} {z}")?;
                self.normals += 1;
                self.last_normal = normal;
            }
            point.normal_number = Some(self.normals);
        }
        Ok(())
    }

    /// Writes the four-sided face p0 p1 p3 p2, or its two triangles.
    fn write_square(&mut self, [p0, mut p1, mut p2, p3]: [&Point; 4]) -> Result<(), Error> {
        if self.reversed {
            (p1, p2) = (p2, p1);
        }
        let first = face_normal([p0, p1, p2]);
        let second = face_normal([p3, p2, p1]);
        let is_flat = matches!((first, second), (Some(a), Some(b)) if dot(a, b) >= 1.0 - TINY * TINY);
        if first.is_none() && second.is_none() {
            return Ok(());
        }
        let interpolation = if self.smooth && !self.wavefront { Bilinear::new([p0, p1, p2, p3]) } else { None };
        if is_flat {
            let mean = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|axis| 0.5 * (a[axis] + b[axis]));
            let normal = mean(first.unwrap_or_default(), second.unwrap_or_default());
            return self.write_face(&[p0, p1, p3, p2], normal, interpolation.as_ref());
        }
        if let Some(normal) = first {
            self.write_face(&[p0, p1, p2], normal, interpolation.as_ref())?;
        }
        if let Some(normal) = second {
            self.write_face(&[p2, p1, p3], normal, interpolation.as_ref())?;
        }
        Ok(())
    }

    fn write_face(&mut self, corners: &[&Point], normal: [f64; 3], smooth: Option<&Bilinear>) -> Result<(), Error> {
        if self.wavefront {
            return self.write_wavefront_face(corners);
        }
        self.faces += 1;
        let mut modifier = self.material;
        if let Some(Bilinear { axis, coefficients }) = smooth {
            let text = &mut self.text;
            write!(text, "\n{modifier} texfunc Phong\n4 surf_dx surf_dy surf_dz surf.cal\n0\n13\t{axis}\n")?;
            coefficients[..3].iter().try_for_each(|coefficient| text.row(*coefficient))?;
            // The texture's perturbation of the face normal.
            text.row(subtract(coefficients[3], normal))?;
            modifier = "Phong";
        }
        let name = format_args!("{}.{}", self.name, self.faces);
        self.text.primitive(modifier, "polygon", name, 3 * corners.len())?;
        Ok(corners.iter().try_for_each(|corner| self.text.row(corner.position))?)
    }

    fn write_wavefront_face(&mut self, corners: &[&Point]) -> Result<(), Error> {
        self.text.write_str("f")?;
        for corner in corners {
            let vertex = if corner.valid { corner.vertex_number as i64 - self.vertices as i64 - 1 } else { 0 };
            let normal = corner.normal_number.map_or(0, |number| number as i64 - self.normals as i64 - 1);
            write!(self.text, " {vertex}/{vertex}/{normal}")?;
        }
        Ok(self.text.write_str("\n")?)
    }
}

/// The unit normal of a non-degenerate triangle of valid points; its sides start at the first
/// corner.
fn face_normal(corners: [&Point; 3]) -> Option<[f64; 3]> {
    if corners.iter().any(|corner| !corner.valid) {
        return None;
    }
    let [apex, b, c] = corners.map(|corner| corner.position);
    normalize(cross(subtract(b, apex), subtract(c, apex)))
}

/// Normals as bilinear functions of two coordinates u and v: k₀·u·v + k₁·u + k₂·v + k₃ equals the
/// normals at four corners.
struct Bilinear {
    /// 0, 1, 2 for x, y, z: the projection axis; u and v are the axes after it.
    axis: usize,
    /// k₀ to k₃.
    coefficients: [[f64; 3]; 4],
}

impl Bilinear {
    /// `None` if the corner positions allow no solution.
    fn new(corners: [&Point; 4]) -> Option<Bilinear> {
        let sum = |axis: usize| corners.iter().map(|corner| corner.normal[axis]).sum::<f64>().abs();
        let axis = usize::from(sum(0) <= sum(1));
        let axis = if sum(axis) > sum(2) { axis } else { 2 };
        let matrix = corners.map(|corner| {
            let (u, v) = (corner.position[(axis + 1) % 3], corner.position[(axis + 2) % 3]);
            [u * v, u, v, 1.0]
        });
        let inverse = invert(matrix)?;
        let coefficients = inverse.map(|row| {
            std::array::from_fn(|axis| (0..4).map(|corner| row[corner] * corners[corner].normal[axis]).sum())
        });
        Some(Bilinear { axis, coefficients })
    }
}

/// The inverse by Gaussian elimination with full pivoting; `None` if a pivot is nearly zero.
fn invert(mut matrix: [[f64; 4]; 4]) -> Option<[[f64; 4]; 4]> {
    let mut inverse: [[f64; 4]; 4] = std::array::from_fn(|row| std::array::from_fn(|column| f64::from(row == column)));
    for column in 0..4 {
        let pivot = (column..4).fold(None, |best: Option<usize>, row| {
            let size = matrix[row][column].abs();
            if size > best.map_or(TINY, |best| matrix[best][column].abs()) { Some(row) } else { best }
        })?;
        matrix.swap(column, pivot);
        inverse.swap(column, pivot);
        let scale = matrix[column][column];
        matrix[column].iter_mut().chain(&mut inverse[column]).for_each(|value| *value /= scale);
        let (own, own_inverse) = (matrix[column], inverse[column]);
        for row in (0..4).filter(|row| *row != column) {
            let factor = matrix[row][column];
            for index in 0..4 {
                matrix[row][index] -= own[index] * factor;
                inverse[row][index] -= own_inverse[index] * factor;
            }
        }
    }
    Some(inverse)
}
