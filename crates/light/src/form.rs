//! Shapes of lights: points on them, sampled by area or by solid angle.

use crate::lobe_weighting::{DiskWarp, exponential, exponential_pdf};
use crate::visible_side::VisibleSide;
use glam::DVec3;
use radsight_accel::polygon_normal;
use radsight_ir::{Facing, Scene, Shape};
use radsight_sampling::unit_disk;
use radsight_triangulation::TriangulatedPolygon;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// The emitting shape, as it is sampled.
#[derive(Clone, Debug)]
pub enum LightForm {
    /// A ring; `x` and `y` are unit and span its plane.
    Disk {
        /// Scene units.
        center: DVec3,
        /// Unit, on the emitting side.
        normal: DVec3,
        /// First of two perpendicular axes in its plane; in a virtual image they need not be unit
        /// vectors.
        x: DVec3,
        /// Second axis.
        y: DVec3,
        /// Square of the radius of the hole, in units of the axes.
        inner_squared: f64,
        /// Square of the outer radius.
        outer_squared: f64,
    },
    /// A parallelogram `corner + u·x + v·y`.
    Parallelogram {
        /// Corner from which both sides start, scene units.
        corner: DVec3,
        /// First side.
        x: DVec3,
        /// Second side.
        y: DVec3,
        /// Unit, on the emitting side.
        normal: DVec3,
        /// Square scene units.
        area: f64,
    },
    /// Any other polygon.
    Polygon {
        /// Its triangles, scene units.
        polygon: TriangulatedPolygon,
        /// Unit, on the emitting side.
        normal: DVec3,
    },
    /// A sphere, or a bubble that shines inward.
    Sphere {
        /// Centre, scene units.
        center: DVec3,
        /// Radius, scene units.
        radius: f64,
        /// Side that emits.
        facing: Facing,
    },
    /// A truncated cone or cylinder.
    Cone {
        /// Start of the axis, scene units.
        base: DVec3,
        /// Unit vector along the axis.
        axis: DVec3,
        /// Length of the axis, scene units.
        length: f64,
        /// Radii at the start and at the end of the axis, scene units.
        radii: [f64; 2],
        /// Side that emits.
        facing: Facing,
    },
    /// An infinitely distant light: a cone of directions.
    Distant {
        /// Unit vector towards its centre.
        direction: DVec3,
        /// First of two unit vectors perpendicular to the direction.
        x: DVec3,
        /// Second one.
        y: DVec3,
        /// `sin²(θ/2)` of the half angle θ of the cone, which is its solid angle over 4π.
        half_angle_sin_squared_half: f64,
    },
    /// Image of a distant light in a prism: directions `direction + a·x + b·y` with (a, b) in the
    /// unit circle.
    DistantImage {
        /// Unit vector towards its centre; `x` and `y` are perpendicular to it.
        direction: DVec3,
        /// First half axis of the image's ellipse, in the tangent plane of the sphere of directions
        /// at its centre.
        x: DVec3,
        /// Second half axis.
        y: DVec3,
    },
}

/// Least ratio of length and width of an elongated light.
const ELONGATED: f64 = 4.0;

/// A sampled point on a light, as seen from a receiver.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit vector from the receiver to the light.
    pub direction: DVec3,
    /// Distance, scene units; infinite for a distant light.
    pub distance: f64,
    /// Density by solid angle at the receiver, 1/sr.
    pub pdf: f64,
    /// Unit normal of the light there, on the emitting side.
    pub normal: DVec3,
}

