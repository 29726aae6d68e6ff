//! The irradiance around a record, from its own rays and those of its neighbours.
//!
//! Neighbours looked into almost the same surroundings, so a plane through what all of them found is better known than any of them alone: with
//! ten neighbours a tenth of the rays is enough. The plane is fitted by weighted least squares (local linear regression: Fan and
//! Gijbels, Local Polynomial Modelling and Its Applications, 1996), the mean of the gradients that the rays themselves tell weighing in
//! where neighbours are few. Where the neighbours disagree by more than their noise, the irradiance bends: then the fit is taken over
//! a smaller neighbourhood, and the record is trusted less far.

use crate::emitter::EmitterModel;
use crate::record::{Limits, Record, mean};
use crate::stored::store_fields;
use glam::{DMat3, DVec3};

/// A plane of irradiance over the tangent plane of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit<const BANDS: usize> {
    irradiance: [f64; BANDS],
    /// Change per radian; its direction is the axis of the turn.
    rotation: [DVec3; BANDS],
    /// Change per length.
    translation: [DVec3; BANDS],
    /// Second derivatives along the tangents x and y of the record's frame: xx, yy, xy.
    curvature: [[f64; 3]; BANDS],
    /// How many rays it rests on.
    rays: f64,
    /// Of the irradiance averaged over the bands.
    variance: f64,
    /// All irradiance averaged over the bands, also what comes otherwise: where it is least counts most.
    brightness: f64,
    /// The scale up to which the neighbours agree.
    pub(crate) scale: f64,
    /// The share of the irradiance by which the neighbours miss the plane beyond their noise, where they do not agree.
    pub(crate) interpolation_error: f64,
}

/// How well a plane goes with the neighbours.
#[derive(Clone, Copy, Debug, Default)]
struct FitResidual {
    /// By how many times the squared residuals exceed what the noise of the rays and a tolerance explain.
    excess: f64,
    /// What noise leaves unexplained, as a share of the irradiance.
    unexplained: f64,
}

