//! Irradiance from lights against closed forms, and the densities that multiple importance sampling
//! needs.

use glam::DVec3;
use radsight_ir::{Cone, Facing, Ring, Scene, Shape, SolidAngle, Source, Sphere, Surface};
use radsight_light::{Light, LightForm, LobePeak, ReceiverCosine};
use std::f64::consts::PI;

/// The R₂ sequence (Roberts 2018).
fn points(count: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..count).map(|n| [0.754_877_666_246_692_8, 0.569_840_290_998_053_3].map(|step| (f64::from(n) * step).fract()))
}

fn light(scene: &mut Scene, shape: Shape) -> Light {
    let name = scene.names.add("light");
    let surface = scene.surfaces.add(Surface { name, span: None, modifier: None, shape });
    let form = LightForm::new(scene, shape).expect("it emits");
    let (center, radius) = form.bounding_sphere();
    Light {
        surface,
        primitive: None,
        form,
        center,
        radius,
        cone: None,
        dark_beyond: None,
        profile: None,
        max_distance: f64::INFINITY,
        focal_distance: 0.0,
        virtual_sources: Vec::new(),
    }
}

fn disk(radius: f64, height: f64) -> Light {
    let mut scene = Scene::default();
    let ring = Ring { center: DVec3::Z * height, normal: -DVec3::Z, inner_radius: 0.0, outer_radius: radius };
    let handle = scene.rings.add(ring);
    light(&mut scene, Shape::Ring(handle))
}

fn sphere(center: DVec3, radius: f64) -> Light {
    let mut scene = Scene::default();
    let handle = scene.spheres.add(Sphere { center, radius, facing: Facing::Outward });
    light(&mut scene, Shape::Sphere(handle))
}

fn polygon(vertices: &[DVec3]) -> Light {
    let mut scene = Scene { vertices: vertices.to_vec(), ..Scene::default() };
    light(&mut scene, Shape::Polygon { start: 0, count: vertices.len() as u32 })
}

fn cylinder() -> Light {
    let mut scene = Scene::default();
    let cone = Cone {
        base: DVec3::new(-1.0, 0.5, 2.0),
        apex: DVec3::new(1.0, 0.0, 2.5),
        base_radius: 0.3,
        apex_radius: 0.1,
        facing: Facing::Outward,
    };
    let handle = scene.cones.add(cone);
    light(&mut scene, Shape::Cone(handle))
}

fn sun(full_angle: f64) -> Light {
    let mut scene = Scene::default();
    let extent = SolidAngle { full_angle };
    let handle = scene.sources.add(Source { direction: DVec3::new(0.6, 0.0, 0.8), extent });
    light(&mut scene, Shape::Source(handle))
}

/// A lobe towards a direction beside the light: it changes the density, but not the mean.
const PEAK: LobePeak =
    LobePeak { axis: DVec3::new(0.28, 0.0, 0.96), width: 20.0, height: 3.0, floor: 0.1, ..LobePeak::NONE };

/// A constant lobe, and lobes of a surface that faces +z.
const PEAKS: [LobePeak; 4] = [
    LobePeak::NONE,
    PEAK,
    LobePeak { cosine: ReceiverCosine::Front(DVec3::Z), ..LobePeak::NONE },
    LobePeak { cosine: ReceiverCosine::Both(DVec3::Z), ..PEAK },
];

/// Irradiance at the origin on a surface that faces +z, for a radiance of one.
fn irradiance(light: &Light, peak: &LobePeak) -> f64 {
    const COUNT: u32 = 1 << 16;
    let sum: f64 = points(COUNT)
        .filter_map(|u| light.sample(DVec3::ZERO, u, peak))
        .map(|sample| sample.direction.z.max(0.0) / sample.pdf)
        .sum();
    sum / f64::from(COUNT)
}

fn agrees(light: &Light, expected: f64) {
    for peak in PEAKS {
        let found = irradiance(light, &peak);
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} and {expected}");
    }
}

#[test]
fn a_disk_gives_the_irradiance_of_its_form_factor() {
    for (radius, height) in [(0.01, 1.0), (1.0, 1.0), (3.0, 0.5)] {
        agrees(&disk(radius, height), PI * radius * radius / (radius * radius + height * height));
    }
}

#[test]
fn a_sphere_gives_the_irradiance_of_the_disk_at_its_rim() {
    for (distance, radius) in [(2.0, 0.1), (2.0, 1.5)] {
        agrees(&sphere(DVec3::Z * distance, radius), PI * (radius / distance) * (radius / distance));
    }
}

/// Lambert's formula for a polygon above the horizon: half the sum over its edges of angle times
/// cosine of the edge's plane.
fn lambert(vertices: &[DVec3]) -> f64 {
    let next = vertices.iter().cycle().skip(1);
    let edge = |(a, b): (&DVec3, &DVec3)| a.angle_between(*b) * a.cross(*b).normalize().z;
    0.5 * vertices.iter().zip(next).map(edge).sum::<f64>().abs()
}

#[test]
fn polygons_give_the_irradiance_of_lamberts_formula() {
    let square = [(-1.0, -0.5), (-1.0, 0.5), (1.0, 0.5), (1.0, -0.5)].map(|(x, y)| DVec3::new(x, y, 0.8 + 0.2 * x));
    let pentagon = [(0.0, 0.0), (0.2, 1.0), (1.0, 1.2), (1.5, 0.6), (0.9, -0.3)].map(|(x, y)| DVec3::new(x, y, 1.0));
    for vertices in [&square[..], &pentagon[..]] {
        agrees(&polygon(vertices), lambert(vertices));
    }
}

#[test]
fn a_distant_light_gives_its_projected_solid_angle() {
    // π·sin²(half angle) times the cosine of its centre, if all of it is above the horizon.
    for full_angle in [0.009_f64, 0.5] {
        let sin = (0.5 * full_angle).sin();
        agrees(&sun(full_angle), PI * sin * sin * 0.8);
    }
}

#[test]
fn samples_have_the_density_of_pdf_and_mis_weights_sum_to_one() {
    let lights = [
        disk(0.7, 1.0),
        sphere(DVec3::new(0.3, 0.2, 2.0), 0.8),
        cylinder(),
        sun(0.4),
        polygon(&[DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.3), DVec3::new(1.0, 0.0, 1.1)]),
    ];
    for light in &lights {
        for peak in PEAKS {
            for sample in points(200).filter_map(|u| light.sample(DVec3::ZERO, u, &peak)) {
                let cosine = -sample.direction.dot(sample.normal);
                let pdf = light.pdf(DVec3::ZERO, sample.direction, sample.distance, cosine, &peak);
                assert!((pdf / sample.pdf - 1.0).abs() < 1e-6, "{pdf} and {} of {:?}", sample.pdf, light.form);
                // The balance heuristic of light sampling and cosine sampling (Veach 1997).
                let by_cosine = sample.direction.z.max(0.0) / PI;
                let weights = [sample.pdf / (sample.pdf + by_cosine), by_cosine / (pdf + by_cosine)];
                assert!((weights[0] + weights[1] - 1.0).abs() < 1e-6);
            }
        }
    }
}
