//! Where the samples of a film are drawn.

use super::velocity::FilmVelocity;
use crate::film::UnblurredFilm;
use crate::neighbourhood::window_means;
use glam::DVec2;

/// Side of the largest strata, pixels.
const LARGEST: f64 = 8.0;

/// Side of strata without motion before anything is known, pixels.
const FIRST_SIDE: f64 = 2.0;

/// Part of the samples that is even over the film, whatever is known.
const EVEN_PART: f64 = 0.1;

/// Part of the samples that is even over a pixel and its neighbours.
const NEAR_PART: f64 = 0.3;

/// A stratum that should get so many samples of a randomisation is divided.
const DIVIDED_SAMPLES: f64 = 4.0;

/// Number of samples that what is known of the whole counts as in one of its parts.
const PRIOR_SAMPLES: f64 = 8.0;

/// Maximum number of samples of a stratum and randomisation in a pass: those of one sequence.
const MOST_SAMPLES: f64 = 65_536.0;

/// Sums over samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SlopeSums {
    count: f64,
    /// Of the derivative of radiance at a moving point, and of its square.
    slope: [f64; 2],
    /// Of what the motion of the point moves from pixel to pixel, and of its square.
    shifted: [f64; 2],
}

impl SlopeSums {
    pub(super) fn of_sample(slope: f64, shifted: f64) -> SlopeSums {
        SlopeSums { count: 1.0, slope: [slope, slope * slope], shifted: [shifted, shifted * shifted] }
    }

    pub(super) fn add(&mut self, other: &SlopeSums) {
        self.count += other.count;
        for (sums, added) in [(&mut self.slope, other.slope), (&mut self.shifted, other.shifted)] {
            sums.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
        }
    }

    /// Variance of a sample, for strata of a side relative to the radius of the kernels. These vary
    /// within a stratum, by so much the more the larger it is.
    fn variance(&self, relative_side: f64) -> f64 {
        let by_kernels = 0.25 * relative_side.min(1.0).powi(2);
        let of = |[sum, squared]: [f64; 2]| {
            let [mean, mean_square] = [sum / self.count, squared / self.count];
            (mean_square - mean * mean).max(0.0) + by_kernels * mean_square
        };
        of(self.slope) + of(self.shifted)
    }
}

/// A square of the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stratum {
    /// The corner at the left and the top, pixels of the film.
    pub(super) corner: DVec2,
    /// Pixels.
    pub(super) side: f64,
    /// Estimated variance of a sample.
    variance: f64,
    /// Samples of each randomisation.
    pub(super) samples: u32,
}

impl Stratum {
    fn new(corner: DVec2, side: f64) -> Stratum {
        Stratum { corner, side, variance: 0.0, samples: 1 }
    }

    fn quarter(&self, index: usize) -> Stratum {
        let side = 0.5 * self.side;
        let corner = self.corner + side * DVec2::new((index % 2) as f64, (index / 2) as f64);
        Stratum { corner, side, ..*self }
    }

    pub(super) fn area(&self) -> f64 {
        self.side * self.side
    }

    fn deviation(&self) -> f64 {
        self.area() * self.variance.sqrt()
    }

    fn learn(&mut self, sums: &SlopeSums, radius: f64) {
        if sums.count > 0.0 {
            let own = sums.count * sums.variance(self.side / radius);
            self.variance = (own + PRIOR_SAMPLES * self.variance) / (sums.count + PRIOR_SAMPLES);
        }
    }
}

/// Squares that cover the film, by rows of the largest ones.
#[derive(Clone, Debug)]
pub(super) struct Strata {
    pub(super) all: Vec<Stratum>,
    /// Of the kernels, pixels.
    radius: f64,
    /// Columns and rows of the film.
    size: [usize; 2],
}

impl Strata {
    /// Before anything is known: pixels where something moves, and squares of four elsewhere.
    pub(super) fn new(film: &UnblurredFilm, velocity: &FilmVelocity) -> Strata {
        let [columns, rows] = film.size();
        let size = DVec2::new(columns as f64, rows as f64);
        let moves = |stratum: &Stratum| {
            let [first, end] = [stratum.corner, (stratum.corner + stratum.side).min(size)];
            let pixels = |from: f64, to: f64| from as usize..to as usize;
            pixels(first.y, end.y)
                .any(|row| pixels(first.x, end.x).any(|column| velocity.moves(row * columns + column)))
        };
        let mut all = Vec::new();
        let tiles = (size / LARGEST).ceil();
        for tile in 0..(tiles.x * tiles.y) as usize {
            let corner = LARGEST * DVec2::new((tile % tiles.x as usize) as f64, (tile / tiles.x as usize) as f64);
            let mut open = vec![Stratum::new(corner, LARGEST)];
            while let Some(stratum) = open.pop() {
                let reaches_out = (stratum.corner + stratum.side).cmpgt(size).any();
                if stratum.corner.cmpge(size).any() {
                    continue;
                }
                let is_divided = stratum.side > FIRST_SIDE || moves(&stratum) || reaches_out;
                if is_divided && stratum.side > 1.0 {
                    open.extend((0..4).map(|index| stratum.quarter(index)));
                } else {
                    all.push(stratum);
                }
            }
        }
        Strata { all, radius: film.shift().abs().min_element(), size: film.size() }
    }