/// A neighbour of a record as its fit sees it.
#[derive(Clone)]
struct Neighbour<'r, const BANDS: usize> {
    record: &'r Record<BANDS>,
    /// Its irradiance without what the trend changes on the way to it.
    moved: [f64; BANDS],
    /// In the tangent plane.
    offset: DVec3,
    /// Zero at the record itself, one at the border of the widest neighbourhood.
    distance: f64,
    /// How well the surfaces agree, 0…1.
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
    /// Whether a fit that was saved is one that could have been made: finite.
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
            brightness: mean(&record.irradiance) + record.otherwise,
            scale: record.scale,
            interpolation_error: 0.0,
        }
    }

    /// From the record and those around it, among which it is itself.
    pub(crate) fn new<'r>(
        record: &Record<BANDS>,
        around: impl Iterator<Item = &'r Record<BANDS>>,
        limits: &Limits,
    ) -> Fit<BANDS> {
        let radius = neighbourhood(limits) * record.reach(limits);
        let mut neighbours: Vec<Neighbour<'r, BANDS>> = around
            .filter_map(|other| {
                let offset = other.position - record.position;
                let forth = record.misplacement(other.position, other.normal, radius, limits.accuracy);
                let back = other.misplacement(record.position, record.normal, radius, limits.accuracy);
                let distance = offset.length() / radius;
                let misplacement = forth.max(back);
                (misplacement < 1.0).then(|| Neighbour {
                    record: other,
                    moved: other.irradiance,
                    offset: offset - record.normal * offset.dot(record.normal),
                    distance,
                    agreement: 1.0 - misplacement.powi(2),
                })
            })
            .collect();
        let weight = |other: &Neighbour<'r, BANDS>| other.weight(1.0);
        let total: f64 = neighbours.iter().map(weight).sum();
        let records = neighbours.iter().map(|other| (other.record, weight(other) / total));
        let model = EmitterModel::new(record.position, records, radius);
        // In creases emitters are so near that the model says too much: then the records agree better without it.
        let mut bent = neighbours.clone();
        let with_model = Trend::new(record, &mut bent, radius, &model);
        let without = Trend::new(record, &mut neighbours, radius, &EmitterModel::none(record.position, radius));
        let bent_fit = Fit::over(record, (&bent, &with_model), 1.0, limits);
        let plain_fit = Fit::over(record, (&neighbours, &without), 1.0, limits);
        let (trend, mut tried) = if bent_fit.1.excess <= MODEL_FAILS * plain_fit.1.excess {
            neighbours = bent;
            (with_model, bent_fit)
        } else {
            (without, plain_fit)
        };
        let (mut share, mut interpolation_error) = (1.0, 0.0);
        loop {
            let (mut fit, fit_residual) = tried;
            let allowed = 1.0 + RESIDUAL_BY_CHANCE / (neighbours.len() as f64).sqrt();
            let (agree, can_judge) = (fit_residual.excess <= allowed, neighbours.len() >= FEWEST_TO_JUDGE);
            if can_judge {
                // Too few to judge bend as the more of whom they are.
                interpolation_error = if agree { 0.0 } else { fit_residual.unexplained };
            }
            if agree || !can_judge || share <= LEAST_SHARE {
                (fit.scale, fit.interpolation_error) = (share * record.scale, interpolation_error);
                fit.hold_to(record, &neighbours);
                return fit;
            }
            share *= 0.5f64.sqrt();
            neighbours.retain(|neighbour| neighbour.distance < share);
            tried = Fit::over(record, (&neighbours, &trend), share, limits);
        }
    }

    /// The fit over a ball of this share of the widest radius, and how well it goes with the neighbours.
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
        let place = |neighbour: &Neighbour<'_, BANDS>| {
            DVec3::new(1.0, neighbour.offset.dot(x) / radius, neighbour.offset.dot(y) / radius)
        };
        // Noise makes slopes: against a prior of a slope that changes the irradiance by itself within the scale, as many rays as noise needs weigh.
        let of_a_ray =
            weights.iter().zip(neighbours).map(|(weight, other)| weight * other.record.variance * other.record.rays);
        let typical = weights.iter().zip(neighbours).map(|(weight, other)| weight * mean(&other.record.irradiance));
        let likely_change = typical.sum::<f64>() / total * radius / record.scale;
        let flatness =
            if likely_change > 0.0 { of_a_ray.sum::<f64>() / (total * likely_change * likely_change) } else { 0.0 };
        let ridge = PRIOR * total + flatness;
        let mut normal_matrix = DMat3::from_diagonal(DVec3::new(0.0, ridge, ridge));
        for (weight, neighbour) in weights.iter().zip(neighbours) {
            let place = place(neighbour);
            normal_matrix += DMat3::from_cols(place * place.x, place * place.y, place * place.z) * *weight;
        }
        let solve = normal_matrix.inverse();
        for band in 0..BANDS {
            let prior = trend.gradient[band] - trend.slope[band];
            let mut right = DVec3::new(0.0, prior.dot(x), prior.dot(y)) * (radius * PRIOR * total);
            for (weight, neighbour) in weights.iter().zip(neighbours) {
                right += place(neighbour) * (*weight * neighbour.moved[band]);
            }
            let plane = solve * right;
            fit.irradiance[band] = plane.x.max(0.0);
            fit.translation[band] = trend.slope[band] + (x * plane.y + y * plane.z) / radius;
        }
        (fit.curvature, fit.rotation) = (trend.curvature, trend.rotation);
        let darkness = |(weight, other): (&f64, &Neighbour<'_, BANDS>)| {
            weight / (fit.strength() + other.record.otherwise).max(f64::MIN_POSITIVE)
        };
        fit.brightness = total / weights.iter().zip(neighbours).map(darkness).sum::<f64>();
        let fit_residual = fit.fit_residual((neighbours, trend), &weights, limits.explained);
        (fit, fit_residual)
    }

    /// Keeps it within what noise explains of what the record's own rays tell: where irradiance changes faster than records are
    /// dense, a plane through the neighbours misses it by far more.
    fn hold_to(&mut self, record: &Record<BANDS>, neighbours: &[Neighbour<'_, BANDS>]) {
        // Rare bright rays may have met the neighbours only: then theirs say how much noise there is, as a share of the fit.
        let (own, fitted) = (mean(&record.irradiance), self.strength());
        let share = |other: &Neighbour<'_, BANDS>| {
            other.record.variance / mean(&other.record.irradiance).powi(2).max(f64::MIN_POSITIVE)
        };
        let rays: f64 = neighbours.iter().map(|other| other.record.rays).sum();
        let of_a_ray = neighbours.iter().map(|other| share(other) * other.record.rays.powi(2)).sum::<f64>();
        let variance = record.variance.max(fitted * fitted * of_a_ray / (rays * record.rays).max(f64::MIN_POSITIVE));
        let apart = (own - fitted).abs();
        let explained = HELD * variance.sqrt();
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
                neighbour.moved[band] - self.irradiance[band] - neighbour.offset.dot(slope)
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

    /// How many rays it rests on.
    #[must_use]
    pub fn rays(&self) -> f64 {
        self.rays
    }

    /// The standard error that its rays leave in the irradiance averaged over the bands.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        self.variance.sqrt()
    }

    /// The irradiance averaged over the bands and that which comes otherwise: their harmonic mean around the record, since what is in shadow is spoilt first.
    #[must_use]
    pub fn brightness(&self) -> f64 {
        self.brightness
    }

    /// The irradiance averaged over the bands.
    fn strength(&self) -> f64 {
        mean(&self.irradiance)
    }

    /// The irradiance moved and turned to a point near its record.
    pub(crate) fn at(&self, record: &Record<BANDS>, position: DVec3, normal: DVec3) -> [f64; BANDS] {
        let offset = position - record.position;
        let turn = record.normal.cross(normal);
        let [x, y, _] = Record::<BANDS>::frame(record.normal).map(|axis| axis.dot(offset));
        std::array::from_fn(|band| {
            let [xx, yy, xy] = self.curvature[band];
            let interpolation_error = 0.5 * (xx * x * x + yy * y * y) + xy * x * y;
            let change = turn.dot(self.rotation[band]) + offset.dot(self.translation[band]) + interpolation_error;
            (self.irradiance[band] + change).max(0.0)
        })
    }
}

