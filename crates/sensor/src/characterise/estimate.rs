//! The quantities of the standard from the statistics of the series.

use super::line::{Line, Point, fit};
use super::measure::{LightStep, PhotonTransfer};
use super::spatial::SpatialVariance;
use crate::interval::Estimate;

/// Variance of rounding to whole grey values.
const ROUNDING: f64 = 1.0 / 12.0;
/// Lines are fitted up to this share of saturation.
const LINEAR_SHARE: f64 = 0.7;
/// Rounds of weighting by the fitted variance.
const ROUNDS: u32 = 6;
/// Pixels at the largest grey value from this share on mean that the converter saturates, not the well.
const CONVERTER_FULL: f64 = 1e-3;

/// Dark pixels at 0 from this share on cut the noise off, and with it all that is measured by it.
const DARK_CUT: f64 = 5e-3;

/// A non-uniformity as it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialEstimate {
    /// Over all pixels.
    pub total: Estimate,
    /// From pixel to pixel.
    pub pixel: Estimate,
    /// From row to row.
    pub row: Estimate,
    /// From column to column.
    pub column: Estimate,
}

/// What a sensor was found to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Characterisation {
    /// K, grey levels an electron.
    pub gain_dn_per_e: Estimate,
    /// η, electrons a photon.
    pub quantum_efficiency: Estimate,
    /// σ_d, noise in the dark at the exposure time of the series, electrons; with the shot noise of the dark current.
    pub dark_noise_e: Estimate,
    /// y_dark, grey level in the dark.
    pub dark_grey: Estimate,
    /// I_d, electrons a second.
    pub dark_current_e_per_s: Estimate,
    /// DSNU, electrons.
    pub dsnu_e: SpatialEstimate,
    /// PRNU, shares of the response.
    pub prnu: SpatialEstimate,
    /// Depth of the well, electrons; `None` where the converter saturates before it.
    pub full_well_e: Option<Estimate>,
    /// μ_e.sat, electrons at the greatest variance in time.
    pub saturation_capacity_e: f64,
    /// Largest signal to noise ratio, a plain ratio: √μ_e.sat.
    pub largest_snr: f64,
    /// Dynamic range, a plain ratio: μ_p.sat over the photons at which the signal equals the noise.
    pub dynamic_range: f64,
    /// Largest deviation of the mean from the line between 5 and 95 % of saturation, share of saturation.
    pub linearity_error: f64,
    /// Responsivity, grey levels a photon.
    pub responsivity: Estimate,
    /// The share of grey values that are 0 in the dark.
    pub dark_at_zero: f64,
}

impl Characterisation {
    /// Whether the dark level is so low that more than 0.5 % of the dark grey values are 0, which the standard does not allow: dark noise,
    /// gain and what follows from them come out wrong.
    #[must_use]
    pub fn is_cut_in_the_dark(&self) -> bool {
        self.dark_at_zero > DARK_CUT
    }
}

/// Why nothing can be said.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CharacterisationError {
    /// Too few pixels or pictures for statistics.
    #[error("{columns} x {rows} pixels: expected at least 8 x 8, 8 steps and stacks of 4 pictures")]
    TooLittle {
        /// Pixels in a row.
        columns: u32,
        /// Rows.
        rows: u32,
    },
    /// More light always gives brighter pictures, or none does.
    #[error("the sensor does not saturate with {photons:e} photons a pixel")]
    NoSaturation {
        /// The most that was tried.
        photons: f64,
    },
    /// Grey does not rise with light, or does not fluctuate.
    #[error("the variance in time does not rise with the mean: there is no photon noise to measure by")]
    NoPhotonNoise,
}