impl LightForm {
    /// Shape of an emitting surface; none for a shape that cannot be sampled.
    pub fn new(scene: &Scene, shape: Shape) -> Option<LightForm> {
        match shape {
            Shape::Polygon { start, count } => LightForm::polygon(scene.polygon_vertices(start, count)),
            Shape::Sphere(handle) => {
                let sphere = scene.spheres[handle];
                Some(LightForm::Sphere { center: sphere.center, radius: sphere.radius, facing: sphere.facing })
            }
            Shape::Cone(handle) => {
                let cone = scene.cones[handle];
                let length = cone.base.distance(cone.apex);
                let axis = (cone.apex - cone.base) / length;
                let radii = [cone.base_radius, cone.apex_radius];
                Some(LightForm::Cone { base: cone.base, axis, length, radii, facing: cone.facing })
            }
            Shape::Ring(handle) => {
                let ring = scene.rings[handle];
                let (x, y) = ring.normal.any_orthonormal_pair();
                Some(LightForm::Disk {
                    center: ring.center,
                    normal: ring.normal,
                    x,
                    y,
                    inner_squared: ring.inner_radius * ring.inner_radius,
                    outer_squared: ring.outer_radius * ring.outer_radius,
                })
            }
            Shape::Source(handle) => {
                let source = scene.sources[handle];
                let (x, y) = source.direction.any_orthonormal_pair();
                let sin = (0.25 * source.extent.full_angle).sin();
                Some(LightForm::Distant { direction: source.direction, x, y, half_angle_sin_squared_half: sin * sin })
            }
            Shape::Mesh(_) | Shape::Instance(_) => None,
        }
    }

    /// A polygon; `None` if it has no area.
    #[must_use]
    pub fn polygon(vertices: &[DVec3]) -> Option<LightForm> {
        let normal = polygon_normal(vertices)?;
        if let [a, b, c, d] = vertices {
            let (x, y) = (*b - *a, *d - *a);
            if (*a + x + y).distance(*c) <= 1e-9 * (x.length() + y.length()) {
                return Some(LightForm::Parallelogram { corner: *a, x, y, normal, area: x.cross(y).length() });
            }
        }
        // The validation of scenes reports outlines that cannot be triangulated.
        let polygon = TriangulatedPolygon::new(vertices, normal).ok()??;
        Some(LightForm::Polygon { polygon, normal })
    }

    /// Emitting area in square scene units; for a sphere the visible disk.
    pub fn area(&self) -> f64 {
        match self {
            LightForm::Disk { inner_squared, outer_squared, .. } => PI * (outer_squared - inner_squared),
            LightForm::Parallelogram { area, .. } => *area,
            LightForm::Polygon { polygon, .. } => polygon.area(),
            LightForm::Sphere { radius, .. } => 4.0 * PI * radius * radius,
            LightForm::Cone { length, radii, .. } => PI * (radii[0] + radii[1]) * length.hypot(radii[1] - radii[0]),
            LightForm::Distant { .. } | LightForm::DistantImage { .. } => f64::INFINITY,
        }
    }

    /// Unit normal of a flat light on its emitting side, and a point of its plane.
    pub fn plane(&self) -> Option<(DVec3, DVec3)> {
        match self {
            LightForm::Disk { center, normal, .. } => Some((*normal, *center)),
            LightForm::Parallelogram { corner, normal, .. } => Some((*normal, *corner)),
            LightForm::Polygon { polygon, normal } => Some((*normal, polygon.triangles()[0][0])),
            _ => None,
        }
    }

    /// Centre and radius of a bounding sphere; for a distant light its direction and an infinite
    /// radius.
    pub fn bounding_sphere(&self) -> (DVec3, f64) {
        match self {
            LightForm::Disk { center, outer_squared, .. } => (*center, outer_squared.sqrt()),
            LightForm::Parallelogram { corner, x, y, .. } => {
                (*corner + (*x + *y) * 0.5, 0.5 * (*x + *y).length().max((*x - *y).length()))
            }
            LightForm::Polygon { polygon, .. } => {
                let triangles = polygon.triangles();
                let corners = triangles.iter().flatten();
                let count = 3.0 * triangles.len() as f64;
                let center = corners.clone().sum::<DVec3>() / count;
                (center, corners.map(|corner| corner.distance(center)).fold(0.0, f64::max))
            }
            LightForm::Sphere { center, radius, .. } => (*center, *radius),
            LightForm::Cone { base, axis, length, radii, .. } => {
                (*base + *axis * (0.5 * length), (0.5 * length).hypot(radii[0].max(radii[1])))
            }
            LightForm::Distant { direction, .. } | LightForm::DistantImage { direction, .. } => {
                (*direction, f64::INFINITY)
            }
        }
    }

