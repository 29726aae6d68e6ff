//! Virtual sources: images of lights in plane mirrors and prisms (Radiance's `virtuals.c`).

use crate::form::LightForm;
use glam::DVec3;
use radsight_accel::MemberId;
use radsight_ir::SurfaceHandle;

/// A plane mirror or prism that makes a virtual source.
#[derive(Clone, Copy, Debug)]
pub struct VirtualSource {
    /// The mirror or prism.
    pub surface: SurfaceHandle,
    /// Its member of the scene, in the acceleration structure.
    pub member: MemberId,
    /// A point of its plane, scene units.
    pub point: DVec3,
    /// Unit normal of its plane, on the front.
    pub normal: DVec3,
    /// Displacement of a point's image per unit of height above the plane: −2 normals for a mirror.
    pub shift: DVec3,
    /// Redirection by a prism; none for a mirror.
    pub redirection: Option<Redirection>,
}

/// Redirection of a light by a prism.
#[derive(Clone, Copy, Debug)]
pub struct Redirection {
    /// Face of the prism.
    pub face: u32,
    /// Centre of the light as seen from the prism, or the unit direction to a distant light.
    pub target: DVec3,
    /// Whether `target` is a direction.
    pub is_distant: bool,
}

impl VirtualSource {
    /// Image of a point, scene units.
    pub fn image_of_point(&self, point: DVec3) -> DVec3 {
        point + self.shift * self.normal.dot(point - self.point)
    }

    /// Image of a direction. Only a mirror preserves its length.
    pub fn image_of_direction(&self, direction: DVec3) -> DVec3 {
        direction + self.shift * self.normal.dot(direction)
    }

    /// Image of a unit direction, normalised.
    pub fn image_of_unit(&self, direction: DVec3) -> DVec3 {
        let image = self.image_of_direction(direction);
        if self.redirection.is_some() { image.normalize_or(direction) } else { image }
    }
}

/// Shape of the virtual source. The image of a distant light in a prism may have another shape,
/// which the prism alone determines.
pub fn virtual_form(form: &LightForm, virtual_source: &VirtualSource) -> LightForm {
    let point = |p: &DVec3| virtual_source.image_of_point(*p);
    let vector = |v: &DVec3| virtual_source.image_of_direction(*v);
    let unit = |v: &DVec3| virtual_source.image_of_unit(*v);
    match form {
        LightForm::Disk { center, normal, x, y, inner_squared, outer_squared } => LightForm::Disk {
            center: point(center),
            normal: unit(normal),
            x: vector(x),
            y: vector(y),
            inner_squared: *inner_squared,
            outer_squared: *outer_squared,
        },
        LightForm::Parallelogram { corner, x, y, normal, area } => LightForm::Parallelogram {
            corner: point(corner),
            x: vector(x),
            y: vector(y),
            normal: unit(normal),
            area: *area,
        },
        LightForm::Polygon { polygon, normal } => LightForm::Polygon {
            polygon: polygon.image(|corner| virtual_source.image_of_point(corner)),
            normal: unit(normal),
        },
        LightForm::Sphere { center, radius, facing } => {
            LightForm::Sphere { center: point(center), radius: *radius, facing: *facing }
        }
        LightForm::Cone { base, axis, length, radii, facing } => {
            LightForm::Cone { base: point(base), axis: unit(axis), length: *length, radii: *radii, facing: *facing }
        }
        LightForm::Distant { direction, x, y, half_angle_sin_squared_half } => LightForm::Distant {
            direction: unit(direction),
            x: unit(x),
            y: unit(y),
            half_angle_sin_squared_half: *half_angle_sin_squared_half,
        },
        LightForm::DistantImage { direction, x, y } => {
            LightForm::DistantImage { direction: unit(direction), x: vector(x), y: vector(y) }
        }
    }
}
