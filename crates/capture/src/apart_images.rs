//! The light of images that is exposed apart, in either way.

use crate::adaptive::{AdaptiveSampler, ImagesApart};
use crate::film_image_light::FilmImageLight;
use crate::image_light::{ExposedImages, ImageLight};

/// The light of images that is exposed apart.
#[derive(Debug)]
pub(crate) enum ApartImages {
    ByPixel(ImageLight),
    OnFilm(FilmImageLight),
}

impl ApartImages {
    /// With the first samples. `None` where the light of images is not exposed apart.
    pub(crate) fn begin(sampler: &AdaptiveSampler<'_>) -> Option<ApartImages> {
        match (&sampler.images_apart, &sampler.film) {
            (ImagesApart::No, _) => None,
            (ImagesApart::OnFilm(images), Some(film)) => {
                Some(ApartImages::OnFilm(FilmImageLight::begin(sampler, images, film)))
            }
            _ => Some(ApartImages::ByPixel(ImageLight::begin(sampler))),
        }
    }

    /// Sum over all pixels, in units of radiance.
    pub(crate) fn sum(&self) -> f64 {
        match self {
            ApartImages::ByPixel(images) => images.sum(),
            ApartImages::OnFilm(images) => images.sum(),
        }
    }

    /// Number of rays.
    pub(crate) fn samples(&self) -> u64 {
        match self {
            ApartImages::ByPixel(images) => images.samples(),
            ApartImages::OnFilm(images) => images.samples(),
        }
    }

    /// Refines the images to a sum of squared errors over all pixels.
    pub(crate) fn expose(&mut self, sampler: &AdaptiveSampler<'_>, squared: f64, most_samples: u32) -> ExposedImages {
        match self {
            ApartImages::ByPixel(images) => images.expose(sampler, squared, most_samples),
            ApartImages::OnFilm(images) => images.expose(sampler, squared, most_samples),
        }
    }
}
