//! Sizes, positions and shapes at the limits of number ranges.

use crate::geometry::{Built, polygon};
use crate::rays::Numbers;
use crate::table::{count, row};
use glam::DVec3;
use radsight_ir::Transform;

/// Surfaces of every kind.
const ROOM: &str = "
void polygon floor 0 0 12 -4 -4 0 4 -4 0 4 4 0 -4 4 0
void sphere ball 0 0 4 1 1 1 .75
void cylinder pipe 0 0 7 -2 0 .5 -1 2 1.5 .25
void cone hat 0 0 8 0 -2 0 0 -2 1.5 1 .25
void ring disk 0 0 8 2 -2 1 0 .6 .8 .25 1
void polygon kite 0 0 9 -3 -3 1 -1 -3.5 2 -2 -1 3
";

/// The largest error of ray hits relative to the untransformed room, in its own units, and the
/// number of rays with another hit.
fn against_the_room(scale: f64, offset: DVec3) -> (f64, usize) {
    let plain = Built::new(ROOM);
    let moved = Built::placed(ROOM, &Transform { translation: offset, scale, ..Transform::IDENTITY });
    let mut numbers = Numbers::new(11);
    let (mut worst, mut others): (f64, usize) = (0.0, 0);
    for _ in 0..RAYS {
        let origin = DVec3::new(numbers.within(-3.5, 3.5), numbers.within(-3.5, 3.5), numbers.within(0.5, 4.0));
        let direction = numbers.direction();
        let here = plain.first(origin, direction).map(|(distance, _)| distance);
        let there = moved.first(origin * scale + offset, direction).map(|(distance, _)| distance / scale);
        match (here, there) {
            (Some(here), Some(there)) if (here - there).abs() < 0.01 => worst = worst.max((here - there).abs()),
            (None, None) => {}
            _ => others += 1,
        }
    }
    (worst, others)
}

const RAYS: usize = 50_000;

#[test]
fn scales() {
    for exponent in [-9, -6, -3, 3, 6, 9] {
        // A power of two, so that no coordinate is rounded.
        let scale = 2f64.powf((f64::from(exponent) * 10f64.log2()).round());
        let (worst, others) = against_the_room(scale, DVec3::ZERO);
        count(&format!("room at scale 1e{exponent}"), "rays that meet something else", RAYS, others);
        row(&format!("room at scale 1e{exponent}"), "distance, against scale 1", 1e-11, worst);
    }
}

#[test]
fn offsets() {
    for sizes in [1e2, 1e5, 1e8] {
        let offset = DVec3::new(sizes, -sizes, sizes / 2.0);
        let (worst, others) = against_the_room(1.0, offset);
        // The rounding error of a coordinate there, times the amplification by oblique rays.
        let rounding = sizes * f64::EPSILON;
        let share = others as f64 / RAYS as f64;
        row(
            &format!("room {sizes:.0e} sizes away"),
            "distance, against none away, in roundings of a coordinate",
            1e4,
            worst / rounding,
        );
        row(
            &format!("room {sizes:.0e} sizes away"),
            "share of rays that meet something else",
            1e-4 + 1e5 * rounding,
            share,
        );
    }
}

/// A strip of adjacent triangles up to 10⁹ times as long as wide.
#[test]
fn needles() {
    for thin in [1e-3, 1e-6, 1e-9] {
        let mut text = String::new();
        let count_of = 400;
        for index in 0..count_of {
            let (low, high) = (f64::from(index) * thin, f64::from(index + 1) * thin);
            text += &polygon(
                2 * index as usize,
                &[DVec3::new(low, 0.0, 0.0), DVec3::new(high, 0.0, 0.0), DVec3::new(low, 1.0, 0.0)],
            );
            text += &polygon(
                2 * index as usize + 1,
                &[DVec3::new(high, 0.0, 0.0), DVec3::new(high, 1.0, 0.0), DVec3::new(low, 1.0, 0.0)],
            );
        }
        let built = Built::new(&text);
        let mut numbers = Numbers::new(5);
        let (mut missed, mut worst): (usize, f64) = (0, 0.0);
        for index in 0..RAYS {
            let column = f64::from(numbers.index(count_of as usize - 1) as u32 + 1);
            let x = if index % 2 == 0 { column * thin } else { numbers.within(0.0, f64::from(count_of) * thin) };
            let aim = DVec3::new(x, numbers.within(1e-3, 1.0 - 1e-3), 0.0);
            let origin = aim + DVec3::new(numbers.within(-1.0, 1.0) * thin, numbers.within(-0.5, 0.5), 1.0);
            // If rounding moves the target outside the strip, there need be no hit.
            let is_within = x > thin && x < f64::from(count_of - 1) * thin;
            match built.first(origin, aim - origin) {
                Some((distance, _)) => worst = worst.max((distance - origin.distance(aim)).abs()),
                None => missed += usize::from(is_within),
            }
        }
        count(&format!("needles {thin:.0e} wide"), "rays at the strip and its seams that miss", RAYS, missed);
        row(&format!("needles {thin:.0e} wide"), "distance", 1e-12, worst);
    }
}