    /// Half angle of the cone of a distant light, radians; `None` for other lights.
    #[must_use]
    pub fn half_angle(&self) -> Option<f64> {
        match self {
            LightForm::Distant { half_angle_sin_squared_half, .. } => {
                Some(2.0 * half_angle_sin_squared_half.sqrt().min(1.0).asin())
            }
            _ => None,
        }
    }

    /// Maps a point of the unit square to a point of a flat shape, uniform by area; returns the
    /// unit normal and the point. `None` for other shapes.
    pub fn point(&self, [u, v]: [f64; 2]) -> Option<(DVec3, DVec3)> {
        let point = match self {
            LightForm::Disk { center, x, y, inner_squared, outer_squared, .. } => {
                point_on_ring(*center, *x, *y, *inner_squared, *outer_squared, u, v)?
            }
            LightForm::Parallelogram { corner, x, y, .. } => *corner + *x * u + *y * v,
            LightForm::Polygon { polygon, .. } => polygon.point([u, v]),
            _ => return None,
        };
        self.plane().map(|(normal, _)| (normal, point))
    }

    /// Intersects a ray from `receiver` along a unit direction with a flat shape that faces it:
    /// distance and cosine at the light.
    pub fn intersect(&self, receiver: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        let (normal, point) = self.plane()?;
        let (cosine, height) = (-normal.dot(direction), normal.dot(receiver - point));
        if cosine <= 0.0 || height <= 0.0 {
            return None;
        }
        let distance = height / cosine;
        let point = receiver + direction * distance;
        let is_inside = match self {
            LightForm::Disk { center, inner_squared, outer_squared, .. } => {
                (*inner_squared..=*outer_squared).contains(&point.distance_squared(*center))
            }
            LightForm::Parallelogram { corner, x, y, .. } => {
                coordinates(*x, *y, point - *corner).iter().all(|share| (0.0..=1.0).contains(share))
            }
            LightForm::Polygon { polygon, .. } => polygon.triangles().iter().any(|triangle| is_in(triangle, point)),
            _ => false,
        };
        is_inside.then_some((distance, cosine))
    }

    /// Samples a point of the light as seen from `receiver`. `None` if the light faces away.
    #[inline]
    pub fn sample(&self, receiver: DVec3, [u, v]: [f64; 2], gradient: DVec3) -> Option<LightSample> {
        let (point, normal, pdf) = match self {
            LightForm::Disk { center, normal, x, y, inner_squared, outer_squared } => {
                let area = PI * (outer_squared - inner_squared);
                if *inner_squared == 0.0 {
                    let radius = outer_squared.sqrt();
                    let warp = disk_warp(gradient, *x * radius, *y * radius);
                    let (a, b) = warp.apply(unit_disk(u, v));
                    (*center + (*x * a + *y * b) * radius, *normal, warp.pdf((a, b)) / area)
                } else {
                    (point_on_ring(*center, *x, *y, *inner_squared, *outer_squared, u, v)?, *normal, area.recip())
                }
            }
            LightForm::Parallelogram { corner, x, y, normal, area } => {
                let (a, pdf_a) = exponential(gradient.dot(*x), u);
                let (b, pdf_b) = exponential(gradient.dot(*y), v);
                (*corner + *x * a + *y * b, *normal, pdf_a * pdf_b / area)
            }
            LightForm::Polygon { polygon, normal } => (polygon.point([u, v]), *normal, polygon.area().recip()),
            LightForm::Sphere { center, radius, facing } => {
                return sample_sphere(*center, *radius, *facing, receiver, [u, v], gradient);
            }
            LightForm::Cone { base, axis, length, radii, facing } => {
                let side = self.visible_side(receiver)?;
                let share = relative_height(*radii, u);
                let radius = radii[0] + (radii[1] - radii[0]) * share;
                let (radial, pdf) = side.sample(v);
                let slope = (radii[1] - radii[0]) / length;
                let outward = (radial - *axis * slope).normalize();
                let normal = if *facing == Facing::Outward { outward } else { -outward };
                (*base + *axis * (share * length) + radial * radius, normal, pdf / self.area())
            }
            LightForm::Distant { direction, x, y, half_angle_sin_squared_half: cap } => {
                let (towards, pdf) = direction_in_cap(*direction, *x, *y, *cap, [u, v], gradient);
                return Some(LightSample { direction: towards, distance: f64::INFINITY, pdf, normal: -towards });
            }
            LightForm::DistantImage { direction, x, y } => {
                let (a, b) = unit_disk(u, v);
                let towards = (*direction + *x * a + *y * b).normalize();
                let pdf = ellipse_pdf(*direction, *x, *y, towards);
                return Some(LightSample { direction: towards, distance: f64::INFINITY, pdf, normal: -towards });
            }
        };
        seen(receiver, point, normal, pdf)
    }

