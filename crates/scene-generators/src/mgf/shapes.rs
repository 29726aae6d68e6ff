//! MGF surfaces.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

use super::{Converter, Vertex, number};
use crate::Error;
use crate::facets::{Barycentric, cross, dot, normalize, subtract};
use crate::text::{Text, wide};

/// Number of steps per quarter circle.
const QUARTER_STEPS: usize = 5;
const TINY: f64 = 1e-6;
/// Normals whose cosine exceeds this are equal.
const SAME_DIRECTION: f64 = 0.999_995;

/// Number of surfaces of each kind written so far.
#[derive(Default)]
pub(crate) struct Counters {
    cones: usize,
    cylinders: usize,
    faces: usize,
    rings: usize,
    spheres: usize,
    triangles: usize,
}

/// The outcome of a statement: the inner error is a mistake of the input.
type Outcome = Result<Result<(), String>, Error>;

/// Unwraps a `Result<_, String>` or returns its error as a mistake of the input.
macro_rules! of_input {
    ($result:expr) => {
        match $result {
            Ok(value) => value,
            Err(mistake) => return Ok(Err(mistake.into())),
        }
    };
}

/// The relation of the corner normals to the face.
enum CornerNormals {
    Flat,
    FlatReversed,
    Smooth,
    SmoothReversed,
    Degenerate,
}

