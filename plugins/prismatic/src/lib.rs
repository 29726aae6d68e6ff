//! prismatic: retroreflective sheeting of cube corners, by ray optics
//!
//! Sheeting of tiny corner prisms in clear plastic, as on modern traffic signs and reflectors. It returns up to two thirds of the light,
//! in six spots around the direction to the lamp when the corners are not quite square, and stops at large entrance angles, where
//! the prisms' faces no longer reflect totally.
//!
//! ```text
//! void brdfplugin prisms
//! 2 prismatic cube_corner
//! 0
//! 3 1.586 .0005 .002
//!
//! void brdfplugin mirrored_prisms
//! 3 prismatic cube_corner metal
//! 0
//! 4 1.49 0 .002 .85
//! ```
//!
//! | model | arguments | unit | range |
//! |---|---|---|---|
//! | `cube_corner` | word: what is behind the prisms, `air` (total reflection, the default) or `metal` | | |
//! | | index of refraction | 1 | 1.3 … 2.2 |
//! | | dihedral error: how far the angles between faces are above 90° | rad | −0.002 … 0.002 |
//! | | spread s: rms angle of a spot in each of two directions | rad | 0.0005 … 0.05 |
//! | | reflectance of a metal-coated face | 1 | 0 … 1 (default 0.85) |
//!
//! For each direction the prism is traced: refraction at the front, the three faces in each of six orders, refraction out. The share
//! of the light in each order is the area of the front through which rays of that order enter and leave again, by cutting the
//! triangle of the front with its image in the corner's point and with the projected edges (after Eckhardt, "Simple Model of
//! Corner Reflector Phenomena", Applied Optics 10(7), 1971). Faces and front reflect by Fresnel's formula for unpolarised light. Half
//! of the prisms are turned by 180°, as in sheeting. Each spot is a Gaussian: scratches, waviness and diffraction are in its width.
//!
//! The prisms' axes are on the normal, and the azimuth of the pattern is that of the frame's x axis. Light that is not retroreflected is
//! lost, and so is the front's mirror image: put the sheeting in a mixture with a glossy material if it matters.

mod cube_corner;
mod polygon;

use cube_corner::{BEAMS, Beam, CubeCorner, Faces};
use radsight_brdf_sdk::{CreateError, DVec3, Description, Lobes, Model, Parameter, Parameters, Sample, direction_near};
use std::f64::consts::TAU;

struct Sheeting {
    corner: CubeCorner,
    /// κ = 1/s²: a spot is `κ/2π exp(−κ |x|²/2)` in the distance x of directions.
    sharpness: f64,
    /// No spot reaches further from the direction of incidence: it is 1e-17 of its peak there.
    reach: f64,
}

/// Probability of a beam without light, times the number of beams: keeps the density above zero next to where beams end.
const LEAST_SHARE: f64 = 1e-3;
/// Standard deviations after which a spot has ended.
const SPOT_END: f64 = 9.0;

impl Sheeting {
    /// A spot at this distance from its middle, 1/sr.
    fn spot(&self, distance: DVec3) -> f64 {
        self.sharpness / TAU * (-0.5 * self.sharpness * distance.length_squared()).exp()
    }

    /// Symmetric in the two directions: beams come in pairs of opposite deviation, which belong to opposite orders of the faces.
    fn shape(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        let between = outgoing - incident;
        if outgoing.z <= 0.0 || incident.z <= 0.0 || between.length() > self.reach {
            return 0.0;
        }
        let beams = self.corner.beams((outgoing + incident).normalize());
        let sum: f64 = beams
            .iter()
            .map(|beam| beam.share * (self.spot(between - beam.deviation) + self.spot(between + beam.deviation)))
            .sum();
        sum / outgoing.z.max(incident.z)
    }

    /// Middles of the spots for light to come from, seen from `outgoing`, and the probabilities with which they are chosen.
    fn targets(&self, outgoing: DVec3) -> [(DVec3, f64); 2 * BEAMS] {
        let beams = self.corner.beams(outgoing);
        let total: f64 = beams.iter().map(|beam| 2.0 * (beam.share + LEAST_SHARE)).sum();
        std::array::from_fn(|index| {
            let Beam { deviation, share } = beams[index / 2];
            let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
            ((outgoing - deviation * sign).normalize(), (share + LEAST_SHARE) / total)
        })
    }

    fn density(&self, targets: &[(DVec3, f64)], incident: DVec3) -> f64 {
        targets.iter().map(|(middle, probability)| probability * self.spot(incident - *middle)).sum::<f64>()
    }
}

impl Model for Sheeting {
    const DESCRIPTION: Description = Description {
        citation: "ray optics; areas after Eckhardt, Applied Optics 10(7), 1971",
        lobes: Lobes { glossy: true, anisotropic: true, ..Lobes::NONE },
        reciprocal: true,
        parameters: &[
            Parameter::choice("backing", "air|metal", "what is behind the prisms").or_word("air"),
            Parameter::number("index", "1", "index of refraction of the prisms").within(1.3, 2.2),
            Parameter::number("dihedral_error", "rad", "by which the angles between faces are above 90°")
                .within(-0.002, 0.002),
            Parameter::number("spread", "rad", "rms width of a spot").within(5e-4, 0.05),
            Parameter::number("metal_reflectance", "1", "of a coated face").within(0.0, 1.0).or(0.85),
        ],
        ..Description::new("cube_corner", "sheeting of corner prisms")
    };

    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
        let faces = match parameters.word("backing") {
            "metal" => Faces::Coated { reflectance: parameters.number("metal_reflectance") },
            _ => Faces::Bare,
        };
        let (index, error) = (parameters.number("index"), parameters.number("dihedral_error"));
        let spread = parameters.number("spread");
        // Deviations are 3.27 n ε at normal incidence and grow with obliqueness.
        let reach = 20.0 * index * error.abs() + SPOT_END * spread;
        Ok(Sheeting { corner: CubeCorner::new(index, error, faces), sharpness: 1.0 / (spread * spread), reach })
    }

    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        values.fill(self.shape(outgoing, incident));
    }

    fn pdf(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        let far = (outgoing - incident).length() > self.reach;
        if outgoing.z <= 0.0 || incident.z <= 0.0 || far {
            return 0.0;
        }
        self.density(&self.targets(outgoing), incident)
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Sample {
        if outgoing.z <= 0.0 {
            return Sample::Absorbed;
        }
        let targets = self.targets(outgoing);
        let mut left = u[2];
        let chosen = targets.iter().find(|(_, probability)| {
            left -= probability;
            left < 0.0
        });
        let middle = chosen.unwrap_or(&targets[0]).0;
        // 1 − cos δ is drawn exponentially: with |x|² = 2 (1 − cos δ) that is the spot's density on the sphere.
        let fall = -(1.0 - u[0]).ln() / self.sharpness;
        if fall >= 2.0 {
            return Sample::Absorbed;
        }
        let incident = direction_near(middle, 2.0 * (0.5 * fall).sqrt().asin(), TAU * u[1]);
        let pdf = if incident.z > 0.0 { self.density(&targets, incident) } else { 0.0 };
        if pdf <= 0.0 || (outgoing - incident).length() > self.reach {
            return Sample::Absorbed;
        }
        weights.fill(self.shape(outgoing, incident) * incident.z / pdf);
        Sample::Continuous { incident, pdf }
    }
}

radsight_brdf_sdk::export!(manual = include_str!("lib.rs"); Sheeting);
