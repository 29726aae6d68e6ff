//! Scenes without text, for tests.

use glam::DVec3;
use radsight_ir::{
    Cone, Glossy, Material, Modifier, ModifierHandle, ModifierKind, Rgb, Ring, Scene, Shape, SolidAngle, Source,
    Sphere, Substitute, Surface,
};
use radsight_render::{NoModels, Ray, RenderOptions, RenderPlan, Renderer};

/// A scene that grows.
#[derive(Clone, Default)]
pub(crate) struct Builder(Scene);

impl Builder {
    pub(crate) fn material(&mut self, material: Material) -> ModifierHandle {
        let name = self.0.names.add("material");
        self.0.modifiers.add(Modifier { name, span: None, modifier: None, kind: ModifierKind::Material(material) })
    }

    pub(crate) fn light(&mut self, radiance: [f64; 3]) -> ModifierHandle {
        self.material(Material::Light { radiance: Rgb(radiance) })
    }

    pub(crate) fn glow(&mut self, radiance: [f64; 3], max_radius: f64) -> ModifierHandle {
        self.material(Material::Glow { radiance: Rgb(radiance), max_radius })
    }

    pub(crate) fn plastic(&mut self, color: [f64; 3], specularity: f64, roughness: f64) -> ModifierHandle {
        self.material(Material::Plastic(Glossy { color: Rgb(color), specularity, roughness }))
    }

    pub(crate) fn metal(&mut self, color: [f64; 3], specularity: f64, roughness: f64) -> ModifierHandle {
        self.material(Material::Metal(Glossy { color: Rgb(color), specularity, roughness }))
    }

    pub(crate) fn mirror(&mut self, reflectance: [f64; 3]) -> ModifierHandle {
        self.material(Material::Mirror { reflectance: Rgb(reflectance), substitute: Substitute::Own })
    }

    pub(crate) fn glass(&mut self, transmissivity: [f64; 3], refractive_index: f64) -> ModifierHandle {
        self.material(Material::Glass { transmissivity: Rgb(transmissivity), refractive_index })
    }

    fn surface(&mut self, modifier: ModifierHandle, shape: Shape) {
        let name = self.0.names.add("surface");
        self.0.surfaces.add(Surface { name, span: None, modifier: Some(modifier), shape });
    }

    pub(crate) fn polygon(&mut self, modifier: ModifierHandle, vertices: &[DVec3]) {
        let start = self.0.vertices.len() as u32;
        self.0.vertices.extend_from_slice(vertices);
        self.surface(modifier, Shape::Polygon { start, count: vertices.len() as u32 });
    }

    pub(crate) fn sphere(&mut self, modifier: ModifierHandle, sphere: Sphere) {
        let handle = self.0.spheres.add(sphere);
        self.surface(modifier, Shape::Sphere(handle));
    }

    pub(crate) fn ring(&mut self, modifier: ModifierHandle, ring: Ring) {
        let handle = self.0.rings.add(ring);
        self.surface(modifier, Shape::Ring(handle));
    }

    pub(crate) fn cone(&mut self, modifier: ModifierHandle, cone: Cone) {
        let handle = self.0.cones.add(cone);
        self.surface(modifier, Shape::Cone(handle));
    }

    pub(crate) fn source(&mut self, modifier: ModifierHandle, direction: DVec3, full_angle: f64) {
        let handle = self.0.sources.add(Source { direction, extent: SolidAngle { full_angle } });
        self.surface(modifier, Shape::Source(handle));
    }
}

/// The red band of rays 0…count of one place and direction.
pub(crate) fn values(
    scene: &Builder,
    options: RenderOptions,
    origin: DVec3,
    direction: DVec3,
    count: usize,
) -> Vec<f64> {
    let valid = scene.0.clone().validate().expect("the test's scene is valid");
    let plan = RenderPlan::new(valid.scene, options, &NoModels).expect("the test's scene can be rendered");
    let ray = Ray::new(origin, direction).expect("the test's ray is one");
    let traced = Renderer::new(plan).trace_all(0, &vec![Some(ray); count]);
    traced.iter().map(|traced| traced.expect("every ray is answered").value[0]).collect()
}

/// The mean of [`values`].
pub(crate) fn mean(scene: &Builder, options: RenderOptions, origin: DVec3, direction: DVec3, count: usize) -> f64 {
    values(scene, options, origin, direction, count).iter().sum::<f64>() / count as f64
}
