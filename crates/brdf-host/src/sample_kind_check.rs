//! Whether the results of `sample` have a kind of the interface.

use crate::PluginBrdf;
use glam::DVec3;
use radsight_brdf_abi::{sample_kind, status};

/// Points of the unit cube along each of its axes.
const POINTS: [f64; 3] = [0.1, 0.5, 0.9];

/// The finding for the first result of an unknown kind.
pub(crate) fn unknown_kind(brdf: &PluginBrdf) -> Option<String> {
    let mut weights = vec![0.0; brdf.bands()];
    for angle in [0.0_f64, 30.0, 60.0] {
        let (sine, cosine) = angle.to_radians().sin_cos();
        for u in POINTS.iter().flat_map(|&a| POINTS.iter().flat_map(move |&b| POINTS.map(|c| [a, b, c]))) {
            let (found, sampled) = brdf.call_sample(DVec3::new(sine, 0.0, cosine), u, &mut weights);
            if found == status::OK && sampled.kind > sample_kind::DELTA {
                let (kind, last) = (sampled.kind, sample_kind::DELTA);
                return Some(format!(
                    "sample returns the unknown kind {kind} at the outgoing angle {angle}°, expected 0 to {last}"
                ));
            }
        }
    }
    None
}
