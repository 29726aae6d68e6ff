//! Rays cannot leave closed surfaces.

use crate::double_double::{to_sphere, to_triangle};
use crate::geometry::{Built, polygon};
use crate::rays::Numbers;
use crate::table::{count, row};
use glam::{DMat3, DQuat, DVec3, EulerRot};
use radsight_ir::Transform;

/// A ball of triangles with displaced corners, far from any axis.
fn crumpled_ball(numbers: &mut Numbers, center: DVec3, size: f64) -> Vec<[DVec3; 3]> {
    let t = (1.0 + 5f64.sqrt()) / 2.0;
    let mut corners: Vec<DVec3> = [(-1.0, t), (1.0, t), (-1.0, -t), (1.0, -t)]
        .into_iter()
        .flat_map(|(a, b)| [DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)])
        .map(DVec3::normalize)
        .collect();
    let side = corners.iter().skip(1).map(|corner| corner.distance(corners[0])).fold(f64::INFINITY, f64::min) * 1.01;
    let near = |a: usize, b: usize, corners: &[DVec3]| a < b && corners[a].distance(corners[b]) < side;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in 0..12 {
            for c in 0..12 {
                if near(a, b, &corners) && near(b, c, &corners) && near(a, c, &corners) {
                    faces.push([a, b, c]);
                }
            }
        }
    }
    assert_eq!(faces.len(), 20);
    for _ in 0..2 {
        faces = split(&faces, &mut corners);
    }
    for corner in &mut corners {
        *corner = center + *corner * (size * numbers.within(0.6, 1.0));
    }
    faces.iter().map(|face| face.map(|corner| corners[corner])).collect()
}

/// Subdivides each face into four; the midpoints of sides are shared.
fn split(faces: &[[usize; 3]], corners: &mut Vec<DVec3>) -> Vec<[usize; 3]> {
    let mut middles = std::collections::BTreeMap::new();
    let mut middle = |a: usize, b: usize| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            corners.push((corners[a] + corners[b]).normalize());
            corners.len() - 1
        })
    };
    let mut four = Vec::new();
    for [a, b, c] in faces.iter().copied() {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        four.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    four
}

/// The target of a ray: on a face, an edge, or a corner.
fn target(numbers: &mut Numbers, [a, b, c]: [DVec3; 3], index: usize) -> DVec3 {
    let (u, v) = (numbers.share(), numbers.share());
    match index % 4 {
        0 => a,
        1 | 2 => a + (b - a) * u,
        _ => a + (b - a) * (u * (1.0 - v)) + (c - a) * (u * v),
    }
}

#[test]
fn closed_meshes() {
    let mut numbers = Numbers::new(1);
    for (name, center, size) in [
        ("about the origin", DVec3::ZERO, 1.0),
        ("1000 sizes from it", DVec3::new(1000.0, -700.0, 300.0), 1.0),
        ("of size 1e-9", DVec3::ZERO, 1e-9),
        ("of size 1e9", DVec3::new(2e9, 3e8, 0.0), 1e9),
    ] {
        let faces = crumpled_ball(&mut numbers, center, size);
        let text: String = faces.iter().enumerate().map(|(index, face)| polygon(index, face)).collect();
        let built = Built::new(&text);
        let rays = 200_000;
        let mut leaks = 0;
        for index in 0..rays {
            let origin = center + numbers.direction() * (0.4 * size * numbers.share());
            let face = faces[numbers.index(faces.len())];
            let direction = target(&mut numbers, face, index) - origin;
            leaks += usize::from(built.first(origin, direction).is_none());
        }
        count(&format!("closed mesh {name}"), "rays at its faces, edges and corners get out", rays, leaks);
        let mut worst: f64 = 0.0;
        for index in 0..2_000 {
            let origin = center + numbers.direction() * (0.4 * size * numbers.share());
            let face = faces[numbers.index(faces.len())];
            let direction = (target(&mut numbers, face, index) - origin).normalize();
            let exact =
                faces.iter().filter_map(|face| to_triangle(*face, origin, direction)).fold(f64::INFINITY, f64::min);
            let found = built.first(origin, direction).map_or(f64::INFINITY, |(distance, _)| distance);
            if exact.is_finite() {
                worst = worst.max((found - exact).abs() / size);
            }
        }
        row(
            &format!("closed mesh {name}"),
            "distance, against all triangles in double-double",
            tolerance(center, size),
            worst,
        );
    }
}

