//! The luminous opening of a luminaire as a box, a cylinder or a sphere.
//!
//! The signs of width, length and height in an LM-63 file encode its shape, by rules that differ
//! between versions. Shapes that Radiance lacks are replaced, with a warning.

use std::f64::consts::PI;
use std::fmt::Write;

use super::luminaire::Luminaire;
use crate::Error;
use crate::text::{Text, general};

/// Diameter of a point source, metres; half of it is the smallest height.
pub(super) const SMALLEST: f64 = 0.001;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Box,
    Cylinder,
    Sphere,
}

impl Shape {
    pub(super) fn words(self) -> &'static str {
        match self {
            Shape::Box => "rectangle or box",
            Shape::Cylinder => "disk or cylinder",
            Shape::Sphere => "sphere",
        }
    }
}

/// Sizes in metres.
pub(super) struct Opening {
    pub(super) shape: Shape,
    pub(super) width: f64,
    pub(super) length: f64,
    pub(super) height: f64,
    pub(super) is_illum: bool,
    /// The shape that the file describes.
    pub(super) described: Option<&'static str>,
    pub(super) warning: Option<&'static str>,
}

const ELLIPSOID_TO_SPHERE: &str =
    "makeshape: shape is an ellipsoid, which is not supported.\nmakeshape: replaced with sphere";
const ELLIPSE_TO_DISK: &str = "makeshape: shape is an ellipse, which is not supported.\nmakeshape: replaced with disk";
const ELLIPSOID_TO_BOX: &str =
    "makeshape: shape is an ellipsoid, which is not supported.\nmakeshape: replaced with box";
const ELLIPTIC_TO_ROUND: &str = "makeshape: shape is a vertical elliptical cylinder, which is not supported.\nmakeshape: replaced with circular cylinder";
const ELLIPTIC_TO_BOX: &str =
    "makeshape: shape is a  vertical elliptical cylinder, which is not supported.\nmakeshape: replaced with box";
const LYING_TO_BOX: &str =
    "makeshape: shape is a horizontal cylinder, which is not supported.\nmakeshape: replaced with box";
const STANDING_TO_RECTANGLE: &str =
    "makeshape: shape is a vertical ellipse, which is not supported.\nmakeshape: replaced with rectangle";

impl Opening {
    fn new(shape: Shape, width: f64, length: f64, height: f64) -> Opening {
        Opening { shape, width, length, height, is_illum: false, described: None, warning: None }
    }

    /// A sphere with a diameter in metres, a proxy for the luminaire.
    pub(super) fn illum(diameter: f64) -> Opening {
        Opening { is_illum: true, ..Opening::sphere(diameter) }
    }

    fn sphere(diameter: f64) -> Opening {
        Opening::new(Shape::Sphere, diameter, diameter, diameter)
    }

    fn cylinder(diameter: f64, height: f64) -> Opening {
        Opening::new(Shape::Cylinder, diameter, diameter, height.max(0.5 * SMALLEST))
    }

    fn cuboid(length: f64, width: f64, height: f64) -> Opening {
        Opening::new(Shape::Box, width.max(SMALLEST), length.max(SMALLEST), height.max(0.5 * SMALLEST))
    }

    fn described(self, words: &'static str) -> Opening {
        Opening { described: Some(words), ..self }
    }

    fn warned(self, warning: &'static str) -> Opening {
        Opening { warning: Some(warning), ..self }
    }

    /// The opening described by a luminaire's file.
    pub(super) fn of(luminaire: &Luminaire) -> Result<Opening, String> {
        let Luminaire { length: l, width: w, height: h, .. } = *luminaire;
        let sign = |value: f64| i8::from(value > 0.0) - i8::from(value < 0.0);
        let signs = (sign(l), sign(w), sign(h));
        let (length, width, height) = (l.abs(), w.abs(), h.abs());
        let equal = |a: f64, b: f64| (a - b).abs() <= 1e-6;
        // The rules of 1991 equal those of 1986, and those of 2019 equal those of 2002.
        let rules = match luminaire.version {
            1986 | 1991 => 1986,
            1995 => 1995,
            _ => 2002,
        };
        let cuboid = || Opening::cuboid(length, width, height);
        let opening = match (rules, signs) {
            (_, (0, 0, 0)) => Opening::sphere(SMALLEST).described("point"),
            (_, (1, 1, 0)) => cuboid().described("rectangle"),
            (_, (1, 1, 1) | (0, 1, 1) | (1, 0, 1)) => cuboid().described("box"),
            (_, (0, -1, 0)) => Opening::cylinder(width, height).described("disk"),
            (1986 | 1995, (0, -1, 1)) => Opening::cylinder(width, height).described("vertical cylinder"),
            (1986, (1, -1, 0)) => elliptic(length, width, 0.0).described("ellipse"),
            (1986, (1, -1, 1)) => ellipsoid(width, length, height).described("ellipsoid"),
            (1995, (0, -1, -1)) if equal(length, height) => Opening::sphere(width).described("sphere"),
            (1995, (1, 0, -1)) => {
                cuboid().warned(LYING_TO_BOX).described("horizontal cylinder along photometric horizontal")
            }
            (1995, (0, 1, -1)) => {
                cuboid().warned(LYING_TO_BOX).described("horizontal cylinder perpendicular to photometric horizontal")
            }
            (1995, (-1, 1, 1) | (1, -1, 1)) => {
                elliptic(length, width, height).described("vertical elliptical cylinder")
            }
            (1995, (-1, 1, -1) | (1, -1, -1)) => ellipsoid(length, width, height).described("ellipsoid"),
            (2002, (-1, -1, 0)) if equal(l, w) => Opening::cylinder(width, height).described("disk"),
            (2002, (-1, -1, 0)) => elliptic(width, length, height).described("ellipse"),
            (2002, (-1, -1, 1)) if equal(l, w) => Opening::cylinder(width, height).described("vertical cylinder"),
            (2002, (-1, -1, 1)) => elliptic(width, length, height).described("vertical elliptical cylinder"),
            (2002, (-1, -1, -1)) if equal(l, w) && equal(l, h) => Opening::sphere(width).described("sphere"),
            (2002, (-1, -1, -1)) => ellipsoid(length, width, height).described("ellipsoid"),
            (2002, (1, -1, -1)) => cuboid().warned(LYING_TO_BOX).described(match equal(w, h) {
                true => "horizontal cylinder along photometric horizontal",
                false => "horizontal elliptical cylinder along photometric horizontal",
            }),
            (2002, (-1, 1, -1)) => cuboid().warned(LYING_TO_BOX).described(match equal(l, h) {
                true => "horizontal cylinder perpendicular to photometric horizontal",
                false => "horizontal elliptical cylinder perpendicular to photometric horizontal",
            }),
            (2002, (-1, 0, -1)) => cuboid().warned(STANDING_TO_RECTANGLE).described(match equal(w, h) {
                true => "vertical disk facing photometric horizontal",
                false => "vertical ellipse facing photometric horizontal",
            }),
            _ => {
                return Err(format!(
                    "a luminous opening of width {w}, length {l} and height {h} m is not a shape of the {} format",
                    luminaire.version
                ));
            }
        };
        Ok(opening)
    }

