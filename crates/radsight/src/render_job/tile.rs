//! Parts of a picture: rectangles of its pixels, and ranges of rays.

use super::{JobTarget, RenderJob};
use crate::error::Error;
use crate::option_check::wrong;
use std::ops::Range;

/// A rectangle of pixels. Rays are one row of pixels.
///
/// ```
/// assert_eq!(radsight::Tile { columns: 0..4, rows: 2..4 }.pixels(), 8);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Its columns; the first column of the picture is 0.
    pub columns: Range<usize>,
    /// Its rows; the top row of the picture is 0.
    pub rows: Range<usize>,
}

impl Tile {
    /// Number of pixels, at most `usize::MAX`.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.columns.len().saturating_mul(self.rows.len())
    }
}

impl RenderJob {
    /// The requested pixels of a picture of this size; rays are one row.
    ///
    /// ```
    /// use radsight::{JobTarget, RenderJob};
    /// let mut job = RenderJob::new(JobTarget::capture("camera.toml"), 64);
    /// job.rows = Some(4..6);
    /// assert_eq!(job.tile_of([16, 12])?.pixels(), 32);
    /// job.rows = Some(4..13);
    /// assert!(job.tile_of([16, 12]).is_err());
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Option`] if the picture does not have them.
    pub fn tile_of(&self, [columns, rows]: [usize; 2]) -> Result<Tile, Error> {
        if let JobTarget::Trace { .. } = self.target {
            none("columns", self.columns.as_ref(), "none for rays, whose range is \"rays\"")?;
            none("rows", self.rows.as_ref(), "none for rays, whose range is \"rays\"")?;
            return Ok(Tile { columns: within("rays", self.rays.as_ref(), columns)?, rows: 0..1 });
        }
        none("rays", self.rays.as_ref(), "none for a picture, whose part is \"columns\" and \"rows\"")?;
        let columns = within("columns", self.columns.as_ref(), columns)?;
        Ok(Tile { columns, rows: within("rows", self.rows.as_ref(), rows)? })
    }

    /// Jobs for at most this number of parts of a picture of this size, with about the same number
    /// of rows or rays each.
    ///
    /// ```
    /// use radsight::{JobTarget, RenderJob};
    /// let parts = RenderJob::new(JobTarget::capture("camera.toml"), 64).split(3, [16, 12])?;
    /// assert_eq!(parts[2].rows, Some(8..12));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Option`] for no parts, for more than a million, and for rows or rays that do not
    /// exist.
    pub fn split(&self, parts: usize, size: [usize; 2]) -> Result<Vec<RenderJob>, Error> {
        if parts == 0 {
            return Err(wrong("parts", parts, "at least 1"));
        }
        let tile = self.tile_of(size)?;
        let is_trace = matches!(self.target, JobTarget::Trace { .. });
        let all = if is_trace { tile.columns } else { tile.rows };
        let parts = parts.min(all.len());
        check_count("parts", parts, parts)?;
        // The product of two large numbers needs more bits.
        let bound = |part: usize| Some(all.start + (all.len() as u128 * part as u128 / parts as u128) as usize);
        let range = |part: usize| bound(part).zip(bound(part + 1)).map(|(start, end)| start..end);
        let job = |part: usize| match is_trace {
            true => RenderJob { rays: range(part), ..self.clone() },
            false => RenderJob { rows: range(part), ..self.clone() },
        };
        Ok((0..parts).map(job).collect())
    }

    /// Jobs for rectangles of at most this size.
    ///
    /// ```
    /// use radsight::{JobTarget, RenderJob};
    /// let tiles = RenderJob::new(JobTarget::capture("camera.toml"), 64).split_tiles([8, 8], [16, 12])?;
    /// assert_eq!((tiles.len(), tiles[3].columns.clone(), tiles[3].rows.clone()), (4, Some(8..16), Some(8..12)));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Option`] for a rectangle without pixels, for more than a million of them, for a job
    /// of rays, and for pixels that the picture does not have.
    pub fn split_tiles(&self, [width, height]: [usize; 2], size: [usize; 2]) -> Result<Vec<RenderJob>, Error> {
        if width == 0 || height == 0 {
            return Err(wrong("tiles", format!("{width}x{height}"), "at least one pixel"));
        }
        if let JobTarget::Trace { .. } = self.target {
            return Err(wrong("tiles", format!("{width}x{height}"), "a number of rays for a job of rays"));
        }
        let tile = self.tile_of(size)?;
        let count = tile.rows.len().div_ceil(height).saturating_mul(tile.columns.len().div_ceil(width));
        check_count("tiles", count, format!("{width}x{height}"))?;
        let rows = pieces(&tile.rows, height);
        let job = |(rows, columns): (Range<usize>, Range<usize>)| {
            let columns = Some(columns).filter(|columns| *columns != (0..size[0]));
            RenderJob { rows: Some(rows), columns, ..self.clone() }
        };
        Ok(rows
            .flat_map(|rows| pieces(&tile.columns, width).map(move |columns| (rows.clone(), columns)))
            .map(job)
            .collect())
    }

