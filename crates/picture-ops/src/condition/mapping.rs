//! The mapping from scene luminance to display output.

use super::histogram::{BINS, Histogram};
use super::luminance::Luminance;
use super::{ConditionOptions, Exposure, MappedLuminance, TINY, VISIBLE};
use crate::cumulative::{cumulative, share_at};
use radsight_picture::WHITE_EFFICACY;

/// A tone mapping.
#[derive(Clone, Debug)]
pub(super) enum Mapping {
    /// Every value is multiplied by a factor.
    Linear { factor: f64 },
    /// By a tone curve.
    Tones(Box<ToneMap>),
}

impl Mapping {
    /// The requested factor, or the one that maps the scene's mean brightness to the middle of the
    /// display's range.
    pub(super) fn linear(options: &ConditionOptions, histogram: &Histogram, luminance: &Luminance) -> Mapping {
        if let Exposure::Factor(factor) = options.exposure
            && factor > TINY
        {
            return Mapping::Linear { factor };
        }
        let middle = (options.display_top.ln() - 0.5 * options.display_range.ln()).exp();
        let mean = histogram.mean.exp();
        let ratio = match options.eye.sensitivity {
            true => threshold(middle) / threshold(mean),
            false => middle / mean,
        };
        Mapping::Linear { factor: ratio * WHITE_EFFICACY / (luminance.exposure * options.display_top) }
    }

    /// The factor from scene values to output values; `None` if it is not constant.
    pub(super) fn recorded_exposure(&self, luminance: &Luminance) -> Option<f64> {
        match self {
            Mapping::Linear { factor } => Some(luminance.exposure * factor),
            Mapping::Tones(_) => None,
        }
    }

    pub(super) fn map(&self, pixel: &mut [f32; 3], luminance: &Luminance) {
        let factor = match self {
            Mapping::Linear { factor } => {
                if luminance.is_xyz() {
                    factor / WHITE_EFFICACY
                } else {
                    *factor
                }
            }
            Mapping::Tones(map) => {
                let world = luminance.of(*pixel);
                if world < VISIBLE[0] {
                    *pixel = [0.0; 3];
                    return;
                }
                let shown = map.brightness(world).exp();
                let part = (shown - map.display_low.exp()) / (map.display_high.exp() - map.display_low.exp());
                part / (world * luminance.exposure) * luminance.efficacy()
            }
        };
        *pixel = pixel.map(|value| (f64::from(value) * factor) as f32);
    }

    /// Scene and display luminance at the centre of each bin.
    pub(super) fn pairs(
        &self,
        histogram: &Histogram,
        options: &ConditionOptions,
        luminance: &Luminance,
    ) -> Vec<MappedLuminance> {
        let shown = |world: f64| match self {
            Mapping::Tones(map) => map.brightness(world).exp(),
            Mapping::Linear { factor } => {
                let shown = factor * luminance.exposure * world;
                shown.clamp(options.display_top / options.display_range, options.display_top)
            }
        };
        (0..BINS).map(|bin| histogram.middle(bin).exp()).map(|world| [world, shown(world)]).collect()
    }
}

/// A tone curve from histogram adjustment: no bin has more contrast than the eye can see.
#[derive(Clone, Debug)]
pub(super) struct ToneMap {
    /// The cumulative distribution at each bin, and 1.
    cumulative: Vec<f64>,
    low: f64,
    high: f64,
    display_low: f64,
    display_high: f64,
}

/// Tolerance of the ceiling: the share of the histogram that may exceed it, and the share that must
/// be left.
const TOLERANCE: f64 = 0.025;

impl ToneMap {
    /// `None` if the display can show the scene's range.
    pub(super) fn new(histogram: &Histogram, options: &ConditionOptions) -> Option<ToneMap> {
        let display_high = options.display_top.ln();
        let display_low = (options.display_top / options.display_range).ln();
        let mut counts = histogram.counts;
        let step = histogram.range() / BINS as f64;
        loop {
            let total: f64 = counts.iter().sum();
            let map = ToneMap {
                cumulative: cumulative(counts.iter().copied(), total),
                low: histogram.low,
                high: histogram.high,
                display_low,
                display_high,
            };
            if total <= histogram.total * TOLERANCE {
                return None;
            }
            let mut trimmings = 0.0;
            for (bin, count) in counts.iter_mut().enumerate() {
                let ceiling = total * step * map.ceiling(histogram.middle(bin).exp(), options);
                if *count > ceiling {
                    trimmings += *count - ceiling;
                    *count = ceiling;
                }
            }
            if trimmings <= total * TOLERANCE {
                return Some(map);
            }
        }
    }

    /// The display brightness of a scene luminance in cd/m².
    pub(super) fn brightness(&self, world: f64) -> f64 {
        let brightness = world.ln();
        if world <= VISIBLE[0] || brightness <= self.low + TINY {
            return self.display_low;
        }
        if brightness >= self.high - TINY {
            return self.display_high;
        }
        let position = BINS as f64 * (brightness - self.low) / (self.high - self.low);
        self.display_low + share_at(&self.cumulative, position) * (self.display_high - self.display_low)
    }

    /// The largest density of the histogram per unit of brightness (Eqs. 6 and 10 of the paper).
    fn ceiling(&self, world: f64, options: &ConditionOptions) -> f64 {
        let shown = self.brightness(world).exp();
        let ratio = match options.eye.sensitivity {
            true => threshold(shown) / threshold(world),
            false => shown / world,
        };
        ratio * world / (shown * (self.display_high - self.display_low))
    }
}

/// The smallest visible difference of luminance at an adaptation luminance, both in cd/m²: J.
/// Ferwerda, S. Pattanaik, P. Shirley, D. Greenberg, "A Model of Visual Adaptation for Realistic
/// Image Synthesis", SIGGRAPH 1996, for rods and for cones.
pub(crate) fn threshold(luminance: f64) -> f64 {
    if luminance < 1.148e-4 {
        return 1.38e-3;
    }
    let log = luminance.log10();
    let log_threshold = if log < -1.44 {
        (0.405 * log + 1.6).powf(2.18) - 2.86
    } else if log < -0.0184 {
        log - 0.395
    } else if log < 1.9 {
        (0.249 * log + 0.65).powf(2.7) - 0.72
    } else {
        log - 1.255
    };
    10f64.powf(log_threshold)
}
