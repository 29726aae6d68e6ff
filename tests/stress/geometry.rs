//! Scene text for intersection tests, without light or materials.

use glam::DVec3;
use radsight_accel::{Builder, Geometry, PrimitiveId, Ray, ShaderId, ShaderTable, Substance};
use radsight_ir::{Cone, Ring, Scene, Shape, Sphere, Surface, Transform, ValidScene};
use radsight_loader::MemoryLoader;
use radsight_parse::{Input, ReadOptions, read_scene};

pub(crate) struct Built {
    scene: ValidScene,
    geometry: Geometry,
    shaders: ShaderTable,
}

impl Built {
    /// The geometry of surfaces with `void`.
    pub(crate) fn new(text: &str) -> Built {
        Built::of(read(text))
    }

    /// The same, translated and scaled in double precision: text has fewer digits, and no sphere of
    /// a millionth.
    pub(crate) fn placed(text: &str, to_scene: &Transform) -> Built {
        let Scene { names, surfaces, vertices, spheres, cones, rings, .. } = read(text);
        let mut moved =
            Scene { names, vertices: vertices.iter().map(|at| to_scene.point(*at)).collect(), ..Scene::default() };
        for surface in surfaces.items() {
            let shape = match surface.shape {
                Shape::Sphere(handle) => {
                    let Sphere { center, radius, facing } = spheres[handle];
                    let (center, radius) = (to_scene.point(center), radius * to_scene.scale);
                    Shape::Sphere(moved.spheres.add(Sphere { center, radius, facing }))
                }
                Shape::Cone(handle) => {
                    let Cone { base, apex, base_radius, apex_radius, facing } = cones[handle];
                    let [base, apex] = [base, apex].map(|end| to_scene.point(end));
                    let [base_radius, apex_radius] = [base_radius, apex_radius].map(|radius| radius * to_scene.scale);
                    Shape::Cone(moved.cones.add(Cone { base, apex, base_radius, apex_radius, facing }))
                }
                Shape::Ring(handle) => {
                    let Ring { center, normal, inner_radius, outer_radius } = rings[handle];
                    let (center, normal) = (to_scene.point(center), to_scene.direction(normal).normalize());
                    let [inner_radius, outer_radius] =
                        [inner_radius, outer_radius].map(|radius| radius * to_scene.scale);
                    Shape::Ring(moved.rings.add(Ring { center, normal, inner_radius, outer_radius }))
                }
                shape => shape,
            };
            moved.surfaces.add(Surface { shape, ..surface.clone() });
        }
        Built::of(moved)
    }

    fn of(scene: Scene) -> Built {
        let scene = scene.validate().expect("the scene is valid").scene;
        let geometry =
            Geometry::build(&scene, |_, _| Substance::Opaque, |_| true, Builder::Quick).expect("few surfaces");
        let shaders = ShaderTable::new((0..=scene.modifiers.len() as u32).map(ShaderId).collect(), Vec::new());
        Built { scene, geometry, shaders }
    }

    /// Distance and unit normal of the first surface.
    pub(crate) fn first(&self, origin: DVec3, direction: DVec3) -> Option<(f64, DVec3)> {
        let ray = Ray::new(origin, direction).expect("a direction");
        let hit = self.geometry.first_hit(&self.scene, &self.shaders, &ray, None)?;
        Some((hit.distance, hit.front))
    }

    /// Whether anything occludes the segment between two points.
    pub(crate) fn is_blocked(&self, from: DVec3, to: DVec3) -> bool {
        let ray = Ray::new(from, to - from).expect("a direction");
        self.geometry.any_between(&self.scene, &ray, (None, PrimitiveId::NONE), from.distance(to), |_| true)
    }
}

fn read(text: &str) -> Scene {
    let input = Input::Text { name: "stress.rad".to_owned(), text: text.as_bytes().into() };
    let read = read_scene(&[input], &MemoryLoader::default(), &ReadOptions::default());
    assert!(!read.has_errors(), "{}", read.render(5));
    read.scene
}

/// A polygon of scene text.
pub(crate) fn polygon(name: usize, corners: &[DVec3]) -> String {
    let numbers: String =
        corners.iter().map(|corner| format!(" {:e} {:e} {:e}", corner.x, corner.y, corner.z)).collect();
    format!("void polygon p{name} 0 0 {}{numbers}\n", 3 * corners.len())
}