impl Converter<'_> {
    pub(crate) fn shape(&mut self, words: &[String]) -> Outcome {
        match (words[0].as_str(), &words[1..]) {
            ("f", names) => {
                let corners = of_input!(self.corners(names));
                self.face(&corners)
            }
            ("fh", names) => {
                let corners = of_input!(seam(names).and_then(|names| self.corners(&names)));
                self.face(&corners)
            }
            ("sph", [centre, radius]) => {
                let (centre, radius) = (of_input!(self.corner(centre)), of_input!(number(radius)));
                self.sphere(centre, radius)
            }
            ("cyl", [from, radius, to]) => {
                let ends = [of_input!(self.corner(from)), of_input!(self.corner(to))];
                let radius = of_input!(number(radius));
                self.cylinder(ends, radius)
            }
            ("cone", [from, from_radius, to, to_radius]) => {
                let ends = [of_input!(self.corner(from)), of_input!(self.corner(to))];
                let radii = [of_input!(number(from_radius)), of_input!(number(to_radius))];
                self.cone(ends.map(|end| end.point), radii)
            }
            ("ring", [centre, inner, outer]) => {
                let centre = of_input!(self.corner(centre));
                let radii = [of_input!(number(inner)), of_input!(number(outer))];
                self.ring(centre, radii)
            }
            ("prism", [names @ .., length]) if names.len() >= 3 => {
                let (corners, length) = (of_input!(self.corners(names)), of_input!(number(length)));
                self.prism(&corners, length)
            }
            ("torus", [centre, smallest, largest]) => {
                let centre = of_input!(self.corner(centre));
                let radii = [of_input!(number(smallest)), of_input!(number(largest))];
                self.torus(centre, radii)
            }
            (keyword, arguments) => Ok(Err(format!("{keyword} is followed by {} words", arguments.len()))),
        }
    }

    fn corner(&self, name: &String) -> Result<Vertex, String> {
        self.vertices.named.get(name).copied().ok_or_else(|| format!("vertex \"{name}\" is not defined"))
    }

    fn corners(&self, names: &[String]) -> Result<Vec<Vertex>, String> {
        names.iter().map(|name| self.corner(name)).collect()
    }

    /// The name of the current material, which is written first if it is new.
    fn material_name(&mut self) -> Result<Result<String, String>, Error> {
        let name = self.material.current.clone().unwrap_or_else(|| "mat".to_owned());
        let current = self.material.current();
        if current.is_new {
            current.is_new = false;
            let material = current.clone();
            let text = self.material_text.as_mut().unwrap_or(&mut self.text);
            of_input!(self.materials.write(text, &name, &material)?);
        }
        Ok(Ok(name))
    }

    fn face(&mut self, corners: &[Vertex]) -> Outcome {
        if corners.len() < 3 {
            return Ok(Err(format!("a face of {} corners", corners.len())));
        }
        let material = of_input!(self.material_name()?);
        let transform = self.transform();
        let has_normals =
            corners.len() <= 4 && corners.iter().all(|corner| dot(corner.normal, corner.normal) > TINY * TINY);
        let normals_kind =
            if has_normals { classify_normals([corners[0], corners[1], corners[2]]) } else { CornerNormals::Flat };
        let reversed = match normals_kind {
            CornerNormals::Degenerate => return Ok(Ok(())),
            CornerNormals::Flat | CornerNormals::Smooth => transform.is_mirrored,
            CornerNormals::FlatReversed | CornerNormals::SmoothReversed => !transform.is_mirrored,
        };
        if matches!(normals_kind, CornerNormals::Smooth | CornerNormals::SmoothReversed) {
            let in_order = |[a, b, c]: [Vertex; 3]| if reversed { [c, b, a] } else { [a, b, c] };
            self.smooth_triangle(&material, in_order([corners[0], corners[1], corners[2]]))?;
            if let [first, _, third, fourth] = corners {
                self.smooth_triangle(&material, in_order([*third, *fourth, *first]))?;
            }
            return Ok(Ok(()));
        }
        self.counters.faces += 1;
        let name = format!("{}f{}", self.object_prefix(), self.counters.faces);
        self.text.primitive(&material, "polygon", name, 3 * corners.len())?;
        let mut points: Vec<[f64; 3]> = corners.iter().map(|corner| transform.point(corner.point)).collect();
        if reversed {
            points.reverse();
        }
        points.iter().try_for_each(|point| row(&mut self.text, *point))?;
        Ok(Ok(()))
    }

    fn smooth_triangle(&mut self, material: &str, corners: [Vertex; 3]) -> Result<(), Error> {
        let transform = self.transform();
        let points = corners.map(|corner| transform.point(corner.point));
        let normals = corners.map(|corner| transform.direction(corner.normal));
        let Some(barycentric) = Barycentric::new(&points) else { return Ok(()) };
        write!(self.text, "\n{material} texfunc Phong\n4 dx dy dz tmesh.cal\n0\n")?;
        barycentric.write_interpolation(&mut self.text, &normals)?;
        self.counters.triangles += 1;
        let name = format!("{}t{}", self.object_prefix(), self.counters.triangles);
        self.text.primitive("Phong", "polygon", name, 9)?;
        points.iter().try_for_each(|point| row(&mut self.text, *point))
    }

    fn sphere(&mut self, centre: Vertex, radius: f64) -> Outcome {
        let transform = self.transform();
        let material = of_input!(self.material_name()?);
        self.counters.spheres += 1;
        let kind = if radius < 0.0 { "bubble" } else { "sphere" };
        let [x, y, z] = transform.point(centre.point).map(wide);
        write!(self.text, "\n{material} {kind} {}s{}\n0\n0\n", self.object_prefix(), self.counters.spheres)?;
        writeln!(self.text, "4 {x} {y} {z} {}", wide(transform.length(radius.abs())))?;
        Ok(Ok(()))
    }

    fn cylinder(&mut self, ends: [Vertex; 2], radius: f64) -> Outcome {
        let transform = self.transform();
        let material = of_input!(self.material_name()?);
        self.counters.cylinders += 1;
        let kind = if radius < 0.0 { "tube" } else { "cylinder" };
        let name = format!("{}cy{}", self.object_prefix(), self.counters.cylinders);
        self.text.primitive(&material, kind, name, 7)?;
        ends.iter().try_for_each(|end| row(&mut self.text, transform.point(end.point)))?;
        writeln!(self.text, "{}", wide(transform.length(radius.abs())))?;
        Ok(Ok(()))
    }

    fn cone(&mut self, ends: [[f64; 3]; 2], radii: [f64; 2]) -> Outcome {
        let transform = self.transform();
        if radii == [0.0; 2] || radii[0] * radii[1] < 0.0 {
            return Ok(Err(format!("a cone of radii {} and {}", radii[0], radii[1])));
        }
        let material = of_input!(self.material_name()?);
        self.counters.cones += 1;
        let kind = if radii[0] < 0.0 || radii[1] < 0.0 { "cup" } else { "cone" };
        let name = format!("{}c{}", self.object_prefix(), self.counters.cones);
        self.text.primitive(&material, kind, name, 8)?;
        ends.iter().try_for_each(|end| row(&mut self.text, transform.point(*end)))?;
        let [r0, r1] = radii.map(|radius| wide(transform.length(radius.abs())));
        writeln!(self.text, "{r0} {r1}")?;
        Ok(Ok(()))
    }

    fn ring(&mut self, centre: Vertex, [inner, outer]: [f64; 2]) -> Outcome {
        let transform = self.transform();
        if dot(centre.normal, centre.normal) <= TINY * TINY {
            return Ok(Err("a ring needs a vertex with a normal".to_owned()));
        }
        if inner < 0.0 || outer <= inner {
            return Ok(Err(format!("a ring of radii {inner} and {outer}")));
        }
        let material = of_input!(self.material_name()?);
        self.counters.rings += 1;
        let name = format!("{}r{}", self.object_prefix(), self.counters.rings);
        self.text.primitive(&material, "ring", name, 8)?;
        row(&mut self.text, transform.point(centre.point))?;
        row(&mut self.text, transform.direction(centre.normal))?;
        let [inner, outer] = [inner, outer].map(|radius| wide(transform.length(radius)));
        writeln!(self.text, "{inner} {outer}")?;
        Ok(Ok(()))
    }

    /// A polygon extruded against its normal by a length, which may be negative.
    fn prism(&mut self, corners: &[Vertex], length: f64) -> Outcome {
        if length.abs() <= TINY {
            return Ok(Err(format!("a prism of length {length}")));
        }
        let origin = corners[0].point;
        let spoke = |index: usize| subtract(corners[index].point, origin);
        let area = (2..corners.len()).fold([0.0; 3], |sum, index| {
            let part = cross(spoke(index - 1), spoke(index));
            std::array::from_fn(|axis| sum[axis] + part[axis])
        });
        let Some(normal) = normalize(area) else { return Ok(Err("a prism over a polygon without area".to_owned())) };
        let moved: Vec<Vertex> = corners
            .iter()
            .map(|corner| Vertex {
                point: std::array::from_fn(|axis| corner.point[axis] - length * normal[axis]),
                ..*corner
            })
            .collect();
        for index in 0..corners.len() {
            let before = (index + corners.len() - 1) % corners.len();
            of_input!(self.face(&[moved[index], corners[index], corners[before], moved[before]])?);
        }
        let flat = |corner: &Vertex| Vertex { normal: [0.0; 3], ..*corner };
        let far: Vec<Vertex> = moved.iter().rev().map(flat).collect();
        of_input!(self.face(&far)?);
        let near: Vec<Vertex> = corners.iter().map(flat).collect();
        self.face(&near)
    }

    /// A torus between two radii about the vertex's normal, made of cones; inside out for negative
    /// radii.
    fn torus(&mut self, centre: Vertex, [smallest, largest]: [f64; 2]) -> Outcome {
        if dot(centre.normal, centre.normal) <= TINY * TINY {
            return Ok(Err("a torus needs a vertex with a normal".to_owned()));
        }
        let smallest = if smallest.abs() <= TINY { 0.0 } else { smallest };
        let sign = if smallest != 0.0 { smallest.signum() } else { largest.signum() };
        if sign * (largest - smallest) <= 0.0 {
            return Ok(Err(format!("a torus of radii {smallest} and {largest}")));
        }
        let (half, middle) = (0.5 * (largest - smallest), 0.5 * (smallest + largest));
        let angle = |step: usize| step as f64 * FRAC_PI_2 / QUARTER_STEPS as f64;
        let point = |step: usize| -> [f64; 3] {
            let height = sign * half * angle(step).cos();
            std::array::from_fn(|axis| centre.point[axis] + height * centre.normal[axis])
        };
        for step in 1..=4 * QUARTER_STEPS {
            // The inner half faces the axis: cups, or cones for a torus that is inside out.
            let side = if step <= 2 * QUARTER_STEPS { 1.0 } else { -1.0 };
            let radius = |step: usize| side * (middle + half * angle(step).sin());
            let radii = [step - 1, step].map(radius).map(|radius| if radius.abs() <= 1e-12 { 0.0 } else { radius });
            of_input!(self.cone([point(step - 1), point(step)], radii)?);
        }
        Ok(Ok(()))
    }
}

