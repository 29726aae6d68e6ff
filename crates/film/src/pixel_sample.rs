//! Samples of the pixels of an interpolated picture, and the surfaces that they see.

use crate::view_camera::{CameraRay, traced, traced_by};
use glam::{DVec3, Vec3};
use radsight_render::{DirectRecord, FirstHit, NearRecord, RayWorker, Traced};

/// Minimum cosine between the normals of corners of an interpolated cell.
const MIN_COSINE: f64 = 0.9;

/// Maximum distance of a corner from the plane of another, relative to the distance between them.
const MAX_SLOPE: f64 = 0.3;

/// Distance of points in one plane, because of rounding, scene units.
const IN_PLANE: f64 = 1e-9;

/// The result of the rays of a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) rays: u32,
    pub(crate) value: [f64; 3],
    /// Squared standard error of the mean over the bands, from the variance of the rays.
    pub(crate) variance: f64,
    pub(crate) surface: Surface,
    /// Whether a highlight was sampled.
    pub(crate) is_glossy: bool,
}

/// The samples of a block of pixels. Most pixels have none, so samples are not stored by pixel: the
/// first use of a page costs as much as a ray.
#[derive(Debug)]
pub(crate) struct Samples {
    samples: Vec<Sample>,
    /// The pixel of each sample.
    pixels: Vec<u32>,
    /// By pixel: one more than the index of its sample, or 0.
    places: Vec<u32>,
}

impl Samples {
    /// For so many pixels.
    pub(crate) fn new(pixels: usize) -> Samples {
        // Memory that is not used costs nothing, but a buffer that grows is copied.
        Samples { samples: Vec::with_capacity(pixels), pixels: Vec::with_capacity(pixels), places: vec![0; pixels] }
    }

    /// Sets the sample of a pixel.
    pub(crate) fn set(&mut self, pixel: usize, sample: Sample) {
        if let Some(index) = self.index(pixel) {
            self.samples[index] = sample;
            return;
        }
        self.samples.push(sample);
        self.pixels.push(pixel as u32);
        self.places[pixel] = self.samples.len() as u32;
    }

    /// Number of pixels.
    pub(crate) fn pixels(&self) -> usize {
        self.places.len()
    }

    /// Number of samples.
    pub(crate) fn count(&self) -> usize {
        self.samples.len()
    }

    /// The index of the sample of a pixel.
    #[inline]
    pub(crate) fn index(&self, pixel: usize) -> Option<usize> {
        (self.places[pixel] as usize).checked_sub(1)
    }

    /// The sample of a pixel.
    #[inline]
    pub(crate) fn get(&self, pixel: usize) -> Option<&Sample> {
        self.index(pixel).map(|index| &self.samples[index])
    }

    /// A sample by its index, and its pixel.
    #[inline]
    pub(crate) fn numbered(&self, index: usize) -> (usize, &Sample) {
        (self.pixels[index] as usize, &self.samples[index])
    }

    /// All samples.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter()
    }
}

/// The rays of a pixel so far.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) rays: u32,
    sum: [f64; 3],
    squares: f64,
    surface: Option<Surface>,
    is_glossy: bool,
}

impl Tally {
    /// The ray of a sample of a single one.
    pub(crate) fn of_one_ray(sample: &Sample) -> Tally {
        let Sample { rays, value, surface, is_glossy, .. } = *sample;
        Tally { rays, sum: value, squares: mean(&value).powi(2), surface: Some(surface), is_glossy }
    }

    pub(crate) fn add(&mut self, RayValue { value, surface: met, is_glossy }: RayValue) {
        self.rays += 1;
        self.is_glossy |= is_glossy;
        self.sum = std::array::from_fn(|band| self.sum[band] + value[band]);
        self.squares += mean(&value).powi(2);
        self.surface = Some(match self.surface {
            Some(before) if !before.joins(&met) => Surface { key: SEVERAL, ..before },
            Some(before) => before,
            None => met,
        });
    }

    pub(crate) fn sample(&self) -> Sample {
        let count = f64::from(self.rays.max(1));
        let value = self.sum.map(|band| band / count);
        let spread = (self.squares / count - mean(&value).powi(2)).max(0.0);
        let variance = spread / (count - 1.0).max(1.0);
        let surface = self.surface.unwrap_or(Surface::NONE);
        Sample { rays: self.rays, value, variance, surface, is_glossy: self.is_glossy }
    }
}

