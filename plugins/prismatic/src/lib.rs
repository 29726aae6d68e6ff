//! prismatic: retroreflective sheeting of cube corners, by ray optics
//!
//! Sheeting of small corner prisms in clear plastic, as on modern traffic signs and reflectors. It
//! returns up to two thirds of the light. If the corners are not exactly square, the light returns
//! in six spots around the direction of the lamp. Retroreflection ends at large entrance angles,
//! where the prisms' faces no longer reflect totally.
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
//! | `cube_corner` | word: backing of the prisms, `air` (total reflection, the default) or `metal` | | |
//! | | index of refraction | 1 | 1.3 … 2.2 |
//! | | dihedral error: excess of the angles between faces over 90° | rad | −0.002 … 0.002 |
//! | | spread s: rms angle of a spot in each of two directions | rad | 0.0005 … 0.05 |
//! | | reflectance of a metal-coated face | 1 | 0 … 1 (default 0.85) |
//!
//! For each direction the prism is traced: refraction at the front, the three faces in each of six
//! orders, refraction out. The fraction of the light in each order is the area of the front through
//! which rays of that order enter and leave again. It is found by clipping the front's triangle by
//! its image in the apex and by the projected edges (after Eckhardt, "Simple Model of Corner
//! Reflector Phenomena", Applied Optics 10(7), 1971). Faces and front reflect by Fresnel's formula
//! for unpolarised light. Half of the prisms are rotated by 180°, as in sheeting. Each spot is a
//! Gaussian, whose width accounts for scratches, waviness and diffraction.
//!
//! The prisms' axes are along the normal, and the azimuth of the pattern is that of the frame's x
//! axis. Light that is not retroreflected is lost, and so is the front's mirror reflection; mix the
//! sheeting with a glossy material if that matters.

use radsight_brdf_sdk::{CreateError, DVec3, Description, Lobes, Model, Parameter, Parameters, Sample};
use radsight_retro::{CubeCornerSheeting, Faces};

struct Sheeting(CubeCornerSheeting);

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
        Ok(Sheeting(CubeCornerSheeting::new(index, error, parameters.number("spread"), faces)))
    }

    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        values.fill(self.0.value(outgoing, incident));
    }

    fn pdf(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        self.0.pdf(outgoing, incident)
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Sample {
        let Some(incident) = self.0.sample(outgoing, u) else { return Sample::Absorbed };
        let pdf = self.0.pdf(outgoing, incident);
        if pdf <= 0.0 {
            return Sample::Absorbed;
        }
        weights.fill(self.0.value(outgoing, incident) * incident.z / pdf);
        Sample::Continuous { incident, pdf }
    }
}

radsight_brdf_sdk::export!(manual = include_str!("lib.rs"); Sheeting);
