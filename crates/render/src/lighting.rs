//! Finding the lights of a scene, and their images in plane mirrors.

use crate::geometry::{Geometry, flat_normal};
use crate::light::{Light, LightCone, LightForm, Mirror, mirrored};
use crate::ray::PrimitiveId;
use crate::shader::{Kind, Shader};
use glam::DVec3;
use radsight_ir::{Material, ModifierKind, Scene, Shape, SurfaceHandle, ValidScene};

/// All lights: real ones first, then their images in one mirror, in two, and so on.
pub(crate) fn collect_lights<'a>(
    scene: &ValidScene,
    geometry: &Geometry,
    shader: impl Fn(SurfaceHandle) -> &'a Shader,
    relay: impl Fn(SurfaceHandle) -> &'a Shader,
    relays: u32,
) -> Vec<Light> {
    let mut primitive_of = vec![None; scene.surfaces.len()];
    for (member, handle) in geometry.members() {
        primitive_of[handle.index()] = geometry.is_plain(member).then(|| member.primitive());
    }
    let mut lights: Vec<Light> = scene
        .surfaces
        .iter()
        .filter(|(handle, _)| shader(*handle).kind.emitter().is_some())
        .filter_map(|(handle, _)| real_light(scene, handle, primitive_of[handle.index()]))
        .collect();
    let mirrors = collect_mirrors(scene, geometry, &relay);
    let mut first = 0;
    for _ in 0..relays {
        let end = lights.len();
        for index in first..end {
            for mirror in &mirrors {
                if let Some(image) = image_of(&lights[index], mirror) {
                    lights.push(image);
                }
            }
        }
        first = end;
    }
    lights
}

fn real_light(scene: &Scene, handle: SurfaceHandle, primitive: Option<PrimitiveId>) -> Option<Light> {
    let surface = &scene.surfaces[handle];
    let material = scene.chain(surface.modifier).find_map(|(_, modifier)| match &modifier.kind {
        ModifierKind::Material(material) => Some(material),
        _ => None,
    })?;
    let (cone, max_distance, focal_distance) = match material {
        Material::Light { .. } | Material::Illum { .. } => (None, f64::INFINITY, 0.0),
        Material::Glow { max_radius, .. } if *max_radius > 0.0 => (None, *max_radius, 0.0),
        Material::Spotlight { cone_angle, direction, focal_distance, .. } => {
            let half_angle = 0.5 * cone_angle;
            let cone = LightCone { axis: *direction, half_angle };
            (Some(cone), f64::INFINITY, *focal_distance)
        }
        _ => return None,
    };
    let form = LightForm::new(scene, surface.shape)?;
    if matches!(surface.shape, Shape::Source(_)) && max_distance.is_finite() {
        return None;
    }
    let (center, radius) = bounding_sphere(&form);
    let usable = form.area() > 0.0;
    usable.then_some(Light {
        surface: handle,
        primitive,
        form,
        center,
        radius,
        cone,
        max_distance,
        focal_distance,
        mirrors: Vec::new(),
    })
}

fn bounding_sphere(form: &LightForm) -> (DVec3, f64) {
    match form {
        LightForm::Disk { center, outer_squared, .. } => (*center, outer_squared.sqrt()),
        LightForm::Parallelogram { corner, x, y, .. } => {
            (*corner + (*x + *y) * 0.5, 0.5 * (*x + *y).length().max((*x - *y).length()))
        }
        LightForm::Triangles { triangles, .. } => {
            let corners = triangles.iter().flatten();
            let count = 3.0 * triangles.len() as f64;
            let center = corners.clone().sum::<DVec3>() / count;
            (center, corners.map(|corner| corner.distance(center)).fold(0.0, f64::max))
        }
        LightForm::Sphere { center, radius, .. } => (*center, *radius),
        LightForm::Cone { base, axis, length, radii, .. } => {
            (*base + *axis * (0.5 * length), (0.5 * length).hypot(radii[0].max(radii[1])))
        }
        LightForm::Distant { direction, .. } => (*direction, f64::INFINITY),
    }
}

fn collect_mirrors<'a>(
    scene: &ValidScene,
    geometry: &Geometry,
    relay: &impl Fn(SurfaceHandle) -> &'a Shader,
) -> Vec<Mirror> {
    geometry
        .members()
        .filter(|(_, handle)| matches!(relay(*handle).kind, Kind::Mirror { .. }))
        .filter_map(|(member, surface)| {
            let shape = scene.surfaces[surface].shape;
            let normal = flat_normal(scene, shape)?;
            let point = match shape {
                Shape::Polygon { start, .. } => scene.vertices[start as usize],
                Shape::Ring(ring) => scene.rings[ring].center,
                _ => return None,
            };
            Some(Mirror { surface, member, point, normal })
        })
        .collect()
}

/// The image of a light in a mirror that it stands in front of.
fn image_of(light: &Light, mirror: &Mirror) -> Option<Light> {
    if light.mirrors.first().is_some_and(|last| last.surface == mirror.surface) || light.surface == mirror.surface {
        return None;
    }
    let in_front = if light.radius.is_infinite() {
        mirror.normal.dot(light.center) > 0.0
    } else {
        mirror.normal.dot(light.center - mirror.point) > -light.radius
    };
    if !in_front {
        return None;
    }
    let distant = light.radius.is_infinite();
    let center = if distant { mirror.image_of_direction(light.center) } else { mirror.image_of_point(light.center) };
    let cone = light.cone.map(|cone| LightCone { axis: mirror.image_of_direction(cone.axis), ..cone });
    let mut mirrors = vec![*mirror];
    mirrors.extend_from_slice(&light.mirrors);
    // The mirrors further along are seen in this one: real rays are unfolded one mirror at a time, so they stay as they are.
    Some(Light { form: mirrored(&light.form, mirror), center, cone, mirrors, ..light.clone() })
}
