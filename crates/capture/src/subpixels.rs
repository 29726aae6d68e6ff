//! The unblurred film within its pixels.
//!
//! A film of pixels' means tells nothing of where in a pixel the light is, and beside the outline of a
//! surface or the edge of a glint this is most of the film's error. But the samples of a pixel are at
//! known places, so each counts for the subpixel where it is, and subpixels are blurred with kernels of
//! their own. The film that is interpolated from the pixels' means is a control variate: what is blurred
//! by subpixels is by how much samples exceed it. So where the film is smooth this adds no noise, and
//! where it is not, the picture is as good as one of a film with [`SIDE`]² times as many pixels.
//!
//! Where a pixel is sampled in two phases ([`two_phase`](crate::two_phase)), all rays of the first phase
//! count, with the light of their stratum.

use crate::Workers;
use crate::adaptive::{AdaptiveSampler, DrawnRay, Phases, Pixel, Sums};
use crate::disk_overlap::Parallelogram;
use crate::shared_rays::{UnblurredFilm, cubic_weights};
use crate::two_phase::{Chosen, FIRST_PHASE, MAX_STRATA};
use glam::{DMat2, DVec2};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Subpixels along each side of a pixel. With four the error of a film is 16 times that of eight.
const SIDE: usize = 8;
const COUNT: usize = SIDE * SIDE;

/// Squared error of a film with subpixels, relative to that of one without: 1/1100 beside straight edges.
pub(crate) const SUBPIXEL_ERROR: f64 = 1.0 / 400.0;

/// The samples of a pixel by subpixel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SubpixelSamples {
    /// Row by row: the weight of the samples, and their weighted light.
    sums: [[f64; 2]; COUNT],
    /// Whether all subpixels have samples of every surface that they see.
    is_dense: bool,
}

impl Default for SubpixelSamples {
    fn default() -> SubpixelSamples {
        SubpixelSamples { sums: [[0.0; 2]; COUNT], is_dense: false }
    }
}

impl SubpixelSamples {
    /// Adds a sample at a place of the pixel, from 0 to 1 along both axes.
    fn add(&mut self, place: [f64; 2], weight: f64, light: f64) {
        let sum = &mut self.sums[SubpixelSamples::part_of(place)];
        *sum = [sum[0] + weight, sum[1] + weight * light];
    }

    /// Adds light at a place, without a sample of its own.
    fn add_light(&mut self, place: [f64; 2], light: f64) {
        self.sums[SubpixelSamples::part_of(place)][1] += light;
    }

    fn part_of(place: [f64; 2]) -> usize {
        let [x, y] = place.map(|at| ((at * SIDE as f64) as usize).min(SIDE - 1));
        y * SIDE + x
    }

    fn add_all(&mut self, other: &SubpixelSamples) {
        for (sum, other) in self.sums.iter_mut().zip(other.sums) {
            *sum = [sum[0] + other[0], sum[1] + other[1]];
        }
        self.is_dense |= other.is_dense;
    }
}

/// The subpixels of a film, by pixel; empty without a film.
#[derive(Debug, Default)]
pub(crate) struct SubpixelRecord(Vec<Mutex<Option<Box<SubpixelSamples>>>>);

impl SubpixelRecord {
    pub(crate) fn new(pixels: usize) -> SubpixelRecord {
        SubpixelRecord((0..pixels).map(|_| Mutex::default()).collect())
    }

    /// Adds samples of a pixel.
    pub(crate) fn add(&self, pixel: usize, samples: &SubpixelSamples) {
        if let Some(own) = self.0.get(pixel) {
            own.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_default().add_all(samples);
        }
    }

    pub(crate) fn to_vec(&self) -> Vec<Option<Box<SubpixelSamples>>> {
        self.0.iter().map(|own| own.lock().unwrap_or_else(PoisonError::into_inner).clone()).collect()
    }
}

