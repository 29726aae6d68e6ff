//! The light of images, exposed for all pixels of the pinhole's disk at once ([`FilmImages`]).

use crate::adaptive::AdaptiveSampler;
use crate::disk_overlap::DiskOverlap;
use crate::film::UnblurredFilm;
use crate::film_images::{FilmImages, ImagePart, PartRay};
use crate::image_light::{ExposedImages, image_target, image_worker};
use crate::pinhole_blur::DERIVATIVE_ERROR;
use crate::pinhole_derivatives::kept_fraction;
use crate::pixel_errors::{gain, unit_error};
use crate::radiance::radiance;
use crate::{Exposer, Workers};
use glam::{DVec2, IVec2};
use radsight_adaptive::{
    ErrorEstimate, MAX_SAMPLES, NoiseTarget, PixelError, PixelSamples, PixelSource, SampleSums, SamplingState, begin,
    double, ray_number, refine,
};
use radsight_sampling::{DimensionSet, RaySampler, unit_disk};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Ray numbers begin at this pixel, so that their samples are independent of others.
const FIRST_PIXEL: u64 = 1 << 42;

/// Maximum number of sequences of samples of a part, each of [`MAX_SAMPLES`], and the pixels between the
/// ray numbers of two.
const MAX_SEQUENCES: u32 = 64;
const SEQUENCE_PIXELS: u64 = 1 << 32;

/// First rays to all uneven parts of a film together, and the most to one of them. What hardly any ray
/// hits must be known before the rays are distributed.
const FIRST_RAYS: usize = 1 << 17;
const MOST_FIRST: usize = 256;

/// Number of rays with light from which their scatter tells the noise of the region.
const MIN_LIT: f64 = 64.0;

/// How far parts of the region that have a slope in common are from each other along each axis, pixels.
const SLOPE_REACH: i32 = 2;

/// The light of the images of a film.
#[derive(Debug)]
pub(crate) struct FilmImageLight {
    images: Arc<FilmImages>,
    film: Arc<UnblurredFilm>,
    /// A "pixel" is a part of an image.
    state: SamplingState<PartSums>,
}

/// Sums over some rays to a part of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct PartSums {
    /// The light, summed over the pixels of the picture and beyond.
    light: f64,
    /// The light times the point of the picture at which it is seen through the middle of the pinhole.
    center: DVec2,
    /// The light times the squared coordinates of that point relative to the middle of the part.
    squared_offset: DVec2,
    /// The light times the point of the pinhole.
    on_pinhole: DVec2,
    /// The points of the pinhole, also of rays that show another image.
    drawn_on_pinhole: DVec2,
    /// Number of rays that show light.
    lit: u32,
}

impl SampleSums for PartSums {
    /// Squared.
    type HalfDifference = f64;
    type Mean = f64;

    fn add(&mut self, other: &PartSums) {
        self.light += other.light;
        self.center += other.center;
        self.squared_offset += other.squared_offset;
        self.on_pinhole += other.on_pinhole;
        self.drawn_on_pinhole += other.drawn_on_pinhole;
        self.lit += other.lit;
    }

    fn half_difference(first: &PartSums, second: &PartSums, samples: u32) -> f64 {
        ((second.light - first.light) / f64::from(2 * samples)).powi(2)
    }

    fn mean(&self, samples: u32) -> f64 {
        self.light / f64::from(samples)
    }
}

type Part = PixelSamples<PartSums>;

impl FilmImageLight {
    /// With the first samples.
    pub(crate) fn begin(sampler: &AdaptiveSampler<'_>, images: &Arc<FilmImages>, film: &Arc<UnblurredFilm>) -> Self {
        let (images, film) = (images.clone(), film.clone());
        let mut state = SamplingState::new(images.parts().len());
        let source = PartSource { sampler, images: &images, film: &film };
        begin(&source, &mut state);
        let parts = images.parts().iter().enumerate();
        let uneven: Vec<usize> = parts.filter(|(_, part)| images.is_uneven(part)).map(|(index, _)| index).collect();
        let first = (FIRST_RAYS / uneven.len().max(1)).min(MOST_FIRST);
        while uneven.first().is_some_and(|part| 2 * state.pixels[*part].samples as usize <= first) && !source.stops() {
            state.pending.clone_from(&uneven);
            double(&source, &mut state);
        }
        FilmImageLight { images, film, state }
    }

    /// Sum over all pixels of the picture, in units of radiance.
    pub(crate) fn sum(&self) -> f64 {
        self.images.parts().iter().zip(&self.state.pixels).map(|(part, samples)| part.visible * samples.mean()).sum()
    }

