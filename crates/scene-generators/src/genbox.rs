//! `genbox material name xsize ysize zsize [-i] [-b bevel | -r round [-n nsegs] [-s]] [-o]`: a box
//! with a corner at the origin.
//!
//! Lengths are in scene units. Edges can be bevelled (`-b`), rounded with cylinders and spheres
//! (`-r`), or rounded with facets (`-n` a power of two per edge; always when `-i` turns the box
//! inside out), flat or smoothed (`-s`). `-o` writes Wavefront text instead of a scene.

use std::f64::consts::PI;
use std::fmt::Write;

use crate::arguments::Arguments;
use crate::facets::{Mesh, Use, cross, normalize, subtract};
use crate::text::{Text, wide};
use crate::{Error, Invocation, Output};

/// Parsed options.
struct Options<'a> {
    material: &'a str,
    name: &'a str,
    size: [f64; 3],
    /// Bevel or radius; zero for sharp edges.
    bevel: f64,
    rounded: bool,
    /// Each rounded edge has 2^`subdivisions` facets; 1 stands for a true cylinder.
    subdivisions: u32,
    reversed: bool,
    smooth: bool,
    wavefront: bool,
}

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let options = read(&mut arguments)?;
    let mut text = Text::default();
    text.command_comment(invocation.argv)?;
    if options.subdivisions > 1 || options.wavefront {
        write_facets(&options, &mut text)?;
    } else {
        emit(&options, &mut Primitives { options: &options, text: &mut text })?;
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

fn write_facets(options: &Options<'_>, text: &mut Text) -> Result<(), Error> {
    // Eight corners of 4^n triangles each dominate. Their vertices and normals take more space than
    // their text.
    text.expect_room(8.0 * 4f64.powi(options.subdivisions as i32), 1000.0)?;
    let mut facets = Facets::new(options);
    emit(options, &mut facets)?;
    let mut mesh = facets.mesh;
    if !options.smooth {
        mesh.flatten();
    }
    if !options.wavefront {
        return mesh.write_scene(text, options.material, options.name);
    }
    if options.rounded {
        mesh.join_vertices(2e-6);
    }
    mesh.write_wavefront(text, options.material, options.name)
}

fn read<'a>(arguments: &mut Arguments<'a>) -> Result<Options<'a>, Error> {
    let material = arguments.required("material")?;
    let name = arguments.required("name")?;
    let size = [arguments.positive("xsize")?, arguments.positive("ysize")?, arguments.positive("zsize")?];
    let (mut bevel, mut rounded, mut segments) = (0.0, false, 1);
    let (mut reversed, mut smooth, mut wavefront) = (false, false, false);
    while let Some(option) = arguments.last_options()? {
        match option.name {
            "-o" => wavefront = true,
            "-i" => reversed = true,
            "-s" => smooth = true,
            "-b" => bevel = arguments.positive("bevel (-b)")?,
            "-r" => {
                rounded = true;
                bevel = arguments.positive("round (-r)")?;
            }
            "-n" => segments = arguments.count("nsegs (-n)")?,
            _ => return Err(arguments.unknown()),
        }
    }
    if (wavefront || reversed) && segments == 1 {
        segments = 32;
    }
    let subdivisions = if rounded { 1 + (segments - 1).checked_ilog2().unwrap_or(0) } else { 0 };
    Ok(Options { material, name, size, bevel, rounded, subdivisions, reversed, smooth, wavefront })
}

/// A corner of the box in octal digits: 1, 2, 4 select the far side along x, y, z, and 010, 020,
/// 040 move it inwards by the bevel along x, y, z.
type Corner = usize;

/// Receives the faces, edges and corners of a box.
trait Faces {
    fn polygon(&mut self, corners: &[Corner]) -> Result<(), Error>;
    fn edge(&mut self, from: Corner, to: Corner) -> Result<(), Error>;
    fn corner_sphere(&mut self, corner: Corner) -> Result<(), Error>;
}

