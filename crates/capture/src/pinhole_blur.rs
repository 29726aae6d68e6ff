//! The picture of a film behind a finite pinhole.

use crate::cubic::cubic_weights;
use crate::film::{PixelPassage, UnblurredFilm};
use crate::neighbourhood::slope;
use crate::pinhole_derivatives::PinholeDerivatives;
use crate::subpixel_kernels::SUBPIXEL_ERROR;
use crate::subpixels::Subpixels;

/// Error of what the derivatives by the point of the pinhole change, relative to it: 0.27 in Figure
/// 10, where cones end.
pub(crate) const DERIVATIVE_ERROR: f64 = 0.25;

/// How a film becomes the picture.
#[derive(Debug)]
pub(crate) struct PinholeBlur<'f> {
    pub(crate) film: &'f UnblurredFilm,
    pub(crate) derivatives: PinholeDerivatives,
    /// Those of the values that are blurred; `None` if they are not known.
    pub(crate) subpixels: Option<Subpixels<'f>>,
}

/// The picture of a film, in the frame of the film; 0 in the margin.
#[derive(Debug)]
pub(crate) struct BlurredPicture {
    pub(crate) values: Vec<f64>,
    /// Squared errors that no number of rays lowers. One is due to the finite size of the film's
    /// pixels: beside sharp edges it is nearly the difference from pixels of constant radiance (in
    /// Figure 14 0.15 and 0.18 %, rms), and subpixels leave a fraction of it. The other is a fraction
    /// of what the derivatives change.
    pub(crate) squared_errors: Vec<f64>,
}

impl PinholeBlur<'_> {
    /// The light that the film predicts for a ray of a pixel, by its index on the film. Its mean over
    /// all rays of the pixel is the pixel's value in the picture.
    pub(crate) fn predicted(&self, values: &[f64], pixel: usize, passage: &PixelPassage) -> f64 {
        let (p, columns) = (passage.on_pinhole, self.film.size()[0] as isize);
        let at = self.film.shift() * p;
        let [by_x, by_y] = &self.derivatives.0;
        let by_point = |near: usize| 1.0 + by_x[near] * p.x + by_y[near] * p.y;
        if let Some(subpixels) = &self.subpixels {
            return subpixels.at(pixel, self.film.corner(pixel) + passage.on_pixel + at, by_point);
        }
        let [across, down] = [at.x, at.y].map(cubic_weights);
        let seen = |x: f64, y: f64| pixel as isize + y as isize * columns + x as isize;
        let first = seen(at.x.floor() - 1.0, at.y.floor() - 1.0);
        let mut sum = 0.0;
        for (row, by_row) in down.into_iter().enumerate() {
            for (column, by_column) in across.into_iter().enumerate() {
                let near = (first + row as isize * columns + column as isize) as usize;
                sum += by_row * by_column * values[near] * by_point(near);
            }
        }
        let nearest = seen(at.x.round(), at.y.round()) as usize;
        sum + slope(values, self.film.size()[0], nearest).dot(passage.on_pixel - 0.5)
    }

    /// The picture of some values of the film.
    pub(crate) fn picture(&self, values: &[f64]) -> BlurredPicture {
        let film = self.film;
        let (blurred, by_pixels) = (film.blurred(values), film.blurred_by_pixels(values));
        let mut picture = blurred.clone();
        for (axis, derivative) in self.derivatives.0.iter().enumerate() {
            let varying: Vec<f64> = values.iter().zip(derivative).map(|(value, by)| value * by).collect();
            picture.iter_mut().zip(film.blurred_moments(&varying, axis)).for_each(|(sum, term)| *sum += term);
        }
        let squared = |(blurred, (by_pixels, picture)): (&f64, (f64, &f64))| {
            SUBPIXEL_ERROR * (blurred - by_pixels).powi(2) + (DERIVATIVE_ERROR * (picture - blurred)).powi(2)
        };
        let squared_errors = blurred.iter().zip(by_pixels.into_iter().zip(&picture)).map(squared).collect();
        if let Some(subpixels) = &self.subpixels {
            subpixels.add_blurred(&blurred, &mut picture);
        }
        BlurredPicture { values: picture, squared_errors }
    }

    /// Mean squared error over the picture that no number of rays lowers.
    pub(crate) fn mean_squared_error(&self, values: &[f64]) -> f64 {
        self.film.mean_over_picture(&self.picture(values).squared_errors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::tests::{film, in_picture, left_of, values};

    #[test]
    fn radiance_that_depends_on_the_point_of_the_pinhole_is_blurred_with_it() {
        let film = film([2.4, 4.1], [6, 6]);
        let radiance = values(&film, |x, y| 5.0 + x + 2.0 * y);
        let derivatives = PinholeDerivatives([vec![0.1; radiance.len()], vec![-0.2; radiance.len()]]);
        // The mean of L(x + S·p)·(1 + g·p) is L(x) + ¼ Σ S·g·∂L; rows are counted downwards.
        let added = 0.25 * (2.4 * 0.1 * 1.0 + -4.1 * -0.2 * 2.0);
        let picture =
            in_picture(&film, &PinholeBlur { film: &film, derivatives, subpixels: None }.picture(&radiance).values);
        for (pixel, value) in picture.into_iter().enumerate() {
            let correct = 5.0 + (pixel % 6) as f64 + 2.0 * (pixel / 6) as f64 + added;
            assert!((value - correct).abs() < 2e-3, "{value} for {correct}");
        }
    }

    /// The estimate of what the size of pixels errs beside an edge is right in the mean over its
    /// positions.
    #[test]
    fn the_error_beside_edges_is_estimated() {
        let radius = 3.6;
        let film = film([radius; 2], [24, 5]);
        let blur = PinholeBlur { film: &film, derivatives: PinholeDerivatives::zero(&film), subpixels: None };
        let [mut correct, mut estimated] = [0.0; 2];
        for step in 0..40 {
            let edge = 12.0 + f64::from(step) * 0.025;
            // A pixel spans from x − ½ to x + ½.
            let sharp = values(&film, |x, _| (edge - x + 0.5).clamp(0.0, 1.0));
            let picture = film.blurred(&sharp);
            let squared = blur.picture(&sharp).squared_errors;
            for pixel in (0..picture.len()).filter(|pixel| film.in_picture(*pixel).is_some()) {
                let x = (pixel % film.size()[0]) as f64 - film.margins().x;
                let steps = 200;
                let at = |step: i32| x - 0.5 + (f64::from(step) + 0.5) / f64::from(steps);
                let blurred = (0..steps).map(|step| left_of(radius, edge - at(step))).sum::<f64>() / f64::from(steps);
                correct += (picture[pixel] - blurred).powi(2);
                // That of a film without subpixels.
                estimated += squared[pixel] / SUBPIXEL_ERROR;
            }
        }
        let ratio = (estimated / correct).sqrt();
        assert!((0.67..1.5).contains(&ratio), "{ratio}");
        assert!((correct / (40.0 * 24.0 * 5.0)).sqrt() < 0.01, "{correct}");
    }
}
