//! The rays of a view, and the projection of points.
//!
//! An image position is (x, y) with (0, 0) at the lower left corner and (1, 1) at the upper right.
//! The formulas are those of Radiance's manual page of `rpict` and, for what it omits, the results
//! of `vwrays`.

use super::{ViewError, ViewKind, ViewOptions};
use glam::{DVec2, DVec3};

/// A valid view, which generates rays.
///
/// ```
/// use radsight_picture::{View, ViewOptions};
/// let view = View::new(ViewOptions::default()).unwrap();
/// let ray = view.ray([0.5, 0.5]).unwrap();
/// assert_eq!((ray.origin, ray.direction), (glam::DVec3::ZERO, glam::DVec3::Y));
/// let location = view.locate(glam::DVec3::new(0.0, 2.0, 0.0)).unwrap();
/// assert_eq!((location.x, location.y, location.distance), (0.5, 0.5, 2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    options: ViewOptions,
    /// Unit vector along the optical axis.
    direction: DVec3,
    /// Unit vector to the right in the picture.
    right: DVec3,
    /// Unit vector upwards in the picture, perpendicular to both.
    above: DVec3,
    /// Width and height in units of the projection: tangents, sines, radians or lengths.
    size: DVec2,
}

/// The ray of an image position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewRay {
    /// Origin, on the fore clipping plane.
    pub origin: DVec3,
    /// Unit vector into the scene.
    pub direction: DVec3,
    /// Distance from the origin to the aft clipping plane; `None` without one.
    pub length: Option<f64>,
}

/// The image position of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewLocation {
    /// From 0 at the left edge to 1 at the right; outside this range the point is outside the
    /// picture.
    pub x: f64,
    /// From 0 at the lower edge to 1 at the upper; outside this range the point is outside the
    /// picture.
    pub y: f64,
    /// Distance along the ray from the fore clipping plane, scene units; not positive behind it.
    pub distance: f64,
    /// Whether the point lies beyond the aft clipping plane.
    pub beyond: bool,
}

impl ViewLocation {
    /// Whether the position is strictly inside the picture, whatever the distance.
    #[must_use]
    pub fn is_inside(&self) -> bool {
        self.x > 0.0 && self.x < 1.0 && self.y > 0.0 && self.y < 1.0
    }
}

/// The unit vector along a finite one, also where its square over- or underflows; `None` for zero.
fn unit(vector: DVec3) -> Option<DVec3> {
    let scaled = || vector / vector.abs().max_element();
    vector.try_normalize().or_else(|| scaled().try_normalize())
}

/// Radiance's smallest significant length.
const TINY: f64 = 1e-6;

impl View {
    /// Checks a view as typed.
    ///
    /// # Errors
    /// Any [`ViewError`] except [`ViewError::UnknownKind`], [`ViewError::Crop`] and
    /// [`ViewError::Missing`].
    pub fn new(mut options: ViewOptions) -> Result<View, ViewError> {
        check_finite(&options)?;
        check_clipping(&options)?;
        let direction = unit(options.direction).ok_or(ViewError::ZeroDirection)?;
        options.up = unit(options.up).ok_or(ViewError::ZeroUp)?;
        let right = direction.cross(options.up).try_normalize().ok_or(ViewError::UpParallel)?;
        let above = right.cross(direction);
        let size = projected_size(&options)?;
        Ok(View { options, direction, right, above, size })
    }

    /// The view as typed, with the up vector normalised.
    #[must_use]
    pub fn options(&self) -> &ViewOptions {
        &self.options
    }

    /// Unit vector along the optical axis.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The unit vector to the right in the picture.
    #[must_use]
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// Unit vector upwards in the picture, perpendicular to direction and right.
    #[must_use]
    pub fn above(&self) -> DVec3 {
        self.above
    }