    /// Number of rays.
    pub(crate) fn samples(&self) -> u64 {
        self.state.samples()
    }

    /// Refines the images to a sum of squared errors over all pixels.
    pub(crate) fn expose(&mut self, sampler: &AdaptiveSampler<'_>, squared: f64, most_samples: u32) -> ExposedImages {
        let images = self.images.clone();
        // A part stands for all pixels of the disk.
        let most_samples = most_samples.saturating_mul(MAX_SEQUENCES);
        let target = NoiseTarget { most_samples, ..image_target(squared, images.parts().len()) };
        let source = PartSource { sampler, images: &images, film: &self.film };
        let estimate = |samples: &[Part]| PartErrors::new(&images, samples);
        let (errors, stop) = refine(&source, &mut self.state, &target, estimate);
        ExposedImages { pixels: self.spread(sampler, &errors), stop }
    }

    /// The light of the pixels, with its errors.
    fn spread(&self, sampler: &AdaptiveSampler<'_>, errors: &PartErrors<'_>) -> Vec<(usize, f64, PixelError)> {
        let mut pixels: BTreeMap<usize, PixelLight> = BTreeMap::new();
        for parts in self.images.by_image() {
            let slopes = self.slopes(parts.clone(), errors);
            for (index, slope) in parts.zip(slopes) {
                let known = &self.images.parts()[index];
                let part = PartLight::new(known, &self.state.pixels[index], errors.of_light(index), slope);
                self.images.for_each_pixel(
                    sampler.exposer.rays,
                    (index, (part.center, part.deviation)),
                    |pixel, overlap| {
                        pixels.entry(pixel).or_default().add(&part, overlap);
                    },
                );
            }
        }
        // The samples are those of all pixels together.
        let each = self.samples() as f64 / pixels.len().max(1) as f64;
        let error = |light: &PixelLight| PixelError {
            squared: light.noise + (DERIVATIVE_ERROR * light.by_slope).powi(2),
            gain: 0.5,
            samples: each.round() as u32,
        };
        pixels.iter().map(|(pixel, light)| (*pixel, light.value, error(light))).collect()
    }

    /// Relative derivatives of the light of an image's parts by the point of the pinhole, per radius. All
    /// parts of an image have them in common; the region shows several images, and parts near to each other
    /// are those of one.
    fn slopes(&self, parts: Range<usize>, errors: &PartErrors<'_>) -> Vec<DVec2> {
        let moments = self.moments(parts.clone(), errors);
        let known = &self.images.parts()[parts];
        if known.first().is_none_or(|first| !self.images.is_in_region(first)) {
            return vec![common_slope(&moments); moments.len()];
        }
        let place = |part: &ImagePart| part.center.floor().as_ivec2();
        let by_place: FxHashMap<IVec2, usize> = known.iter().map(place).zip(0..).collect();
        let around = |part: &ImagePart| {
            let along = || -SLOPE_REACH..=SLOPE_REACH;
            let near = along().flat_map(|y| along().map(move |x| IVec2::new(x, y)));
            let near = near.filter_map(|offset| by_place.get(&(place(part) + offset)));
            common_slope(&near.map(|index| moments[*index]).collect::<Vec<_>>())
        };
        known.iter().map(around).collect()
    }

    fn moments(&self, parts: Range<usize>, errors: &PartErrors<'_>) -> Vec<PinholeMoment> {
        let moment = |index: usize| {
            let Part { sums, samples, .. } = &self.state.pixels[index];
            let samples = f64::from(*samples);
            let light = sums.light / samples;
            let at = (sums.on_pinhole - light * sums.drawn_on_pinhole) / samples;
            PinholeMoment { light, squared_error: errors.of_light(index), at }
        };
        parts.map(moment).collect()
    }
}

/// The light of a part, and its first moment over the pinhole, in radii.
#[derive(Clone, Copy, Debug)]
struct PinholeMoment {
    light: f64,
    /// Squared error of the light.
    squared_error: f64,
    at: DVec2,
}

