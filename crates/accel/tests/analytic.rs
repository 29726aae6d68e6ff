//! Distances, form factors and the choice among coincident surfaces, compared with closed forms and
//! brute force.

use glam::{DMat3, DVec3};
use radsight_accel::{Builder, Geometry, PrimitiveId, Ray, ShaderId, ShaderTable, Substance};
use radsight_ir::{
    Cone, Cube, Facing, Instance, Material, Mesh, MeshInstance, MeshTriangle, Modifier, ModifierHandle, ModifierKind,
    OctreeScene, Rgb, Ring, Scene, Shape, Sphere, Surface, Transform, ValidScene,
};
use radsight_sampling::cosine_hemisphere;
use std::sync::Arc;

/// Modifiers with even handles count as opaque, others as transparent, whatever their materials.
fn substance(_: &Scene, modifier: Option<ModifierHandle>) -> Substance {
    match modifier {
        None => Substance::Nothing,
        Some(handle) if handle.index() % 2 == 0 => Substance::Opaque,
        Some(_) => Substance::Transparent,
    }
}

fn add(scene: &mut Scene, modifier: Option<ModifierHandle>, shape: Shape) {
    let name = scene.names.add("surface");
    scene.surfaces.add(Surface { name, span: None, modifier, shape });
}

fn modifier(scene: &mut Scene) -> ModifierHandle {
    let name = scene.names.add("material");
    let kind = ModifierKind::Material(Material::Light { radiance: Rgb([1.0; 3]) });
    scene.modifiers.add(Modifier { name, span: None, modifier: None, kind })
}

fn polygon(scene: &mut Scene, modifier: Option<ModifierHandle>, vertices: &[DVec3]) {
    let start = scene.vertices.len() as u32;
    scene.vertices.extend_from_slice(vertices);
    add(scene, modifier, Shape::Polygon { start, count: vertices.len() as u32 });
}

struct Built {
    scene: ValidScene,
    geometry: Geometry,
    shaders: ShaderTable,
}

impl Built {
    fn new(scene: Scene) -> Built {
        let scene = scene.validate().expect("the scene is valid").scene;
        let geometry = Geometry::build(&scene, substance, |_| true, Builder::Quick).expect("few surfaces");
        let shaders = table(&scene);
        Built { scene, geometry, shaders }
    }

    fn first(&self, origin: DVec3, direction: DVec3, from: Option<PrimitiveId>) -> Option<(f64, DVec3, ShaderId)> {
        let ray = Ray::new(origin, direction).expect("a direction");
        let hit = self.geometry.first_hit(&self.scene, &self.shaders, &ray, from)?;
        Some((hit.distance, hit.front, hit.shader))
    }

    fn distance(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        self.first(origin, direction, None).map(|(distance, ..)| distance)
    }
}

/// The shader of a surface without a modifier is 0, that of modifier n is n + 1.
fn table(scene: &Scene) -> ShaderTable {
    let octrees = scene.octrees.items().iter().map(|octree| Arc::new(table(&octree.scene))).collect();
    ShaderTable::new((0..=scene.modifiers.len() as u32).map(ShaderId).collect(), octrees)
}

/// Evenly distributed numbers in 0…1 (Roberts' R₂ and similar sequences).
fn scattered(index: u32, dimension: usize) -> f64 {
    (f64::from(index + 1) * [0.819_172_513, 0.671_043_607, 0.549_700_478, 0.450_295_000][dimension]).fract()
}

fn direction(index: u32) -> DVec3 {
    let z = 2.0 * scattered(index, 0) - 1.0;
    let (sin, cos) = (std::f64::consts::TAU * scattered(index, 1)).sin_cos();
    DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
}

#[test]
fn a_sphere_is_hit_where_the_closed_form_says() {
    let mut scene = Scene::default();
    let sphere = Sphere { center: DVec3::new(1.0, 2.0, 3.0), radius: 0.5, facing: Facing::Outward };
    let handle = scene.spheres.add(sphere);
    add(&mut scene, None, Shape::Sphere(handle));
    let built = Built::new(scene);
    for offset in [0.0_f64, 0.3, 0.499, 0.501] {
        let origin = DVec3::new(1.0 + offset, 2.0, 10.0);
        let expected = (offset < 0.5).then(|| 7.0 - (0.25 - offset * offset).sqrt());
        match (built.distance(origin, -DVec3::Z), expected) {
            (Some(found), Some(expected)) => assert!((found - expected).abs() < 1e-12, "{found} and {expected}"),
            (found, expected) => assert_eq!(found, expected),
        }
    }
}