    /// Density with which [`LightForm::sample`] finds the point at `distance` along `direction`,
    /// 1/sr.
    pub fn pdf(&self, receiver: DVec3, direction: DVec3, distance: f64, cosine: f64, gradient: DVec3) -> f64 {
        let by_area = distance * distance / (self.area() * cosine);
        match self {
            LightForm::Disk { center, x, y, inner_squared, outer_squared, .. } if *inner_squared == 0.0 => {
                let radius = outer_squared.sqrt();
                let from_center = receiver + direction * distance - *center;
                let at = (from_center.dot(*x) / radius, from_center.dot(*y) / radius);
                by_area * disk_warp(gradient, *x * radius, *y * radius).pdf(at)
            }
            LightForm::Parallelogram { corner, x, y, normal, area } => {
                let from_corner = receiver + direction * distance - *corner;
                let a = from_corner.cross(*y).dot(*normal) / area;
                let b = x.cross(from_corner).dot(*normal) / area;
                by_area * exponential_pdf(gradient.dot(*x), a) * exponential_pdf(gradient.dot(*y), b)
            }
            LightForm::Sphere { center, radius, facing: Facing::Outward }
                if center.distance_squared(receiver) > radius * radius =>
            {
                let axis = (*center - receiver).normalize();
                let (x, y) = axis.any_orthonormal_pair();
                cap_pdf(axis, x, y, sphere_cap(*center, *radius, receiver), direction, gradient)
            }
            LightForm::Distant { direction: axis, x, y, half_angle_sin_squared_half } => {
                cap_pdf(*axis, *x, *y, *half_angle_sin_squared_half, direction, gradient)
            }
            LightForm::Cone { base, axis, .. } => {
                let from_base = receiver + direction * distance - *base;
                let from_axis = (from_base - *axis * from_base.dot(*axis)).normalize_or_zero();
                self.visible_side(receiver).map_or(0.0, |side| by_area * side.pdf(from_axis))
            }
            LightForm::DistantImage { direction: axis, x, y } => ellipse_pdf(*axis, *x, *y, direction),
            _ => by_area,
        }
    }

    /// Visible part of a cone; `None` if nothing is visible, and for other shapes.
    fn visible_side(&self, receiver: DVec3) -> Option<VisibleSide> {
        let LightForm::Cone { base, axis, length, radii, facing } = self else { return None };
        VisibleSide::new(receiver - *base, *axis, (radii[0], (radii[1] - radii[0]) / length), *facing)
    }

