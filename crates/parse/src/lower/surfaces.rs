//! Surfaces.

use super::reader::{Here, Reader};
use crate::Kind;
use crate::signature::signature;
use crate::syntax::Primitive;
use glam::DVec3;
use radsight_diag::Diagnostic;
use radsight_ir::{Cone, Facing, Ring, Shape, SolidAngle, Source, Sphere, Surface};

/// Radiance treats lengths below this as zero.
const TINY: f64 = 1e-6;

/// Why a surface cannot be built.
enum Refusal {
    /// The surface is left out with a warning, as in Radiance.
    LeftOut(&'static str),
    /// The surface is an error.
    Wrong(String),
}

impl Reader<'_> {
    pub(super) fn surface(&mut self, primitive: &Primitive<'_>, here: Here<'_>) {
        let modifier = self.surface_modifier(primitive, here);
        if self.has_integers(primitive, here) || !self.has_right_reals(primitive, here) {
            return;
        }
        if self.has_most_surfaces(primitive, here) {
            return;
        }
        let mut placed = std::mem::take(&mut self.placed);
        let reals = if here.context.is_plain {
            primitive.reals
        } else {
            here.context.placement.reals(primitive.kind, primitive.reals, &mut placed);
            &placed
        };
        let shape = self.shape(primitive, reals, here);
        self.placed = placed;
        match shape {
            Ok(shape) => self.add_surface(primitive, shape, here, modifier),
            Err(refusal) => self.refuse(primitive, refusal, here),
        }
    }

    /// Whether the number of surfaces has reached its limit. If so, reading stops.
    pub(super) fn has_most_surfaces(&mut self, primitive: &Primitive<'_>, here: Here<'_>) -> bool {
        let is_full = self.surface_modifiers.len() >= self.options.most_surfaces;
        if is_full {
            let message = format!("the scene has more than {} surfaces", self.options.most_surfaces);
            self.stop(Diagnostic::error(message).at(here.span(primitive.place())));
        }
        is_full
    }

    pub(super) fn add_surface(
        &mut self,
        primitive: &Primitive<'_>,
        shape: Shape,
        here: Here<'_>,
        modifier: Option<super::modifiers::RawHandle>,
    ) {
        let name = primitive.text(primitive.name);
        let name = String::from_utf8_lossy(&name);
        let prefix = &here.context.placement.prefix;
        let name = if prefix.is_empty() {
            self.scene.names.add(&name)
        } else {
            self.scene.names.add(&format!("{prefix}.{name}"))
        };
        let span = Some(here.span(primitive.place()));
        self.scene.surfaces.add(Surface { name, span, modifier: None, shape });
        self.surface_modifiers.push(modifier);
        self.numberer.note_surface();
    }

    fn has_right_reals(&mut self, primitive: &Primitive<'_>, here: Here<'_>) -> bool {
        let (kind, found) = (primitive.kind, primitive.reals.len());
        let expected = signature(kind);
        if expected.reals.allows(found) {
            return true;
        }
        let name = primitive.text(primitive.name);
        let name = String::from_utf8_lossy(&name);
        let plural = if found == 1 { "" } else { "s" };
        let message = format!("{kind} \"{name}\" has {found} real argument{plural}, expected {}", expected.reals);
        let span = here.span(primitive.counts[2].place());
        self.log.push(Diagnostic::error(message).at(span).maybe_hint(expected.hint()));
        false
    }

    fn refuse(&mut self, primitive: &Primitive<'_>, refusal: Refusal, here: Here<'_>) {
        let name = primitive.text(primitive.name);
        let called = format!("{} \"{}\"", primitive.kind, String::from_utf8_lossy(&name));
        let diagnostic = match refusal {
            Refusal::LeftOut(reason) => Diagnostic::warning(format!("{called} {reason}; it is left out")),
            Refusal::Wrong(reason) => Diagnostic::error(format!("{called} {reason}")),
        };
        self.log.push(diagnostic.at(here.span(primitive.place())));
    }

    fn warn_of_flip(&mut self, primitive: &Primitive<'_>, here: Here<'_>) {
        let name = primitive.text(primitive.name);
        let (kind, other) = (primitive.kind, primitive.kind.inside_out());
        let name = String::from_utf8_lossy(&name);
        let message = format!("{kind} \"{name}\" has a negative radius; it becomes a {other}");
        self.log.push(Diagnostic::warning(message).at(here.span(primitive.place())));
    }

