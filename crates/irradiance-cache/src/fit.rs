//! The irradiance around a record, from its own rays and those of its neighbours.
//!
//! Neighbours see almost the same surroundings, so a plane fitted to all of them is more accurate
//! than any of them alone: with ten neighbours a tenth of the rays suffices. The plane is fitted by
//! weighted least squares (local linear regression: Fan and Gijbels, Local Polynomial Modelling and
//! Its Applications, 1996). Where neighbours are few, the mean of the gradients from their rays
//! acts as a prior. Where the neighbours differ from the plane by more than their noise, the
//! irradiance is not linear: then the fit uses a smaller neighbourhood, and the record gets a
//! smaller reach.

use crate::bands::mean;
use crate::emitter_model::EmitterModel;
use crate::obstacles::Occluders;
use crate::record::{Limits, Record};
use crate::stored::store_fields;
use glam::{DMat3, DVec3};

/// A plane of irradiance over the tangent plane of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit<const BANDS: usize> {
    irradiance: [f64; BANDS],
    /// Change per radian; its direction is the axis of rotation.
    rotation: [DVec3; BANDS],
    /// Change per unit length.
    translation: [DVec3; BANDS],
    /// Second derivatives along the tangents x and y of the record's frame: xx, yy, xy.
    curvature: [[f64; 3]; BANDS],
    /// Number of rays in the fit.
    rays: f64,
    /// Of the irradiance averaged over the bands.
    variance: f64,
    /// Total irradiance averaged over the bands, including the irradiance that is not gathered. The
    /// minimum in the neighbourhood counts most.
    brightness: f64,
    /// The scale on which the neighbours agree.
    pub(crate) scale: f64,
    /// Relative residual of the neighbours beyond their noise, where they do not agree.
    pub(crate) interpolation_error: f64,
}

/// How well a plane fits the neighbours.
#[derive(Clone, Copy, Debug, Default)]
struct FitResidual {
    /// Ratio by which the squared residuals exceed the variance of the rays plus a tolerance.
    excess: f64,
    /// Residual beyond noise, relative to the irradiance.
    unexplained: f64,
}

/// A neighbour of a record in its fit.
#[derive(Clone)]
struct Neighbour<'r, const BANDS: usize> {
    record: &'r Record<BANDS>,
    /// Its irradiance minus the change predicted by the trend.
    detrended: [f64; BANDS],
    /// In the tangent plane.
    offset: DVec3,
    /// 0 at the record itself, 1 at the border of the widest neighbourhood.
    distance: f64,
    /// Agreement of the surfaces' normals and positions, 0…1.
    agreement: f64,
}

store_fields!(
    Fit: irradiance,
    rotation,
    translation,
    curvature,
    rays,
    variance,
    brightness,
    scale,
    interpolation_error
);

impl<const BANDS: usize> Fit<BANDS> {
    /// Whether a restored fit is finite and thus possible.
    pub(crate) fn is_usable(&self) -> bool {
        let numbers = [self.rays, self.variance, self.brightness, self.scale, self.interpolation_error];
        self.irradiance.iter().chain(&numbers).all(|number| number.is_finite() && *number >= 0.0)
            && self.rotation.iter().chain(&self.translation).all(|change| change.is_finite())
            && self.curvature.as_flattened().iter().all(|number| number.is_finite())
    }

    /// From the record alone.
    pub(crate) fn of(record: &Record<BANDS>) -> Fit<BANDS> {
        Fit {
            irradiance: record.irradiance,
            rotation: record.gradients.rotation,
            translation: record.gradients.translation,
            curvature: [[0.0; 3]; BANDS],
            rays: record.rays,
            variance: record.variance,
            brightness: mean(&record.irradiance) + record.ungathered,
            scale: record.scale,
            interpolation_error: 0.0,
        }
    }

