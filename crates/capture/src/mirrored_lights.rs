//! Rays towards the images of lights in curved mirrors.
//!
//! A sphere reflects each LED as a point a thousand times as bright as the sheet and a millionth of
//! a pixel in size. Rays that are uniform over pixel and pinhole hit it by chance only. Where such
//! an image is found, some of the rays of the pixel are aimed at it. For a point on the pixel, the
//! points of the pinhole that see the image fill an ellipse, known from the linear map from pinhole
//! to light. In the focus of a lens all of its points see the same, so the points on the pixel that
//! see the image are used instead ([`Domain`]). The rays of a pixel are then drawn from a mixture of
//! densities and divided by its pdf, so the estimate stays unbiased (Owen and Zhou 2000).
//!
//! Images in plane mirrors are known exactly, so rays aimed at them form strata of their own
//! ([`PlaneImages`]).

use crate::curved_image::CurvedImage;
use crate::domain::Domain;
use crate::ellipse::{Ellipse, LinearMap};
use crate::film::PixelPassage;
use crate::plane_images::{PlaneImage, PlaneImages, PlaneStrata, WeightedPoint};
use glam::{DMat2, DVec2, DVec3};
use radsight_pinhole::{CameraRay, Rays};
use radsight_render::{MirroredLight, Ray, RayWorker, RenderPlan, Renderer};
use radsight_sampling::choose;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Newton's method takes at most this many steps, and converges within this fraction of a light's
/// radius.
const MAX_STEPS: u32 = 8;
const CONVERGED: f64 = 0.02;

/// Accepted distance where it does not converge, as between the facets of a mesh, in radii of the
/// light.
const MAX_MISS: f64 = 1.5;

/// Fraction of the rays of a pixel that is aimed at images in curved mirrors, where they show all
/// light.
const AIMED: f64 = 0.5;

/// The same where they show the light of images alone, in pixels that also see images in plane mirrors, and
/// in pixels of which images fill more than aimed rays would hit. Fractions of powers of two divide the
/// low-discrepancy sequence exactly.
const AIMED_BESIDE_PLANE: f64 = 0.875;
const AIMED_AT_WIDE: f64 = 0.125;

/// Points farther out than this, in radii of the pinhole or in pixels, belong to other pixels.
const MAX_COORDINATE: f64 = 3.0;

/// The images that each pixel sees.
#[derive(Debug)]
pub(crate) struct PixelImages {
    domain: Domain,
    /// The images in curved mirrors.
    curved: Vec<CurvedImage>,
    /// Those of each pixel; empty if no pixel sees any.
    of_pixels: Vec<PixelCurvedImages>,
    /// The lights that plane mirrors may show, and their images.
    in_plane_mirrors: Vec<MirroredLight>,
    plane: PlaneImages,
}

/// How the rays of a pixel are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RayPurpose {
    /// They show all light.
    AllLight,
    /// They show the light of images alone, where rays are aimed at them. Others show it elsewhere.
    ImagesApart,
}

/// The images in curved mirrors that one pixel sees.
#[derive(Clone, Debug, Default)]
struct PixelCurvedImages {
    images: Vec<PixelImage>,
    /// Fraction of the rays that is aimed at them, where they show the light of images alone.
    aimed: f64,
}

/// The image of a light in a pixel.
#[derive(Clone, Copy, Debug)]
struct PixelImage {
    /// Index of the image.
    image: usize,
    /// Where its rays are aimed.
    domain: Domain,
    /// The image of the light's disk by the linear map.
    ellipse: Ellipse,
    /// Share of the draws.
    probability: f64,
}

impl PixelImages {
    /// Whether no pixel sees an image.
    pub(crate) fn is_empty(&self) -> bool {
        self.of_pixels.is_empty() && self.plane.is_empty()
    }

    /// The images in curved mirrors; `None` if there are others.
    pub(crate) fn curved_alone(&self) -> Option<&[CurvedImage]> {
        self.plane.is_empty().then_some(&self.curved)
    }