    /// Width and height in the units of the projection: twice the tangent of half the angle
    /// (perspective, and the height of a panorama), twice its sine (hemispherical), radians
    /// (angular, and the width of a panorama), twice the tangent of a quarter of the angle
    /// (planispheric), or scene units (parallel).
    #[must_use]
    pub fn size(&self) -> DVec2 {
        self.size
    }

    /// The height over the width.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        self.size.y / self.size.x
    }

    /// The largest resolution within `width` x `height` with the given pixel aspect (height divided
    /// by width). An aspect of 0 leaves the resolution unchanged.
    #[must_use]
    pub fn fit(&self, width: usize, height: usize, pixel_aspect: f64) -> (usize, usize) {
        let aspect = self.aspect();
        if pixel_aspect.is_nan() || pixel_aspect <= TINY {
            return (width, height);
        }
        let rounded = |size: f64| (size + 0.5) as usize;
        if aspect * width as f64 > pixel_aspect * height as f64 {
            (rounded(height as f64 / aspect * pixel_aspect), height)
        } else {
            (width, rounded(width as f64 * aspect / pixel_aspect))
        }
    }

    /// The ray of an image position; `None` outside the projection (the corners of a fisheye).
    #[must_use]
    pub fn ray(&self, [x, y]: [f64; 2]) -> Option<ViewRay> {
        let ViewOptions { kind, point, fore, aft, shift, lift, .. } = self.options;
        let image_point = DVec2::new(x + shift - 0.5, y + lift - 0.5) * self.size;
        let depth = (aft > TINY).then_some(aft - fore);
        match kind {
            ViewKind::Parallel => {
                let origin = point + fore * self.direction + image_point.x * self.right + image_point.y * self.above;
                Some(ViewRay { origin, direction: self.direction, length: depth })
            }
            // The clipping surfaces of these two are a plane and a cylinder, which an oblique ray
            // meets later.
            ViewKind::Perspective => {
                let slanted = self.direction + image_point.x * self.right + image_point.y * self.above;
                Some(self.slanted_ray(slanted, depth))
            }
            ViewKind::Cylindrical => {
                let (sine, cosine) = image_point.x.sin_cos();
                let slanted = cosine * self.direction + sine * self.right + image_point.y * self.above;
                Some(self.slanted_ray(slanted, depth))
            }
            ViewKind::Hemispherical | ViewKind::Angular | ViewKind::Planispheric => {
                let [forward, sideways] = fisheye(kind, image_point.length())?;
                let direction =
                    forward * self.direction + sideways * (image_point.x * self.right + image_point.y * self.above);
                Some(ViewRay { origin: point + fore * direction, direction, length: depth })
            }
        }
    }

    /// The ray of a direction whose component perpendicular to the clipping surface has unit
    /// length.
    fn slanted_ray(&self, slanted: DVec3, depth: Option<f64>) -> ViewRay {
        let stretch = slanted.length();
        ViewRay {
            origin: self.options.point + self.options.fore * slanted,
            direction: slanted / stretch,
            length: depth.map(|depth| depth * stretch),
        }
    }

    /// The image position of a point. `None` if it has none: at the eye, in the plane of the eye of
    /// a perspective view, on the axis of a panorama, or directly behind a planispheric view.
    #[must_use]
    pub fn locate(&self, point: DVec3) -> Option<ViewLocation> {
        let ViewOptions { kind, fore, aft, shift, lift, .. } = self.options;
        let from_eye = point - self.options.point;
        let (forward, right, above) =
            (from_eye.dot(self.direction), from_eye.dot(self.right), from_eye.dot(self.above));
        let length = from_eye.length();
        let clipped = |depth: f64| aft > TINY && depth >= aft;
        let (image_point, distance, beyond) = match kind {
            ViewKind::Parallel => (DVec2::new(right, above), forward - fore, clipped(forward)),
            ViewKind::Perspective => {
                if forward.abs() <= TINY {
                    return None;
                }
                // A point behind the eye projects through it, at a negative distance.
                let distance = length.copysign(forward) * (1.0 - fore / forward);
                (DVec2::new(right, above) / forward.abs(), distance, clipped(forward))
            }
            ViewKind::Cylindrical => {
                let radius = forward.hypot(right);
                if radius <= TINY {
                    return None;
                }
                let distance = length * (1.0 - fore / radius);
                (DVec2::new(right.atan2(forward), above / radius), distance, clipped(radius))
            }
            ViewKind::Hemispherical => {
                let distance = length.copysign(forward) - fore;
                (DVec2::new(right, above).checked_div(length)?, distance, clipped(distance + fore))
            }
            ViewKind::Angular => {
                let sideways = right.hypot(above);
                let angle = sideways.atan2(forward);
                let unit = DVec2::new(right, above).checked_div(sideways).unwrap_or(DVec2::X);
                (angle * unit, length - fore, clipped(length))
            }
            ViewKind::Planispheric => {
                (DVec2::new(right, above).checked_div(length + forward)?, length - fore, clipped(length))
            }
        };
        let DVec2 { x, y } = image_point / self.size + DVec2::new(0.5 - shift, 0.5 - lift);
        Some(ViewLocation { x, y, distance, beyond })
    }

    /// The view of a part of the picture between two opposite corners `from` and `to`.
    ///
    /// # Errors
    /// [`ViewError::Crop`] for an empty crop or one that leaves the hemisphere; others if the part
    /// is too large.
    pub fn crop(&self, from: [f64; 2], to: [f64; 2]) -> Result<View, ViewError> {
        let (from, to) = (DVec2::from(from).min(DVec2::from(to)), DVec2::from(from).max(DVec2::from(to)));
        let extent = to - from;
        if !extent.is_finite() || extent.min_element() <= TINY {
            return Err(ViewError::Crop);
        }
        let mut options = self.options;
        let size = self.size * extent;
        options.horizontal = typed_size(options.kind, Axis::Horizontal, size.x).ok_or(ViewError::Crop)?;
        options.vertical = typed_size(options.kind, Axis::Vertical, size.y).ok_or(ViewError::Crop)?;
        let middle = (from + to) * 0.5 - DVec2::splat(0.5) + DVec2::new(options.shift, options.lift);
        (options.shift, options.lift) = (middle / extent).into();
        View::new(options)
    }
}