/// No single surface.
pub(crate) const SEVERAL: u64 = 0;

/// The surface that a pixel sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    /// 0 where the rays of the pixel saw several surfaces.
    pub(crate) key: u64,
    material: u32,
    point: DVec3,
    normal: DVec3,
    distance: f64,
    /// Unit direction of a mirror reflection, textures included.
    reflected: Vec3,
}

impl Surface {
    const NONE: Surface = Surface {
        key: SEVERAL,
        material: u32::MAX,
        point: DVec3::ZERO,
        normal: DVec3::ZERO,
        distance: f64::INFINITY,
        reflected: Vec3::ZERO,
    };

    /// The surface that a ray in this direction hit first; `key` identifies all surfaces on its
    /// path.
    pub(crate) fn new(key: u64, hit: Option<FirstHit>, direction: DVec3) -> Surface {
        let key = key.max(1);
        match hit {
            Some(FirstHit { distance, point, normal, perturbed_normal, material, .. }) if distance.is_finite() => {
                let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
                let reflected = direction.reflect(perturbed_normal).as_vec3();
                Surface { key, material, point, normal, distance, reflected }
            }
            _ => Surface { key, ..Surface::NONE },
        }
    }

    /// Whether it is a surface at a finite distance.
    pub(crate) fn is_hit(&self) -> bool {
        self.distance.is_finite()
    }

    /// Index of the compiled material; `None` for no surface.
    pub(crate) fn material(&self) -> Option<u32> {
        self.is_hit().then_some(self.material)
    }

    pub(crate) fn point(&self) -> DVec3 {
        self.point
    }

    /// The unit direction of a mirror reflection, textures included.
    pub(crate) fn reflected(&self) -> DVec3 {
        self.reflected.as_dvec3()
    }

    /// Whether pixels between two can be interpolated.
    pub(crate) fn joins(&self, other: &Surface) -> bool {
        self.key == other.key && self.key != SEVERAL && self.continues(other)
    }

    /// Whether the first surface is the same, or continues smoothly in another one.
    pub(crate) fn continues(&self, other: &Surface) -> bool {
        if self.material != other.material || self.is_hit() != other.is_hit() {
            return false;
        }
        !self.is_hit() || self.is_smooth_beside(other)
    }

    /// Whether two surfaces, whatever their materials, have about the same plane.
    pub(crate) fn is_smooth_beside(&self, other: &Surface) -> bool {
        if self.normal.dot(other.normal) < MIN_COSINE {
            return false;
        }
        let way = other.point - self.point;
        let [here, there] = [self, other].map(|surface| surface.normal.dot(way).abs());
        let apart = if there > here { there } else { here };
        // Most neighbours lie in one plane, which needs no square root.
        apart <= IN_PLANE || apart <= MAX_SLOPE * way.length() + IN_PLANE
    }
}

/// Outside the view, or beyond the aft clipping plane.
const OUTSIDE: Surface = Surface { key: 1, ..Surface::NONE };

/// The result of a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayValue {
    pub(crate) value: [f64; 3],
    pub(crate) surface: Surface,
    /// Whether a highlight was sampled.
    is_glossy: bool,
}

impl RayValue {
    pub(crate) const OUTSIDE: RayValue = RayValue { value: [0.0; 3], surface: OUTSIDE, is_glossy: false };

    /// The radiance of a ray, and the surfaces that it hits. Where rays beside it recorded direct
    /// light, its own is added to `record`.
    pub(crate) fn trace(
        worker: &mut RayWorker<'_>,
        index: u64,
        ray: &CameraRay,
        (near, record): (Option<&[NearRecord]>, &mut Option<DirectRecord>),
    ) -> RayValue {
        let traced = match near {
            None => traced(worker, index, ray),
            Some(near) => traced_by(worker, ray, |worker, ray| worker.trace_near(index, ray, near, record)),
        };
        traced.map_or(RayValue::OUTSIDE, |traced| RayValue::of(&traced, ray))
    }

    fn of(traced: &Traced, ray: &CameraRay) -> RayValue {
        RayValue {
            value: traced.value,
            surface: Surface::new(traced.surface_key, traced.first_hit, ray.direction),
            is_glossy: traced.samples_highlight,
        }
    }
}

/// The mean over the bands.
pub(crate) fn mean(value: &[f64; 3]) -> f64 {
    (value[0] + value[1] + value[2]) / 3.0
}
