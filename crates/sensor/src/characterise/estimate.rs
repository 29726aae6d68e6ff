//! The standard's quantities from the statistics of a measurement series.

use super::error::CharacterisationError;
use super::line::{Line, Point, fit};
use super::measure::{LightStep, PhotonTransfer};
use super::spatial::SpatialVariance;
use crate::interval::Estimate;

/// Variance of rounding to integer grey values.
const ROUNDING: f64 = 1.0 / 12.0;
/// Lines are fitted up to this fraction of saturation.
const LINEAR_SHARE: f64 = 0.7;
/// Iterations of weighting by the fitted variance.
const ROUNDS: u32 = 6;
/// Fraction of pixels at the largest grey value from which the converter, not the well, counts as
/// saturated.
const CONVERTER_FULL: f64 = 1e-3;

/// Fraction of dark pixels at 0 from which the noise counts as clipped, which biases everything
/// derived from it.
const DARK_CUT: f64 = 5e-3;

/// Estimated non-uniformity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialEstimate {
    /// Standard deviation over all pixels.
    pub total: Estimate,
    /// Pixel component.
    pub pixel: Estimate,
    /// Row component.
    pub row: Estimate,
    /// Column component.
    pub column: Estimate,
}

/// Characterisation of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Characterisation {
    /// System gain K, grey levels per electron.
    pub gain_dn_per_e: Estimate,
    /// Quantum efficiency η, electrons per photon.
    pub quantum_efficiency: Estimate,
    /// Temporal dark noise σ_d at the exposure time of the series, electrons, including the shot
    /// noise of the dark current.
    pub dark_noise_e: Estimate,
    /// Dark grey level y_dark.
    pub dark_grey: Estimate,
    /// Dark current I_d, electrons per second.
    pub dark_current_e_per_s: Estimate,
    /// DSNU, electrons.
    pub dsnu_e: SpatialEstimate,
    /// PRNU, relative to the response.
    pub prnu: SpatialEstimate,
    /// Full-well capacity, electrons; `None` if the converter saturates first.
    pub full_well_e: Option<Estimate>,
    /// Saturation capacity μ_e.sat: electrons at maximum temporal variance.
    pub saturation_capacity_e: f64,
    /// Maximum signal-to-noise ratio √μ_e.sat, as a plain ratio.
    pub largest_snr: f64,
    /// Dynamic range as a plain ratio: μ_p.sat over the photons at which signal equals noise.
    pub dynamic_range: f64,
    /// Maximum deviation of the mean from the line between 5 and 95 % of saturation, relative to
    /// saturation.
    pub linearity_error: f64,
    /// Responsivity, grey levels per photon.
    pub responsivity: Estimate,
    /// Fraction of dark grey values that are 0.
    pub dark_at_zero: f64,
}

impl Characterisation {
    /// Whether more than 0.5 % of the dark grey values are 0, which the standard does not allow:
    /// dark noise, gain and the quantities derived from them are then biased.
    #[must_use]
    pub fn is_cut_in_the_dark(&self) -> bool {
        self.dark_at_zero > DARK_CUT
    }
}

/// Estimates the standard's quantities.
///
/// # Errors
/// If the pictures show no photon noise.
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

/// Intermediate results.
struct Transfer<'a> {
    series: &'a PhotonTransfer,
    dark_mean: f64,
    /// Line of temporal variance over mean.
    photon_transfer: Line,
    /// Line of mean over photons.
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

    /// Total, pixel, row and column component of DSNU, grey values.
    fn dsnu(&self) -> [Estimate; 4] {
        let dark = &self.series.dark;
        SpatialVariance::of(&dark.means, self.columns()).estimates(dark.variance / f64::from(dark.pictures))
    }

    /// The same of PRNU, relative to the response, with the best values of its components.
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

    /// Standard error of the mean response of these pixels, relative to that of the sensor type.
    fn pattern_error(&self, parts: &crate::SpatialDeviation) -> f64 {
        let [columns, rows] = self.series.pixels.map(f64::from);
        (parts.pixel.powi(2) / (columns * rows) + parts.row.powi(2) / rows + parts.column.powi(2) / columns).sqrt()
    }

    fn responsivity(&self, parts: &crate::SpatialDeviation) -> Estimate {
        let error = self.response.slope_error.hypot(self.pattern_error(parts) * self.response.slope);
        Estimate::normal(self.response.slope, error)
    }

    /// I_d in grey values per second.
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

    /// Full well from the plateau, if the well and not the converter saturates.
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

/// The step of maximum temporal variance.
fn saturation(series: &PhotonTransfer) -> Option<LightStep> {
    series.light.iter().copied().max_by(|a, b| a.variance.total_cmp(&b.variance)).filter(|step| step.variance > 0.0)
}

/// Line of variance over mean, weighted by the variance of a variance, which the line itself
/// predicts.
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
                // The error of the mean moves the point along the line.
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

/// Line of mean over photons.
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