    /// From the record and those around it, which include the record itself, as far as they are in
    /// sight of it.
    pub(crate) fn new<'r>(
        record: &Record<BANDS>,
        around: impl Iterator<Item = &'r Record<BANDS>>,
        limits: &Limits,
        occluders: &dyn Occluders,
    ) -> Fit<BANDS> {
        let radius = neighbourhood(limits) * record.reach(limits);
        let mut neighbours: Vec<Neighbour<'r, BANDS>> = around
            .filter_map(|other| {
                let offset = other.position - record.position;
                let forward = record.relative_error(other.position, other.normal, radius, limits.accuracy);
                let backward = other.relative_error(record.position, record.normal, radius, limits.accuracy);
                let distance = offset.length() / radius;
                let relative_error = forward.max(backward);
                let is_hidden = || {
                    (record.may_be_hidden_from(other.position) || other.may_be_hidden_from(record.position))
                        && occluders.separate(record.position, record.normal, other.position)
                        || record.is_on_another_level(other.position, other.normal, occluders)
                };
                (relative_error < 1.0 && !is_hidden()).then(|| Neighbour {
                    record: other,
                    detrended: other.irradiance,
                    offset: offset - record.normal * offset.dot(record.normal),
                    distance,
                    agreement: 1.0 - relative_error.powi(2),
                })
            })
            .collect();
        let weight = |other: &Neighbour<'r, BANDS>| other.weight(1.0);
        let total: f64 = neighbours.iter().map(weight).sum();
        let records = neighbours.iter().map(|other| (other.record, weight(other) / total));
        let model = EmitterModel::new(record.position, records, radius);
        // In corners emitters are so near that the model overestimates: then the records agree
        // better without it.
        let mut modelled = neighbours.clone();
        let with_model = Trend::new(record, &mut modelled, radius, &model);
        let without = Trend::new(record, &mut neighbours, radius, &EmitterModel::none(record.position, radius));
        let modelled_fit = Fit::over(record, (&modelled, &with_model), 1.0, limits);
        let plain_fit = Fit::over(record, (&neighbours, &without), 1.0, limits);
        let (trend, mut tried) = if modelled_fit.1.excess <= MAX_MODEL_EXCESS * plain_fit.1.excess {
            neighbours = modelled;
            (with_model, modelled_fit)
        } else {
            (without, plain_fit)
        };
        let (mut share, mut interpolation_error) = (1.0, 0.0);
        loop {
            let (mut fit, fit_residual) = tried;
            let allowed = 1.0 + SIGNIFICANT_RESIDUAL / (neighbours.len() as f64).sqrt();
            let (agree, can_judge) = (fit_residual.excess <= allowed, neighbours.len() >= MIN_NEIGHBOURS);
            if can_judge {
                // With too few neighbours to assess the fit, the parent neighbourhood decides.
                interpolation_error = if agree { 0.0 } else { fit_residual.unexplained };
            }
            if agree || !can_judge || share <= MIN_RADIUS {
                (fit.scale, fit.interpolation_error) = (share * record.scale, interpolation_error);
                fit.limit_to_own_rays(record, &neighbours);
                return fit;
            }
            share *= 0.5f64.sqrt();
            neighbours.retain(|neighbour| neighbour.distance < share);
            tried = Fit::over(record, (&neighbours, &trend), share, limits);
        }
    }

    /// The fit over a ball of this fraction of the widest radius, and its residual.
    fn over(
        record: &Record<BANDS>,
        (neighbours, trend): (&[Neighbour<'_, BANDS>], &Trend<BANDS>),
        share: f64,
        limits: &Limits,
    ) -> (Fit<BANDS>, FitResidual) {
        let radius = share * (neighbourhood(limits) * record.reach(limits));
        let weights: Vec<f64> = neighbours.iter().map(|neighbour| neighbour.weight(share)).collect();
        let total: f64 = weights.iter().sum();
        let mut fit = Fit::of(record);
        if neighbours.len() < 2 || total <= 0.0 {
            return (fit, FitResidual::default());
        }
        let squares: f64 =
            weights.iter().zip(neighbours).map(|(weight, other)| weight * weight / other.record.rays).sum();
        fit.rays = total * total / squares;
        let noise = |(weight, other): (&f64, &Neighbour<'_, BANDS>)| weight * weight * other.record.variance;
        fit.variance = weights.iter().zip(neighbours).map(noise).sum::<f64>() / (total * total);
        let [x, y, _] = Record::<BANDS>::frame(record.normal);
        let row_of = |neighbour: &Neighbour<'_, BANDS>| {
            DVec3::new(1.0, neighbour.offset.dot(x) / radius, neighbour.offset.dot(y) / radius)
        };
        // Noise causes slopes. The prior is a slope that changes the irradiance by itself within
        // the scale, with the weight that the noise needs, in rays.
        let of_a_ray =
            weights.iter().zip(neighbours).map(|(weight, other)| weight * other.record.variance * other.record.rays);
        let typical = weights.iter().zip(neighbours).map(|(weight, other)| weight * mean(&other.record.irradiance));
        let likely_change = typical.sum::<f64>() / total * radius / record.scale;
        let flatness =
            if likely_change > 0.0 { of_a_ray.sum::<f64>() / (total * likely_change * likely_change) } else { 0.0 };
        let ridge = PRIOR_WEIGHT * total + flatness;
        let mut normal_matrix = DMat3::from_diagonal(DVec3::new(0.0, ridge, ridge));
        for (weight, neighbour) in weights.iter().zip(neighbours) {
            let row = row_of(neighbour);
            normal_matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * *weight;
        }
        let solve = normal_matrix.inverse();
        for band in 0..BANDS {
            let prior = trend.gradient[band] - trend.slope[band];
            let mut right = DVec3::new(0.0, prior.dot(x), prior.dot(y)) * (radius * PRIOR_WEIGHT * total);
            for (weight, neighbour) in weights.iter().zip(neighbours) {
                right += row_of(neighbour) * (*weight * neighbour.detrended[band]);
            }
            let plane = solve * right;
            fit.irradiance[band] = plane.x.max(0.0);
            fit.translation[band] = trend.slope[band] + (x * plane.y + y * plane.z) / radius;
        }
        (fit.curvature, fit.rotation) = (trend.curvature, trend.rotation);
        let darkness = |(weight, other): (&f64, &Neighbour<'_, BANDS>)| {
            weight / (fit.strength() + other.record.ungathered).max(f64::MIN_POSITIVE)
        };
        fit.brightness = total / weights.iter().zip(neighbours).map(darkness).sum::<f64>();
        let fit_residual = fit.fit_residual((neighbours, trend), &weights, limits.explained);
        (fit, fit_residual)
    }

    /// Limits the fit to what noise allows around the mean of the record's own rays: where
    /// irradiance varies faster than the spacing of records, a plane through the neighbours is much
    /// farther off.
    fn limit_to_own_rays(&mut self, record: &Record<BANDS>, neighbours: &[Neighbour<'_, BANDS>]) {
        // Rare bright rays may have been found by neighbours only: then their variance is used,
        // relative to the fit.
        let (own, fitted) = (mean(&record.irradiance), self.strength());
        let share = |other: &Neighbour<'_, BANDS>| {
            other.record.variance / mean(&other.record.irradiance).powi(2).max(f64::MIN_POSITIVE)
        };
        let rays: f64 = neighbours.iter().map(|other| other.record.rays).sum();
        let of_a_ray = neighbours.iter().map(|other| share(other) * other.record.rays.powi(2)).sum::<f64>();
        let variance = record.variance.max(fitted * fitted * of_a_ray / (rays * record.rays).max(f64::MIN_POSITIVE));
        let apart = (own - fitted).abs();
        let explained = MAX_DEVIATION * variance.sqrt();
        if apart > explained {
            let share = 1.0 - explained / apart;
            for (band, own) in self.irradiance.iter_mut().zip(record.irradiance) {
                *band += (own - *band) * share;
            }
        }
    }

    fn fit_residual(
        &self,
        (neighbours, trend): (&[Neighbour<'_, BANDS>], &Trend<BANDS>),
        weights: &[f64],
        explained: f64,
    ) -> FitResidual {
        let (mut found, mut noise, mut total) = (0.0, 0.0, 0.0);
        for (weight, neighbour) in weights.iter().zip(neighbours) {
            let residual = |band: usize| {
                let slope = self.translation[band] - trend.slope[band];
                neighbour.detrended[band] - self.irradiance[band] - neighbour.offset.dot(slope)
            };
            let residual = (0..BANDS).map(residual).sum::<f64>() / BANDS as f64;
            found += weight * residual * residual;
            noise += weight * explained * neighbour.record.variance;
            total += weight;
        }
        let expected = noise + total * (TOLERANCE * self.strength()).powi(2);
        let unexplained = (found - noise).max(0.0).sqrt() / (total.sqrt() * self.strength()).max(f64::MIN_POSITIVE);
        FitResidual { excess: if expected > 0.0 { found / expected } else { 0.0 }, unexplained }
    }

    /// Number of rays in the fit.
    #[must_use]
    pub fn rays(&self) -> f64 {
        self.rays
    }

    /// Standard error of the irradiance averaged over the bands, due to the rays.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        self.variance.sqrt()
    }

    /// The irradiance averaged over the bands, including that which is not gathered: its harmonic
    /// mean around the record, since errors are most visible in shadow.
    #[must_use]
    pub fn brightness(&self) -> f64 {
        self.brightness
    }

    /// The irradiance averaged over the bands.
    fn strength(&self) -> f64 {
        mean(&self.irradiance)
    }

    /// The irradiance extrapolated to a point and normal near its record.
    pub(crate) fn at(&self, record: &Record<BANDS>, position: DVec3, normal: DVec3) -> [f64; BANDS] {
        let offset = position - record.position;
        let rotation = record.normal.cross(normal);
        let [x, y, _] = Record::<BANDS>::frame(record.normal).map(|axis| axis.dot(offset));
        std::array::from_fn(|band| {
            let [xx, yy, xy] = self.curvature[band];
            let interpolation_error = 0.5 * (xx * x * x + yy * y * y) + xy * x * y;
            let change = rotation.dot(self.rotation[band]) + offset.dot(self.translation[band]) + interpolation_error;
            (self.irradiance[band] + change).max(0.0)
        })
    }
}

impl<const BANDS: usize> Neighbour<'_, BANDS> {
    /// In proportion to the number of rays; falls to zero at the border of the neighbourhood.
    fn weight(&self, share: f64) -> f64 {
        let distance = self.distance / share;
        if distance >= 1.0 { 0.0 } else { self.record.rays * self.agreement * (1.0 - distance * distance) }
    }
}

/// The variation of the irradiance around a record, from the rays of all neighbours.
#[derive(Debug)]
struct Trend<const BANDS: usize> {
    /// Change per radian, and per unit length, from neighbouring rays of a record (Ward and
    /// Heckbert 1992).
    rotation: [DVec3; BANDS],
    gradient: [DVec3; BANDS],
    /// Change per unit length, and its second derivatives (xx, yy, xy), from the emitter model.
    slope: [DVec3; BANDS],
    curvature: [[f64; 3]; BANDS],
}

impl<const BANDS: usize> Trend<BANDS> {
    /// From the neighbours of a record; subtracts the trend from their irradiance.
    fn new(
        record: &Record<BANDS>,
        neighbours: &mut [Neighbour<'_, BANDS>],
        radius: f64,
        model: &EmitterModel<BANDS>,
    ) -> Self {
        let weight = |neighbour: &Neighbour<'_, BANDS>| neighbour.weight(1.0);
        let total: f64 = neighbours.iter().map(weight).sum();
        let average = |of: &dyn Fn(&Record<BANDS>) -> DVec3| {
            neighbours.iter().map(|other| of(other.record) * weight(other)).sum::<DVec3>() / total
        };
        let frame = Record::<BANDS>::frame(record.normal);
        let [x, y, normal] = frame;
        let changes = model.change(record.position, frame, DIFFERENCE_STEP * radius);
        let trend = Trend {
            rotation: std::array::from_fn(|band| average(&|other| other.gradients.rotation[band])),
            gradient: std::array::from_fn(|band| average(&|other| other.gradients.translation[band])),
            slope: changes.map(|change| x * change.slope[0] + y * change.slope[1]),
            curvature: changes.map(|change| change.curvature),
        };
        let here = model.irradiance(record.position, normal);
        for neighbour in neighbours {
            let rotation = neighbour.record.normal.cross(record.normal);
            let there = model.irradiance(neighbour.record.position, normal);
            for band in 0..BANDS {
                neighbour.detrended[band] += rotation.dot(trend.rotation[band]) - (there[band] - here[band]);
            }
        }
        trend
    }
}

/// The radius of a fit's neighbourhood, relative to the reach of its record.
pub(crate) fn neighbourhood(limits: &Limits) -> f64 {
    (MAX_RADIUS_TO_SCALE / limits.accuracy).clamp(MIN_REACHES, MAX_REACHES)
}

/// Maximum radius of a neighbourhood relative to the scale, whatever the reach of records.
const MAX_RADIUS_TO_SCALE: f64 = 0.4;
const MIN_REACHES: f64 = 1.5;
const MAX_REACHES: f64 = 3.5;

/// The weight of the gradients from rays, relative to that of the neighbours.
const PRIOR_WEIGHT: f64 = 0.02;

/// The emitter model is used unless it increases the squared residuals by this factor.
const MAX_MODEL_EXCESS: f64 = 1.2;

/// Step of the finite differences for slopes and curvatures, relative to the radius of the
/// neighbourhood.
const DIFFERENCE_STEP: f64 = 0.25;

/// A squared residual that exceeds the noise by more than this over the square root of the number
/// of neighbours is significant. It is over four standard deviations of the mean, since a few
/// bright rays dominate it.
const SIGNIFICANT_RESIDUAL: f64 = 6.0;

/// Allowed relative residual of a plane.
const TOLERANCE: f64 = 0.01;

/// Number of standard errors by which the fit may differ from a record's own rays.
const MAX_DEVIATION: f64 = 3.0;

/// Fewer neighbours agree with some plane in any case.
const MIN_NEIGHBOURS: usize = 4;

/// Minimum relative radius of a neighbourhood.
const MIN_RADIUS: f64 = 0.3;
impl<const BANDS: usize> Record<BANDS> {
    /// The irradiance at the record itself, on a facet with this unit normal.
    #[must_use]
    pub fn irradiance_on(&self, facet: DVec3) -> [f64; BANDS] {
        Fit::of(self).at(self, self.position, facet)
    }
}