/// Relative derivative of the light of parts by the point of the pinhole, per radius, shrunk by its noise.
fn common_slope(parts: &[PinholeMoment]) -> DVec2 {
    let light: f64 = parts.iter().map(|part| part.light).sum();
    let moment: DVec2 = parts.iter().map(|part| part.at).sum();
    let of_light: f64 = parts.iter().map(|part| part.squared_error).sum();
    // Parts with a slope in common differ by noise. Whether the few rays of a part meet the edge of its
    // light depends on the point of the pinhole, and the slope is noisier than the light.
    let scatter: f64 = parts.iter().map(|part| (part.at - part.light / light * moment).length_squared()).sum();
    let count = parts.len() as f64;
    let scatter = if count > 1.0 { scatter * count / (count - 1.0) } else { 0.0 };
    // Over the unit disk the mean of p·pᵀ is ¼.
    let slope = 4.0 * moment / light;
    let of_noise = f64::max(8.0 * of_light, 16.0 * scatter) / (light * light);
    if slope.is_finite() { kept_fraction(slope.length_squared(), of_noise) * slope } else { DVec2::ZERO }
}

/// The light of a part of an image.
struct PartLight {
    light: f64,
    /// Mean and standard deviation of where it is seen.
    center: DVec2,
    deviation: DVec2,
    slope: DVec2,
    /// Squared error of the light.
    squared: f64,
}

impl PartLight {
    fn new(part: &ImagePart, samples: &Part, squared: f64, slope: DVec2) -> PartLight {
        let light = samples.mean();
        let PartSums { light: sum, center, squared_offset, .. } = samples.sums;
        let (mean, squared_offset) =
            if light > 0.0 { (center / sum, squared_offset / sum) } else { (part.center, DVec2::ZERO) };
        let variance = squared_offset - (mean - part.center) * (mean - part.center);
        let deviation = DVec2::new(variance.x.max(0.0).sqrt(), variance.y.max(0.0).sqrt());
        PartLight { light, center: mean, deviation, slope, squared }
    }
}

/// The light of images in a pixel.
#[derive(Clone, Copy, Debug, Default)]
struct PixelLight {
    value: f64,
    /// Squared error due to noise.
    noise: f64,
    /// What the dependence on the point of the pinhole adds.
    by_slope: f64,
}

impl PixelLight {
    fn add(&mut self, part: &PartLight, overlap: DiskOverlap) {
        let by_slope = part.light * part.slope.dot(overlap.moment);
        self.value += part.light * overlap.area + by_slope;
        self.by_slope += by_slope;
        self.noise += part.squared * overlap.area * overlap.area;
    }
}

/// The errors of the parts, summed over the picture.
struct PartErrors<'p> {
    parts: &'p [ImagePart],
    errors: Vec<PixelError>,
}

impl<'p> PartErrors<'p> {
    /// The noise of single parts is uncertain, so the relative noise of all is pooled: of those of known
    /// images, and of those of the region. Where a part has shown no light yet, it may have what is
    /// expected. So may the region, as long as few of its rays have shown any.
    fn new(images: &'p FilmImages, samples: &[Part]) -> PartErrors<'p> {
        let parts = images.parts();
        let pooled = [false, true].map(|in_region| {
            let of_group = || parts.iter().zip(samples).filter(|(part, _)| images.is_in_region(part) == in_region);
            let sum = |of_part: &dyn Fn(&ImagePart, &Part) -> f64| -> f64 {
                of_group().map(|(part, samples)| of_part(part, samples)).sum()
            };
            // Of one sample.
            let last = sum(&|_, samples| samples.last * f64::from(samples.samples));
            let before = sum(&|_, samples| samples.before * f64::from(samples.samples));
            let relative = last / sum(&|part, _| part.expected * part.expected).max(f64::MIN_POSITIVE);
            let is_unknown = in_region && sum(&|_, samples| f64::from(samples.sums.lit)) < MIN_LIT;
            let least = if is_unknown { images.region_variance() } else { 0.0 };
            (relative.max(least), gain(last, before))
        });
        let of_part = |(part, samples): (&ImagePart, &Part)| {
            let (relative, gain) = pooled[usize::from(images.is_in_region(part))];
            let own = if images.is_uneven(part) { samples.last * f64::from(samples.samples) } else { 0.0 };
            let near = f64::max(relative * part.expected * part.expected, own);
            unit_error(samples, near, gain, part.squared_weights)
        };
        PartErrors { parts, errors: parts.iter().zip(samples).map(of_part).collect() }
    }

    /// The squared error of a part's light.
    fn of_light(&self, part: usize) -> f64 {
        self.errors[part].squared / self.parts[part].squared_weights
    }
}

impl ErrorEstimate for PartErrors<'_> {
    fn pixels(&self) -> &[PixelError] {
        &self.errors
    }
}