    /// The length of an elongated light as seen from a point at this offset from its centre, in distances from it:
    /// pieces that are no longer than ε of their distances are so many times 1/ε. 0 for other lights.
    pub fn angular_length(&self, offset: DVec3) -> f64 {
        let (half, squared_width) = match self {
            LightForm::Parallelogram { x, y, .. } => {
                let (long, short) = if x.length_squared() > y.length_squared() { (x, y) } else { (y, x) };
                (*long * 0.5, short.length_squared())
            }
            LightForm::Cone { axis, length, radii, .. } => {
                (*axis * (0.5 * length), (2.0 * radii[0].max(radii[1])).powi(2))
            }
            _ => return 0.0,
        };
        // Most lights are not, and need no square root.
        if 4.0 * half.length_squared() < ELONGATED * ELONGATED * squared_width {
            return 0.0;
        }
        let half_length = half.length();
        let along = offset.dot(half) / half_length;
        let aside = (offset.length_squared() - along * along).max(0.25 * squared_width).sqrt();
        ((half_length - along) / aside).asinh() + ((half_length + along) / aside).asinh()
    }

    /// Solid angle of a distant light; of a near one an estimate from its cross-section, as if it
    /// faced the point, sr.
    pub fn solid_angle(&self, distance: f64) -> f64 {
        match self {
            LightForm::Distant { half_angle_sin_squared_half, .. } => cap_solid_angle(*half_angle_sin_squared_half),
            LightForm::DistantImage { x, y, .. } => PI * x.cross(*y).length(),
            LightForm::Sphere { radius, .. } => PI * radius * radius / (distance * distance),
            LightForm::Cone { .. } => self.area() * FRAC_1_PI / (distance * distance),
            form => form.area() / (distance * distance),
        }
    }
}

/// Light sample at a point of a surface, its density converted from area to solid angle.
#[inline]
pub(crate) fn seen(receiver: DVec3, point: DVec3, normal: DVec3, area_pdf: f64) -> Option<LightSample> {
    let offset = point - receiver;
    let squared = offset.length_squared();
    let distance = squared.sqrt();
    let direction = offset / distance;
    let cosine = -direction.dot(normal);
    (cosine > 0.0).then(|| LightSample { direction, distance, pdf: squared * area_pdf / cosine, normal })
}

/// Coefficients of a vector in the basis `x`, `y` of its plane.
pub fn coordinates(x: DVec3, y: DVec3, vector: DVec3) -> [f64; 2] {
    let across = x.cross(y);
    [vector.cross(y), x.cross(vector)].map(|part| part.dot(across) / across.length_squared())
}

/// Whether a point of a triangle's plane lies in the triangle.
fn is_in(&[a, b, c]: &[DVec3; 3], point: DVec3) -> bool {
    let across = (b - a).cross(c - a);
    [(a, b), (b, c), (c, a)].iter().all(|(from, to)| (*to - *from).cross(point - *from).dot(across) >= 0.0)
}

/// Warp of a disk whose axes are these radii.
#[inline]
fn disk_warp(gradient: DVec3, x: DVec3, y: DVec3) -> DiskWarp {
    DiskWarp::new(gradient.dot(x), gradient.dot(y))
}

fn point_on_ring(center: DVec3, x: DVec3, y: DVec3, inner: f64, outer: f64, u: f64, v: f64) -> Option<DVec3> {
    let (a, b) = unit_disk(u, v);
    let squared = a * a + b * b;
    // Maps the disk to the ring, preserving uniformity by area.
    let scale = (squared > 0.0).then(|| ((inner + squared * (outer - inner)) / squared).sqrt())?;
    Some(center + (x * a + y * b) * scale)
}

/// `sin²(θ/2)` of the half angle θ of a sphere, that is (1 − cos θ)/2, without cancellation.
fn sphere_cap(center: DVec3, radius: f64, receiver: DVec3) -> f64 {
    let squared = center.distance_squared(receiver);
    let sin_squared = (radius * radius / squared).min(1.0);
    let cosine = (1.0 - sin_squared).sqrt();
    0.5 * sin_squared / (1.0 + cosine)
}

fn cap_solid_angle(sin_squared_half: f64) -> f64 {
    4.0 * PI * sin_squared_half
}