#[rustfmt::skip]
const BEVELLED_SIDES: [[Corner; 4]; 6] = [
    [0o51, 0o55, 0o54, 0o50], [0o64, 0o66, 0o62, 0o60], [0o32, 0o33, 0o31, 0o30],
    [0o53, 0o52, 0o56, 0o57], [0o65, 0o61, 0o63, 0o67], [0o36, 0o34, 0o35, 0o37],
];
#[rustfmt::skip]
const BEVELS: [[Corner; 4]; 12] = [
    [0o31, 0o51, 0o50, 0o30], [0o60, 0o62, 0o32, 0o30], [0o50, 0o54, 0o64, 0o60],
    [0o34, 0o36, 0o66, 0o64], [0o37, 0o57, 0o56, 0o36], [0o52, 0o62, 0o66, 0o56],
    [0o52, 0o53, 0o33, 0o32], [0o57, 0o67, 0o63, 0o53], [0o61, 0o31, 0o33, 0o63],
    [0o65, 0o67, 0o37, 0o35], [0o55, 0o51, 0o61, 0o65], [0o34, 0o54, 0o55, 0o35],
];
#[rustfmt::skip]
const BEVELLED_CORNERS: [[Corner; 3]; 8] = [
    [0o30, 0o50, 0o60], [0o51, 0o31, 0o61], [0o32, 0o62, 0o52], [0o64, 0o54, 0o34],
    [0o36, 0o56, 0o66], [0o65, 0o35, 0o55], [0o53, 0o63, 0o33], [0o37, 0o67, 0o57],
];
#[rustfmt::skip]
const EDGES: [[Corner; 2]; 12] = [
    [0o70, 0o71], [0o70, 0o74], [0o70, 0o72], [0o73, 0o71], [0o73, 0o72], [0o73, 0o77],
    [0o75, 0o71], [0o75, 0o74], [0o75, 0o77], [0o76, 0o72], [0o76, 0o74], [0o76, 0o77],
];
const SHARP_SIDES: [[Corner; 4]; 6] =
    [[1, 5, 4, 0], [4, 6, 2, 0], [2, 3, 1, 0], [3, 2, 6, 7], [5, 1, 3, 7], [6, 4, 5, 7]];

/// All faces in Radiance's order.
fn emit(options: &Options<'_>, faces: &mut dyn Faces) -> Result<(), Error> {
    if options.bevel == 0.0 {
        return SHARP_SIDES.iter().try_for_each(|side| faces.polygon(side));
    }
    BEVELLED_SIDES.iter().try_for_each(|side| faces.polygon(side))?;
    if options.rounded {
        EDGES.iter().try_for_each(|edge| faces.edge(edge[0], edge[1]))?;
        return (0o70..0o100).try_for_each(|corner| faces.corner_sphere(corner));
    }
    BEVELS.iter().try_for_each(|side| faces.polygon(side))?;
    BEVELLED_CORNERS.iter().try_for_each(|corner| faces.polygon(corner))
}

impl Options<'_> {
    /// Position of a corner, in scene units.
    fn position(&self, corner: Corner) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let far = ((corner >> axis) & 1 != 0) != self.reversed;
            let inset = if (corner >> axis) & 0o10 != 0 { self.bevel } else { 0.0 };
            if far { self.size[axis] - inset } else { inset }
        })
    }
}

/// Writes Radiance primitives.
struct Primitives<'a, 'b> {
    options: &'a Options<'b>,
    text: &'a mut Text,
}

/// The letter of a corner in a primitive's name.
fn letter(corner: Corner) -> char {
    const LETTERS: &[u8; 64] = b"0123456789._ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
    LETTERS[corner & 63] as char
}

impl Primitives<'_, '_> {
    fn head(&mut self, kind: &str, corners: &[Corner], numbers: usize) -> Result<(), Error> {
        let Options { material, name, .. } = self.options;
        let letters: String = corners.iter().map(|corner| letter(*corner)).collect();
        self.text.primitive(material, kind, format_args!("{name}.{letters}"), numbers)?;
        for corner in corners {
            let [x, y, z] = self.options.position(*corner);
            self.text.vertex(x, y, z)?;
        }
        Ok(())
    }
}

impl Faces for Primitives<'_, '_> {
    fn polygon(&mut self, corners: &[Corner]) -> Result<(), Error> {
        self.head("polygon", corners, 3 * corners.len())
    }

    fn edge(&mut self, from: Corner, to: Corner) -> Result<(), Error> {
        self.head("cylinder", &[from, to], 7)?;
        Ok(writeln!(self.text, "\t{}", wide(self.options.bevel))?)
    }

    fn corner_sphere(&mut self, corner: Corner) -> Result<(), Error> {
        self.head("sphere", &[corner], 4)?;
        Ok(writeln!(self.text, "\t{}", wide(self.options.bevel))?)
    }
}

