//! The choice of what is interpolated: the film behind a point pinhole, which is then blurred, or the
//! picture.

use crate::adaptive::{AdaptiveSampler, ImagesApart};
use crate::apart_images::ApartImages;
use crate::checkpoint::AdaptiveState;
use crate::film::UnblurredFilm;
use crate::film_image_search::UnknownImages;
use crate::film_images::FilmImages;
use crate::highlights::highlights;
use crate::image_light::IMAGE_FRACTION;
use crate::pixel_errors::{Estimate, SELECTION_BIAS};
use crate::subpixels::SubpixelRecord;
use radsight_adaptive::{ErrorTarget, Replicas, Stop};
use std::sync::Arc;
use std::sync::atomic::Ordering;

impl AdaptiveSampler<'_> {
    /// Exposes some pixels and interpolates the others: where it pays, those of the film behind a
    /// point pinhole, which is then blurred. Otherwise as [`AdaptiveSampler::sparse`]. `None` also if
    /// the film that is known was not interpolated, and for pictures of a few pixels.
    pub(crate) fn interpolated(
        &mut self,
        state: &mut AdaptiveState,
        target: ErrorTarget,
    ) -> Option<(Estimate, Option<Stop>)> {
        if self.replicas != Replicas::ONE || self.shared.known().is_some_and(|known| known.record.is_empty()) {
            return None;
        }
        let found = self.interpolated_film(state, target);
        self.images_apart = ImagesApart::No;
        found
    }

    /// The same, until images are no longer exposed apart.
    fn interpolated_film(
        &mut self,
        state: &mut AdaptiveState,
        target: ErrorTarget,
    ) -> Option<(Estimate, Option<Stop>)> {
        self.film = self.unblurred_film();
        let known = self.shared.known().map(|known| known.record.film.is_some());
        if known.is_some_and(|has_film| has_film != self.film.is_some()) {
            return None;
        }
        if let Some(film) = &self.film {
            let mut film_state = AdaptiveState::new(film.pixel_count());
            self.subpixels = SubpixelRecord::new(film.pixel_count());
            let found = self.on_lattice(&mut film_state, target);
            self.film = None;
            self.subpixels = SubpixelRecord::default();
            if found.is_some() {
                *state = film_state;
                return found;
            }
            if self.progress.stops() || known.is_some() {
                return None;
            }
        }
        self.on_lattice(state, target)
    }

    /// Finds the lattice and exposes it.
    fn on_lattice(&mut self, state: &mut AdaptiveState, target: ErrorTarget) -> Option<(Estimate, Option<Stop>)> {
        self.images_apart = self.images_apart(target).ok()?;
        self.refracted = self.film.as_ref().map_or_else(Vec::new, |film| film.refracted(self.exposer));
        self.highlights = highlights(self.exposer, self.film.as_deref());
        let mut images = ApartImages::begin(self);
        let found = self.lattice().and_then(|(sparse, outlines)| {
            self.outlines = outlines;
            self.sparse(state, target, images.as_mut(), sparse)
        });
        self.outlines = Vec::new();
        if found.is_none() {
            self.discarded.fetch_add(images.map_or(0, |images| images.samples()), Ordering::Relaxed);
        }
        found
    }

    /// How the light of images is exposed with the film, if there is one. Fails where the film would
    /// miss images.
    fn images_apart(&self, target: ErrorTarget) -> Result<ImagesApart, UnknownImages> {
        let allowed = IMAGE_FRACTION * (target.error / SELECTION_BIAS).powi(2);
        if !self.is_plain() {
            return Ok(ImagesApart::No);
        }
        let on_film = match (&self.film, self.images.curved_alone()) {
            (Some(film), Some(curved)) => FilmImages::find(self.exposer, film, curved, allowed)?,
            (Some(_), None) if self.exposer.renderer.plan().divides_rays => return Err(UnknownImages),
            _ => None,
        };
        Ok(match on_film {
            Some(images) => ImagesApart::OnFilm(Arc::new(images)),
            None if !self.images.is_empty() => ImagesApart::ByPixel,
            None => ImagesApart::No,
        })
    }

    fn unblurred_film(&self) -> Option<Arc<UnblurredFilm>> {
        match self.shared.known() {
            _ if !self.is_plain() => None,
            Some(known) => {
                let film = known.record.film.clone()?;
                film.suits(self.exposer, |pixel| known.is_picture_affected[pixel]).then_some(film)
            }
            None => UnblurredFilm::new(self.exposer).map(Arc::new),
        }
    }
}