/// What the subpixels of a film add to it.
#[derive(Debug)]
pub(crate) struct Subpixels<'f> {
    film: &'f UnblurredFilm,
    /// The pixels' means, without the blur that a smooth function suffers by them.
    sharpened: Vec<f64>,
    /// By pixel: by how much the light of each subpixel exceeds the interpolated film, as a fraction of
    /// a pixel.
    dense: BTreeMap<usize, [f64; COUNT]>,
    /// The same of pixels with few samples, blurred.
    sparse: Vec<f64>,
}

impl<'f> Subpixels<'f> {
    /// Of the exposed `pixels` of a film, among those that stand for themselves alone.
    pub(crate) fn new(
        film: &'f UnblurredFilm,
        values: &[f64],
        record: &SubpixelRecord,
        (pixels, stands_alone): (&[Pixel], impl Fn(usize) -> bool),
    ) -> Subpixels<'f> {
        let sharpened = sharpened(values, film.size()[0]);
        let mut found = Subpixels { film, sharpened, dense: BTreeMap::new(), sparse: vec![0.0; values.len()] };
        let kernels = &film.subpixel_kernels;
        for (pixel, samples) in record.0.iter().enumerate() {
            let samples = samples.lock().unwrap_or_else(PoisonError::into_inner);
            let Some(samples) = samples.as_deref().filter(|_| stands_alone(pixel) && found.is_inside(pixel)) else {
                continue;
            };
            let surplus = found.surplus(pixel, samples, pixels[pixel].samples);
            if samples.is_dense {
                found.dense.insert(pixel, surplus);
            } else {
                kernels.add_blurred(film, pixel, &surplus, &mut found.sparse);
            }
        }
        found
    }

    /// Whether a pixel has all neighbours from which it is interpolated.
    fn is_inside(&self, pixel: usize) -> bool {
        let [columns, rows] = self.film.size();
        let (x, y) = (pixel % columns, pixel / columns);
        (2..columns - 2).contains(&x) && (2..rows - 2).contains(&y)
    }

    fn surplus(&self, pixel: usize, samples: &SubpixelSamples, count: u32) -> [f64; COUNT] {
        let columns = self.film.size()[0];
        std::array::from_fn(|part| {
            let [weight, light] = samples.sums[part];
            if weight == 0.0 {
                return 0.0;
            }
            let at = DVec2::new((part % SIDE) as f64, (part / SIDE) as f64);
            let offset = (at + 0.5) / SIDE as f64 - 0.5;
            (light - weight * interpolated(&self.sharpened, columns, pixel, offset)) / f64::from(count)
        })
    }

    /// Adds what it blurs to, to a picture in the frame of the film that was blurred from the pixels'
    /// means.
    pub(crate) fn add_blurred(&self, blurred: &[f64], picture: &mut [f64]) {
        let kernels = &self.film.subpixel_kernels;
        let mut own = self.film.convolved(&self.sharpened, &kernels.interpolated);
        own.iter_mut().zip(blurred).zip(&self.sparse).for_each(|((own, blurred), sparse)| *own += sparse - blurred);
        for (pixel, surplus) in &self.dense {
            kernels.add_blurred(self.film, *pixel, surplus, &mut own);
        }
        for (pixel, (value, own)) in picture.iter_mut().zip(own).enumerate() {
            if self.film.in_picture(pixel).is_some() {
                *value += own;
            }
        }
    }

    /// The light that is predicted at a point of the film for a ray of a pixel of the picture, by its
    /// index on the film. `by_point` is the factor of each pixel of the film for the ray's point of the
    /// pinhole.
    pub(crate) fn at(&self, pixel: usize, point: DVec2, by_point: impl Fn(usize) -> f64) -> f64 {
        let Some(seen) = self.film.pixel_at(point).filter(|seen| self.is_inside(*seen)) else { return 0.0 };
        let columns = self.film.size()[0];
        let place = point - self.film.corner(seen);
        let varying = |near: usize| self.sharpened[near] * by_point(near);
        let mut sum = self.sparse[pixel] + interpolation(columns, seen, place - 0.5, varying);
        if let Some(surplus) = self.dense.get(&seen) {
            sum += COUNT as f64 * surplus[SubpixelSamples::part_of(place.into())];
        }
        sum
    }
}