    /// Whether a pixel sees an image.
    pub(crate) fn sees_any(&self, pixel: usize) -> bool {
        !self.curved_of(pixel).is_empty() || self.plane.sees_any(pixel)
    }

    /// The ray that passes through a pixel and the pinhole.
    pub(crate) fn plain_ray(&self, rays: &Rays, passage: &PixelPassage) -> Option<CameraRay> {
        let (fixed, at) = self.domain.fixed_and_drawn(passage.on_pixel, passage.on_pinhole);
        self.domain.ray(rays, passage.pixel as u64, fixed, at)
    }

    /// Whether rays are aimed where a ray passes. With plane mirrors they are aimed everywhere.
    pub(crate) fn are_aimed_at(&self, passage: &PixelPassage) -> bool {
        let is_aimed_at = |image: &PixelImage| self.density(image, passage.on_pixel, passage.on_pinhole) > 0.0;
        self.plane.sees_any(passage.pixel) || self.curved_of(passage.pixel).iter().any(is_aimed_at)
    }

    /// The images in curved mirrors that a pixel sees.
    fn curved_of(&self, pixel: usize) -> &[PixelImage] {
        self.of_pixels.get(pixel).map_or(&[], |of_pixel| &of_pixel.images)
    }

    /// The pdf of the samples of an image, relative to uniform sampling.
    fn density(&self, image: &PixelImage, on_pixel: DVec2, on_pinhole: DVec2) -> f64 {
        let (fixed, at) = image.domain.fixed_and_drawn(on_pixel, on_pinhole);
        let pdf = self.curved[image.image].footprint.pdf(image.ellipse.offset(fixed, at));
        image.probability * pdf * image.domain.area() / image.ellipse.relative_area()
    }

    /// Whether a pixel sees an image in a plane mirror.
    fn sees_plane(&self, pixel: usize) -> bool {
        self.plane.sees_any(pixel)
    }