    /// Divides those with much noise, by what the samples of their quarters say.
    pub(super) fn divide(&mut self, sums: &[[SlopeSums; 4]]) {
        for (stratum, quarters) in self.all.iter_mut().zip(sums) {
            let mut whole = SlopeSums::default();
            quarters.iter().for_each(|quarter| whole.add(quarter));
            stratum.learn(&whole, self.radius);
        }
        let (parts, samples) = (self.parts(), self.samples());
        let divided = self.all.iter().zip(sums).zip(parts).flat_map(|((stratum, quarters), part)| {
            let is_divided = part * samples >= DIVIDED_SAMPLES;
            let quarter = |index: usize| {
                let mut quarter = stratum.quarter(index);
                quarter.learn(&quarters[index], self.radius);
                quarter
            };
            (0..4).filter(move |_| is_divided).map(quarter).chain((!is_divided).then_some(*stratum))
        });
        self.all = divided.collect();
    }

    /// Distributes about so many samples of each randomisation.
    pub(super) fn distribute(&mut self, samples: f64) {
        let parts = self.parts();
        for (stratum, part) in self.all.iter_mut().zip(parts) {
            stratum.samples = (samples * part).round().clamp(1.0, MOST_SAMPLES) as u32;
        }
    }

    /// The part of the samples that each gets. Some are even over a pixel and its neighbours, since what
    /// few samples have found may be larger than the stratum, and some are even over the film.
    fn parts(&self) -> Vec<f64> {
        let pixels = self.size[0] * self.size[1];
        let mut near = vec![0.0; pixels];
        for stratum in &self.all {
            self.pixels_of(stratum).for_each(|(pixel, share)| near[pixel] += share * stratum.deviation());
        }
        let near = window_means(&near, self.size[0], 1);
        let [total, total_near] = [self.all.iter().map(Stratum::deviation).sum::<f64>(), near.iter().sum()];
        let part = |stratum: &Stratum| {
            let even = stratum.area() / pixels as f64;
            if total == 0.0 {
                return even;
            }
            let around: f64 = self.pixels_of(stratum).map(|(pixel, _)| near[pixel]).sum();
            let around = around * stratum.area().min(1.0) / total_near;
            EVEN_PART * even + NEAR_PART * around + (1.0 - EVEN_PART - NEAR_PART) * stratum.deviation() / total
        };
        self.all.iter().map(part).collect()
    }

    /// The pixels of a stratum, with their part of it.
    fn pixels_of(&self, stratum: &Stratum) -> impl Iterator<Item = (usize, f64)> {
        let (columns, side) = (self.size[0], stratum.side.ceil() as usize);
        let first = stratum.corner.y as usize * columns + stratum.corner.x as usize;
        let pixels = (0..side).flat_map(move |row| (0..side).map(move |column| first + row * columns + column));
        pixels.map(move |pixel| (pixel, ((side * side) as f64).recip()))
    }

    /// Samples of each randomisation.
    pub(super) fn samples(&self) -> f64 {
        self.all.iter().map(|stratum| f64::from(stratum.samples)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::tests::film;

    /// Strata of a film of 21 by 17 pixels, of which one moves.
    fn strata() -> Strata {
        let film = film([2.5, 1.6], [11, 9]);
        assert_eq!(film.size(), [21, 17]);
        let mut moves = vec![false; film.pixel_count()];
        moves[5 * 21 + 4] = true;
        Strata::new(&film, &FilmVelocity::zero(&film, moves))
    }

    fn assert_covers(strata: &Strata) {
        let mut covered = vec![0.0; 21 * 17];
        for stratum in &strata.all {
            strata.pixels_of(stratum).for_each(|(pixel, share)| covered[pixel] += share * stratum.area());
        }
        assert!(covered.iter().all(|area| (area - 1.0).abs() < 1e-12), "{covered:?}");
    }

    #[test]
    fn strata_cover_the_film_once() {
        let strata = strata();
        assert_covers(&strata);
        let side_at = |at: DVec2| {
            let holds = |stratum: &&Stratum| {
                (at - stratum.corner).min_element() >= 0.0 && (at - stratum.corner).max_element() < stratum.side
            };
            strata.all.iter().find(holds).map(|stratum| stratum.side)
        };
        assert_eq!(side_at(DVec2::new(4.5, 5.5)), Some(1.0));
        assert_eq!(side_at(DVec2::new(10.5, 10.5)), Some(FIRST_SIDE));
    }

    /// Where one quarter of a stratum changes, it gets most samples, and others keep some.
    #[test]
    fn samples_go_where_the_noise_is() {
        let mut strata = strata();
        let noisy = strata.all.iter().position(|stratum| stratum.side == 1.0).expect("one pixel moves");
        let corner = strata.all[noisy].corner;
        for _ in 0..4 {
            let of_quarter = |stratum: &Stratum, quarter: usize| {
                let is_noisy = stratum.corner.distance(corner) < 1e-9 && quarter == 0;
                let mut sums = SlopeSums::default();
                for slope in [1.0, -1.0].repeat(64) {
                    sums.add(&SlopeSums::of_sample(if is_noisy { slope } else { 0.0 }, 0.0));
                }
                sums
            };
            strata.distribute(4096.0);
            let sums: Vec<_> =
                strata.all.iter().map(|stratum| std::array::from_fn(|quarter| of_quarter(stratum, quarter))).collect();
            strata.divide(&sums);
            assert_covers(&strata);
        }
        strata.distribute(4096.0);
        let within = |stratum: &&Stratum| {
            (stratum.corner - corner).max_element() < 0.25 && (stratum.corner - corner).min_element() >= 0.0
        };
        let samples: u32 = strata.all.iter().filter(within).map(|stratum| stratum.samples).sum();
        assert!(samples > 2048, "{samples}");
        assert!(strata.all.iter().all(|stratum| stratum.samples >= 1));
    }
}