/// Values without the blur that a smooth function suffers by pixels: 1/24 of its second derivatives,
/// which are 0 across the border.
fn sharpened(values: &[f64], columns: usize) -> Vec<f64> {
    let rows = values.len() / columns;
    let second_difference = |pixel: usize, (at, count): (usize, usize), step: usize| {
        let is_inside = (1..count - 1).contains(&at);
        if is_inside { values[pixel + step] - 2.0 * values[pixel] + values[pixel - step] } else { 0.0 }
    };
    let of_pixel = |pixel: usize| {
        let [column, row] = [(pixel % columns, columns), (pixel / columns, rows)];
        values[pixel] - (second_difference(pixel, column, 1) + second_difference(pixel, row, columns)) / 24.0
    };
    (0..values.len()).map(of_pixel).collect()
}

fn interpolated(values: &[f64], columns: usize, pixel: usize, offset: DVec2) -> f64 {
    interpolation(columns, pixel, offset, |near| values[near])
}

/// At an offset from the middle of a pixel, up to one pixel along both axes.
fn interpolation(columns: usize, pixel: usize, offset: DVec2, value: impl Fn(usize) -> f64) -> f64 {
    let [across, down] = [offset.x, offset.y].map(cubic_weights);
    let first = [offset.x, offset.y].map(|at| at.floor() as isize - 1);
    let mut sum = 0.0;
    for (row, by_row) in down.into_iter().enumerate() {
        for (column, by_column) in across.into_iter().enumerate() {
            let step = (first[1] + row as isize) * columns as isize + first[0] + column as isize;
            sum += by_row * by_column * value((pixel as isize + step) as usize);
        }
    }
    sum
}

/// Weights of the subpixels of a film.
#[derive(Debug)]
pub(crate) struct SubpixelKernels {
    /// By subpixel: offsets of pixels of the picture from the pixel of the film, and their weights.
    of_parts: Vec<Vec<([isize; 2], f64)>>,
    /// Of the pixels around a pixel of the picture, as they are interpolated.
    interpolated: Vec<f64>,
}

impl SubpixelKernels {
    /// For a shift by radius, in a kernel that reaches `margin` pixels to each side.
    pub(crate) fn new(shift: DVec2, margin: [usize; 2]) -> SubpixelKernels {
        let inverse = DMat2::from_diagonal(shift.recip());
        let on_pinhole = Parallelogram::new(inverse);
        let [reach_x, reach_y] = margin.map(|margin| margin as isize);
        let of_part = |part: usize| {
            let corner = DVec2::new((part % SIDE) as f64, (part / SIDE) as f64) / SIDE as f64 - 0.5;
            let offsets = (-reach_y..=reach_y).flat_map(|y| (-reach_x..=reach_x).map(move |x| [x, y]));
            let weighted = |[x, y]: [isize; 2]| {
                // The mean over the subpixel by four points.
                let points = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
                let area = points.map(|point| {
                    let at = corner + DVec2::from(point) / SIDE as f64;
                    on_pinhole.overlap(inverse * (DVec2::new(x as f64, y as f64) - at)).area
                });
                ([x, y], 0.25 * area.iter().sum::<f64>())
            };
            offsets.map(weighted).filter(|(_, weight)| *weight > 0.0).collect()
        };
        let of_parts: Vec<Vec<_>> = (0..COUNT).map(of_part).collect();
        let interpolated = SubpixelKernels::interpolated(&of_parts, margin);
        SubpixelKernels { of_parts, interpolated }
    }