    /// Finds the images that the pixels of a camera see.
    pub(crate) fn find(renderer: &Renderer, rays: &Rays) -> PixelImages {
        let (domain, camera) = (Domain::of(rays.hole()), rays.camera());
        let none = PixelImages {
            domain,
            curved: Vec::new(),
            of_pixels: Vec::new(),
            in_plane_mirrors: Vec::new(),
            plane: PlaneImages::default(),
        };
        if !rays.hole().has_points() {
            return none;
        }
        let position = camera.position_m() / camera.scene_unit_m();
        let field = FieldOfView::new(rays);
        let is_seen = |axis, reach| field.as_ref().is_none_or(|field| field.meets(axis, reach));
        let mut worker = renderer.worker();
        let lights = worker.mirrored_lights(position, is_seen);
        let curved = CurvedImage::all(&mut worker, &lights, position);
        let in_plane_mirrors = MirroredLight::in_plane_mirrors(renderer.plan(), position);
        if curved.is_empty() && in_plane_mirrors.is_empty() {
            return none;
        }
        let may_see_any = |cone: &PixelCone| {
            curved.iter().any(|image| cone.meets(image.direction(), image.reach()))
                || in_plane_mirrors.iter().any(|image| cone.meets_plane(image))
        };
        let blocks = PixelBlocks::new(rays, may_see_any);
        let of_pixel = |worker: &mut RayWorker<'_>, pixel: usize| {
            if !blocks.may_see_any(pixel) {
                return (PixelCurvedImages::default(), None);
            }
            let pixel = pixel as u64;
            let Some(cone) = PixelCone::new(rays, pixel) else { return (PixelCurvedImages::default(), None) };
            let search = &mut Search { worker, rays, pixel, domain };
            let images = PixelCurvedImages::new(search.curved_images(&cone, &curved), &curved);
            let seen = in_plane_mirrors.iter().enumerate().filter(|(_, image)| cone.meets_plane(image));
            let plane = seen.filter_map(|image| search.plane_image(renderer.plan(), image));
            (images, PlaneStrata::new(plane, domain).map(Box::new))
        };
        let (of_pixels, plane): (Vec<_>, Vec<_>) = (0..camera.pixel_count() as usize)
            .into_par_iter()
            .with_min_len(64)
            .map_init(|| renderer.worker(), of_pixel)
            .unzip();
        let is_empty = of_pixels.iter().all(|of_pixel: &PixelCurvedImages| of_pixel.images.is_empty());
        let of_pixels = if is_empty { Vec::new() } else { of_pixels };
        PixelImages { domain, curved, of_pixels, in_plane_mirrors, plane: PlaneImages::new(plane) }
    }

    /// The ray of a pixel for a point of the unit cube, and its weight. `None` where it would miss
    /// the pinhole or the pixel, or its light belongs to another stratum.
    #[inline]
    pub(crate) fn ray(
        &self,
        (plan, rays): (&RenderPlan, &Rays),
        (pixel, purpose): (usize, RayPurpose),
        u: [f64; 4],
    ) -> Option<(CameraRay, f64)> {
        if !self.sees_any(pixel) {
            return Some((rays.ray(pixel as u64, u), 1.0));
        }
        let is_point = self.domain == Domain::Square;
        let [fixed, drawn] = if is_point { [[u[2], u[3]], [u[0], u[1]]] } else { [[u[0], u[1]], [u[2], u[3]]] };
        let curved = self.curved_of(pixel);
        let (aimed, is_apart) = match purpose {
            RayPurpose::AllLight => (AIMED, false),
            // With plane mirrors rays are aimed everywhere.
            RayPurpose::ImagesApart if self.sees_plane(pixel) => (AIMED_BESIDE_PLANE, false),
            RayPurpose::ImagesApart => (self.of_pixels[pixel].aimed, true),
        };
        let mixed = |drawn| self.mixed_point(curved, (aimed, is_apart), fixed, drawn);
        let ray = |fixed, at| self.domain.ray(rays, pixel as u64, fixed, at);
        let hits = |fixed, at, light: usize| {
            let ray = ray(fixed, at).and_then(|ray| Ray::new(ray.origin, ray.direction));
            ray.is_some_and(|ray| self.in_plane_mirrors[light].is_in_plane_mirror(plan, &ray))
        };
        let WeightedPoint { fixed, at, weight } = match self.plane.of_pixel(pixel) {
            None => mixed(drawn)?,
            Some(strata) => strata.sample((fixed.into(), drawn), hits, mixed)?,
        };
        Some((ray(fixed, at)?, weight))
    }

    /// A point of the pinhole, or of the pixel for a point pinhole, and its fixed point, with their
    /// weight. `aimed` is the fraction of points that is aimed at the images; if they are exposed apart, there
    /// are no points elsewhere. `None` where the aimed one of them misses the pinhole or the pixel.
    fn mixed_point(
        &self,
        images: &[PixelImage],
        (aimed, is_apart): (f64, bool),
        uniform: [f64; 2],
        drawn: [f64; 2],
    ) -> Option<WeightedPoint> {
        let fixed = DVec2::from(uniform);
        if images.is_empty() {
            return Some(WeightedPoint { fixed, at: self.domain.uniform(drawn), weight: 1.0 });
        }
        let (on_pixel, on_pinhole) = if drawn[0] < aimed {
            let (chosen, u) = choose(images.iter().map(|image| image.probability), drawn[0] / aimed)?;
            let PixelImage { domain, ellipse, image, .. } = &images[chosen];
            let fixed = if *domain == self.domain { fixed } else { self.domain.uniform(uniform) };
            let at = ellipse.point(fixed, self.curved[*image].footprint.sample([u, drawn[1]]));
            if !domain.contains(at) {
                return None;
            }
            domain.fixed_and_drawn(fixed, at)
        } else {
            let at = self.domain.uniform([(drawn[0] - aimed) / (1.0 - aimed), drawn[1]]);
            self.domain.fixed_and_drawn(fixed, at)
        };
        let density = images.iter().map(|image| self.density(image, on_pixel, on_pinhole)).sum::<f64>();
        if is_apart && density <= 0.0 {
            return None;
        }
        let pdf = 1.0 - aimed + aimed * density;
        let (fixed, at) = self.domain.fixed_and_drawn(on_pixel, on_pinhole);
        // By rounding a point may lie outside of the image that it was drawn from.
        (pdf > 0.0).then(|| WeightedPoint { fixed, at, weight: pdf.recip() })
    }
}

