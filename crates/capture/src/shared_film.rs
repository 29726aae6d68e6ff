//! What the rays of a picture show of a scene without its moving parts.
//!
//! A picture of the scene with parts uses it for all pixels whose light the parts do not affect: its
//! rays would show the same. "Film" stands for what is exposed, the unblurred film or the picture.

use crate::film::UnblurredFilm;
use crate::pinhole_derivatives::PinholeProbe;
use crate::subpixels::SubpixelSamples;
use crate::sums::Pixel;
use radsight_adaptive::Replicas;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Whether an exposure shares its film.
#[derive(Debug)]
pub(crate) enum SharedFilm<'a> {
    /// It does not.
    Own,
    /// It records what others may use.
    Recorded(Box<Mutex<FilmRecord>>),
    /// It uses what was recorded without parts.
    Known(KnownFilm<'a>),
}

/// What was seen on a film. Empty for a film that was not interpolated.
#[derive(Clone, Debug, Default)]
pub(crate) struct FilmRecord {
    /// `None` if the picture itself was exposed.
    pub(crate) film: Option<Arc<UnblurredFilm>>,
    /// By pixel: the width of the sharpest edge.
    pub(crate) edge_widths: Vec<f64>,
    /// By pixel: whether it sees the outline of a surface.
    pub(crate) outlines: Vec<bool>,
    /// Whether points of a pixel are followed by their mirror images.
    pub(crate) mirrors_points: bool,
    /// The samples of the exposed pixels, and interpolated values of the others.
    pub(crate) pixels: Vec<Pixel>,
    /// By pixel of the film: its exposed samples by subpixel.
    pub(crate) subpixels: Vec<Option<Box<SubpixelSamples>>>,
    /// By pixel, where the dependence on the point of the pinhole was measured.
    pub(crate) probes: Vec<Option<PinholeProbe>>,
    /// By pixel: the light of the rays of the first audit; NaN elsewhere.
    pub(crate) audited: Vec<f64>,
}

/// A recorded film in front of which parts were placed.
#[derive(Debug)]
pub(crate) struct KnownFilm<'a> {
    pub(crate) record: &'a FilmRecord,
    /// The samples of the finished picture.
    pub(crate) picture: &'a [Pixel],
    /// By pixel of the film: whether parts affect it.
    pub(crate) is_affected: Vec<bool>,
    /// By pixel of the picture: whether parts affect a film pixel that is blurred into it.
    pub(crate) is_picture_affected: Vec<bool>,
}

impl FilmRecord {
    pub(crate) fn is_empty(&self) -> bool {
        self.pixels.is_empty()
    }
}

impl<'a> SharedFilm<'a> {
    pub(crate) fn known(&self) -> Option<&KnownFilm<'a>> {
        if let SharedFilm::Known(known) = self { Some(known) } else { None }
    }

    /// The record to be filled, if there is one.
    pub(crate) fn record(&self) -> Option<MutexGuard<'_, FilmRecord>> {
        match self {
            SharedFilm::Recorded(record) => Some(record.lock().unwrap_or_else(PoisonError::into_inner)),
            _ => None,
        }
    }

    /// The finished record; empty if there is none.
    pub(crate) fn take_record(&self) -> FilmRecord {
        self.record().map(|mut record| std::mem::take(&mut *record)).unwrap_or_default()
    }
}

impl KnownFilm<'_> {
    /// The samples of a pixel of the picture, or of one of its replicas.
    pub(crate) fn picture_samples(&self, index: usize, replicas: Replicas) -> Option<Pixel> {
        let is_affected = self.is_picture_affected[index / replicas.count()];
        if is_affected { None } else { self.picture.get(index).copied() }
    }

    /// The edge width of a pixel of the film, if parts affect neither the pixel nor the two to which
    /// it is compared.
    pub(crate) fn edge_width(&self, pixel: usize, columns: usize) -> Option<f64> {
        let is_affected = |pixel: usize| self.is_affected.get(pixel).is_some_and(|is_affected| *is_affected);
        let is_known = !(is_affected(pixel) || is_affected(pixel + 1) || is_affected(pixel + columns));
        self.record.edge_widths.get(pixel).copied().filter(|_| is_known)
    }

    /// Whether a pixel of the film sees the outline of a surface.
    pub(crate) fn sees_outline(&self, pixel: usize) -> Option<bool> {
        let recorded = || self.record.outlines.get(pixel).copied();
        if self.is_affected[pixel] { None } else { recorded() }
    }

    /// The samples of a pixel of the film.
    pub(crate) fn samples(&self, pixel: usize) -> Option<Pixel> {
        let recorded = || self.record.pixels.get(pixel).copied().filter(|samples| samples.samples > 0);
        if self.is_affected[pixel] { None } else { recorded() }
    }

    /// The samples of a pixel of the film by subpixel.
    pub(crate) fn subpixels(&self, pixel: usize) -> Option<&SubpixelSamples> {
        let recorded = || self.record.subpixels.get(pixel)?.as_deref();
        if self.is_affected[pixel] { None } else { recorded() }
    }

    /// The radiance of a pixel of the film through four points of the pinhole.
    pub(crate) fn probe(&self, pixel: usize) -> Option<PinholeProbe> {
        let recorded = || self.record.probes.get(pixel).copied().flatten();
        if self.is_affected[pixel] { None } else { recorded() }
    }

    /// The light of the first audit of a pixel of the picture, by its index on the film. `seen` is the
    /// pixel of the film that its ray sees.
    pub(crate) fn audited(&self, pixel: usize, seen: usize) -> Option<f64> {
        let recorded = || self.record.audited.get(pixel).copied().filter(|light| !light.is_nan());
        if self.is_affected[seen] { None } else { recorded() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::Sums;

    #[test]
    fn nothing_is_known_where_parts_affect_the_film() {
        let exposed = Pixel::of(Sums { whole: 3.0, ..Sums::default() }, 4);
        let record = FilmRecord {
            edge_widths: vec![5.0; 12],
            pixels: vec![exposed, exposed, Pixel::default(), exposed],
            outlines: vec![true; 12],
            audited: vec![1.0, f64::NAN, 2.0, 3.0],
            ..FilmRecord::default()
        };
        let mut is_affected = vec![false; 12];
        is_affected[6] = true;
        let picture = vec![exposed; 12];
        let is_picture_affected = is_affected.clone();
        let known = KnownFilm { record: &record, picture: &picture, is_affected, is_picture_affected };
        // Three rows of four pixels: the pixel, the one to the left and the one above.
        let unknown: Vec<usize> = (0..12).filter(|pixel| known.edge_width(*pixel, 4).is_none()).collect();
        assert_eq!(unknown, [2, 5, 6]);
        assert_eq!(known.samples(0).map(|pixel| pixel.mean()), Some(0.75));
        assert_eq!([5, 6].map(|pixel| known.sees_outline(pixel)), [Some(true), None]);
        assert!(known.samples(2).is_none() && known.samples(6).is_none());
        assert_eq!([5, 6].map(|pixel| known.picture_samples(pixel, Replicas::ONE).is_some()), [true, false]);
        assert_eq!([known.audited(0, 0), known.audited(1, 0), known.audited(3, 6)], [Some(1.0), None, None]);
    }
}
