//! The lights of a scene, for surfaces that become lights themselves (`l+`): their radiance must
//! include lights seen through them.

use crate::failure::Failure;
use crate::input::Planner;
use radsight_flux::{FluxSurface, IllumSurface, Shape as Form, Toward};
use radsight_ir::{Material, ModifierKind, Rgb, Scene, Shape, Surface, ValidScene};
use radsight_render::{Lights, Ray, RenderOptions, Renderer};

/// Computes light that arrives directly from lights, through panes alone.
///
/// Each ray towards a light is traced with and without visible lights: the difference is the
/// light's contribution.
#[derive(Debug)]
pub(super) struct LightFinder {
    lights: Vec<Toward>,
    seen: Renderer,
    unseen: Renderer,
}

impl LightFinder {
    /// `options` are those of the program.
    pub(super) fn new(
        options: &RenderOptions,
        scene: &ValidScene,
        planner: &Planner<'_>,
    ) -> Result<LightFinder, Failure> {
        let renderer = |lights, options| {
            let options = RenderOptions { lights, ..options };
            planner.plan(scene.clone(), options).map(Renderer::new)
        };
        let direct = RenderOptions { ambient_bounces: 0, ambient_value: Rgb::BLACK, ..options.clone() };
        Ok(LightFinder {
            lights: scene.surfaces.items().iter().filter_map(|surface| light(scene, surface)).collect(),
            seen: renderer(Lights::Visible, direct.clone())?,
            unseen: renderer(Lights::Invisible, direct)?,
        })
    }

    pub(super) fn renderers(&self) -> [&Renderer; 2] {
        [&self.seen, &self.unseen]
    }

    /// Adds direct light to the mean radiances of a surface's directions, with as many rays per
    /// light as per direction.
    pub(super) fn add(&self, surface: &IllumSurface, means: &mut [[f64; 3]]) {
        let rays = self
            .lights
            .iter()
            .flat_map(|light| (0..surface.samples()).filter_map(|number| surface.ray_to_light(light, number)));
        let rays: Vec<_> = rays.collect();
        let to_trace: Vec<Option<Ray>> =
            rays.iter().map(|ray| Some(Ray { origin: ray.origin, direction: ray.direction })).collect();
        let values = self.seen.trace_all(0, &to_trace).into_iter().zip(self.unseen.trace_all(0, &to_trace));
        for (ray, (seen, unseen)) in rays.iter().zip(values) {
            let (Some(seen), Some(unseen)) = (seen, unseen) else { continue };
            for (band, mean) in means[ray.cell].iter_mut().enumerate() {
                let light = (seen.value[band] - unseen.value[band]).max(0.0);
                *mean += light * ray.weight / surface.samples() as f64;
            }
        }
    }
}

/// A surface as the target of rays.
fn light(scene: &Scene, surface: &Surface) -> Option<Toward> {
    let material = scene.chain(surface.modifier).find_map(|(_, modifier)| match &modifier.kind {
        ModifierKind::Material(material) => Some(material),
        _ => None,
    });
    let shines = match material? {
        Material::Light { .. } | Material::Spotlight { .. } => true,
        Material::Glow { max_radius, .. } => *max_radius > 0.0,
        _ => false,
    };
    if !shines {
        return None;
    }
    match surface.shape {
        Shape::Polygon { start, count } => {
            let vertices = scene.polygon_vertices(start, count);
            let numbers: Vec<f64> = vertices.iter().flat_map(|vertex| vertex.to_array()).collect();
            FluxSurface::new("light", Form::Polygon, &numbers).ok().map(Toward::Surface)
        }
        Shape::Ring(ring) => {
            let ring = &scene.rings[ring];
            let (middle, normal) = (ring.center, ring.normal);
            let numbers =
                [middle.x, middle.y, middle.z, normal.x, normal.y, normal.z, ring.inner_radius, ring.outer_radius];
            FluxSurface::new("light", Form::Ring, &numbers).ok().map(Toward::Surface)
        }
        Shape::Sphere(sphere) => {
            let sphere = &scene.spheres[sphere];
            Some(Toward::Ball { middle: sphere.center, radius: sphere.radius })
        }
        Shape::Source(source) => {
            let source = &scene.sources[source];
            Some(Toward::Distant { direction: source.direction, cosine: (0.5 * source.extent.full_angle).cos() })
        }
        _ => None,
    }
}
