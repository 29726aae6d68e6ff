//! Hits do not depend on the builder.

use glam::{DMat3, DVec3};
use radsight_accel::{Builder, Geometry, PrimitiveId, Ray, ShaderId, ShaderTable, Substance};
use radsight_ir::{
    Cube, Facing, Instance, Material, Mesh, MeshInstance, MeshTriangle, Modifier, ModifierHandle, ModifierKind,
    OctreeScene, Rgb, Scene, Shape, Sphere, Surface, Transform,
};
use std::sync::Arc;

/// Random numbers in 0…1 (Marsaglia, "Xorshift RNGs", Journal of Statistical Software 8(14), 2003).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A point of the cube from −1 to 1.
    fn point(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| 2.0 * self.next() - 1.0))
    }

    /// A triangle near a point; sizes vary by a factor of a hundred.
    fn triangle(&mut self) -> [DVec3; 3] {
        let (center, size) = (self.point(), 0.003 * 100.0_f64.powf(self.next()));
        [(); 3].map(|()| center + size * self.point())
    }
}

/// Every third material is opaque, the others are transparent or missing.
fn substance(_: &Scene, modifier: Option<ModifierHandle>) -> Substance {
    match modifier.map(|handle| handle.index() % 3) {
        None => Substance::Nothing,
        Some(0) => Substance::Opaque,
        Some(_) => Substance::Transparent,
    }
}

fn add(scene: &mut Scene, modifier: Option<ModifierHandle>, shape: Shape) {
    let name = scene.names.add("surface");
    scene.surfaces.add(Surface { name, span: None, modifier, shape });
}

fn polygon(scene: &mut Scene, modifier: ModifierHandle, vertices: &[DVec3]) {
    let start = scene.vertices.len() as u32;
    scene.vertices.extend_from_slice(vertices);
    add(scene, Some(modifier), Shape::Polygon { start, count: vertices.len() as u32 });
}

fn modifiers(scene: &mut Scene) -> [ModifierHandle; 6] {
    [(); 6].map(|()| {
        let name = scene.names.add("material");
        let kind = ModifierKind::Material(Material::Light { radiance: Rgb([1.0; 3]) });
        scene.modifiers.add(Modifier { name, span: None, modifier: None, kind })
    })
}

fn mesh(numbers: &mut Numbers, count: usize) -> Mesh {
    let vertices = (0..count).flat_map(|_| numbers.triangle()).collect();
    let triangle = |index: usize| MeshTriangle {
        vertices: [0, 1, 2].map(|corner| (3 * index + corner) as u32),
        smooth: false,
        textured: false,
        modifier: None,
    };
    let triangles = (0..count).map(triangle).collect();
    Mesh { file: String::new(), cube: Cube::default(), vertices, normals: Vec::new(), uvs: Vec::new(), triangles }
}

fn random_transform(numbers: &mut Numbers) -> Transform {
    let rotation = DMat3::from_rotation_y(numbers.next()) * DMat3::from_rotation_x(numbers.next());
    Transform { rotation, scale: 0.2 + numbers.next(), translation: numbers.point() }
}

/// Triangles, some of them coincident with other materials, quadrilaterals in a common plane,
/// spheres, meshes and instances.
fn scene(numbers: &mut Numbers) -> Scene {
    let mut scene = Scene::default();
    let materials = modifiers(&mut scene);
    for index in 0..3000 {
        let triangle = numbers.triangle();
        polygon(&mut scene, materials[index % 6], &triangle);
        if index % 5 == 0 {
            polygon(&mut scene, materials[(index / 5) % 6], &triangle);
        }
    }
    for index in 0..200 {
        let (low, size) = (numbers.point() * DVec3::new(1.0, 1.0, 0.0), 0.3 * numbers.next());
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y].map(|corner| low + size * corner);
        polygon(&mut scene, materials[index % 6], &corners);
    }
    for index in 0..100 {
        let sphere = Sphere { center: numbers.point(), radius: 0.1 * numbers.next() + 1e-3, facing: Facing::Outward };
        let handle = scene.spheres.add(sphere);
        add(&mut scene, Some(materials[index % 6]), Shape::Sphere(handle));
    }
    let handle = scene.meshes.add(mesh(numbers, 700));
    for _ in 0..5 {
        let placing = MeshInstance { mesh: handle, to_scene: random_transform(numbers) };
        let placing = scene.mesh_instances.add(placing);
        add(&mut scene, Some(materials[0]), Shape::Mesh(placing));
    }
    scene
}