/// Finds the quantities.
///
/// # Errors
/// When the pictures show no photon noise.
pub fn evaluate(series: &PhotonTransfer) -> Result<Characterisation, CharacterisationError> {
    let found = Transfer::new(series)?;
    let gain_error = found.photon_transfer.slope_error / found.gain();
    let per_electron = found.gain().recip();
    let dark_variance = (series.dark.variance - ROUNDING).max(0.0);
    let dark_degrees = found.pixels() * f64::from(series.dark.pictures - 1);
    let dark_noise = Estimate::deviation(series.dark.variance, dark_degrees, ROUNDING, 1.0);
    let prnu = found.prnu();
    let dsnu = found.dsnu().map(|part| part.scaled_by(per_electron, gain_error));
    let responsivity = found.responsivity(&prnu.1);
    let quantum_efficiency = {
        let error = found.response.slope_error.hypot(found.pattern_error(&prnu.1) * found.response.slope);
        Estimate::normal(found.response.slope, error).scaled_by(per_electron, gain_error)
    };
    let capacity = quantum_efficiency.value * found.saturation.photons;
    let threshold = (dark_variance + ROUNDING).sqrt() * per_electron + 0.5;
    Ok(Characterisation {
        gain_dn_per_e: Estimate::normal(found.gain(), found.photon_transfer.slope_error),
        quantum_efficiency,
        dark_noise_e: dark_noise.scaled_by(per_electron, gain_error),
        dark_grey: Estimate::normal(found.dark_mean, found.dark_mean_error()),
        dark_current_e_per_s: found.dark_current()?.scaled_by(per_electron, gain_error),
        dsnu_e: named(dsnu),
        prnu: named(prnu.0),
        full_well_e: found.full_well(gain_error),
        saturation_capacity_e: capacity,
        largest_snr: capacity.sqrt(),
        dynamic_range: capacity / threshold,
        linearity_error: found.linearity_error(),
        responsivity,
        dark_at_zero: series.dark.at_zero,
    })
}

fn named([total, pixel, row, column]: [Estimate; 4]) -> SpatialEstimate {
    SpatialEstimate { total, pixel, row, column }
}

/// What is found on the way.
struct Transfer<'a> {
    series: &'a PhotonTransfer,
    dark_mean: f64,
    /// Variance in time over mean.
    photon_transfer: Line,
    /// Mean over photons.
    response: Line,
    saturation: LightStep,
}

impl<'a> Transfer<'a> {
    fn new(series: &'a PhotonTransfer) -> Result<Self, CharacterisationError> {
        let saturation = saturation(series).ok_or(CharacterisationError::NoPhotonNoise)?;
        let dark_mean = series.dark.mean();
        let limit = dark_mean + LINEAR_SHARE * (saturation.mean - dark_mean);
        let points: Vec<LightStep> = series.light.iter().copied().filter(|step| step.mean <= limit).collect();
        let photon_transfer = photon_transfer(series, &points).filter(|line| line.slope > 0.0);
        let photon_transfer = photon_transfer.ok_or(CharacterisationError::NoPhotonNoise)?;
        let response = response(series, &points, &photon_transfer).filter(|line| line.slope > 0.0);
        let response = response.ok_or(CharacterisationError::NoPhotonNoise)?;
        Ok(Transfer { series, dark_mean, photon_transfer, response, saturation })
    }

    fn gain(&self) -> f64 {
        self.photon_transfer.slope
    }

    fn pixels(&self) -> f64 {
        self.series.dark.means.len() as f64
    }

    fn columns(&self) -> usize {
        self.series.pixels[0] as usize
    }

    fn dark_mean_error(&self) -> f64 {
        (self.series.dark.variance / (self.pixels() * f64::from(self.series.dark.pictures))).sqrt()
    }

    /// Total, pixel, row and column part, grey values.
    fn dsnu(&self) -> [Estimate; 4] {
        let dark = &self.series.dark;
        SpatialVariance::of(&dark.means, self.columns()).estimates(dark.variance / f64::from(dark.pictures))
    }

    /// The same of the response, as shares of it, with the best values of its parts.
    fn prnu(&self) -> ([Estimate; 4], crate::SpatialDeviation) {
        let (dark, half) = (&self.series.dark, &self.series.half);
        let difference: Vec<f64> = half.means.iter().zip(&dark.means).map(|(half, dark)| half - dark).collect();
        let rise = difference.iter().sum::<f64>() / difference.len() as f64;
        let shares: Vec<f64> = difference.iter().map(|value| value / rise).collect();
        let noise = half.variance / f64::from(half.pictures) + dark.variance / f64::from(dark.pictures);
        let variance = SpatialVariance::of(&shares, self.columns());
        let noise = noise / (rise * rise);
        (variance.estimates(noise), variance.parts(noise))
    }

    /// How far the mean response of these pixels may be from that of the type, as a share.
    fn pattern_error(&self, parts: &crate::SpatialDeviation) -> f64 {
        let [columns, rows] = self.series.pixels.map(f64::from);
        (parts.pixel.powi(2) / (columns * rows) + parts.row.powi(2) / rows + parts.column.powi(2) / columns).sqrt()
    }