#[test]
fn a_cone_is_hit_at_the_radius_of_its_height() {
    let mut scene = Scene::default();
    let cone = Cone { base: DVec3::ZERO, apex: DVec3::Z, base_radius: 2.0, apex_radius: 1.0, facing: Facing::Outward };
    let handle = scene.cones.add(cone);
    add(&mut scene, None, Shape::Cone(handle));
    let built = Built::new(scene);
    for height in [0.1, 0.5, 0.9] {
        let (distance, front, _) = built.first(DVec3::new(5.0, 0.0, height), -DVec3::X, None).expect("it is met");
        assert!((distance - (5.0 - (2.0 - height))).abs() < 1e-12);
        // The slope of the wall is 1, so its normal is half way between outward and up.
        assert!(front.distance(DVec3::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt())) < 1e-12);
    }
    assert_eq!(built.distance(DVec3::new(5.0, 0.0, 1.1), -DVec3::X), None);
}

#[test]
fn a_disk_has_its_analytic_form_factor() {
    // From a point of a surface that faces a parallel disk of radius r at height h: r²/(r² + h²).
    for (radius, height) in [(1.0, 1.0), (0.3, 1.0), (2.0, 0.5)] {
        let mut scene = Scene::default();
        let ring = Ring { center: DVec3::Z * height, normal: -DVec3::Z, inner_radius: 0.0, outer_radius: radius };
        let handle = scene.rings.add(ring);
        add(&mut scene, None, Shape::Ring(handle));
        let built = Built::new(scene);
        // The R₂ sequence (Roberts 2018): the rim could lie between two rows of a grid.
        let rays = 40_000;
        let found = (0..rays)
            .filter(|ray| {
                let [u, v] =
                    [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (f64::from(*ray) * step).fract());
                built.distance(DVec3::ZERO, DVec3::from_array(cosine_hemisphere(u, v))).is_some()
            })
            .count();
        let expected = radius * radius / (radius * radius + height * height);
        let share = found as f64 / f64::from(rays);
        assert!((share - expected).abs() < 1e-3, "{share} and {expected}");
    }
}

/// Distance to a triangle by Cramer's rule (Möller and Trumbore, Journal of Graphics Tools 2(1),
/// 1997).
fn to_triangle([a, b, c]: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    let t = origin - a;
    let u = t.dot(p) / determinant;
    let q = t.cross(ab);
    let (v, distance) = (direction.dot(q) / determinant, ac.dot(q) / determinant);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
}

fn soup(count: u32) -> Vec<[DVec3; 3]> {
    (0..count)
        .map(|index| {
            let center = DVec3::new(scattered(index, 0), scattered(index, 1), scattered(index, 2)) * 10.0;
            [0, 1, 2].map(|corner| center + direction(3 * index + corner) * (0.1 + scattered(index, 3)))
        })
        .collect()
}

fn nearest(triangles: &[[DVec3; 3]], origin: DVec3, direction: DVec3) -> Option<f64> {
    triangles.iter().filter_map(|triangle| to_triangle(*triangle, origin, direction)).reduce(f64::min)
}

fn agrees(found: Option<f64>, expected: Option<f64>) -> bool {
    match (found, expected) {
        (Some(found), Some(expected)) => (found - expected).abs() < 1e-9 * expected.max(1.0),
        (None, None) => true,
        _ => false,
    }
}

#[test]
fn the_hierarchy_agrees_with_brute_force() {
    let triangles = soup(500);
    let mut scene = Scene::default();
    triangles.iter().for_each(|triangle| polygon(&mut scene, None, triangle));
    let built = Built::new(scene);
    let wrong = (0..2000)
        .filter(|index| {
            let origin = DVec3::splat(5.0) + direction(index * 7 + 1) * 12.0;
            let towards = (DVec3::splat(5.0) + direction(index * 3 + 2) * 4.0 - origin).normalize();
            !agrees(built.distance(origin, towards), nearest(&triangles, origin, towards))
        })
        .count();
    assert_eq!(wrong, 0);
}