impl PixelCurvedImages {
    /// Points of pixel and pinhole that tell how well rays can be aimed.
    const POINTS: u32 = 64;

    /// Of images with their light instead of probabilities. Those whose rays hardly pass the pixel get few.
    fn new(mut images: Vec<PixelImage>, curved: &[CurvedImage]) -> PixelCurvedImages {
        if images.is_empty() {
            return PixelCurvedImages::default();
        }
        let share = |is_counted: &dyn Fn([f64; 4]) -> bool| {
            (0..PixelCurvedImages::POINTS).filter(|index| is_counted(even_point(*index))).count() as f64
                / f64::from(PixelCurvedImages::POINTS)
        };
        // The fraction of the rays aimed at each image that pass.
        let passing: Vec<f64> = images
            .iter()
            .map(|image| {
                let passes = |[a, b, c, d]: [f64; 4]| {
                    let (fixed, place) =
                        (image.domain.uniform_fixed([a, b]), curved[image.image].footprint.sample([c, d]));
                    image.domain.contains(image.ellipse.point(fixed, place))
                };
                share(&passes)
            })
            .collect();
        for (image, passing) in images.iter_mut().zip(&passing) {
            image.probability *= passing.max(f64::from(PixelCurvedImages::POINTS).recip());
        }
        let total: f64 = images.iter().map(|image| image.probability).sum();
        images.iter_mut().for_each(|image| image.probability /= total);
        let passing: f64 = images.iter().zip(&passing).map(|(image, passing)| image.probability * passing).sum();
        // The fraction of uniform rays that show an image.
        let shows = |image: &PixelImage, [a, b, c, d]: [f64; 4]| {
            let (fixed, at) = image.domain.fixed_and_drawn(DVec2::new(a, b), Domain::Disk.uniform([c, d]));
            curved[image.image].footprint.in_cells(image.ellipse.offset(fixed, at)) > 0.0
        };
        let showing = share(&|u| images.iter().any(|image| shows(image, u)));
        let aimed = if passing >= showing { 1.0 } else { AIMED_AT_WIDE };
        PixelCurvedImages { images, aimed }
    }
}

/// Evenly distributed points of the unit cube of four dimensions (the R4 sequence of M. Roberts).
fn even_point(index: u32) -> [f64; 4] {
    const STEPS: [f64; 4] =
        [0.856_674_883_854_502_9, 0.733_891_856_627_126, 0.628_706_721_037_808_7, 0.538_597_257_223_610_1];
    STEPS.map(|step| (0.5 + step * f64::from(index)).fract())
}

/// A cone around all rays of a plain pinhole camera.
struct FieldOfView {
    /// Unit.
    axis: DVec3,
    /// Radians.
    half_angle: f64,
}

impl FieldOfView {
    /// `None` for cameras whose corners may not be farthest from the axis.
    fn new(rays: &Rays) -> Option<FieldOfView> {
        let camera = rays.camera();
        if !camera.is_plain_pinhole() {
            return None;
        }
        let (axis, last) = (camera.direction(), camera.pixel_count() - 1);
        let [columns, rows] = [camera.columns(), camera.rows()].map(u64::from);
        let corners =
            [(0, [0.0, 0.0]), (columns - 1, [1.0, 0.0]), ((rows - 1) * columns, [0.0, 1.0]), (last, [1.0; 2])];
        let mut half_angle = 0.0_f64;
        for (pixel, place) in corners {
            // The rim of the pinhole is at most as far from its centre as the wider of two points.
            let at = |on_pinhole: [f64; 2]| rays.ray_through(pixel, place, on_pinhole).map(|ray| ray.direction);
            let (middle, rim) = (at([0.0; 2])?, at([1.0, 0.0])?.distance(at([-1.0, 0.0])?));
            half_angle = half_angle.max(middle.angle_between(axis) + rim);
        }
        Some(FieldOfView { axis, half_angle })
    }