/// The rounding error of coordinates, relative to the size. Corners closer than this may be
/// exchanged.
fn tolerance(center: DVec3, size: f64) -> f64 {
    1e-12 * (1.0 + center.length() / size)
}

/// Points inside a solid, and points on its edges and seams.
struct Body {
    name: &'static str,
    text: String,
    inside: fn(&mut Numbers) -> DVec3,
    rim: fn(&mut Numbers) -> DVec3,
}

fn around(numbers: &mut Numbers, radius: f64, z: f64) -> DVec3 {
    let (sin, cos) = numbers.within(0.0, std::f64::consts::TAU).sin_cos();
    DVec3::new(radius * cos, radius * sin, z)
}

fn bodies() -> Vec<Body> {
    let inside = |numbers: &mut Numbers| {
        let z = numbers.within(0.05, 1.95);
        let radius = 0.9 * numbers.share();
        around(numbers, radius, z)
    };
    let in_cone = |numbers: &mut Numbers| {
        let z = numbers.within(0.05, 1.8);
        let radius = 0.9 * (1.0 - 0.5 * z) * numbers.share();
        around(numbers, radius, z)
    };
    let in_ball = |numbers: &mut Numbers| numbers.direction() * numbers.share();
    let rim = |numbers: &mut Numbers| {
        let z = [0.0, 2.0][numbers.index(2)];
        around(numbers, 1.0, z)
    };
    let cone_rim = |numbers: &mut Numbers| match numbers.index(4) {
        0 => DVec3::new(0.0, 0.0, 2.0),
        _ => around(numbers, 1.0, 0.0),
    };
    let frustum_rim = |numbers: &mut Numbers| match numbers.index(2) {
        0 => around(numbers, 0.5, 2.0),
        _ => around(numbers, 1.0, 0.0),
    };
    let in_frustum = |numbers: &mut Numbers| {
        let z = numbers.within(0.05, 1.95);
        let radius = 0.9 * (1.0 - 0.25 * z) * numbers.share();
        around(numbers, radius, z)
    };
    let end = "void ring a 0 0 8 0 0 0 0 0 -1 0 1\n";
    let ends = "void ring a 0 0 8 0 0 0 0 0 -1 0 1\nvoid ring b 0 0 8 0 0 2 0 0 1 0 1\n";
    let half = "void ring a 0 0 8 0 0 0 0 0 -1 0 1\nvoid ring b 0 0 8 0 0 2 0 0 1 0 .5\n";
    let parts =
        "void ring a 0 0 8 0 0 0 0 0 -1 0 .5\nvoid ring c 0 0 8 0 0 0 0 0 -1 .5 1\nvoid ring b 0 0 8 0 0 2 0 0 1 0 1\n";
    let inner_rim = |numbers: &mut Numbers| around(numbers, 0.5, 0.0);
    vec![
        Body {
            name: "sphere",
            text: "void sphere s 0 0 4 0 0 0 1\n".to_owned(),
            inside: in_ball,
            rim: |n| n.direction(),
        },
        Body {
            name: "bubble",
            text: "void bubble s 0 0 4 0 0 0 1\n".to_owned(),
            inside: in_ball,
            rim: |n| n.direction(),
        },
        Body { name: "cylinder and rings", text: format!("void cylinder s 0 0 7 0 0 0 0 0 2 1\n{ends}"), inside, rim },
        Body { name: "tube and rings", text: format!("void tube s 0 0 7 0 0 0 0 0 2 1\n{ends}"), inside, rim },
        Body {
            name: "cone and ring",
            text: format!("void cone s 0 0 8 0 0 0 0 0 2 1 0\n{end}"),
            inside: in_cone,
            rim: cone_rim,
        },
        Body {
            name: "cut cone and rings",
            text: format!("void cone s 0 0 8 0 0 0 0 0 2 1 .5\n{half}"),
            inside: in_frustum,
            rim: frustum_rim,
        },
        Body {
            name: "cup and rings",
            text: format!("void cup s 0 0 8 0 0 0 0 0 2 1 .5\n{half}"),
            inside: in_frustum,
            rim: frustum_rim,
        },
        Body {
            name: "ring in ring",
            text: format!("void cylinder s 0 0 7 0 0 0 0 0 2 1\n{parts}"),
            inside,
            rim: inner_rim,
        },
    ]
}