/// Collects facets for edges and corners that are not true cylinders and spheres.
struct Facets<'a, 'b> {
    options: &'a Options<'b>,
    mesh: Mesh,
    /// The mesh vertex of each corner, if it has one.
    vertices: [Option<usize>; 64],
}

impl<'a, 'b> Facets<'a, 'b> {
    fn new(options: &'a Options<'b>) -> Self {
        Facets { options, mesh: Mesh::default(), vertices: [None; 64] }
    }

    fn vertex(&mut self, corner: Corner) -> usize {
        *self.vertices[corner].get_or_insert_with(|| self.mesh.vertex(self.options.position(corner)))
    }

    /// 1, or −1 if the box is inside out.
    fn sign(&self) -> f64 {
        if self.options.reversed { -1.0 } else { 1.0 }
    }

    /// A spherical triangle between three unit vectors, divided `levels` times into four.
    fn sphere_part(&mut self, centre: [f64; 3], directions: [[f64; 3]; 3], levels: u32) {
        if levels == 0 {
            let (radius, sign) = (self.options.bevel, self.sign());
            let corners = directions.map(|direction| {
                let vertex = self.mesh.vertex(std::array::from_fn(|axis| centre[axis] + radius * direction[axis]));
                Use { vertex, normal: self.mesh.normal(direction.map(|value| sign * value)) }
            });
            return self.mesh.face(&corners);
        }
        let [a, b, c] = directions;
        let middle = |p: [f64; 3], q: [f64; 3]| normalize(std::array::from_fn(|axis| p[axis] + q[axis])).unwrap_or(p);
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        for part in [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]] {
            self.sphere_part(centre, part, levels - 1);
        }
    }
}

impl Faces for Facets<'_, '_> {
    fn polygon(&mut self, corners: &[Corner]) -> Result<(), Error> {
        let mut uses: Vec<Use> =
            corners.iter().map(|corner| Use { vertex: self.vertex(*corner), normal: None }).collect();
        if self.options.rounded {
            let [a, b, c] = [0, 1, 2].map(|index| self.mesh.position(uses[index].vertex));
            let normal = self.mesh.normal(cross(subtract(b, a), subtract(c, b)));
            uses.iter_mut().for_each(|corner| corner.normal = normal);
        }
        self.mesh.face(&uses);
        Ok(())
    }

    fn edge(&mut self, from: Corner, to: Corner) -> Result<(), Error> {
        let (Options { size, bevel, subdivisions, .. }, sign) = (self.options, self.sign());
        let ends = [from, to].map(|corner| {
            let vertex = self.vertex(corner);
            self.mesh.position(vertex)
        });
        let outwards = |axis: usize| if ends[1][axis] < 0.5 * size[axis] { -bevel } else { *bevel };
        // The start and end directions of the quarter circle.
        let (start, end) = match (from ^ to) & 7 {
            1 => (2, 1),
            2 => (0, 2),
            _ => (1, 0),
        };
        let segments = 1u32 << subdivisions;
        let mut previous: Option<[Use; 2]> = None;
        for step in 0..=segments {
            let (sine, cosine) =
                if step == 0 { (0.0, 1.0) } else { (0.5 * PI / f64::from(segments) * f64::from(step)).sin_cos() };
            let mut offset = [0.0; 3];
            offset[start] = cosine * outwards(start);
            offset[end] = sine * outwards(end);
            let vertices = ends.map(|point| self.mesh.vertex(std::array::from_fn(|axis| point[axis] + offset[axis])));
            let normal = self.mesh.normal(offset.map(|value| sign * value));
            let current = vertices.map(|vertex| Use { vertex, normal });
            if let Some([before_from, before_to]) = previous {
                self.mesh.face(&[before_from, before_to, current[1], current[0]]);
            }
            previous = Some(current);
        }
        Ok(())
    }

    fn corner_sphere(&mut self, corner: Corner) -> Result<(), Error> {
        let mut directions = [[0.0; 3]; 3];
        for (axis, direction) in directions.iter_mut().enumerate() {
            let far = ((corner >> axis) & 1 != 0) != self.options.reversed;
            direction[axis] = if far { 1.0 } else { -1.0 };
        }
        if matches!(corner & 7, 0 | 3 | 5 | 6) {
            directions.swap(0, 1);
        }
        let vertex = self.vertex(corner);
        self.sphere_part(self.mesh.position(vertex), directions, self.options.subdivisions);
        Ok(())
    }
}
