//! Rays of the picture that audit and correct its interpolated pixels.

use crate::Workers;
use crate::adaptive::{AdaptiveSampler, DrawnRay, RESERVED_NUMBER};
use crate::correction::{AllowedErrors, Corrections};
use crate::film::{FilmRay, PixelPassage};
use crate::lattice::Lattice;
use crate::neighbourhood::slope;
use crate::pinhole_blur::PinholeBlur;
use crate::shared_film::KnownFilm;
use crate::sparse_estimate::{Picture, SparseEstimate};
use radsight_adaptive::ray_number;
use radsight_render::CountedLight;
use radsight_sampling::{DimensionSet, RaySampler};
use rayon::prelude::*;

/// One pixel is audited in each square of this side.
const AUDIT_SIDE: usize = 3;

/// Squared error that a correction may have at any pixel, relative to the mean over all pixels, as long
/// as the requested error is kept.
const MOST_ADDED: f64 = 2.0;

impl<'a> AdaptiveSampler<'a> {
    /// The light of one ray of some interpolated pixels; NaN elsewhere.
    pub(crate) fn audited(&self, (lattice, nodes): (&Lattice, &[u8]), round: u32) -> Vec<f64> {
        let chosen = self.audited_pixels((lattice, nodes), round);
        let known = self.shared.known().filter(|_| round == 0);
        let light = |worker: &mut Workers<'a>, pixel: usize| {
            let known = known.and_then(|known| self.known_audit(known, pixel));
            let light = known.unwrap_or_else(|| {
                self.report_discarded(1);
                self.light_of_picture(worker, pixel)
            });
            (pixel, light)
        };
        let rays: Vec<(usize, f64)> =
            chosen.into_par_iter().with_min_len(32).map_init(|| self.picture_worker(), light).collect();
        let mut audited = vec![f64::NAN; nodes.len()];
        rays.into_iter().for_each(|(pixel, light)| audited[pixel] = light);
        if let Some(mut record) = self.shared.record().filter(|_| round == 0) {
            record.audited.clone_from(&audited);
        }
        audited
    }

    /// The known light of the ray that audits a pixel of the picture, in the frame of the film.
    fn known_audit(&self, known: &KnownFilm<'_>, pixel: usize) -> Option<f64> {
        let seen = match &self.film {
            Some(film) => {
                let own = film.in_picture(pixel)?;
                film.seen(pixel, PixelPassage::new(own, self.audit_point(own).1))?.1
            }
            None => pixel,
        };
        known.audited(pixel, seen)
    }

    /// The ray number and the point of the unit cube of the ray that audits a pixel of the picture.
    fn audit_point(&self, own: usize) -> (u64, [f64; 4]) {
        let index = ray_number(own as u64, 0);
        (index, RaySampler::new(self.exposer.rays.seed(), index).take(DimensionSet::CAMERA))
    }

    /// The light of one ray of a pixel of the picture, in the frame of the film.
    fn light_of_picture(&self, worker: &mut Workers<'a>, pixel: usize) -> f64 {
        let Some(own) = self.in_picture(pixel) else { return f64::NAN };
        let (number, u) = self.audit_point(own);
        let ray = match &self.film {
            None => self.drawn(own, number, u),
            Some(film) => {
                let passage = PixelPassage::new(own, u);
                let ray = self.exposer.rays.ray(own as u64, u);
                let counted = film
                    .seen(pixel, passage)
                    .map(|(point, pixel)| self.counted_on_film(&FilmRay { ray, pixel, point, passage: Some(passage) }));
                Some(DrawnRay { number, ray, weight: 1.0, counted: counted.unwrap_or(CountedLight::All) })
            }
        };
        self.summed(worker, own, ray.into_iter()).whole
    }

    /// The pixel of the picture by its index on the film; `None` in the margin of the film.
    fn in_picture(&self, pixel: usize) -> Option<usize> {
        self.film.as_ref().map_or(Some(pixel), |film| film.in_picture(pixel))
    }

    /// A worker for rays of the picture. It integrates lights as that of the lattice does.
    pub(crate) fn picture_worker(&self) -> Workers<'a> {
        let mut worker = self.exposer.workers();
        worker.integrate_lights(Some(self.cubature_error));
        worker
    }

    /// Corrects the pixels that were not exposed by the light of audited rays. `requested` is the mean
    /// squared error of all pixels.
    pub(crate) fn correct(
        &self,
        (estimate, picture): (&mut SparseEstimate, Option<&mut Picture>),
        (lattice, nodes): (&Lattice, &[u8]),
        (audited, blur): (&[f64], Option<&PinholeBlur<'_>>),
        requested: f64,
    ) {
        let columns = lattice.columns();
        let residuals = self.residuals(&estimate.values, columns, blur, audited);
        let (values, noise, bias) = match picture {
            Some(Picture { values, noise, bias }) => (values, noise, bias),
            None => (&mut estimate.values, &mut estimate.noise, &mut estimate.bias),
        };
        let of_pixels: Vec<f64> = noise.iter().zip(bias).map(|(noise, bias)| noise + *bias).collect();
        let mean = of_pixels.iter().sum::<f64>() / estimate.pixel_count as f64;
        // Without panic where errors are not finite.
        let of_any = (requested - mean).max(0.0).min(MOST_ADDED * mean);
        let allowed = AllowedErrors { of_pixels, of_any };
        let is_corrected = |pixel: usize| self.is_estimated(nodes, pixel);
        Corrections::new(&residuals, columns, &allowed, is_corrected).apply(values, noise);
    }

    /// By how much the light of each audited ray exceeds what the film, or the picture if there is
    /// none, predicts for it. The mean prediction for all rays of a pixel is the pixel's value.
    fn residuals(
        &self,
        values: &[f64],
        columns: usize,
        blur: Option<&PinholeBlur<'_>>,
        audited: &[f64],
    ) -> Vec<Option<f64>> {
        let residual = |(pixel, light): (usize, &f64)| {
            let own = self.in_picture(pixel).filter(|_| !light.is_nan())?;
            let passage = PixelPassage::new(own, self.audit_point(own).1);
            let predicted = match blur {
                Some(blur) => blur.predicted(values, pixel, &passage),
                None => values[pixel] + slope(values, columns, pixel).dot(passage.on_pixel - 0.5),
            };
            Some(light - predicted)
        };
        audited.iter().enumerate().map(residual).collect()
    }

    /// One interpolated pixel of each square.
    fn audited_pixels(&self, (lattice, nodes): (&Lattice, &[u8]), round: u32) -> Vec<usize> {
        let columns = lattice.columns();
        let rows = nodes.len() / columns;
        let seed = self.exposer.rays.seed();
        let of_square = |(x, y): (usize, usize)| {
            let number = RESERVED_NUMBER - 1 - (y * columns + x) as u64;
            let u = RaySampler::new(seed, number).take(DimensionSet::render(round));
            let [x, y] = [(x, u[0]), (y, u[1])].map(|(first, u)| first + (u * AUDIT_SIDE as f64) as usize);
            (x < columns && y < rows).then_some(y * columns + x)
        };
        let squares = (0..rows).step_by(AUDIT_SIDE).flat_map(|y| (0..columns).step_by(AUDIT_SIDE).map(move |x| (x, y)));
        squares.filter_map(of_square).filter(|pixel| self.is_estimated(nodes, *pixel)).collect()
    }

    /// Whether a pixel of the film is in the picture, and not exposed itself.
    fn is_estimated(&self, nodes: &[u8], pixel: usize) -> bool {
        match &self.film {
            Some(film) => film.in_picture(pixel).is_some(),
            None => nodes[pixel] == 0,
        }
    }
}
