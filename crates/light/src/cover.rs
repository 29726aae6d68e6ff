//! Flat covers of lights: quadrangles behind which a point sees nothing of a light.

use crate::form::LightForm;
use glam::DVec3;
use radsight_accel::Shaft;
use radsight_ir::Facing;

impl LightForm {
    /// The corners of a quadrangle, one after the other: the light that a point sees lies in the
    /// pyramid between the two. None for a distant light and for other forms around the point.
    fn cover(&self, receiver: DVec3) -> Option<[DVec3; 4]> {
        match self {
            LightForm::Disk { center, x, y, outer_squared, .. } => {
                let radius = outer_squared.sqrt();
                Some(rectangle(*center, *x * radius, *y * radius))
            }
            LightForm::Parallelogram { corner, x, y, .. } => {
                Some(rectangle(*corner + (*x + *y) * 0.5, *x * 0.5, *y * 0.5))
            }
            LightForm::Polygon { polygon, normal } => cover_of_triangles(polygon.triangles(), *normal),
            LightForm::Sphere { center, radius, facing: Facing::Outward } => {
                let axis = *center - receiver;
                let half = width_of_tangents(*radius, axis.length())?;
                let (x, y) = axis.normalize().any_orthonormal_pair();
                Some(rectangle(*center, x * half, y * half))
            }
            // Of a tapered one more than half may be seen.
            LightForm::Cone { base, axis, length, radii, facing: Facing::Outward } if radii[0] == radii[1] => {
                cover_of_cylinder(receiver - *base, *axis, *length, radii[0])
                    .map(|corners| corners.map(|at| *base + at))
            }
            _ => None,
        }
    }

    /// The shaft around all rays from a receiver to the light; `None` where none is known.
    #[must_use]
    pub fn shaft(&self, receiver: DVec3) -> Option<Shaft> {
        let shaft = Shaft::new(receiver, self.cover(receiver)?)?;
        Some(match self {
            LightForm::Disk { center, x, y, outer_squared, .. } => {
                shaft.to_disk(*center, outer_squared.sqrt() * x.length().max(y.length()))
            }
            _ => shaft,
        })
    }
}

fn rectangle(center: DVec3, x: DVec3, y: DVec3) -> [DVec3; 4] {
    [center - x - y, center + x - y, center + x + y, center - x + y]
}

/// Half the width between the tangents to a circle at a distance, in the plane through its centre.
fn width_of_tangents(radius: f64, distance: f64) -> Option<f64> {
    (distance > radius).then(|| radius * distance / (distance * distance - radius * radius).sqrt())
}

fn cover_of_triangles(triangles: &[[DVec3; 3]], normal: DVec3) -> Option<[DVec3; 4]> {
    let [first, second, _] = triangles.first()?;
    let x = (*second - *first).try_normalize()?;
    let y = normal.cross(x);
    let (low, high) =
        triangles.iter().flatten().fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(low, high), at| {
            let at = [(*at - *first).dot(x), (*at - *first).dot(y)];
            (std::array::from_fn(|axis| low[axis].min(at[axis])), std::array::from_fn(|axis| high[axis].max(at[axis])))
        });
    let center = *first + x * (0.5 * (low[0] + high[0])) + y * (0.5 * (low[1] + high[1]));
    Some(rectangle(center, x * (0.5 * (high[0] - low[0])), y * (0.5 * (high[1] - low[1]))))
}

/// In the plane through the axis that the receiver looks at straight; all places are from the base.
fn cover_of_cylinder(receiver: DVec3, axis: DVec3, length: f64, radius: f64) -> Option<[DVec3; 4]> {
    let foot = receiver.dot(axis);
    let away = receiver - axis * foot;
    let distance = away.length();
    let half = width_of_tangents(radius, distance)?;
    // The nearest places are seen farthest out along the axis.
    let stretch = distance / (distance - radius);
    let low = (-foot).min(-foot * stretch);
    let high = (length - foot).max((length - foot) * stretch);
    let center = axis * (foot + 0.5 * (low + high));
    Some(rectangle(center, axis * (0.5 * (high - low)), axis.cross(away / distance) * half))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A place that is seen lies before the cover, and within its rim.
    fn holds(form: &LightForm, receiver: DVec3) {
        let [a, b, c, d] = form.cover(receiver).unwrap();
        let center = (a + c) * 0.5;
        let normal = (b - a).cross(d - a).normalize();
        for step in 0..400 {
            let u = [f64::from(step % 20) / 19.0, f64::from(step / 20) / 19.0];
            let Some(sample) = form.sample(receiver, u, DVec3::ZERO) else { continue };
            let met = normal.dot(center - receiver) / normal.dot(sample.direction);
            assert!(met > 0.0 && sample.distance <= met * (1.0 + 1e-9), "{form:?}: {} of {met}", sample.distance);
            let at = receiver + sample.direction * met - a;
            for side in [b - a, d - a] {
                let share = at.dot(side) / side.length_squared();
                assert!((-1e-9..=1.0 + 1e-9).contains(&share), "{form:?} from {receiver}: {share}");
            }
        }
    }

    #[test]
    fn covers_hold_what_is_seen_of_a_light() {
        let center = DVec3::new(0.3, -0.2, 2.0);
        let forms = [
            LightForm::Sphere { center, radius: 0.7, facing: Facing::Outward },
            LightForm::Cone { base: center, axis: DVec3::X, length: 1.5, radii: [0.3; 2], facing: Facing::Outward },
            LightForm::Disk {
                center,
                normal: -DVec3::Z,
                x: DVec3::X,
                y: DVec3::Y,
                inner_squared: 0.04,
                outer_squared: 0.49,
            },
            LightForm::Parallelogram {
                corner: center,
                x: DVec3::new(1.0, 0.0, 0.0),
                y: DVec3::new(0.0, -2.0, 0.0),
                normal: -DVec3::Z,
                area: 2.0,
            },
        ];
        for form in &forms {
            for receiver in [DVec3::ZERO, DVec3::new(3.0, 0.4, 0.1), DVec3::new(-0.3, -2.0, 1.2)] {
                holds(form, receiver);
            }
        }
    }

    #[test]
    fn around_a_point_there_is_no_cover() {
        let sphere = LightForm::Sphere { center: DVec3::ZERO, radius: 1.0, facing: Facing::Outward };
        assert!(sphere.cover(DVec3::new(0.5, 0.0, 0.0)).is_none());
    }
}