#[test]
fn curved_bodies() {
    let turned = DMat3::from_quat(DQuat::from_euler(EulerRot::XYZ, 0.5, 0.3, 1.0));
    let placed = |scale, translation| Transform { rotation: turned, translation, scale };
    for (place, to_scene) in [
        ("", Transform::IDENTITY),
        (", turned", placed(1.0, DVec3::ZERO)),
        (", 70 sizes away and small", placed(1e-9, DVec3::new(50.0, -70.0, 20.0) * 1e-9)),
        (", 1e6 sizes away", placed(1.0, DVec3::new(1e6, -2e5, 3e4))),
    ] {
        for Body { name, text, inside, rim } in bodies() {
            let built = Built::placed(&text, &to_scene);
            let mut numbers = Numbers::new(7);
            let (rays, mut leaks) = (60_000, 0);
            for index in 0..rays {
                let origin = inside(&mut numbers);
                let aim = if index % 3 == 0 { origin + numbers.direction() } else { rim(&mut numbers) };
                let [origin, aim] = [origin, aim].map(|point| to_scene.point(point));
                leaks += usize::from(aim != origin && built.first(origin, aim - origin).is_none());
            }
            count(&format!("{name}{place}"), "rays at its rims and all about get out", rays, leaks);
        }
    }
}

#[test]
fn spheres_are_met_where_higher_precision_says() {
    for (radius, center) in [(1e-12, 0.0), (1.0, 0.0), (1.0, 1e8), (1e12, 0.0), (1e12, 1e12)] {
        let center = DVec3::new(center, -center, 0.5 * center);
        let to_scene = Transform { translation: center, scale: radius, ..Transform::IDENTITY };
        let built = Built::placed("void sphere s 0 0 4 0 0 0 1\n", &to_scene);
        let mut numbers = Numbers::new(3);
        let (mut worst, mut missed): (f64, usize) = (0.0, 0);
        let rays = 100_000;
        for index in 0..rays {
            let inside = index % 2 == 0;
            let origin = center
                + numbers.direction()
                    * (radius * if inside { numbers.within(0.0, 0.99) } else { numbers.within(1.01, 100.0) });
            let aim = center + numbers.direction() * (radius * numbers.within(0.0, 0.9));
            let Some(direction) = (aim - origin).try_normalize() else { continue };
            let Some(exact) = to_sphere(center, radius, origin, direction) else { continue };
            let exact = if inside { exact[1] } else { exact[0] };
            match built.first(origin, direction) {
                Some((found, _)) => worst = worst.max((found - exact).abs() / (origin.distance(center) + radius)),
                None => missed += usize::from(exact > 0.0 && (aim - center).length() > 1e-9 * center.length()),
            }
        }
        let case = format!("sphere of radius {radius:.0e} at {:.0e}", center.length());
        count(&case, "rays at its inside miss it", rays, missed);
        row(
            &case,
            "distance, against double-double, over distance and radius",
            1e-14 * (1.0 + center.length() / radius),
            worst,
        );
    }
}
