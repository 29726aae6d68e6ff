//! Collects the lights of a scene, and their virtual images in plane mirrors and prisms.

use crate::emission_cone::emission_cone;
use crate::prism::PrismKind;
use crate::prism_image::PrismInteraction;
use crate::shader::{Kind, Shader};
use glam::DVec3;
use radsight_accel::{Geometry, MemberId, PrimitiveId, Ray, flat_normal};
use radsight_cal::Scratch;
use radsight_ir::{Material, ModifierKind, Ring, Scene, Shape, SurfaceHandle, ValidScene};
use radsight_light::{Light, LightCone, LightForm, Redirection, VirtualSource, virtual_form};
use radsight_texture::SurfaceInteraction;

/// All lights: first the real ones, then their images in one mirror or prism, in two, and so on.
pub(crate) fn collect_lights<'a>(
    scene: &ValidScene,
    geometry: &Geometry,
    shader: impl Fn(SurfaceHandle) -> &'a Shader,
    virtual_source: impl Fn(SurfaceHandle) -> &'a Shader,
    virtual_sources: u32,
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
    let virtual_surfaces = collect_virtual_surfaces(scene, geometry, &virtual_source);
    let real = lights.len();
    let mut first = 0;
    for _ in 0..virtual_sources {
        let end = lights.len();
        for index in first..end {
            for virtual_surface in &virtual_surfaces {
                if lights.len() - real >= MAX_IMAGES {
                    return lights;
                }
                let images: Vec<Light> = virtual_surface.images_of(&lights[index]).collect();
                lights.extend(images);
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
            let cone = LightCone::new(*direction, half_angle);
            (Some(cone), f64::INFINITY, *focal_distance)
        }
        _ => return None,
    };
    let form = LightForm::new(scene, surface.shape)?;
    if matches!(surface.shape, Shape::Source(_)) && max_distance.is_finite() {
        return None;
    }
    let (center, radius) = form.bounding_sphere();
    let usable = form.area() > 0.0;
    usable.then_some(Light {
        surface: handle,
        primitive,
        form,
        center,
        radius,
        cone,
        dark_beyond: emission_cone(scene, surface.modifier),
        profile: None,
        max_distance,
        focal_distance,
        virtual_sources: Vec::new(),
    })
}

/// Maximum number of virtual images: in a hall of mirrors each further one is weaker.
const MAX_IMAGES: usize = 1 << 13;

/// A flat surface that makes virtual images of lights.
struct VirtualSourceSurface<'a> {
    surface: SurfaceHandle,
    member: MemberId,
    point: DVec3,
    normal: DVec3,
    /// Points whose convex hull contains the surface, and their mean.
    corners: Vec<DVec3>,
    middle: DVec3,
    /// The prism; `None` for a mirror.
    prism: Option<&'a PrismKind>,
}

fn square_around(ring: &Ring) -> Vec<DVec3> {
    let (x, y) = ring.normal.any_orthonormal_pair();
    let corner = |(a, b): (f64, f64)| ring.center + (x * a + y * b) * ring.outer_radius;
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(corner).to_vec()
}

fn collect_virtual_surfaces<'a>(
    scene: &ValidScene,
    geometry: &Geometry,
    virtual_source: &impl Fn(SurfaceHandle) -> &'a Shader,
) -> Vec<VirtualSourceSurface<'a>> {
    geometry
        .listed_members()
        .filter_map(|(member, surface)| {
            let prism = match &virtual_source(surface).kind {
                Kind::Mirror { .. } => None,
                Kind::Prism(prism) => Some(prism),
                _ => return None,
            };
            let shape = scene.surfaces[surface].shape;
            let normal = flat_normal(scene, shape)?;
            let corners = match shape {
                Shape::Polygon { start, count } => scene.polygon_vertices(start, count).to_vec(),
                Shape::Ring(ring) => square_around(&scene.rings[ring]),
                _ => return None,
            };
            let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
            Some(VirtualSourceSurface { surface, member, point: corners[0], normal, corners, middle, prism })
        })
        .collect()
}

impl VirtualSourceSurface<'_> {
    /// Virtual images of a light: in a mirror with the light in front of it, or in each face of a
    /// prism.
    fn images_of(&self, light: &Light) -> impl Iterator<Item = Light> {
        let is_own = light.virtual_sources.first().is_some_and(|last| last.surface == self.surface);
        let is_dark = is_own || light.surface == self.surface || !self.is_lit_by(light);
        let ways = if is_dark { Vec::new() } else { self.ways(light) };
        let distant = light.radius.is_infinite();
        ways.into_iter().map(move |(shift, redirection)| {
            let VirtualSourceSurface { surface, member, point, normal, .. } = *self;
            let virtual_source = VirtualSource { surface, member, point, normal, shift, redirection };
            let center = if distant {
                virtual_source.image_of_unit(light.center)
            } else {
                virtual_source.image_of_point(light.center)
            };
            // Behind a prism the cone has no sharp boundary at one point: the radiance at the prism
            // decides.
            let [cone, dark_beyond] = [light.cone, light.dark_beyond].map(|cone| {
                let cone = cone.filter(|_| redirection.is_none())?;
                Some(LightCone::new(virtual_source.image_of_direction(cone.axis), cone.half_angle))
            });
            let radius = if redirection.is_some() { light.radius * (1.0 + shift.length()) } else { light.radius };
            let prism = self.prism.map(|prism| PrismInteraction { prism, middle: self.middle, normal });
            let image = prism.zip(redirection).and_then(|(prism, redirection)| prism.image(&light.form, &redirection));
            let form = image.unwrap_or_else(|| virtual_form(&light.form, &virtual_source));
            let mut virtual_sources = vec![virtual_source];
            virtual_sources.extend_from_slice(&light.virtual_sources);
            // Earlier mirrors are seen through this one. Rays are unfolded one mirror at a time, so
            // their planes stay.
            Light { form, center, radius, cone, dark_beyond, virtual_sources, ..light.clone() }
        })
    }

    /// Whether the surface can receive light from the light and from the mirror of its virtual
    /// image.
    fn is_lit_by(&self, light: &Light) -> bool {
        let reaches_before =
            |(normal, point): (DVec3, DVec3)| self.corners.iter().any(|corner| normal.dot(*corner - point) > 0.0);
        let last = light.virtual_sources.first().filter(|last| last.redirection.is_none());
        light.form.plane().is_none_or(reaches_before)
            && last.is_none_or(|last| reaches_before((last.normal, last.point)))
    }

    /// Displacements that make virtual images of a light.
    fn ways(&self, light: &Light) -> Vec<(DVec3, Option<Redirection>)> {
        let is_distant = light.radius.is_infinite();
        let Some(prism) = self.prism else {
            let in_front = if is_distant {
                self.normal.dot(light.center) > 0.0
            } else {
                self.normal.dot(light.center - self.point) > -light.radius
            };
            return if in_front { vec![(self.normal * -2.0, None)] } else { Vec::new() };
        };
        let arriving = if is_distant { -light.center } else { self.middle - light.center };
        let Some(direction) = arriving.try_normalize() else { return Vec::new() };
        let distance = if is_distant { f64::MAX } else { arriving.length() };
        let ray = Ray { origin: self.middle - direction, direction };
        let interaction = SurfaceInteraction::new(&ray, self.middle, self.normal, distance, distance);
        let mut scratch = Scratch::default();
        let target = light.center;
        (0..prism.faces)
            .filter_map(|face| {
                let shift = prism.shift(face, &interaction, self.normal, &mut scratch)?;
                Some((shift, Some(Redirection { face, target, is_distant })))
            })
            .collect()
    }
}
