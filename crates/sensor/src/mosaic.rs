//! Colour filter mosaics, and demosaicing.

/// A Bayer mosaic, named by the colours of the first two pixels of the first two rows (Bayer, US
/// patent 3971065, 1976).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bayer {
    /// Red first, blue in the second row.
    Rggb,
    /// Blue first, red in the second row.
    Bggr,
    /// Green first, red beside it.
    Grbg,
    /// Green first, blue beside it.
    Gbrg,
}

/// Demosaicing method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Demosaic {
    /// Mean of the nearest pixels of each colour.
    Bilinear,
    /// Linear filters over 5 x 5 pixels that transfer the detail of one colour to the others
    /// (Malvar, He, Cutler, ICASSP 2004).
    GradientCorrected,
}

const RED: usize = 0;
const GREEN: usize = 1;
const BLUE: usize = 2;

impl Bayer {
    /// All of them, for messages.
    pub const ALL: [Bayer; 4] = [Bayer::Rggb, Bayer::Bggr, Bayer::Grbg, Bayer::Gbrg];

    /// Name in a camera file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Bayer::Rggb => "RGGB",
            Bayer::Bggr => "BGGR",
            Bayer::Grbg => "GRBG",
            Bayer::Gbrg => "GBRG",
        }
    }

    /// Mosaic of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Bayer> {
        Bayer::ALL.into_iter().find(|mosaic| mosaic.name().eq_ignore_ascii_case(name))
    }

    /// Colours (0 red, 1 green, 2 blue) of the cell of 2 x 2 pixels, row by row.
    #[must_use]
    pub fn cell(self) -> [usize; 4] {
        match self {
            Bayer::Rggb => [RED, GREEN, GREEN, BLUE],
            Bayer::Bggr => [BLUE, GREEN, GREEN, RED],
            Bayer::Grbg => [GREEN, RED, BLUE, GREEN],
            Bayer::Gbrg => [GREEN, BLUE, RED, GREEN],
        }
    }

    /// Colour of a pixel's filter.
    #[must_use]
    pub fn color(self, column: usize, row: usize) -> usize {
        self.cell()[2 * (row % 2) + column % 2]
    }

    /// Demosaics grey values: red, green and blue of every pixel, row by row, at most `largest`.
    ///
    /// The picture is mirrored at the centres of its outermost pixels, which preserves the order of
    /// the filters.
    #[must_use]
    pub fn demosaic(self, greys: &[u16], columns: usize, method: Demosaic, largest: u16) -> Vec<u16> {
        let rows = greys.len() / columns.max(1);
        let raw = Raw { mosaic: self, greys, columns, rows };
        let mut colors = Vec::with_capacity(3 * greys.len());
        for row in 0..rows {
            for column in 0..columns {
                for color in [RED, GREEN, BLUE] {
                    let value = raw.value(column, row, color, method).round();
                    colors.push((value as u16).min(largest));
                }
            }
        }
        colors
    }
}

/// Grey values of a mosaic.
struct Raw<'a> {
    mosaic: Bayer,
    greys: &'a [u16],
    columns: usize,
    rows: usize,
}

impl Raw<'_> {
    fn value(&self, column: usize, row: usize, color: usize, method: Demosaic) -> f64 {
        let own = self.mosaic.color(column, row);
        if own == color {
            return f64::from(self.greys[row * self.columns + column]);
        }
        let sum = |offsets: &[[i64; 2]]| -> f64 { offsets.iter().map(|&[x, y]| self.at(column, row, x, y)).sum() };
        let cross = || sum(&[[-1, 0], [1, 0], [0, -1], [0, 1]]);
        let diagonal = || sum(&[[-1, -1], [1, -1], [-1, 1], [1, 1]]);
        let [beside, above] = [[[-1, 0], [1, 0]], [[0, -1], [0, 1]]];
        let corrects = method == Demosaic::GradientCorrected;
        let middle = self.at(column, row, 0, 0);
        let far_beside = || sum(&[[-2, 0], [2, 0]]);
        let far_above = || sum(&[[0, -2], [0, 2]]);
        if color == GREEN {
            let plain = 0.25 * cross();
            return if corrects { plain + 0.5 * middle - 0.125 * (far_beside() + far_above()) } else { plain };
        }
        if own != GREEN {
            let plain = 0.25 * diagonal();
            return if corrects { plain + 0.75 * middle - 0.1875 * (far_beside() + far_above()) } else { plain };
        }
        // A green pixel has a red neighbour in one direction and a blue one in the other.
        let is_beside = self.mosaic.color(column + 1, row) == color;
        let plain = 0.5 * sum(if is_beside { &beside } else { &above });
        if !corrects {
            return plain;
        }
        let (along, across) = if is_beside { (far_beside(), far_above()) } else { (far_above(), far_beside()) };
        plain + 0.625 * middle - 0.125 * (along + diagonal()) + 0.0625 * across
    }

    fn at(&self, column: usize, row: usize, x: i64, y: i64) -> f64 {
        let column = mirrored(column as i64 + x, self.columns);
        let row = mirrored(row as i64 + y, self.rows);
        f64::from(self.greys[row * self.columns + column])
    }
}