/// Traces rays to the parts of images.
struct PartSource<'s, 'a> {
    sampler: &'s AdaptiveSampler<'a>,
    images: &'s FilmImages,
    film: &'s UnblurredFilm,
}

impl<'a> PixelSource for PartSource<'_, 'a> {
    type Sums = PartSums;
    type Worker = Workers<'a>;

    fn worker(&self) -> Workers<'a> {
        image_worker(self.sampler)
    }

    fn sums(&self, worker: &mut Workers<'a>, part: usize, samples: Range<u32>) -> PartSums {
        let Exposer { rays, weights, .. } = *self.sampler.exposer;
        let mut sums = PartSums::default();
        for sample in samples {
            let sequence = u64::from(sample / MAX_SAMPLES);
            let pixel = FIRST_PIXEL + sequence * SEQUENCE_PIXELS + part as u64;
            let index = ray_number(pixel, sample % MAX_SAMPLES);
            let u = RaySampler::new(rays.seed(), index).take(DimensionSet::CAMERA);
            let on_pinhole = DVec2::from(unit_disk(u[2], u[3]));
            sums.drawn_on_pinhole += on_pinhole;
            let drawn = self.images.ray((rays, self.film), part, [u[0], u[1]], on_pinhole);
            if let Some(PartRay { ray, center, weight }) = drawn {
                let light = weight * ray.cos4 * radiance(worker, index, (rays, 0), &ray, weights);
                sums.light += light;
                sums.lit += u32::from(light > 0.0);
                sums.center += light * center;
                let offset = center - self.images.parts()[part].center;
                sums.squared_offset += light * offset * offset;
                sums.on_pinhole += light * on_pinhole;
            }
        }
        sums
    }

    fn stops(&self) -> bool {
        self.sampler.progress.stops()
    }

    fn traced(&self, samples: u32) {
        self.sampler.report(samples);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a hundred parts with a light of 1, from the moment of each.
    fn slope(moment: impl Fn(f64) -> DVec2) -> DVec2 {
        let part = |index: u32| PinholeMoment { light: 1.0, squared_error: 1e-4, at: moment(f64::from(index)) };
        common_slope(&(0..100).map(part).collect::<Vec<_>>())
    }

    #[test]
    fn a_slope_that_parts_have_in_common_is_kept() {
        let common = DVec2::new(0.05, -0.02);
        let noise = |index: f64| 0.05 * DVec2::from_angle(2.4 * index);
        assert!(slope(|_| common).distance(4.0 * common) < 0.1 * common.length());
        assert!(slope(|index| common + noise(index)).distance(4.0 * common) < 0.4 * common.length());
    }

    #[test]
    fn slopes_that_parts_do_not_have_in_common_are_noise() {
        let of_one = |index: f64| if index == 7.0 { DVec2::new(0.5, 0.1) } else { DVec2::ZERO };
        assert_eq!(slope(of_one), DVec2::ZERO);
        assert_eq!(slope(|index| 0.5 * DVec2::from_angle(2.4 * index)), DVec2::ZERO);
    }

    /// A part that is as large as a pixel would otherwise be a twelfth of a squared pixel too sharp.
    #[test]
    fn the_light_of_a_part_is_spread_as_far_as_it_is_seen() {
        let part = ImagePart::unseen(DVec2::new(10.5, 7.5));
        let mut sums = PartSums::default();
        for index in 0..64 {
            let at = DVec2::new(f64::from(index % 8) + 0.5, f64::from(index / 8) + 0.5) / 8.0;
            let center = DVec2::new(10.0, 7.0) + at;
            let offset = center - part.center;
            sums.add(&PartSums {
                light: 2.0,
                center: 2.0 * center,
                squared_offset: 2.0 * offset * offset,
                ..PartSums::default()
            });
        }
        let light = PartLight::new(&part, &Part { sums, samples: 64, ..Part::default() }, 0.0, DVec2::ZERO);
        assert!((light.light - 2.0).abs() < 1e-12 && light.center.distance(part.center) < 1e-12);
        // Of 64 points; 1/12 of a continuum.
        let variance = (1.0 - 1.0 / 64.0) / 12.0;
        assert!((light.deviation * light.deviation - variance).abs().max_element() < 1e-12, "{}", light.deviation);
    }

    #[test]
    fn without_light_there_is_no_slope() {
        let dark = PinholeMoment { light: 0.0, squared_error: 0.0, at: DVec2::ZERO };
        assert_eq!([common_slope(&[dark; 2]), common_slope(&[])], [DVec2::ZERO; 2]);
    }
}