    /// Whether a cone with a half angle by its tangent may contain a ray.
    fn meets(&self, axis: DVec3, tangent: f64) -> bool {
        self.axis.angle_between(axis) <= self.half_angle + tangent.atan()
    }
}

/// The square blocks of pixels of a picture that may see an image: saves most pixels their search.
struct PixelBlocks {
    columns: usize,
    /// Row by row; empty for cameras whose blocks have no known cone.
    may_see_any: Vec<bool>,
}

impl PixelBlocks {
    /// Pixels along each side.
    const SIDE: usize = 8;

    /// The corners of a block may have pixels that are smaller by this factor than others.
    const MARGIN: f64 = 1.1;

    /// `may_see_any` tells whether pixels within a cone may see an image.
    fn new(rays: &Rays, may_see_any: impl Fn(&PixelCone) -> bool) -> PixelBlocks {
        let camera = rays.camera();
        let [columns, rows] = [camera.columns(), camera.rows()].map(|count| count as usize);
        let across = columns.div_ceil(PixelBlocks::SIDE);
        let of_block = |block: usize| {
            let [x, y] = [block % across, block / across].map(|index| index * PixelBlocks::SIDE);
            let last = [(x, columns), (y, rows)].map(|(first, count)| (first + PixelBlocks::SIDE - 1).min(count - 1));
            let cone = PixelBlocks::cone(rays, columns, [[x, last[0]], [y, last[1]]]);
            cone.is_none_or(|cone| may_see_any(&cone))
        };
        let may_see_any = match camera.is_plain_pinhole() {
            true => (0..across * rows.div_ceil(PixelBlocks::SIDE)).map(of_block).collect(),
            false => Vec::new(),
        };
        PixelBlocks { columns, may_see_any }
    }

    /// The cone around all pixels from the first to the last of two columns and rows.
    fn cone(rays: &Rays, columns: usize, [across, down]: [[usize; 2]; 2]) -> Option<PixelCone> {
        let of_pixel = |x: usize, y: usize| PixelCone::new(rays, (y * columns + x) as u64);
        let middle = of_pixel(across[0].midpoint(across[1]), down[0].midpoint(down[1]))?;
        let mut max_chord = middle.max_chord;
        for (x, y) in down.into_iter().flat_map(|y| across.map(|x| (x, y))) {
            let corner = of_pixel(x, y)?;
            max_chord = max_chord.max(PixelBlocks::MARGIN * corner.max_chord + corner.middle.distance(middle.middle));
        }
        Some(PixelCone { max_chord, ..middle })
    }

    fn may_see_any(&self, pixel: usize) -> bool {
        let [x, y] = [pixel % self.columns, pixel / self.columns].map(|index| index / PixelBlocks::SIDE);
        self.may_see_any.get(y * self.columns.div_ceil(PixelBlocks::SIDE) + x).is_none_or(|may_see| *may_see)
    }
}

/// A cone around the rays of a pixel.
struct PixelCone {
    /// Unit.
    middle: DVec3,
    /// Chord from the axis within which images are searched.
    max_chord: f64,
}

impl PixelCone {
    fn new(rays: &Rays, pixel: u64) -> Option<PixelCone> {
        let direction =
            |place: [f64; 2], on_pinhole: [f64; 2]| rays.ray_through(pixel, place, on_pinhole).map(|ray| ray.direction);
        let middle = direction([0.5; 2], [0.0; 2])?;
        let across =
            |place, on_pinhole| direction(place, on_pinhole).map_or(0.0, |direction| direction.distance(middle));
        let widest = across([0.0; 2], [0.0; 2]).max(across([1.0; 2], [0.0; 2])) + across([0.5; 2], [1.0, 0.0]);
        // An upper bound: no pixel and no pinhole is wider.
        Some(PixelCone { middle, max_chord: (2.0 * widest).min(0.5) })
    }