/// An index inside the picture, mirrored at the centres of the first and last pixel.
fn mirrored(at: i64, count: usize) -> usize {
    if count < 2 {
        return 0;
    }
    let period = 2 * (count as i64 - 1);
    let at = at.rem_euclid(period);
    at.min(period - at) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw(mosaic: Bayer, columns: usize, rows: usize, scene: impl Fn(usize, usize) -> [u16; 3]) -> Vec<u16> {
        let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        all.map(|(column, row)| scene(column, row)[mosaic.color(column, row)]).collect()
    }

    #[test]
    fn a_uniform_colour_is_reconstructed_from_every_mosaic() {
        for mosaic in Bayer::ALL {
            for method in [Demosaic::Bilinear, Demosaic::GradientCorrected] {
                let greys = raw(mosaic, 7, 6, |_, _| [900, 500, 120]);
                let colors = mosaic.demosaic(&greys, 7, method, 4095);
                if method == Demosaic::Bilinear {
                    assert!(colors.chunks(3).all(|color| color == [900, 500, 120]), "{mosaic:?}");
                }
                // The corrected filters preserve a uniform colour, since it has no detail.
                let sum: Vec<u32> =
                    (0..3).map(|c| colors.iter().skip(c).step_by(3).map(|&v| u32::from(v)).sum()).collect();
                assert_eq!(sum, [900 * 42, 500 * 42, 120 * 42], "{mosaic:?} {method:?}");
            }
        }
    }

    #[test]
    fn the_corrected_method_is_exact_for_ramps_and_much_nearer_than_bilinear_for_fine_grey_waves() {
        let error = |scene: &dyn Fn(usize, usize) -> [u16; 3], method| {
            let colors = Bayer::Grbg.demosaic(&raw(Bayer::Grbg, 24, 24, scene), 24, method, u16::MAX);
            let inner = (2..22).flat_map(|row| (2..22).map(move |column| (column, row)));
            let square = |(column, row): (usize, usize)| -> u64 {
                let found = &colors[3 * (row * 24 + column)..][..3];
                found.iter().zip(scene(column, row)).map(|(a, b)| u64::from(a.abs_diff(b)).pow(2)).sum()
            };
            inner.map(square).sum::<u64>()
        };
        let ramp = |column: usize, row: usize| [(100 + 16 * column + 8 * row) as u16; 3];
        assert_eq!(error(&ramp, Demosaic::GradientCorrected), 0);
        let wave =
            |column: usize, row: usize| [(1000.0 + 500.0 * (1.3 * column as f64 + 0.9 * row as f64).sin()) as u16; 3];
        let [corrected, bilinear] =
            [Demosaic::GradientCorrected, Demosaic::Bilinear].map(|method| error(&wave, method));
        assert!(3 * corrected < bilinear, "{corrected} against {bilinear}");
    }

    #[test]
    fn one_pixel_and_one_row_are_demosaiced() {
        assert_eq!(Bayer::Rggb.demosaic(&[7], 1, Demosaic::GradientCorrected, 255).len(), 3);
        assert_eq!(Bayer::Rggb.demosaic(&[7, 8, 9], 3, Demosaic::Bilinear, 255).len(), 9);
        assert!(Bayer::Rggb.demosaic(&[], 0, Demosaic::Bilinear, 255).is_empty());
    }
}
