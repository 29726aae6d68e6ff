//! Scenes for tests, built without text.
#![allow(dead_code, reason = "each test binary builds other scenes")]

use glam::DVec3;
use radsight_cal::{Bindings, Definitions, Program, Root, Scope};
use radsight_diag::SourceMap;
use radsight_ir::{
    Cone, Cube, Dielectric, FunctionCall, Glossy, Instance, Material, Mesh, MeshInstance, Modifier, ModifierHandle,
    ModifierKind, OctreeScene, Pattern, Prism, PrismFace, Rgb, Ring, Scene, Shape, SolidAngle, Source, Sphere,
    Substitute, Surface, Texture, Transform,
};
use radsight_render::{NoModels, Ray, RenderOptions, RenderPlan, Renderer, Traced};
use std::sync::Arc;

/// A scene under construction.
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

    /// Retroreflective sheeting: a highlight about the viewer's direction, and nothing else.
    pub(crate) fn sheeting(&mut self, specularity: f64, roughness: f64) -> ModifierHandle {
        let name = self.0.names.add("to_viewer");
        let kind = ModifierKind::Texture(Texture::Function(call(&["-Dx-Nx", "-Dy-Ny", "-Dz-Nz"])));
        let texture = self.0.modifiers.add(Modifier { name, span: None, modifier: None, kind });
        let name = self.0.names.add("sheeting");
        let kind = ModifierKind::Material(Material::Plastic(Glossy { color: Rgb([0.0; 3]), specularity, roughness }));
        self.0.modifiers.add(Modifier { name, span: None, modifier: Some(texture), kind })
    }

    pub(crate) fn spotlight(&mut self, radiance: [f64; 3], cone_angle: f64, direction: DVec3) -> ModifierHandle {
        self.material(Material::Spotlight { radiance: Rgb(radiance), cone_angle, direction, focal_distance: 0.0 })
    }

    pub(crate) fn mirror(&mut self, reflectance: [f64; 3]) -> ModifierHandle {
        self.material(Material::Mirror { reflectance: Rgb(reflectance), substitute: Substitute::Own })
    }

    pub(crate) fn glass(&mut self, transmissivity: [f64; 3], refractive_index: f64) -> ModifierHandle {
        self.material(Material::Glass { transmissivity: Rgb(transmissivity), refractive_index })
    }

    pub(crate) fn dielectric(&mut self, transmissivity: [f64; 3], refractive_index: f64) -> ModifierHandle {
        self.material(Material::Dielectric(Dielectric {
            transmissivity: Rgb(transmissivity),
            refractive_index,
            hartmann: 0.0,
        }))
    }

    fn surface(&mut self, modifier: ModifierHandle, shape: Shape) {
        self.any_surface(Some(modifier), shape);
    }

    fn any_surface(&mut self, modifier: Option<ModifierHandle>, shape: Shape) {
        let name = self.0.names.add("surface");
        self.0.surfaces.add(Surface { name, span: None, modifier, shape });
    }

    /// `void` as modifier keeps each triangle's own.
    pub(crate) fn mesh(&mut self, modifier: Option<ModifierHandle>, mesh: Mesh, to_scene: Transform) {
        let mesh = self.0.meshes.add(mesh);
        let handle = self.0.mesh_instances.add(MeshInstance { mesh, to_scene });
        self.any_surface(modifier, Shape::Mesh(handle));
    }

    /// `void` as modifier keeps each surface's own.
    pub(crate) fn instance(&mut self, modifier: Option<ModifierHandle>, scene: &Arc<Scene>, to_scene: Transform) {
        let known =
            self.0.octrees.iter().find(|(_, octree)| Arc::ptr_eq(&octree.scene, scene)).map(|(handle, _)| handle);
        let octree = known.unwrap_or_else(|| {
            self.0.octrees.add(OctreeScene { file: String::new(), cube: Cube::default(), scene: scene.clone() })
        });
        let handle = self.0.instances.add(Instance { octree, to_scene });
        self.any_surface(modifier, Shape::Instance(handle));
    }

    /// The scene, for instances in others.
    pub(crate) fn shared(self) -> Arc<Scene> {
        Arc::new(self.0)
    }

    /// A glow whose radiance is the value of an expression.
    pub(crate) fn glow_of(&mut self, expression: &str) -> ModifierHandle {
        self.patterned(expression, Material::Glow { radiance: Rgb::WHITE, max_radius: 0.0 })
    }

    /// A prism with one face: its coefficient and the components of its direction.
    pub(crate) fn prism(&mut self, expressions: [&str; 4]) -> ModifierHandle {
        self.material(Material::Prism(Prism { call: call(&expressions), faces: PrismFace::One }))
    }

    /// A material that is multiplied by the value of an expression.
    pub(crate) fn patterned(&mut self, expression: &str, material: Material) -> ModifierHandle {
        let call = call(&[expression]);
        let name = self.0.names.add("pattern");
        let kind = ModifierKind::Pattern(Pattern::BrightFunction(call));
        let pattern = self.0.modifiers.add(Modifier { name, span: None, modifier: None, kind });
        let name = self.0.names.add("patterned");
        let kind = ModifierKind::Material(material);
        self.0.modifiers.add(Modifier { name, span: None, modifier: Some(pattern), kind })
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

/// A call of expressions of the ray.
fn call(expressions: &[&str]) -> FunctionCall {
    let mut sources = SourceMap::default();
    let roots: Vec<Root<'_>> = expressions
        .iter()
        .map(|expression| {
            let source = sources.add("test", expression.as_bytes().to_vec(), None);
            Root::Expression { text: expression, span: sources.span(source, 0, expression.len()) }
        })
        .collect();
    let definitions = Definitions::with_initial_library();
    let program = Program::compile(&definitions, &Scope::global(), &roots, &Bindings::of_ray())
        .expect("the test's expressions are some");
    FunctionCall { program: Arc::new(program), to_scene: Transform::IDENTITY, words: Vec::new(), numbers: Vec::new() }
}

/// A square of this half width centred on the z axis, facing up.
pub(crate) fn square(half: f64, height: f64) -> [DVec3; 4] {
    [[half, half], [-half, half], [-half, -half], [half, -half]].map(|[x, y]| DVec3::new(x, y, height))
}

/// The red band of rays 0…count with the same origin and direction.
pub(crate) fn values(
    scene: &Builder,
    options: RenderOptions,
    origin: DVec3,
    direction: DVec3,
    count: usize,
) -> Vec<f64> {
    let ray = Ray::new(origin, direction).expect("the test's ray is one");
    traced(scene, options, &vec![ray; count]).iter().map(|traced| traced.value[0]).collect()
}

/// The results of rays.
pub(crate) fn traced(scene: &Builder, options: RenderOptions, rays: &[Ray]) -> Vec<Traced> {
    let rays: Vec<Option<Ray>> = rays.iter().copied().map(Some).collect();
    let traced = Renderer::new(plan(scene, options)).trace_all(0, &rays);
    traced.into_iter().map(|traced| traced.expect("every ray is answered")).collect()
}

pub(crate) fn plan(scene: &Builder, options: RenderOptions) -> RenderPlan {
    let valid = scene.0.clone().validate().expect("the test's scene is valid");
    RenderPlan::new(valid.scene, options, &NoModels).expect("the test's scene can be rendered")
}

/// The mean of [`values`].
pub(crate) fn mean(scene: &Builder, options: RenderOptions, origin: DVec3, direction: DVec3, count: usize) -> f64 {
    values(scene, options, origin, direction, count).iter().sum::<f64>() / count as f64
}