    fn interpolated(of_parts: &[Vec<([isize; 2], f64)>], margin: [usize; 2]) -> Vec<f64> {
        let [width, height] = margin.map(|margin| 2 * margin + 1);
        let mut kernel = vec![0.0; width * height];
        for (part, weights) in of_parts.iter().enumerate() {
            let offset = [part % SIDE, part / SIDE].map(|at| (at as f64 + 0.5) / SIDE as f64 - 0.5);
            let [columns, rows] = offset.map(cubic_weights);
            let first = offset.map(|at| at.floor() as isize - 1);
            for ([x, y], weight) in weights {
                for (down, by_row) in rows.into_iter().enumerate() {
                    for (right, by_column) in columns.into_iter().enumerate() {
                        // The pixel of the film as seen from that of the picture.
                        let at = [first[0] + right as isize - x, first[1] + down as isize - y];
                        let [x, y] = [0, 1].map(|axis| (at[axis] + margin[axis] as isize) as usize);
                        kernel[y * width + x] += by_row * by_column * weight / COUNT as f64;
                    }
                }
            }
        }
        kernel
    }

    /// Adds the light of the subpixels of a pixel, as fractions of a pixel.
    fn add_blurred(&self, film: &UnblurredFilm, pixel: usize, light: &[f64; COUNT], picture: &mut [f64]) {
        let columns = film.size()[0] as isize;
        for (light, weights) in light.iter().zip(&self.of_parts).filter(|(light, _)| **light != 0.0) {
            for ([x, y], weight) in weights {
                let index = pixel as isize + y * columns + x;
                if let Some(value) = usize::try_from(index).ok().and_then(|index| picture.get_mut(index)) {
                    *value += light * weight;
                }
            }
        }
    }
}

impl<'a> AdaptiveSampler<'a> {
    /// Sums over some samples of a pixel of the film, which are recorded by subpixel.
    pub(crate) fn film_sums(&self, worker: &mut Workers<'a>, pixel: usize, samples: Range<u32>) -> Sums {
        let (mut whole, mut parts) = (0.0, SubpixelSamples::default());
        for sample in samples {
            let (number, u) = self.sample_point(pixel, sample);
            let light = self.drawn(pixel, number, u).map_or(0.0, |ray| self.light(worker, pixel, ray));
            whole += light;
            parts.add([u[0], u[1]], 1.0, light);
        }
        self.subpixels.add(pixel, &parts);
        Sums { whole, ..Sums::default() }
    }

    /// The same in two phases.
    pub(crate) fn two_phase_film_sums(&self, worker: &mut Workers<'a>, pixel: usize, samples: Range<u32>) -> Sums {
        let Phases { mut rays, strata, chosen } = self.phases(pixel, samples);
        let (mut whole, mut parts) = (0.0, SubpixelSamples { is_dense: true, ..SubpixelSamples::default() });
        let mut lit: Vec<(Chosen, f64)> = Vec::with_capacity(chosen.len());
        for chosen in chosen {
            let Some(ray) = rays[chosen.index].1.take() else { continue };
            let light = self.light(worker, pixel, DrawnRay { weight: 1.0, ..ray });
            whole += chosen.weight * light;
            lit.push((chosen, light));
        }
        let means = stratum_means(&strata, &lit);
        let mean = |index: usize| strata[index].map_or(0.0, |stratum| means[stratum]);
        for (index, (place, _)) in rays.iter().enumerate() {
            parts.add(*place, f64::from(FIRST_PHASE).recip(), mean(index));
        }
        for (chosen, light) in lit {
            parts.add_light(rays[chosen.index].0, chosen.weight * (light - mean(chosen.index)));
        }
        self.subpixels.add(pixel, &parts);
        Sums { whole, ..Sums::default() }
    }

    fn light(&self, worker: &mut Workers<'a>, pixel: usize, ray: DrawnRay) -> f64 {
        self.summed(worker, pixel, std::iter::once(ray)).whole
    }
}

