//! The light of images, exposed apart from the rest of a picture.
//!
//! Without the images of lights in mirrors a picture is smooth, so its pixels may be interpolated
//! and may share rays. With them some of its pixels are a thousand times as bright as others, and
//! the images begin and end within a pixel. So the radiance of a ray is divided
//! ([`CountedLight`]): where rays are aimed at images, the picture has no light of images, and the
//! aimed rays add that light alone. They are cheap, since no light is sampled.
//!
//! Images that were not found belong to the rest. Rays find them by chance, and pixels share them.

use crate::adaptive::{AdaptiveSampler, MAX_PASSES};
use crate::checkpoint::AdaptiveState;
use crate::mirrored_lights::RayPurpose;
use crate::pixel_errors::{Estimate, NoisePooling, pooled_errors};
use crate::radiance::radiance;
use crate::sums::{Pixel, Sums};
use crate::{Exposer, Workers};
use radsight_adaptive::{
    ErrorEstimate, MAX_SAMPLES, NoiseTarget, PixelError, PixelSource, Selection, Stop, begin, ray_number, refine,
};
use radsight_render::CountedLight;
use radsight_sampling::{DimensionSet, RaySampler};
use std::ops::Range;

/// Fraction of the squared error that is kept for the light of images. Their rays are cheap.
pub(crate) const IMAGE_FRACTION: f64 = 0.15;

/// Ray numbers of images begin at this pixel, so that their samples are independent of others.
const FIRST_PIXEL: u64 = 1 << 40;

/// The target for a sum of squared errors over so many pixels or parts of images.
pub(crate) fn image_target(squared: f64, count: usize) -> NoiseTarget {
    let most_passes = MAX_PASSES;
    NoiseTarget { most_passes, ..NoiseTarget::new(squared / count as f64, Selection::FractionOrFirst) }
}

/// A worker whose rays count the light of images alone.
pub(crate) fn image_worker<'a>(sampler: &AdaptiveSampler<'a>) -> Workers<'a> {
    let mut worker = sampler.exposer.workers();
    worker.count(CountedLight::Images);
    worker
}

/// The light of images in the pixels that see any.
#[derive(Debug)]
pub(crate) struct ImageLight {
    /// In ascending order.
    pixels: Vec<usize>,
    state: AdaptiveState,
}

/// The light of exposed images, with errors by pixel.
#[derive(Debug)]
pub(crate) struct ExposedImages {
    /// The pixel, the mean of its samples, and its error.
    pub(crate) pixels: Vec<(usize, f64, PixelError)>,
    /// Why it has more error than requested.
    pub(crate) stop: Option<Stop>,
}

impl ExposedImages {
    /// Adds the light to the other light of pixels, and its error to the estimate.
    pub(crate) fn add_to(&self, state: &mut AdaptiveState, estimate: &mut Estimate) {
        let before = estimate.mean;
        for (pixel, mean, _) in &self.pixels {
            let samples = &mut state.pixels[*pixel];
            samples.sums.whole += mean * f64::from(samples.samples);
            estimate.mean += mean / estimate.pixels.len() as f64;
        }
        let unit = (estimate.mean * estimate.mean).recip();
        estimate.pixels.iter_mut().for_each(|pixel| pixel.squared *= before * before * unit);
        for (pixel, _, error) in &self.pixels {
            let whole = &mut estimate.pixels[*pixel];
            whole.squared += unit * error.squared;
            whole.samples += error.samples;
            let samples = &mut state.pixels[*pixel];
            (samples.last, samples.before) = (samples.last + error.squared, samples.before + 2.0 * error.squared);
        }
    }
}

/// Traces the rays of the pixels of an [`ImageLight`].
struct ImageSource<'s, 'a> {
    sampler: &'s AdaptiveSampler<'a>,
    pixels: &'s [usize],
}

impl ImageLight {
    /// With the first samples.
    pub(crate) fn begin(sampler: &AdaptiveSampler<'_>) -> ImageLight {
        let count = sampler.exposer.rays.camera().pixel_count() as usize;
        let pixels: Vec<usize> = (0..count).filter(|pixel| sampler.images.sees_any(*pixel)).collect();
        let mut state = AdaptiveState::new(pixels.len());
        begin(&ImageSource { sampler, pixels: &pixels }, &mut state);
        ImageLight { pixels, state }
    }

    /// Sum over all pixels, in units of radiance.
    pub(crate) fn sum(&self) -> f64 {
        self.state.pixels.iter().map(Pixel::mean).sum()
    }

    /// Number of rays.
    pub(crate) fn samples(&self) -> u64 {
        self.state.samples()
    }

    /// Refines the images to a sum of squared errors over all pixels.
    pub(crate) fn expose(&mut self, sampler: &AdaptiveSampler<'_>, squared: f64, most_samples: u32) -> ExposedImages {
        let ImageLight { pixels, state } = self;
        let columns = sampler.exposer.rays.camera().columns() as usize;
        let most_samples = most_samples.min(MAX_SAMPLES);
        let target = NoiseTarget { most_samples, ..image_target(squared, pixels.len()) };
        let estimate = |samples: &[Pixel]| ImageErrors::new(pixels, samples, columns);
        let source = ImageSource { sampler, pixels };
        let (ImageErrors(errors), stop) = refine(&source, state, &target, estimate);
        let means = state.pixels.iter().map(Pixel::mean);
        let exposed = pixels.iter().zip(means).zip(errors).map(|((pixel, mean), error)| (*pixel, mean, error));
        ExposedImages { pixels: exposed.collect(), stop }
    }
}

/// The errors of the pixels with images.
struct ImageErrors(Vec<PixelError>);

impl ImageErrors {
    fn new(pixels: &[usize], samples: &[Pixel], columns: usize) -> ImageErrors {
        let size = pixels.last().map_or(0, |last| (last / columns + 1) * columns);
        let mut picture = vec![Pixel::default(); size];
        pixels.iter().zip(samples).for_each(|(pixel, samples)| picture[*pixel] = *samples);
        let errors =
            pooled_errors((&picture, NoisePooling::Near), columns, |pixel| usize::from(picture[pixel].samples > 0));
        ImageErrors(errors.into_iter().map(|(_, error)| error).collect())
    }
}

impl ErrorEstimate for ImageErrors {
    fn pixels(&self) -> &[PixelError] {
        &self.0
    }
}

impl<'a> PixelSource for ImageSource<'_, 'a> {
    type Sums = Sums;
    type Worker = Workers<'a>;

    fn worker(&self) -> Workers<'a> {
        image_worker(self.sampler)
    }

    fn sums(&self, worker: &mut Workers<'a>, pixel: usize, samples: Range<u32>) -> Sums {
        let Exposer { renderer, rays, weights, .. } = *self.sampler.exposer;
        let pixel = self.pixels[pixel];
        let number = pixel as u64;
        let purpose = RayPurpose::ImagesApart;
        let light = |sample: u32| {
            let index = ray_number(FIRST_PIXEL + number, sample);
            let u = RaySampler::new(rays.seed(), index).take(DimensionSet::CAMERA);
            let (ray, weight) = self.sampler.images.ray((renderer.plan(), rays), (pixel, purpose), u)?;
            Some(weight * ray.cos4 * radiance(worker, index, (rays, number), &ray, weights))
        };
        Sums { whole: samples.filter_map(light).sum(), ..Sums::default() }
    }

    fn stops(&self) -> bool {
        self.sampler.progress.stops()
    }

    fn traced(&self, samples: u32) {
        self.sampler.report(samples);
    }
}