    /// Whether the pixel may see an image in a direction with this reach, as a tangent.
    fn meets(&self, direction: DVec3, reach: f64) -> bool {
        let chord = self.max_chord + reach;
        self.middle.distance_squared(direction) <= chord * chord
    }

    /// Whether the pixel may see a light in a plane mirror.
    fn meets_plane(&self, image: &MirroredLight) -> bool {
        let meets_mirror = |(axis, reach)| self.meets(axis, reach);
        self.meets(image.direction(), 0.0) && image.mirror_cone().is_none_or(meets_mirror)
    }
}

/// Finds an image in one pixel.
struct Search<'s, 'r> {
    worker: &'s mut RayWorker<'r>,
    rays: &'s Rays,
    pixel: u64,
    domain: Domain,
}

impl Search<'_, '_> {
    /// The ray through a fixed point and a point of the domain.
    fn ray(&self, fixed: DVec2, at: DVec2) -> Option<Ray> {
        let ray = self.domain.ray(self.rays, self.pixel, fixed, at)?;
        Ray::new(ray.origin, ray.direction)
    }

    /// Where this ray passes the light, in radii of the light.
    fn offset_from_light(&mut self, image: &MirroredLight, fixed: DVec2, at: DVec2) -> Option<DVec2> {
        let ray = self.ray(fixed, at)?;
        self.worker.offset_from(image, &ray)
    }

    /// The point of the domain whose ray has the image's direction, to first order in the size of
    /// the pinhole.
    fn start(&self, image: &MirroredLight) -> Option<DVec2> {
        let middle = self.domain.middle();
        let direction = |at: DVec2| {
            let ray = self.domain.ray(self.rays, self.pixel, Domain::MIDDLE_OF_PIXEL, at);
            ray.map(|ray| ray.direction)
        };
        let own = direction(middle)?;
        let [x, y] = [direction(middle + DVec2::X)? - own, direction(middle + DVec2::Y)? - own];
        let off = image.direction() - own;
        // Least squares in the plane of the two derivatives.
        let normal = DMat2::from_cols_array(&[x.dot(x), x.dot(y), x.dot(y), y.dot(y)]);
        let at = middle + normal.inverse() * DVec2::new(x.dot(off), y.dot(off));
        (at.is_finite() && at.length() <= MAX_COORDINATE).then_some(at)
    }

    /// The image as the pixel sees it, by Newton's method; `None` if it does not.
    fn image(&mut self, image: &MirroredLight) -> Option<Ellipse> {
        let domain = self.domain;
        let mut at = self.start(image)?;
        let mut best: Option<(f64, Ellipse)> = None;
        for _ in 0..MAX_STEPS {
            let linear = LinearMap::new(at, |at| self.offset_from_light(image, Domain::MIDDLE_OF_PIXEL, at));
            let Some(linear) = linear else { break };
            let center = linear.zero();
            if !center.is_finite() || center.length() > MAX_COORDINATE {
                break;
            }
            let miss = linear.value.length();
            if best.as_ref().is_none_or(|(least, _)| miss < *least) {
                let ellipse = linear.ellipse(domain, |fixed| self.offset_from_light(image, fixed, at));
                best = ellipse.map(|ellipse| (miss, ellipse)).or(best);
            }
            if miss <= CONVERGED {
                break;
            }
            at = center;
        }
        best.filter(|(miss, _)| *miss <= MAX_MISS).map(|(_, ellipse)| ellipse)
    }

    /// The images in curved mirrors that the pixel sees, with their light instead of probabilities.
    fn curved_images(&self, cone: &PixelCone, images: &[CurvedImage]) -> Vec<PixelImage> {
        let seen = |(image, curved): (usize, &CurvedImage)| {
            let is_near = cone.meets(curved.direction(), curved.reach());
            let (domain, ellipse) = is_near.then(|| self.curved_image(curved))??;
            Some(PixelImage { image, domain, ellipse, probability: curved.light() })
        };
        images.iter().enumerate().filter_map(seen).collect()
    }

