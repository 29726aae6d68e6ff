//! Outlines of lights: a few points in whose convex hull lies all that a point sees of a light.

use crate::form::LightForm;
use glam::DVec3;
use radsight_ir::Facing;
use std::f64::consts::{PI, TAU};

/// Corners of the polygon around a circle.
const CORNERS: usize = 64;

/// Parts into which a cone is divided along its axis, for projections that curve it.
const PARTS: usize = 8;

/// Sine of a distant light's half angle above which it has no outline.
const MAX_DISTANT_SINE: f64 = 0.5;

impl LightForm {
    /// The outline as seen from a point, scene units; unit directions for a distant light. Empty
    /// where there is none: within a sphere, and for a large part of the sky.
    #[must_use]
    pub fn outline(&self, from: DVec3) -> Vec<DVec3> {
        match self {
            LightForm::Disk { center, x, y, outer_squared, .. } => {
                let radius = outer_squared.sqrt();
                around(*center, *x * radius, *y * radius).collect()
            }
            LightForm::Parallelogram { corner, x, y, .. } => {
                vec![*corner, *corner + *x, *corner + *x + *y, *corner + *y]
            }
            LightForm::Polygon { polygon, .. } => polygon.triangles().iter().flatten().copied().collect(),
            LightForm::Sphere { center, radius, facing: Facing::Outward } => tangents(*center, *radius, from),
            LightForm::Sphere { .. } | LightForm::DistantImage { .. } => Vec::new(),
            LightForm::Cone { base, axis, length, radii, .. } => {
                let (x, y) = axis.any_orthonormal_pair();
                let circle = |part: usize| {
                    let share = part as f64 / PARTS as f64;
                    let radius = radii[0] + (radii[1] - radii[0]) * share;
                    around(*base + *axis * (share * length), x * radius, y * radius)
                };
                (0..=PARTS).flat_map(circle).collect()
            }
            LightForm::Distant { direction, x, y, half_angle_sin_squared_half } => {
                let cosine = 1.0 - 2.0 * half_angle_sin_squared_half;
                let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                if cosine <= 0.0 || sine > MAX_DISTANT_SINE {
                    return Vec::new();
                }
                let tangent = sine / cosine;
                around(*direction, *x * tangent, *y * tangent).map(DVec3::normalize).collect()
            }
        }
    }