fn mesh_of(triangles: &[[DVec3; 3]]) -> Mesh {
    let triangle = |index: usize| MeshTriangle {
        vertices: [0, 1, 2].map(|corner| (3 * index + corner) as u32),
        smooth: false,
        textured: false,
        modifier: None,
    };
    Mesh {
        file: String::new(),
        cube: Cube::default(),
        vertices: triangles.iter().flatten().copied().collect(),
        normals: Vec::new(),
        uvs: Vec::new(),
        triangles: (0..triangles.len()).map(triangle).collect(),
    }
}

#[test]
fn an_instance_of_a_mesh_is_hit_at_its_transformed_triangles() {
    let triangles = soup(60);
    let placings = [0.5, 2.0].map(|scale| Transform {
        rotation: DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(scale),
        scale,
        translation: DVec3::new(3.0, -20.0 * scale, 1.0),
    });
    let mut inner = Scene::default();
    let mesh = inner.meshes.add(mesh_of(&triangles));
    let placed = inner.mesh_instances.add(MeshInstance { mesh, to_scene: placings[0] });
    add(&mut inner, None, Shape::Mesh(placed));
    let mut scene = Scene::default();
    let octree = scene.octrees.add(OctreeScene { file: String::new(), cube: Cube::default(), scene: Arc::new(inner) });
    for to_scene in placings {
        let handle = scene.instances.add(Instance { octree, to_scene });
        add(&mut scene, None, Shape::Instance(handle));
    }
    let built = Built::new(scene);
    let moved: Vec<[DVec3; 3]> = placings
        .iter()
        .flat_map(|outer| triangles.iter().map(|t| t.map(|corner| outer.point(placings[0].point(corner)))))
        .collect();
    // Two instances, and in each the placed mesh and its triangles.
    assert_eq!(built.geometry.primitive_count(), 2 + 2 * (1 + 60));
    let mut met = 0;
    for index in 0..1000 {
        let target = moved[index as usize % moved.len()].iter().sum::<DVec3>() / 3.0;
        let origin = target + direction(index) * 60.0;
        let towards = (target - origin).normalize();
        let found = built.distance(origin, towards);
        met += u32::from(found.is_some());
        assert!(agrees(found, nearest(&moved, origin, towards)), "ray {index}");
    }
    assert_eq!(met, 1000);
}

#[test]
fn a_ray_does_not_hit_its_own_flat_surface() {
    let square = |z: f64| [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, z));
    let mut scene = Scene::default();
    polygon(&mut scene, None, &square(0.0));
    polygon(&mut scene, None, &square(1.0));
    let built = Built::new(scene);
    let lower = built.geometry.members().find(|(_, surface)| surface.index() == 0).expect("a surface").0.primitive();
    // An origin that rounding has moved behind the surface would hit it.
    let origin = DVec3::new(0.1, 0.2, -1e-9);
    assert!(built.first(origin, DVec3::Z, Some(lower)).is_some_and(|(distance, ..)| distance > 0.5));
}

#[test]
fn of_coincident_surfaces_the_opaque_one_and_then_the_last_one_is_hit() {
    let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let met = |order: [usize; 2]| {
        let mut scene = Scene::default();
        let modifiers = [(); 4].map(|()| modifier(&mut scene));
        order.iter().for_each(|index| polygon(&mut scene, Some(modifiers[*index]), &square));
        let built = Built::new(scene);
        built.first(DVec3::Z, -DVec3::Z, None).map(|(_, _, shader)| shader)
    };
    for order in [[0, 1], [1, 0], [0, 3], [3, 0]] {
        assert_eq!(met(order), Some(ShaderId(1)), "opaque before transparent: {order:?}");
    }
    assert_eq!(met([0, 2]), Some(ShaderId(3)));
    assert_eq!(met([2, 0]), Some(ShaderId(3)));
    assert_eq!(met([3, 1]), Some(ShaderId(4)));
}