    fn shape(&mut self, primitive: &Primitive<'_>, reals: &[f64], here: Here<'_>) -> Result<Shape, Refusal> {
        let kind = here.context.placement.kind(primitive.kind);
        match (kind, reals) {
            (Kind::Polygon, vertices) => self.polygon(vertices),
            (Kind::Sphere | Kind::Bubble, &[x, y, z, radius]) => {
                if radius.abs() <= TINY {
                    return Err(Refusal::LeftOut("has a radius of zero"));
                }
                let mut facing = facing(kind);
                if radius < 0.0 {
                    self.warn_of_flip(primitive, here);
                    facing = facing.flipped();
                }
                let sphere = Sphere { center: DVec3::new(x, y, z), radius: radius.abs(), facing };
                Ok(Shape::Sphere(self.scene.spheres.add(sphere)))
            }
            (Kind::Cylinder | Kind::Tube, [ends @ .., radius]) if ends.len() == 6 => {
                let (base, apex) = (DVec3::from_slice(ends), DVec3::from_slice(&ends[3..]));
                self.cone(primitive, kind, [base, apex], [*radius; 2], here)
            }
            (Kind::Cone | Kind::Cup, [ends @ .., first, second]) if ends.len() == 6 => {
                let (base, apex) = (DVec3::from_slice(ends), DVec3::from_slice(&ends[3..]));
                self.cone(primitive, kind, [base, apex], [*first, *second], here)
            }
            (Kind::Ring, [place @ .., first, second]) if place.len() == 6 => {
                self.ring(DVec3::from_slice(place), DVec3::from_slice(&place[3..]), [*first, *second])
            }
            (Kind::Source, &[x, y, z, degrees]) => self.source(DVec3::new(x, y, z), degrees),
            _ => Err(Refusal::Wrong("is not supported yet".to_owned())),
        }
    }

    fn polygon(&mut self, coordinates: &[f64]) -> Result<Shape, Refusal> {
        let start = self.scene.vertices.len();
        let full = || Refusal::Wrong("does not fit: the scene has 2^32 vertices".to_owned());
        let end = u32::try_from(start + coordinates.len() / 3).map_err(|_| full())?;
        let (first, last) = (DVec3::from_slice(coordinates), DVec3::from_slice(&coordinates[coordinates.len() - 3..]));
        // A last vertex equal to the first one closes the polygon and is dropped.
        let is_closed = coordinates.len() > 9 && first.distance_squared(last) <= TINY * TINY;
        let kept = if is_closed { &coordinates[..coordinates.len() - 3] } else { coordinates };
        self.scene.vertices.extend(kept.chunks_exact(3).map(DVec3::from_slice));
        Ok(Shape::Polygon { start: start as u32, count: end - start as u32 - u32::from(is_closed) })
    }

    fn cone(
        &mut self,
        primitive: &Primitive<'_>,
        kind: Kind,
        [base, apex]: [DVec3; 2],
        radii: [f64; 2],
        here: Here<'_>,
    ) -> Result<Shape, Refusal> {
        let [first, second] = radii.map(sign);
        if first + second == 0 {
            return Err(Refusal::LeftOut("has radii that are zero or of opposite signs"));
        }
        if base == apex {
            return Err(Refusal::LeftOut("has no length"));
        }
        let mut facing = facing(kind);
        if first < 0 || second < 0 {
            self.warn_of_flip(primitive, here);
            facing = facing.flipped();
        }
        // Treat as zero or equal what Radiance treats so.
        let [mut base_radius, mut apex_radius] = radii.map(|radius| if sign(radius) == 0 { 0.0 } else { radius.abs() });
        if (base_radius - apex_radius).abs() <= TINY {
            apex_radius = base_radius.max(apex_radius);
            base_radius = apex_radius;
        }
        let cone = Cone { base, apex, base_radius, apex_radius, facing };
        Ok(Shape::Cone(self.scene.cones.add(cone)))
    }

    fn ring(&mut self, center: DVec3, normal: DVec3, radii: [f64; 2]) -> Result<Shape, Refusal> {
        let signs = radii.map(sign);
        let (inner, outer) = (radii[0].min(radii[1]), radii[0].max(radii[1]));
        if signs.contains(&-1) || signs == [0, 0] || outer - inner <= TINY {
            return Err(Refusal::LeftOut("has radii that enclose no area"));
        }
        let normal = normal.try_normalize().ok_or(Refusal::LeftOut("has no direction"))?;
        let ring = Ring { center, normal, inner_radius: inner.max(0.0), outer_radius: outer };
        Ok(Shape::Ring(self.scene.rings.add(ring)))
    }

    fn source(&mut self, direction: DVec3, degrees: f64) -> Result<Shape, Refusal> {
        let direction = direction.try_normalize().ok_or(Refusal::Wrong("has no direction".to_owned()))?;
        // The floats of a compiled octree can slightly exceed the angle as written.
        let full_angle = degrees.min(360.0).to_radians();
        if 0.5 * full_angle <= TINY || degrees > 360.0 + ROUNDING {
            return Err(Refusal::Wrong(format!("has the angle {degrees}, expected degrees above 0, at most 360")));
        }
        let source = Source { direction, extent: SolidAngle { full_angle } };
        Ok(Shape::Source(self.scene.sources.add(source)))
    }
}

/// Largest error of an octree's floats, degrees.
const ROUNDING: f64 = 1e-5;

fn facing(kind: Kind) -> Facing {
    match kind {
        Kind::Bubble | Kind::Cup | Kind::Tube => Facing::Inward,
        _ => Facing::Outward,
    }
}

/// The sign of a length as −1, 0 or 1, with Radiance's tolerance.
fn sign(length: f64) -> i32 {
    i32::from(length > TINY) - i32::from(length < -TINY)
}
