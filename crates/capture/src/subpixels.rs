//! The unblurred film within its pixels.
//!
//! A film of pixels' means tells nothing of where in a pixel the light is, and beside the outline of a
//! surface or the edge of a glint this is most of the film's error. But the samples of a pixel are at
//! known places, so each counts for the subpixel where it is, and subpixels are blurred with kernels of
//! their own. The film that is interpolated from the pixels' means is a control variate: what is blurred
//! by subpixels is by how much samples exceed it. So where the film is smooth this adds no noise, and
//! where it is not, the picture is as good as one of a film with [`SIDE`]² times as many pixels.

use crate::cubic::cubic_weights;
use crate::film::UnblurredFilm;
use crate::subpixel_kernels::{COUNT, SIDE};
use crate::sums::Pixel;
use glam::DVec2;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

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
    /// None yet of a pixel whose subpixels all have samples of every surface that they see.
    pub(crate) fn dense() -> SubpixelSamples {
        SubpixelSamples { is_dense: true, ..SubpixelSamples::default() }
    }

    /// Adds a sample at a place of the pixel, from 0 to 1 along both axes.
    pub(crate) fn add(&mut self, place: [f64; 2], weight: f64, light: f64) {
        let sum = &mut self.sums[SubpixelSamples::part_of(place)];
        *sum = [sum[0] + weight, sum[1] + weight * light];
    }

    /// Adds light at a place, without a sample of its own.
    pub(crate) fn add_light(&mut self, place: [f64; 2], light: f64) {
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
                kernels.add_blurred(film.size()[0], pixel, &surplus, &mut found.sparse);
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
            kernels.add_blurred(self.film.size()[0], *pixel, surplus, &mut own);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::tests::{film, left_of};
    use crate::pinhole_blur::PinholeBlur;
    use crate::pinhole_derivatives::PinholeDerivatives;
    use crate::subpixel_kernels::SUBPIXEL_ERROR;

    const RADIUS: f64 = 3.6;
    const SIZE: [usize; 2] = [24, 3];

    /// The film of an upright edge, bright on its left, from samples of each pixel that are `steps`
    /// along rows.
    fn edge(film: &UnblurredFilm, at: f64, steps: usize) -> (Vec<f64>, PinholeBlur<'_>) {
        let (columns, count) = (film.size()[0], film.pixel_count());
        let (mut values, mut pixels, record) =
            (vec![0.0; count], vec![Pixel::default(); count], SubpixelRecord::new(count));
        for pixel in 0..count {
            let mut samples = SubpixelSamples::dense();
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
            blur.predicted(&values, pixel, &crate::film::PixelPassage::new(0, u))
        };
        for pixel in (0..picture.len()).filter(|pixel| film.in_picture(*pixel).is_some()) {
            let mean = (0..points).map(|index| of_point(pixel, index)).sum::<f64>() / f64::from(points);
            assert!((picture[pixel] - mean).abs() < 1e-3, "{} for {mean}", picture[pixel]);
        }
    }
}