    /// The projected area from below, m².
    pub(super) fn area(&self) -> f64 {
        match self.shape {
            Shape::Box => self.width * self.length,
            Shape::Cylinder | Shape::Sphere => PI / 4.0 * self.width * self.width,
        }
    }

    /// Writes the emitting surfaces: below, above, at the sides.
    pub(super) fn write(
        &self,
        scene: &mut Text,
        name: &str,
        units_per_metre: f64,
        [lower, upper, sides]: [bool; 3],
    ) -> Result<(), Error> {
        let half = |size: f64| general(0.5 * size * units_per_metre, 6);
        let radius = half(self.width);
        match self.shape {
            Shape::Sphere => write!(scene, "\n'{name}_light' sphere '{name}.s'\n0\n0\n4 0 0 0 {radius}\n")?,
            Shape::Cylinder => {
                let (up, down) = (half(self.height), half(-self.height));
                for (wanted, part, height, normal) in [(lower, "d", down, "-1"), (upper, "u", up, "1")] {
                    if wanted {
                        write!(scene, "\n'{name}_light' ring '{name}.{part}'\n0\n0\n8\n")?;
                        write!(scene, "\t0 0 {height}\n\t0 0 {normal}\n\t0 {radius}\n")?;
                    }
                }
                if sides {
                    write!(scene, "\n'{name}_light' cylinder '{name}.c'\n0\n0\n7\n")?;
                    write!(scene, "\t0 0 {up}\n\t0 0 {down}\n\t{radius}\n")?;
                }
            }
            Shape::Box => {
                // Corners: 1, 2, 4 select the far side along x, y, z.
                let faces = [
                    (lower, "d", [0, 2, 3, 1]),
                    (upper, "u", [4, 5, 7, 6]),
                    (sides, "1", [0, 1, 5, 4]),
                    (sides, "2", [1, 3, 7, 5]),
                    (sides, "3", [3, 2, 6, 7]),
                    (sides, "4", [2, 0, 4, 6]),
                ];
                for (_, part, corners) in faces.into_iter().filter(|face| face.0) {
                    write!(scene, "\n'{name}_light' polygon '{name}.{part}'\n0\n0\n12\n")?;
                    for corner in corners {
                        let place = |bit: usize, size: f64| half(if corner & bit != 0 { size } else { -size });
                        let [x, y, z] = [place(1, self.length), place(2, self.width), place(4, self.height)];
                        writeln!(scene, "\t{x}\t{y}\t{z}")?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Whether a size is within 50 % of a mean; in single precision, as ies2rad compares.
fn is_near(size: f64, mean: f32) -> bool {
    f64::from(0.5 * mean) < size && size < f64::from(1.5 * mean)
}

/// A substitute for a vertical elliptical cylinder.
fn elliptic(length: f64, width: f64, height: f64) -> Opening {
    let mean = ((width + length) / 2.0) as f32;
    if is_near(width, mean) && is_near(length, mean) {
        Opening::cylinder(width, height).warned(ELLIPTIC_TO_ROUND)
    } else {
        // ies2rad exchanges the sides of this box, so we do too.
        Opening::cuboid(width, length, height).warned(ELLIPTIC_TO_BOX)
    }
}

/// A substitute for an ellipsoid. The real program uses a sphere only if it is much higher than
/// wide.
fn ellipsoid(width: f64, length: f64, height: f64) -> Opening {
    let mean = ((width + length + height) / 3.0) as f32;
    let is_round = is_near(width, mean) && is_near(length, mean);
    if is_round && height > f64::from(1.5 * mean) {
        Opening::sphere(f64::from(mean)).warned(ELLIPSOID_TO_SPHERE)
    } else if is_round && height <= 0.5 * SMALLEST {
        Opening::cylinder(width, 0.0).warned(ELLIPSE_TO_DISK)
    } else {
        Opening::cuboid(width, length, height).warned(ELLIPSOID_TO_BOX)
    }
}
