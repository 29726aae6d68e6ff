//! Counts invalid results of plugins; the picture gets zero instead, and the user a message.

use glam::DVec3;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of invalid results of an instance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultCounts {
    /// Values, weights or densities that are not a number.
    pub nan: u64,
    /// Negative values, weights or densities.
    pub negative: u64,
    /// Infinite values, weights or densities.
    pub infinite: u64,
    /// Sampled directions that are not unit vectors or have no density.
    pub bad_sample: u64,
    /// Calls that returned a status other than ok.
    pub failed_call: u64,
}

impl FaultCounts {
    /// Sum over all kinds.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.nan + self.negative + self.infinite + self.bad_sample + self.failed_call
    }
}

impl std::fmt::Display for FaultCounts {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kinds = [
            (self.nan, "NaN"),
            (self.negative, "negative"),
            (self.infinite, "infinite"),
            (self.bad_sample, "bad samples"),
            (self.failed_call, "failed calls"),
        ];
        let parts: Vec<String> =
            kinds.iter().filter(|(count, _)| *count > 0).map(|(count, name)| format!("{count} {name}")).collect();
        out.write_str(&if parts.is_empty() { "none".to_owned() } else { parts.join(", ") })
    }
}

/// Faults of one instance, for a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultReport {
    /// Name of the material.
    pub material: String,
    /// Position of the material in the scene.
    pub place: String,
    /// The library.
    pub library: String,
    /// The model.
    pub model: String,
    /// Number of faults.
    pub counts: FaultCounts,
    /// Description of the first fault, with angles and value.
    pub first: String,
}

impl std::fmt::Display for FaultReport {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let FaultReport { material, place, library, model, counts, first } = self;
        write!(
            out,
            "{place}: plugin \"{library}\", model \"{model}\", material \"{material}\" returned {} wrong results, which count as zero: {counts}; the first: {first}",
            counts.total()
        )
    }
}

/// Counters shared by threads.
#[derive(Debug, Default)]
pub(crate) struct Faults {
    nan: AtomicU64,
    negative: AtomicU64,
    infinite: AtomicU64,
    bad_sample: AtomicU64,
    failed_call: AtomicU64,
    first: OnceLock<String>,
}

impl Faults {
    pub(crate) fn counts(&self) -> FaultCounts {
        FaultCounts {
            nan: self.nan.load(Ordering::Relaxed),
            negative: self.negative.load(Ordering::Relaxed),
            infinite: self.infinite.load(Ordering::Relaxed),
            bad_sample: self.bad_sample.load(Ordering::Relaxed),
            failed_call: self.failed_call.load(Ordering::Relaxed),
        }
    }

    pub(crate) fn first(&self) -> String {
        self.first.get().cloned().unwrap_or_default()
    }

    /// Counts a number that is not finite or is negative.
    #[cold]
    pub(crate) fn bad_number(&self, what: &str, number: f64, outgoing: DVec3, incident: DVec3) {
        let counter = match number {
            number if number.is_nan() => &self.nan,
            number if number.is_infinite() => &self.infinite,
            _ => &self.negative,
        };
        counter.fetch_add(1, Ordering::Relaxed);
        self.first.get_or_init(|| format!("{what} {number} at {}", directions(outgoing, incident)));
    }

    #[cold]
    pub(crate) fn bad_sample(&self, what: &str, outgoing: DVec3, incident: DVec3) {
        self.bad_sample.fetch_add(1, Ordering::Relaxed);
        self.first.get_or_init(|| format!("{what} at {}", directions(outgoing, incident)));
    }

    #[cold]
    pub(crate) fn failed_call(&self, what: &str, status: u32, outgoing: DVec3) {
        self.failed_call.fetch_add(1, Ordering::Relaxed);
        let name = radsight_brdf_abi::status_name(status);
        self.first
            .get_or_init(|| format!("{what} failed ({name}) at outgoing angle {}", degrees_from_normal(outgoing)));
    }
}

/// Both angles from the normal, and the azimuth between them.
fn directions(outgoing: DVec3, incident: DVec3) -> String {
    let azimuth = incident.y.atan2(incident.x) - outgoing.y.atan2(outgoing.x);
    format!(
        "outgoing angle {}, incident angle {}, azimuth between them {:.4}°",
        degrees_from_normal(outgoing),
        degrees_from_normal(incident),
        azimuth.rem_euclid(std::f64::consts::TAU).to_degrees()
    )
}

fn degrees_from_normal(direction: DVec3) -> String {
    format!("{:.4}°", direction.x.hypot(direction.y).atan2(direction.z).to_degrees())
}