    fn responsivity(&self, parts: &crate::SpatialDeviation) -> Estimate {
        let error = self.response.slope_error.hypot(self.pattern_error(parts) * self.response.slope);
        Estimate::normal(self.response.slope, error)
    }

    /// I_d in grey values a second.
    fn dark_current(&self) -> Result<Estimate, CharacterisationError> {
        let own = self.dark_mean_error().powi(2);
        let mut points =
            vec![Point { x: self.series.exposure_s, y: self.dark_mean, variance: own.max(f64::MIN_POSITIVE) }];
        points.extend(self.series.dark_times.iter().map(|step| Point {
            x: step.exposure_s,
            y: step.mean,
            variance: (step.variance / (2.0 * self.pixels())).max(f64::MIN_POSITIVE),
        }));
        let line = fit(&points).ok_or(CharacterisationError::NoPhotonNoise)?;
        Ok(Estimate::normal(line.slope, line.slope_error))
    }

    /// From the plateau, where it is the well's and not the converter's.
    fn full_well(&self, gain_error: f64) -> Option<Estimate> {
        let plateau: Vec<&LightStep> =
            self.series.light.iter().filter(|step| step.photons > 1.4 * self.saturation.photons).collect();
        if plateau.is_empty() || plateau.iter().any(|step| step.at_the_largest_grey > CONVERTER_FULL) {
            return None;
        }
        let steps = plateau.len() as f64;
        let mean = plateau.iter().map(|step| step.mean).sum::<f64>() / steps;
        let noise = plateau.iter().map(|step| step.variance).sum::<f64>() / (steps * steps * 2.0 * self.pixels());
        let dark_electrons = self.dark_current().ok()?.value * self.series.exposure_s;
        let error = noise.sqrt().hypot(self.dark_mean_error());
        let rise = Estimate::normal(mean - self.dark_mean + dark_electrons, error);
        Some(rise.scaled_by(self.gain().recip(), gain_error))
    }

    fn linearity_error(&self) -> f64 {
        let top = self.saturation.mean - self.dark_mean;
        let inner = |step: &&LightStep| (0.05..=0.95).contains(&((step.mean - self.dark_mean) / top));
        let off = |step: &LightStep| (step.mean - self.response.at(step.photons)).abs() / top;
        self.series.light.iter().filter(inner).map(off).fold(0.0, f64::max)
    }
}

/// The step of the greatest variance in time.
fn saturation(series: &PhotonTransfer) -> Option<LightStep> {
    series.light.iter().copied().max_by(|a, b| a.variance.total_cmp(&b.variance)).filter(|step| step.variance > 0.0)
}

/// The line of variance over mean, weighted by the variance of a variance that the line itself gives.
fn photon_transfer(series: &PhotonTransfer, points: &[LightStep]) -> Option<Line> {
    let pixels = series.dark.means.len() as f64;
    let dark_degrees = pixels * f64::from(series.dark.pictures - 1);
    let dark = (series.dark.mean(), series.dark.variance);
    let mut line = Line { intercept: 0.0, slope: 0.0, slope_error: 0.0 };
    for round in 0..ROUNDS {
        let expected = |mean: f64, found: f64| if round == 0 { found } else { line.at(mean) }.max(ROUNDING);
        let mut weighted: Vec<Point> = points
            .iter()
            .map(|step| {
                let variance = expected(step.mean, step.variance);
                // The mean has an error too, which moves the point along the line.
                let along = line.slope * line.slope * variance / (2.0 * pixels);
                Point { x: step.mean, y: step.variance, variance: 2.0 * variance * variance / pixels + along }
            })
            .collect();
        let variance = expected(dark.0, dark.1);
        weighted.push(Point { x: dark.0, y: dark.1, variance: 2.0 * variance * variance / dark_degrees });
        line = fit(&weighted)?;
    }
    Some(line)
}

/// The line of mean over photons.
fn response(series: &PhotonTransfer, points: &[LightStep], transfer: &Line) -> Option<Line> {
    let pixels = series.dark.means.len() as f64;
    let mut weighted: Vec<Point> = points
        .iter()
        .map(|step| Point {
            x: step.photons,
            y: step.mean,
            variance: transfer.at(step.mean).max(ROUNDING) / (2.0 * pixels),
        })
        .collect();
    let variance = series.dark.variance.max(ROUNDING) / (pixels * f64::from(series.dark.pictures));
    weighted.push(Point { x: 0.0, y: series.dark.mean(), variance });
    fit(&weighted)
}