/// The bits of the first hit, and whether there is an occluder before a distance.
type TraceResult = (Option<(u64, usize, ShaderId, [u64; 6])>, bool);

fn traced(numbers: &mut Numbers, scene: &radsight_ir::ValidScene, geometry: &Geometry) -> Vec<TraceResult> {
    let octrees = scene.octrees.items().iter().map(|octree| table(&octree.scene, Vec::new())).collect();
    let shaders = table(scene, octrees);
    let tell = |_| {
        let ray = Ray::new(2.0 * numbers.point(), numbers.point()).expect("a direction");
        let hit = geometry.first_hit(scene, &shaders, &ray, None).map(|hit| {
            let [point, front] = [hit.point, hit.front].map(|vector| vector.to_array().map(f64::to_bits));
            let place = std::array::from_fn(|axis| if axis < 3 { point[axis] } else { front[axis - 3] });
            (hit.distance.to_bits(), hit.surface.index(), hit.shader, place)
        });
        let distance = numbers.next();
        (
            hit,
            geometry.any_between(scene, &ray, (None, PrimitiveId::NONE), distance, |crossing| crossing.distance > 0.1),
        )
    };
    (0..4000).map(tell).collect()
}

fn table(scene: &Scene, octrees: Vec<Arc<ShaderTable>>) -> Arc<ShaderTable> {
    Arc::new(ShaderTable::new((0..=scene.modifiers.len() as u32).map(ShaderId).collect(), octrees))
}

#[test]
fn hits_are_equal_bits_with_every_builder() {
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    let inner = Arc::new(scene(&mut numbers));
    let mut outer = scene(&mut numbers);
    let octree = OctreeScene { file: String::new(), cube: Cube::default(), scene: inner };
    let octree = outer.octrees.add(octree);
    for _ in 0..4 {
        let to_scene = random_transform(&mut numbers);
        let handle = outer.instances.add(Instance { octree, to_scene });
        add(&mut outer, None, Shape::Instance(handle));
    }
    let scene = outer.validate().expect("the scene is valid").scene;
    let [quick, thorough] = [Builder::Quick, Builder::Thorough]
        .map(|builder| Geometry::build(&scene, substance, |_| true, builder).expect("few surfaces"));
    let order = |geometry: &Geometry| geometry.members().map(|(_, surface)| surface.index()).collect::<Vec<_>>();
    assert_ne!(order(&quick), order(&thorough), "the builders should differ");
    let listed =
        |geometry: &Geometry| geometry.listed_members().map(|(_, surface)| surface.index()).collect::<Vec<_>>();
    assert_eq!((listed(&quick), listed(&thorough)), (order(&quick), order(&quick)));
    let [quick, thorough] = [quick, thorough].map(|geometry| traced(&mut Numbers(7), &scene, &geometry));
    assert!(quick.iter().filter(|(hit, _)| hit.is_some()).count() > 1000);
    let differing = quick.iter().zip(&thorough).filter(|(one, other)| one != other).count();
    assert_eq!(differing, 0);
}

#[test]
fn degenerate_arrangements_are_built_and_hit() {
    let coincident: Vec<[DVec3; 3]> = vec![[DVec3::ZERO, DVec3::X, DVec3::Y]; 3000];
    let shrinking: Vec<[DVec3; 3]> = (0..900)
        .map(|index| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|corner| corner * 0.5_f64.powf(f64::from(index) / 9.0)))
        .collect();
    let flat: Vec<[DVec3; 3]> = (0..2000)
        .map(|index| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|corner| corner + DVec3::X * f64::from(index)))
        .collect();
    let huge: Vec<[DVec3; 3]> = (0..2000)
        .map(|index| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|corner| corner * 1e30 * f64::from(index + 1)))
        .collect();
    for (triangles, size) in [(coincident, 1.0), (shrinking, 1.0), (flat, 1.0), (huge, 1e30)] {
        let mut scene = Scene::default();
        let materials = modifiers(&mut scene);
        triangles.iter().for_each(|triangle| polygon(&mut scene, materials[0], triangle));
        let scene = scene.validate().expect("the scene is valid").scene;
        let geometry = Geometry::build(&scene, substance, |_| true, Builder::Thorough).expect("few surfaces");
        let ray = Ray::new(size * DVec3::new(0.2, 0.3, 1.0), -DVec3::Z).expect("a direction");
        let distance = geometry.distance(&scene, &ray).expect("it is met");
        assert!((distance / size - 1.0).abs() < 1e-12, "{distance}");
    }
}