    /// Jobs for ranges of at most this number of rays.
    ///
    /// ```
    /// use radsight::{JobTarget, RenderJob};
    /// let parts = RenderJob::new(JobTarget::trace("sensors.txt"), 1).split_rays(64, 100)?;
    /// assert_eq!(parts[1].rays, Some(64..100));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Option`] for no rays, for more than a million jobs, for a job of a picture, and for
    /// rays that do not exist.
    pub fn split_rays(&self, rays: usize, all: usize) -> Result<Vec<RenderJob>, Error> {
        if rays == 0 {
            return Err(wrong("rays", rays, "at least 1"));
        }
        let JobTarget::Trace { .. } = self.target else {
            return Err(wrong("rays", rays, "the size of a tile for a job of a picture"));
        };
        let tile = self.tile_of([all, 1])?;
        check_count("rays", tile.columns.len().div_ceil(rays), rays)?;
        Ok(pieces(&tile.columns, rays).map(|rays| RenderJob { rays: Some(rays), ..self.clone() }).collect())
    }

    /// The job without its part: what all parts share.
    pub(super) fn whole(&self) -> RenderJob {
        RenderJob { columns: None, rows: None, rays: None, ..self.clone() }
    }

    /// The job for a rectangle of a picture of this size.
    pub(super) fn for_tile(&self, tile: &Tile, size: [usize; 2]) -> RenderJob {
        let whole = self.whole();
        match self.target {
            JobTarget::Trace { .. } => RenderJob { rays: Some(tile.columns.clone()), ..whole },
            _ => {
                let columns = Some(tile.columns.clone()).filter(|columns| *columns != (0..size[0]));
                RenderJob { columns, rows: Some(tile.rows.clone()), ..whole }
            }
        }
    }
}

/// Largest number of parts.
const MOST_PARTS: usize = 1 << 20;

/// Refuses so many parts that their list would not fit into memory.
fn check_count(what: &'static str, count: usize, asked: impl ToString) -> Result<(), Error> {
    if count <= MOST_PARTS { Ok(()) } else { Err(wrong(what, asked, "a split into at most 1048576 parts")) }
}

/// Ranges of at most this length.
fn pieces(all: &Range<usize>, most: usize) -> impl Iterator<Item = Range<usize>> + use<> {
    let end = all.end;
    all.clone().step_by(most).map(move |start| start..end.min(start.saturating_add(most)))
}

/// A range below this number; all if none is given.
fn within(what: &'static str, asked: Option<&Range<usize>>, all: usize) -> Result<Range<usize>, Error> {
    let asked = asked.cloned().unwrap_or(0..all);
    if asked.start >= asked.end || asked.end > all {
        let found = format!("{} to {}", asked.start, asked.end);
        return Err(wrong(what, found, "some that there are, the first from 0 and the last not counted"));
    }
    Ok(asked)
}

fn none(what: &'static str, asked: Option<&Range<usize>>, expected: &'static str) -> Result<(), Error> {
    match asked {
        Some(asked) => Err(wrong(what, format!("{} to {}", asked.start, asked.end), expected)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn huge_numbers_are_split_without_overflow() {
        let job = RenderJob::new(JobTarget::trace("rays.txt"), 1);
        let parts = job.split(3, [usize::MAX, 1]).unwrap();
        assert_eq!(parts[0].rays, Some(0..usize::MAX / 3));
        assert_eq!(parts[2].rays.as_ref().unwrap().end, usize::MAX);
        let picture = RenderJob::new(JobTarget::capture("camera.toml"), 64);
        assert_eq!(picture.tile_of([usize::MAX, usize::MAX]).unwrap().pixels(), usize::MAX);
    }

    #[test]
    fn more_parts_than_fit_into_memory_are_refused() {
        let job = RenderJob::new(JobTarget::trace("rays.txt"), 1);
        let message = job.split(usize::MAX, [usize::MAX, 1]).unwrap_err().to_string();
        assert_eq!(message, format!("parts is {}, expected a split into at most 1048576 parts", usize::MAX));
        assert!(job.split_rays(1, usize::MAX).is_err());
        let picture = RenderJob::new(JobTarget::capture("camera.toml"), 64);
        assert!(picture.split_tiles([1, 1], [usize::MAX, usize::MAX]).is_err());
    }
}