fn row(text: &mut Text, [x, y, z]: [f64; 3]) -> Result<(), Error> {
    Ok(writeln!(text, "{} {} {}", wide(x), wide(y), wide(z))?)
}

/// The corners of a face with holes (each after `-`) as one outline with seams to each hole.
fn seam(names: &[String]) -> Result<Vec<String>, String> {
    let mut loops = names.split(|name| name.starts_with('-'));
    let outline = loops.next().unwrap_or_default();
    let mut corners = outline.to_vec();
    let mut has_holes = false;
    for hole in loops {
        if hole.is_empty() {
            break;
        }
        if hole.len() < 3 {
            return Err(format!("a hole of {} corners", hole.len()));
        }
        corners.extend(hole.last().cloned());
        corners.extend(hole.iter().cloned());
        has_holes = true;
    }
    if outline.len() < 3 {
        return Err(format!("a face of {} corners", outline.len()));
    }
    if has_holes {
        corners.extend(outline.last().cloned());
    }
    Ok(corners)
}

fn classify_normals(corners: [Vertex; 3]) -> CornerNormals {
    let [a, b, c] = corners.map(|corner| corner.point);
    let Some(normal) = normalize(cross(subtract(b, a), subtract(c, b))) else { return CornerNormals::Degenerate };
    let cosines = corners.map(|corner| dot(normal, corner.normal));
    if cosines.iter().all(|cosine| *cosine < 0.0) {
        let is_smooth = cosines.iter().any(|cosine| *cosine > -SAME_DIRECTION);
        return if is_smooth { CornerNormals::SmoothReversed } else { CornerNormals::FlatReversed };
    }
    if cosines.iter().any(|cosine| *cosine < SAME_DIRECTION) { CornerNormals::Smooth } else { CornerNormals::Flat }
}