    /// Where the light of an image in curved mirrors is seen; `None` if the pixel does not see it.
    fn curved_image(&self, image: &CurvedImage) -> Option<(Domain, Ellipse)> {
        let tangents = |on_pixel: DVec2, on_pinhole: DVec2| {
            let ray = Domain::Disk.ray(self.rays, self.pixel, on_pixel, on_pinhole)?;
            Some(image.tangents(ray.origin, ray.direction))
        };
        let middle = Domain::MIDDLE_OF_PIXEL;
        let own = tangents(middle, DVec2::ZERO)?;
        // Differences over the whole pixel, and over half of the pinhole.
        let across = |of_side: &dyn Fn(DVec2) -> Option<DVec2>| {
            let [x, y] = [DVec2::X, DVec2::Y].map(|side| {
                let [low, high] = [-0.5, 0.5].map(|half| of_side(half * side));
                Some(high? - low?)
            });
            Some(DMat2::from_cols(x?, y?))
        };
        let by_pixel = across(&|side| tangents(middle + side, DVec2::ZERO))?;
        let by_pinhole = across(&|side| tangents(middle, side))?;
        // The directions through all of the pinhole, and those of the pixel.
        let is_blurred = PI * by_pinhole.determinant().abs() > by_pixel.determinant().abs();
        let (domain, by_drawn, by_fixed) =
            if is_blurred { (Domain::Disk, by_pinhole, by_pixel) } else { (Domain::Square, by_pixel, by_pinhole) };
        let inverse = by_drawn.inverse();
        let slope = -(inverse * by_fixed);
        let center = domain.middle() + inverse * (image.center - own);
        let ellipse = Ellipse::new(center - slope * domain.middle_of_fixed(), slope, inverse * image.map);
        // Half of the pixel, or the radius of the pinhole.
        let reach_of_fixed = if domain == Domain::Disk { 0.5 } else { 1.0 };
        let moved = reach_of_fixed * (slope.x_axis.length() + slope.y_axis.length());
        let reach = image.footprint.reach() * ellipse.widest() + moved;
        (ellipse.is_finite() && domain.meets(center, reach)).then_some((domain, ellipse))
    }

    /// The image of a light in a plane mirror; `None` if the pixel does not see it.
    fn plane_image(&mut self, plan: &RenderPlan, (light, image): (usize, &MirroredLight)) -> Option<PlaneImage> {
        let domain = self.domain;
        let mut found = PlaneImage::new(self.image(image)?, light, domain)?;
        let place_in_ring = |fixed, at| image.place_in_ring(&self.ray(fixed, at)?);
        if let (Some(opening), Some(ring)) = (image.ring_opening(), ring_outline(domain, place_in_ring)) {
            let miss = |fixed, at, place: DVec2| Some(place_in_ring(fixed, at)?.distance(place));
            found = found.clipped(ring, opening, miss);
        }
        let mut rays = found.overlap_points(domain).filter_map(|(fixed, at)| self.ray(fixed, at));
        if !rays.any(|ray| image.is_in_plane_mirror(plan, &ray)) {
            return None;
        }
        let mut farthest = 0.0_f64;
        for (fixed, at) in found.own_points() {
            let offset = self.offset_from_light(image, fixed, at)?;
            farthest = farthest.max(offset.distance(found.offset(fixed, at)));
        }
        found.widened(farthest)
    }
}

/// The outline of a ring, whose rim has the distance 1 from its centre in the plane of the ring.
fn ring_outline(domain: Domain, place: impl Fn(DVec2, DVec2) -> Option<DVec2>) -> Option<Ellipse> {
    let at = domain.middle();
    let linear = LinearMap::new(at, |at| place(Domain::MIDDLE_OF_PIXEL, at))?;
    linear.ellipse(domain, |fixed| place(fixed, at))
}