    /// Points on the edge of the hole of a ring, scene units, whose convex hull is free of light.
    /// Empty where there is none.
    #[must_use]
    pub fn hole(&self) -> Vec<DVec3> {
        match self {
            LightForm::Disk { center, x, y, inner_squared, .. } if *inner_squared > 0.0 => {
                let radius = inner_squared.sqrt();
                circle(*center, *x * radius, *y * radius).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The share of the area in its outline that the light covers, where it is round; else 1. That of
    /// a ring with a hole depends on how much of the hole is in the view, so it is 1.
    #[must_use]
    pub fn share_of_outline(&self) -> f64 {
        match self {
            LightForm::Disk { inner_squared, .. } if *inner_squared > 0.0 => 1.0,
            LightForm::Disk { .. } | LightForm::Sphere { .. } | LightForm::Distant { .. } => {
                let half_angle = PI / CORNERS as f64;
                half_angle / half_angle.tan()
            }
            _ => 1.0,
        }
    }
}

/// The corners of a polygon around an ellipse with these half axes.
fn around(center: DVec3, x: DVec3, y: DVec3) -> impl Iterator<Item = DVec3> {
    let stretch = (PI / CORNERS as f64).cos().recip();
    circle(center, x * stretch, y * stretch)
}

/// Points on an ellipse with these half axes.
fn circle(center: DVec3, x: DVec3, y: DVec3) -> impl Iterator<Item = DVec3> {
    (0..CORNERS).map(move |corner| {
        let (sine, cosine) = (corner as f64 * TAU / CORNERS as f64).sin_cos();
        center + x * cosine + y * sine
    })
}

/// A polygon around the circle in which the tangents from a point touch a sphere.
fn tangents(center: DVec3, radius: f64, from: DVec3) -> Vec<DVec3> {
    let to_eye = from - center;
    let distance = to_eye.length();
    if distance <= radius {
        return Vec::new();
    }
    let axis = to_eye / distance;
    let along = radius * radius / distance;
    let (x, y) = axis.any_orthonormal_pair();
    let half = (radius * radius - along * along).max(0.0).sqrt();
    around(center + axis * along, x * half, y * half).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a direction lies within the convex hull of others, all around the first one's side:
    /// no plane through the eye separates it from them.
    fn is_within(direction: DVec3, outline: &[DVec3]) -> bool {
        let (x, y) = direction.any_orthonormal_pair();
        (0..720).all(|step| {
            let (sine, cosine) = (f64::from(step) * TAU / 720.0).sin_cos();
            let side = x * cosine + y * sine;
            outline.iter().any(|at| side.dot(at.normalize()) > -1e-9)
        })
    }

    #[test]
    fn outlines_hold_what_is_seen_of_a_light() {
        let center = DVec3::new(0.3, -0.2, 2.0);
        let disk = |normal: DVec3| {
            let (x, y) = normal.any_orthonormal_pair();
            LightForm::Disk { center, normal, x, y, inner_squared: 0.0, outer_squared: 0.3 }
        };
        let cone =
            |radii| LightForm::Cone { base: center, axis: DVec3::X, length: 1.5, radii, facing: Facing::Outward };
        let forms = [
            LightForm::Sphere { center, radius: 0.7, facing: Facing::Outward },
            cone([0.3; 2]),
            cone([0.5, 0.1]),
            disk(-DVec3::Z),
            LightForm::Parallelogram { corner: center, x: DVec3::X, y: -2.0 * DVec3::Y, normal: -DVec3::Z, area: 2.0 },
            LightForm::Distant { direction: DVec3::Z, x: DVec3::X, y: DVec3::Y, half_angle_sin_squared_half: 0.01 },
        ];
        for form in &forms {
            for from in [DVec3::ZERO, DVec3::new(3.0, 0.4, 0.1), DVec3::new(-0.3, -2.0, 1.2)] {
                let shift = if form.area().is_infinite() { DVec3::ZERO } else { from };
                let outline: Vec<DVec3> = form.outline(from).iter().map(|at| *at - shift).collect();
                for step in 0..400 {
                    let u = [f64::from(step % 20) / 19.0, f64::from(step / 20) / 19.0];
                    let Some(sample) = form.sample(from, u, DVec3::ZERO) else { continue };
                    assert!(is_within(sample.direction, &outline), "{form:?} from {from}: {}", sample.direction);
                }
            }
        }
    }

    #[test]
    fn a_disk_covers_its_share_of_its_outline() {
        let disk = LightForm::Disk {
            center: DVec3::ZERO,
            normal: DVec3::Z,
            x: DVec3::X,
            y: DVec3::Y,
            inner_squared: 0.0,
            outer_squared: 4.0,
        };
        let outline = disk.outline(DVec3::Z);
        let next = outline.iter().cycle().skip(1);
        let area: f64 = outline.iter().zip(next).map(|(from, to)| 0.5 * from.cross(*to).z).sum();
        assert!((area * disk.share_of_outline() - 4.0 * PI).abs() < 1e-12, "{area}");
    }

    #[test]
    fn the_sky_and_a_sphere_around_the_eye_have_no_outline() {
        let sky =
            LightForm::Distant { direction: DVec3::Z, x: DVec3::X, y: DVec3::Y, half_angle_sin_squared_half: 0.5 };
        let sphere = LightForm::Sphere { center: DVec3::ZERO, radius: 1.0, facing: Facing::Outward };
        assert!(sky.outline(DVec3::ZERO).is_empty() && sphere.outline(DVec3::new(0.5, 0.0, 0.0)).is_empty());
    }
}