/// For overlapping surfaces, a ray meets the first one, and shadow rays find both.
#[test]
fn nearly_coincident_surfaces() {
    for gap in [0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3] {
        let square = |z: f64| [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, z));
        let built = Built::new(&(polygon(0, &square(0.0)) + &polygon(1, &square(gap))));
        let mut numbers = Numbers::new(9);
        let (mut worst, mut open): (f64, usize) = (0.0, 0);
        for _ in 0..RAYS {
            let aim = DVec3::new(numbers.within(-0.9, 0.9), numbers.within(-0.9, 0.9), 0.0);
            let origin = aim + DVec3::new(numbers.within(-1.0, 1.0), numbers.within(-1.0, 1.0), 1.0);
            let slant = (origin - aim).length();
            let (distance, _) = built.first(origin, aim - origin).unwrap_or((f64::INFINITY, DVec3::Z));
            worst = worst.max((distance - slant * (1.0 - gap)).abs());
            open += usize::from(!built.is_blocked(origin, aim - (origin - aim)));
        }
        count(&format!("sheets {gap:.0e} apart"), "shadow rays that pass both", RAYS, open);
        // Within 1e-6 Radiance's rule selects either.
        let tolerance = if gap <= 1e-6 { 1.75 * gap + 1e-12 } else { 1e-12 };
        row(&format!("sheets {gap:.0e} apart"), "distance to the first", tolerance, worst);
    }
}

/// Rays in the plane of a polygon, and at angles of 89.9999° and closer to it.
#[test]
fn rays_along_faces() {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let built = Built::new(&polygon(0, &corners));
    for degrees in [89.9, 89.9999, 89.999_999] {
        let climb = (90.0_f64 - degrees).to_radians();
        let mut numbers = Numbers::new(2);
        let (mut worst, mut missed): (f64, usize) = (0.0, 0);
        for _ in 0..RAYS {
            let aim = DVec3::new(numbers.within(-0.9, 0.9), numbers.within(-0.9, 0.9), 0.0);
            let (sin, cos) = numbers.within(0.0, std::f64::consts::TAU).sin_cos();
            let away = DVec3::new(climb.cos() * cos, climb.cos() * sin, climb.sin()) * 5.0;
            match built.first(aim + away, -away) {
                Some((distance, _)) => worst = worst.max((distance - 5.0).abs()),
                None => missed += 1,
            }
        }
        count(&format!("rays at {degrees}° to a face"), "that miss it", RAYS, missed);
        row(
            &format!("rays at {degrees}° to a face"),
            "distance, in roundings over the angle's sine",
            64.0,
            worst * climb.sin() / f64::EPSILON,
        );
    }
    let mut numbers = Numbers::new(4);
    let wrong = (0..RAYS)
        .filter(|_| {
            let (sin, cos) = numbers.within(0.0, std::f64::consts::TAU).sin_cos();
            let hit = built.first(DVec3::new(-3.0 * cos, -3.0 * sin, 0.0), DVec3::new(cos, sin, 0.0));
            hit.is_some_and(|(distance, _)| !(1.5..4.5).contains(&distance))
        })
        .count();
    count("rays in the plane of a face", "that meet it where it is not", RAYS, wrong);
}