impl<const BANDS: usize> Neighbour<'_, BANDS> {
    /// In proportion to the rays; falls to zero at the border of the neighbourhood.
    fn weight(&self, share: f64) -> f64 {
        let distance = self.distance / share;
        if distance >= 1.0 { 0.0 } else { self.record.rays * self.agreement * (1.0 - distance * distance) }
    }
}

/// How the irradiance changes around a record as far as the rays themselves say, those of all neighbours together.
#[derive(Debug)]
struct Trend<const BANDS: usize> {
    /// Change per radian, and per length, by what neighbouring rays of a record saw (Ward and Heckbert 1992).
    rotation: [DVec3; BANDS],
    gradient: [DVec3; BANDS],
    /// Change per length, and its second derivatives (xx, yy, xy), by where the light comes from.
    slope: [DVec3; BANDS],
    curvature: [[f64; 3]; BANDS],
}

impl<const BANDS: usize> Trend<BANDS> {
    /// From the neighbours of a record, which then know what it takes from their irradiance.
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
        let changes = model.change(record.position, frame, DIFFERENCE * radius);
        let trend = Trend {
            rotation: std::array::from_fn(|band| average(&|other| other.gradients.rotation[band])),
            gradient: std::array::from_fn(|band| average(&|other| other.gradients.translation[band])),
            slope: changes.map(|change| x * change.slope[0] + y * change.slope[1]),
            curvature: changes.map(|change| change.curvature),
        };
        let here = model.irradiance(record.position, normal);
        for neighbour in neighbours {
            let turn = neighbour.record.normal.cross(record.normal);
            let there = model.irradiance(neighbour.record.position, normal);
            for band in 0..BANDS {
                neighbour.moved[band] += turn.dot(trend.rotation[band]) - (there[band] - here[band]);
            }
        }
        trend
    }
}

/// The radius of the neighbourhood of a fit, in reaches of its record.
pub(crate) fn neighbourhood(limits: &Limits) -> f64 {
    (WIDEST / limits.accuracy).clamp(NARROWEST_IN_REACHES, WIDEST_IN_REACHES)
}

/// No neighbourhood is wider than this share of the scale, however far records reach: irradiance bends.
const WIDEST: f64 = 0.4;
const NARROWEST_IN_REACHES: f64 = 1.5;
const WIDEST_IN_REACHES: f64 = 3.5;

/// The weight of the gradient that the rays themselves tell, beside that of the neighbours.
const PRIOR: f64 = 0.02;

/// The emitter model is used unless the neighbours differ by this many times as much, in squares, with it as without.
const MODEL_FAILS: f64 = 1.2;

/// Slopes and curvatures are told by differences over this share of the radius of the neighbourhood.
const DIFFERENCE: f64 = 0.25;

/// Squared residuals that exceed the noise by more than this over the square root of the neighbours' number are no noise any more: over four
/// standard deviations of its mean, since few bright rays make most of it.
const RESIDUAL_BY_CHANCE: f64 = 6.0;

/// A plane may miss the irradiance by this share.
const TOLERANCE: f64 = 0.01;

/// Standard errors by which a record's own rays may differ from the fit.
const HELD: f64 = 3.0;

/// Fewer neighbours always agree with some plane.
const FEWEST_TO_JUDGE: usize = 4;

/// The neighbourhood is not narrowed below this share.
const LEAST_SHARE: f64 = 0.3;