/// The mean light of the chosen rays of each stratum.
fn stratum_means(strata: &[Option<usize>], lit: &[(Chosen, f64)]) -> [f64; MAX_STRATA] {
    let mut sums = [[0.0; 2]; MAX_STRATA];
    for (chosen, light) in lit {
        if let Some(stratum) = strata[chosen.index] {
            let [weight, weighted] = sums[stratum];
            sums[stratum] = [weight + chosen.weight, weighted + chosen.weight * light];
        }
    }
    sums.map(|[weight, light]| if weight > 0.0 { light / weight } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pinhole_derivatives::PinholeDerivatives;
    use crate::shared_rays::PinholeBlur;
    use crate::shared_rays::tests::{film, left_of};

    const RADIUS: f64 = 3.6;
    const SIZE: [usize; 2] = [24, 3];

    /// The film of an upright edge, bright on its left, from samples of each pixel that are `steps`
    /// along rows.
    fn edge(film: &UnblurredFilm, at: f64, steps: usize) -> (Vec<f64>, PinholeBlur<'_>) {
        let (columns, count) = (film.size()[0], film.pixel_count());
        let (mut values, mut pixels, record) =
            (vec![0.0; count], vec![Pixel::default(); count], SubpixelRecord::new(count));
        for pixel in 0..count {
            let mut samples = SubpixelSamples { is_dense: true, ..SubpixelSamples::default() };
            for index in 0..SIDE * steps {
                let [x, y] = [index % steps, index / steps].map(|step| step as f64 + 0.5);
                let place = [x / steps as f64, y / SIDE as f64];
                let light = f64::from(u8::from((pixel % columns) as f64 + place[0] < at));
                samples.add(place, 1.0, light);
                values[pixel] += light / (SIDE * steps) as f64;
            }
            pixels[pixel].samples = (SIDE * steps) as u32;
            record.add(pixel, &samples);
        }
        let subpixels = Some(Subpixels::new(film, &values, &record, (&pixels, |_| true)));
        let derivatives = PinholeDerivatives::zero(film);
        (values, PinholeBlur { film, derivatives, subpixels })
    }

    #[test]
    fn edges_are_blurred_with_a_fraction_of_the_error() {
        let film = film([RADIUS; 2], SIZE);
        let columns = film.size()[0];
        let [mut before, mut after, mut mean] = [0.0; 3];
        for step in 0..40 {
            let at = 15.0 + f64::from(step) * 0.025;
            let (values, blur) = edge(&film, at, 200);
            let (with, without) = (blur.picture(&values).values, film.blurred(&values));
            for pixel in (0..film.pixel_count()).filter(|pixel| film.in_picture(*pixel).is_some()) {
                let steps = 100;
                let place = |step: i32| (pixel % columns) as f64 + (f64::from(step) + 0.5) / f64::from(steps);
                let exact = (0..steps).map(|step| left_of(RADIUS, at - place(step))).sum::<f64>() / f64::from(steps);
                before += (without[pixel] - exact).powi(2);
                after += (with[pixel] - exact).powi(2);
                mean += with[pixel] - exact;
            }
        }
        assert!(after < SUBPIXEL_ERROR * before, "{after} instead of {before}");
        assert!(mean.abs() / (40.0 * 72.0) < 2e-4, "{mean}");
    }

    /// What is blurred is the mean over pixel and pinhole of what is predicted for their points.
    #[test]
    fn the_picture_is_the_mean_of_what_is_predicted() {
        let film = film([RADIUS; 2], SIZE);
        let (values, blur) = edge(&film, 15.3, 40);
        let picture = blur.picture(&values).values;
        let points = 1 << 14;
        let of_point = |pixel: usize, index: u32| {
            let u = [1.0, 0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_4]
                .map(|step| (f64::from(index) * step).fract());
            let u = [(f64::from(index) + 0.5) / f64::from(points), u[1], u[2], u[3]];
            blur.predicted(&values, pixel, &crate::shared_rays::PixelPassage::new(0, u))
        };
        for pixel in (0..picture.len()).filter(|pixel| film.in_picture(*pixel).is_some()) {
            let mean = (0..points).map(|index| of_point(pixel, index)).sum::<f64>() / f64::from(points);
            assert!((picture[pixel] - mean).abs() < 1e-3, "{} for {mean}", picture[pixel]);
        }
    }
}