/// Unit direction within the cap about `axis`, and its density. Cosine and azimuth come from the
/// warped concentric map.
fn direction_in_cap(axis: DVec3, x: DVec3, y: DVec3, cap: f64, [u, v]: [f64; 2], gradient: DVec3) -> (DVec3, f64) {
    let rim = (4.0 * cap * (1.0 - cap)).max(0.0).sqrt();
    let warp = disk_warp(gradient, x * rim, y * rim);
    let (a, b) = warp.apply(unit_disk(u, v));
    // 1 − cos θ' = (a² + b²)·(1 − cos θ); sin θ' follows without cancellation.
    let versed = 2.0 * cap * (a * a + b * b);
    let scale = (2.0 * cap * (2.0 - versed)).sqrt();
    (axis * (1.0 - versed) + x * (a * scale) + y * (b * scale), warp.pdf((a, b)) / cap_solid_angle(cap))
}

/// Density of [`direction_in_cap`], 1/sr.
fn cap_pdf(axis: DVec3, x: DVec3, y: DVec3, cap: f64, direction: DVec3, gradient: DVec3) -> f64 {
    let rim = (4.0 * cap * (1.0 - cap)).max(0.0).sqrt();
    let versed = 0.5 * direction.distance_squared(axis);
    let scale = (2.0 * cap * (2.0 - versed)).sqrt();
    let at = (direction.dot(x) / scale, direction.dot(y) / scale);
    disk_warp(gradient, x * rim, y * rim).pdf(at) / cap_solid_angle(cap)
}

/// Density by solid angle of directions uniform over an ellipse in the tangent plane at `axis`,
/// 1/sr.
fn ellipse_pdf(axis: DVec3, x: DVec3, y: DVec3, towards: DVec3) -> f64 {
    // An area element of the plane is at distance 1/cos and tilted by that cosine.
    (PI * x.cross(y).length() * axis.dot(towards).powi(3)).recip()
}

fn sample_sphere(
    center: DVec3,
    radius: f64,
    facing: Facing,
    receiver: DVec3,
    [u, v]: [f64; 2],
    gradient: DVec3,
) -> Option<LightSample> {
    let axis = center - receiver;
    let squared = axis.length_squared();
    if facing == Facing::Inward || squared <= radius * radius {
        return sample_sphere_by_area(center, radius, facing, receiver, u, v);
    }
    let axis = axis / squared.sqrt();
    let (x, y) = axis.any_orthonormal_pair();
    let cap = sphere_cap(center, radius, receiver);
    let (direction, pdf) = direction_in_cap(axis, x, y, cap, [u, v], gradient);
    let along = (center - receiver).dot(direction);
    let miss_squared = (squared - along * along).min(radius * radius);
    let distance = along - (radius * radius - miss_squared).sqrt();
    let normal = (receiver + direction * distance - center) / radius;
    Some(LightSample { direction, distance, pdf, normal })
}

fn sample_sphere_by_area(
    center: DVec3,
    radius: f64,
    facing: Facing,
    receiver: DVec3,
    u: f64,
    v: f64,
) -> Option<LightSample> {
    let z = 1.0 - 2.0 * u;
    let (sin, cos) = (TAU * v).sin_cos();
    let rim = (1.0 - z * z).max(0.0).sqrt();
    let outward = DVec3::new(rim * cos, rim * sin, z);
    let normal = if facing == Facing::Outward { outward } else { -outward };
    seen(receiver, center + outward * radius, normal, (4.0 * PI * radius * radius).recip())
}

/// Relative height of a truncated cone below which the fraction `u` of its lateral area lies.
fn relative_height(radii: [f64; 2], u: f64) -> f64 {
    let [low, high] = radii;
    let squared = low * low + u * (high * high - low * low);
    let radius = squared.max(0.0).sqrt();
    // s = (r − r₀)/(r₁ − r₀) = u·(r₀ + r₁)/(r + r₀), which also holds for a cylinder.
    if radius + low > 0.0 { u * (low + high) / (radius + low) } else { 0.0 }
}