trait CheckedDivision: Sized {
    fn checked_div(self, divisor: f64) -> Option<Self>;
}

impl CheckedDivision for DVec2 {
    /// Divides; `None` unless the divisor is positive.
    fn checked_div(self, divisor: f64) -> Option<Self> {
        (divisor > 0.0).then(|| self / divisor)
    }
}

/// The cosine of the angle to the axis at a distance from the image centre, and the sine divided by
/// that distance.
fn fisheye(kind: ViewKind, radius: f64) -> Option<[f64; 2]> {
    match kind {
        // radius = sin θ
        ViewKind::Hemispherical => (radius <= 1.0).then(|| [(1.0 - radius * radius).sqrt(), 1.0]),
        // radius = θ
        ViewKind::Angular if radius > std::f64::consts::PI => None,
        ViewKind::Angular if radius == 0.0 => Some([1.0, 1.0]),
        ViewKind::Angular => Some([radius.cos(), radius.sin() / radius]),
        // radius = tan θ/2
        _ => {
            let cosine = (1.0 - radius * radius) / (1.0 + radius * radius);
            Some([cosine, 1.0 + cosine])
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Axis {
    Horizontal,
    Vertical,
}

fn projected_size(options: &ViewOptions) -> Result<DVec2, ViewError> {
    let size = |axis: Axis, option: &'static str, value: f64| {
        let (largest, is_allowed, expected) = match (options.kind, axis) {
            (ViewKind::Parallel, _) => (f64::INFINITY, true, "a positive length"),
            (ViewKind::Perspective, _) | (ViewKind::Cylindrical, Axis::Vertical) => {
                (180.0, false, "an angle above 0 and below 180 degrees")
            }
            (ViewKind::Hemispherical, _) => (180.0, true, "an angle above 0 and up to 180 degrees"),
            (ViewKind::Angular, _) | (ViewKind::Cylindrical, Axis::Horizontal) => {
                (360.0, true, "an angle above 0 and up to 360 degrees")
            }
            (ViewKind::Planispheric, _) => (360.0, false, "an angle above 0 and below 360 degrees"),
        };
        let above = if is_allowed { value > largest + TINY } else { value >= largest - TINY };
        if value <= TINY || above {
            return Err(ViewError::Size { option, value: value.to_string(), expected });
        }
        Ok(projected(options.kind, axis, value))
    };
    let horizontal = size(Axis::Horizontal, "-vh", options.horizontal)?;
    Ok(DVec2::new(horizontal, size(Axis::Vertical, "-vv", options.vertical)?))
}

/// Converts a size as typed to units of the projection.
fn projected(kind: ViewKind, axis: Axis, typed: f64) -> f64 {
    let half = typed.to_radians() / 2.0;
    match (kind, axis) {
        (ViewKind::Parallel, _) => typed,
        (ViewKind::Perspective, _) | (ViewKind::Cylindrical, Axis::Vertical) => 2.0 * half.tan(),
        (ViewKind::Angular, _) | (ViewKind::Cylindrical, Axis::Horizontal) => typed.to_radians(),
        (ViewKind::Hemispherical, _) => 2.0 * half.sin(),
        (ViewKind::Planispheric, _) => 2.0 * (half / 2.0).tan(),
    }
}

/// Converts a size in units of the projection to one as typed; `None` if no angle has it.
fn typed_size(kind: ViewKind, axis: Axis, projected: f64) -> Option<f64> {
    let half = projected / 2.0;
    match (kind, axis) {
        (ViewKind::Parallel, _) => Some(projected),
        (ViewKind::Perspective, _) | (ViewKind::Cylindrical, Axis::Vertical) => Some(2.0 * half.atan().to_degrees()),
        (ViewKind::Angular, _) | (ViewKind::Cylindrical, Axis::Horizontal) => Some(projected.to_degrees()),
        (ViewKind::Hemispherical, _) => (half <= 1.0 + TINY).then(|| 2.0 * half.min(1.0).asin().to_degrees()),
        (ViewKind::Planispheric, _) => Some(4.0 * half.atan().to_degrees()),
    }
}

fn check_finite(options: &ViewOptions) -> Result<(), ViewError> {
    let ViewOptions { point, direction, up, horizontal, vertical, fore, aft, shift, lift, .. } = *options;
    for (option, vector) in [("-vp", point), ("-vd", direction), ("-vu", up)] {
        if !vector.is_finite() {
            return Err(ViewError::NotFinite { option, value: vector.to_string() });
        }
    }
    let numbers = [("-vh", horizontal), ("-vv", vertical), ("-vo", fore), ("-va", aft), ("-vs", shift), ("-vl", lift)];
    for (option, number) in numbers {
        if !number.is_finite() {
            return Err(ViewError::NotFinite { option, value: number.to_string() });
        }
    }
    Ok(())
}

fn check_clipping(&ViewOptions { fore, aft, .. }: &ViewOptions) -> Result<(), ViewError> {
    if fore < -TINY || aft < -TINY || (aft > TINY && aft <= fore) {
        return Err(ViewError::Clipping { fore: fore.to_string(), aft: aft.to_string() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(line: &str) -> Result<View, ViewError> {
        let mut options = ViewOptions::default();
        options.apply_line(line).unwrap();
        View::new(options)
    }

    const VIEWS: [&str; 6] = [
        "-vtv -vp 1 2 3 -vd 1 2 -.5 -vh 60 -vv 40 -vo .5 -va 9 -vs .2 -vl -.1",
        "-vtl -vp 1 2 3 -vd 1 2 -.5 -vh 3 -vv 4 -vo .5 -va 9 -vs .2 -vl -.1",
        "-vtc -vp 1 2 3 -vd 1 2 -.5 -vh 300 -vv 40 -vo .5 -va 9 -vs .05 -vl -.1",
        "-vth -vp 1 2 3 -vd 1 2 -.5 -vh 120 -vv 90 -vo .5 -va 9 -vs .2 -vl -.1",
        "-vta -vp 1 2 3 -vd 1 2 -.5 -vh 170 -vv 300 -vo .5 -va 9 -vs .2 -vl -.1",
        "-vts -vp 1 2 3 -vd 1 2 -.5 -vh 170 -vv 300 -vo .5 -va 9 -vs .2 -vl -.1",
    ];

    #[test]
    fn a_point_on_a_ray_has_the_image_position_of_the_ray() {
        for line in VIEWS {
            let view = view(line).unwrap();
            for (i, j) in (0..9).flat_map(|i| (0..9).map(move |j| (i, j))) {
                let image_point = [f64::from(i) / 8.0, f64::from(j) / 8.0];
                let Some(ray) = view.ray(image_point) else { continue };
                assert!((ray.direction.length() - 1.0).abs() < 1e-14, "{line}");
                let found = view.locate(ray.origin + 2.5 * ray.direction).unwrap();
                let error =
                    (found.x - image_point[0]).abs() + (found.y - image_point[1]).abs() + (found.distance - 2.5).abs();
                assert!(error < 1e-12, "{line}: {image_point:?} {found:?}");
                assert!(!found.beyond);
                assert!(view.locate(ray.origin + 1.0001 * ray.length.unwrap() * ray.direction).unwrap().beyond);
            }
        }
    }

    #[test]
    fn a_crop_has_the_rays_of_its_part() {
        for line in VIEWS {
            let whole = view(line).unwrap();
            let part = whole.crop([0.75, 0.3], [0.25, 0.8]).unwrap();
            for (x, y) in [(0.5, 0.5), (0.1, 0.9)] {
                let (Some(a), Some(b)) = (part.ray([x, y]), whole.ray([0.25 + 0.5 * x, 0.3 + 0.5 * y])) else {
                    continue;
                };
                assert!(a.origin.distance(b.origin) + a.direction.distance(b.direction) < 1e-12, "{line}");
            }
        }
    }

    #[test]
    fn invalid_views_are_named() {
        let message = |line: &str| view(line).unwrap_err().to_string();
        assert_eq!(message("-vd 0 0 0"), "the view direction (-vd) is zero");
        assert_eq!(message("-vu 0 0 0"), "the view up vector (-vu) is zero");
        assert_eq!(message("-vu 0 3 0"), "the view up vector (-vu) is parallel to the view direction (-vd)");
        assert_eq!(message("-vh 180"), "-vh is 180, expected an angle above 0 and below 180 degrees");
        assert_eq!(message("-vtl -vv 0"), "-vv is 0, expected a positive length");
        assert_eq!(
            message("-vo 3 -va 2"),
            "clipping planes -vo 3 -va 2, expected 0 <= fore, and aft = 0 or aft > fore"
        );
        assert_eq!(message("-vp 1e999 0 0"), "-vp is [inf, 0, 0], expected finite numbers");
        assert!(view("-vth -vh 180 -vv 180").is_ok() && view("-vta -vh 360 -vv 360").is_ok());
    }

    #[test]
    fn directions_of_any_length_are_directions() {
        for length in ["1e300", "1e-300", "1e-320"] {
            let view = view(&format!("-vd 0 {length} 0 -vu 0 0 {length}")).unwrap();
            assert_eq!((view.direction(), view.above()), (DVec3::Y, DVec3::Z), "{length}");
        }
    }

    #[test]
    fn the_resolution_shrinks_to_the_aspect() {
        let wide = view("-vh 60 -vv 40").unwrap();
        assert_eq!(wide.fit(512, 512, 1.0), (512, 323));
        assert_eq!(wide.fit(512, 200, 1.0), (317, 200));
        assert_eq!(wide.fit(512, 200, 0.0), (512, 200));
    }
}
