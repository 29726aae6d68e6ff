//! Applies a placement to primitives: what `xform` does to each type.

use crate::Kind;
use glam::DVec3;
use radsight_ir::Transform;

/// The combined effect of one or more `xform`s.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Placement {
    /// Transform from the coordinates of the text to those of the scene.
    pub(crate) transform: Transform,
    /// Whether `-I` was given: surfaces are turned inside out.
    pub(crate) inside_out: bool,
    /// Prefix of surface names, joined with a `.`.
    pub(crate) prefix: String,
    /// Modifier that replaces those of all surfaces.
    pub(crate) modifier: Option<NewModifier>,
}

/// A modifier given with `-m`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NewModifier {
    pub(crate) name: String,
    /// Span of the option, if it stands in a scene.
    pub(crate) span: Option<radsight_diag::Span>,
}

impl Default for Placement {
    fn default() -> Self {
        Placement { transform: Transform::IDENTITY, inside_out: false, prefix: String::new(), modifier: None }
    }
}

impl Placement {
    /// This placement followed by `outer`.
    pub(crate) fn then(&self, outer: &Placement) -> Placement {
        let prefix = match (&*outer.prefix, &*self.prefix) {
            ("", inner) => inner.to_owned(),
            (outer, "") => outer.to_owned(),
            (outer, inner) => format!("{outer}.{inner}"),
        };
        Placement {
            transform: self.transform.then(&outer.transform),
            inside_out: self.inside_out != outer.inside_out,
            prefix,
            modifier: outer.modifier.clone().or_else(|| self.modifier.clone()),
        }
    }

    /// Whether numbers stay unchanged.
    pub(crate) fn keeps_numbers(&self) -> bool {
        !self.inside_out && self.transform == Transform::IDENTITY
    }

    /// The type of a primitive after placement.
    pub(crate) fn kind(&self, kind: Kind) -> Kind {
        if self.inside_out { kind.inside_out() } else { kind }
    }

    /// The real arguments of a primitive after placement; overwrites `out`. A wrong number of
    /// arguments passes unchanged.
    pub(crate) fn reals(&self, kind: Kind, reals: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.extend_from_slice(reals);
        let scale = self.transform.scale;
        match (kind, &mut out[..]) {
            (Kind::Polygon, vertices) => self.polygon(vertices),
            (Kind::Sphere | Kind::Bubble, [center @ .., radius]) if center.len() == 3 => {
                self.point(center);
                *radius *= scale;
            }
            (Kind::Cone | Kind::Cup, [ends @ .., base, apex]) if ends.len() == 6 => {
                ends.chunks_exact_mut(3).for_each(|end| self.point(end));
                *base *= scale;
                *apex *= scale;
            }
            (Kind::Cylinder | Kind::Tube, [ends @ .., radius]) if ends.len() == 6 => {
                ends.chunks_exact_mut(3).for_each(|end| self.point(end));
                *radius *= scale;
            }
            (Kind::Ring, [place @ .., inner, outer]) if place.len() == 6 => {
                let (center, normal) = place.split_at_mut(3);
                self.point(center);
                self.vector(normal);
                if self.inside_out {
                    normal.iter_mut().for_each(|component| *component = -*component);
                }
                *inner *= scale;
                *outer *= scale;
            }
            (Kind::Source, [direction @ .., _]) if direction.len() == 3 => self.vector(direction),
            (Kind::Glow, [_, _, _, max_radius]) => *max_radius *= scale,
            (Kind::Spotlight, [_, _, _, _, aim @ ..]) if aim.len() == 3 => self.vector(aim),
            (Kind::Mist, [red, green, blue, ..]) => [red, green, blue].into_iter().for_each(|band| *band /= scale),
            (Kind::Dielectric, [color @ .., _, _]) if color.len() == 3 => per_length(color, scale),
            (Kind::Interface, sides) if sides.len() == 8 => {
                sides.chunks_exact_mut(4).for_each(|side| per_length(&mut side[..3], scale));
            }
            (Kind::BrightText | Kind::ColorText | Kind::MixText, text) if text.len() >= 9 => {
                self.point(&mut text[..3]);
                text[3..9].chunks_exact_mut(3).for_each(|motion| self.vector(motion));
            }
            _ => {}
        }
    }

    /// A name in the source list of a mist; names of virtual sources are joined with `>`.
    pub(crate) fn mist_source(&self, name: &str) -> String {
        if self.prefix.is_empty() {
            return name.to_owned();
        }
        name.split_inclusive('>').map(|part| format!("{}.{part}", self.prefix)).collect()
    }

    fn polygon(&self, vertices: &mut [f64]) {
        if !vertices.len().is_multiple_of(3) {
            return;
        }
        vertices.chunks_exact_mut(3).for_each(|vertex| self.point(vertex));
        if self.transform.is_mirror_image() != self.inside_out {
            vertices.reverse();
            vertices.chunks_exact_mut(3).for_each(<[f64]>::reverse);
        }
    }

    fn point(&self, coordinates: &mut [f64]) {
        let placed = self.transform.point(DVec3::from_slice(coordinates));
        placed.write_to_slice(coordinates);
    }

    /// Transforms a vector, including its scale.
    fn vector(&self, components: &mut [f64]) {
        let placed = self.transform.direction(DVec3::from_slice(components)) * self.transform.scale;
        placed.write_to_slice(components);
    }
}

/// Converts transmittances per old unit of length to those per new unit.
fn per_length(color: &mut [f64], scale: f64) {
    if scale != 1.0 {
        color.iter_mut().for_each(|band| *band = band.powf(1.0 / scale));
    }
}
