//! The search for the images of lights that a film shows.

use crate::Exposer;
use crate::curved_image::CurvedImage;
use crate::film::UnblurredFilm;
use crate::film_images::FilmImages;
use crate::region_search::{FoundRegion, RegionSearch};

/// Images may be seen that were not searched.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnknownImages;

impl FilmImages {
    /// Those of known images and of the region that may show others; `None` where the film shows no image.
    /// `allowed` is the squared error that images may add to pixels, relative to the squared mean exposure.
    ///
    /// # Errors
    /// Dielectrics may show images that were not searched: hardly any ray meets them, and nobody would
    /// miss them.
    pub(crate) fn find(
        exposer: &Exposer<'_>,
        film: &UnblurredFilm,
        curved: &[CurvedImage],
        allowed: f64,
    ) -> Result<Option<FilmImages>, UnknownImages> {
        let mut found = FilmImages::new(exposer, film, curved);
        match RegionSearch::new(exposer, film, &found).region(allowed) {
            FoundRegion::Lit(region) => found.add_region(exposer.rays, film, region),
            FoundRegion::Unknown if exposer.renderer.plan().divides_rays => return Err(UnknownImages),
            FoundRegion::Dark | FoundRegion::Unknown => {}
        }
        Ok((!found.is_empty()).then_some(found))
    }
}
