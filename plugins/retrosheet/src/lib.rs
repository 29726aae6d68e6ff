//! retrosheet: retroreflective sheeting of glass beads
//!
//! Sheeting that returns light to its source, such as 3M Scotchlite 3870: traffic signs, and the
//! background of a vision system with lamps around the camera. The widths and strengths are
//! measured values.
//!
//! ```text
//! void brdfplugin sheeting
//! 2 retrosheet bead_sheet
//! 0
//! 3 .086 .00612 1.5
//! ```
//!
//! | model | arguments | unit | range |
//! |---|---|---|---|
//! | `bead_sheet` | ρ_s, fraction of the light returned at normal incidence | 1 | 0 … 1 |
//! | | α, width of the lobe: its rms angle to the axis in each of two directions is √2 α | rad | above 0, at most 0.2 |
//! | | index of refraction of the clear top film; 1: none | 1 | 1 … 2.5 (default 1.5) |
//! | | ρ_d, diffuse reflectance of the sheeting between the beads | 1 | 0 … 1 (default 0) |
//! | | roughness of the film, for its sheen | 1 | 0.0005 … 1 (default 0.1) |
//!
//! Lobe: Rushmeier, Parker and Lee, "Physically Accurate Synthetic Images for Computer Vision
//! System Design", 1991, eq. 6, in a reciprocal form: `f = ρ_s exp(−δ²/4α²)/(4πα² max(cos θ_i, cos
//! θ_o))`, with δ the angle between the two directions (the observation angle). Light passes the
//! film twice, with Fresnel's transmittance relative to normal incidence, so the lobe decreases
//! with the entrance angle. The film itself reflects as microfacets (Walter et al., EGSR 2007): the
//! sheen that the paper's conclusions miss.
//!
//! The sum of ρ_s, ρ_d and the film's reflectance must not exceed 1.

use radsight_brdf_sdk::{
    CreateError, DVec3, Description, Ggx, Lobes, Model, Parameter, Parameters, Sample, angle_between,
    cosine_hemisphere, cosine_pdf, direction_near, fresnel_dielectric,
};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

struct BeadSheet {
    retroreflectance: f64,
    width: f64,
    index: f64,
    matte: f64,
    film: Ggx,
    /// Transmittance of the film at normal incidence.
    transmittance: f64,
    /// Probabilities of sampling the retroreflecting lobe and the film; otherwise the diffuse base
    /// is sampled.
    choice: [f64; 2],
}

impl BeadSheet {
    /// The Gaussian of the lobe in the observation angle δ, 1/sr.
    fn gaussian(&self, delta: f64) -> f64 {
        let variance = 4.0 * self.width * self.width;
        (-delta * delta / variance).exp() / (PI * variance)
    }

    /// Transmittance of the film relative to normal incidence.
    fn passage(&self, cosine: f64) -> f64 {
        (1.0 - fresnel_dielectric(cosine, self.index)) / self.transmittance
    }

    fn value_and_pdf(&self, outgoing: DVec3, incident: DVec3) -> (f64, f64) {
        if outgoing.z <= 0.0 || incident.z <= 0.0 {
            return (0.0, 0.0);
        }
        let delta = angle_between(outgoing, incident);
        let gaussian = self.gaussian(delta);
        let film = self.film.reflect(outgoing, incident);
        let passage = self.passage(outgoing.z) * self.passage(incident.z);
        let retro = self.retroreflectance * gaussian * passage / outgoing.z.max(incident.z);
        let sheen = film.value * fresnel_dielectric(film.cosine, self.index);
        let matte = self.matte * FRAC_1_PI * passage;
        // The angle is sampled in a plane, where a ring is δ/sin δ times wider than on the sphere.
        let sin_delta = outgoing.cross(incident).length();
        let retro_pdf = if sin_delta > 1e-9 { gaussian * delta / sin_delta } else { gaussian };
        let [retro_choice, film_choice] = self.choice;
        let matte_choice = 1.0 - retro_choice - film_choice;
        let pdf = retro_choice * retro_pdf + film_choice * film.pdf + matte_choice * cosine_pdf(incident);
        (retro + sheen + matte, pdf)
    }
}

impl Model for BeadSheet {
    const DESCRIPTION: Description = Description {
        citation: "Rushmeier, Parker and Lee, 1991, eq. 6, made reciprocal",
        lobes: Lobes { diffuse: true, glossy: true, ..Lobes::NONE },
        reciprocal: true,
        parameters: &[
            Parameter::number("rho_s", "1", "fraction of the light returned at normal incidence").within(0.0, 1.0),
            Parameter::number("alpha", "rad", "width of the retroreflected lobe").above(0.0).at_most(0.2),
            Parameter::number("index", "1", "index of refraction of the top film, 1 for none").within(1.0, 2.5).or(1.5),
            Parameter::number("rho_d", "1", "diffuse reflectance between the beads").within(0.0, 1.0).or(0.0),
            Parameter::number("roughness", "1", "of the top film").within(0.0005, 1.0).or(0.1),
        ],
        ..Description::new("bead_sheet", "glass-bead sheeting with a sheen")
    };

    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
        let index = parameters.number("index");
        let (retroreflectance, matte) = (parameters.number("rho_s"), parameters.number("rho_d"));
        let film = fresnel_dielectric(1.0, index);
        if retroreflectance + matte + film > 1.0 {
            let message = format!(
                "with rho_d {matte} and the film's {film:.4} the sheeting would reflect more than all light, expected a sum of at most 1"
            );
            return Err(CreateError::Parameter { name: "rho_s", message });
        }
        let total = retroreflectance + matte + film;
        // Every existing lobe keeps a minimum probability, since the film's reflectance grows
        // towards grazing incidence.
        let share = |part: f64| if part > 0.0 { 0.1 + 0.7 * part / total } else { 0.0 };
        let shares = [share(retroreflectance), share(film), share(matte).max(0.05)];
        let sum: f64 = shares.iter().sum();
        Ok(BeadSheet {
            retroreflectance,
            width: parameters.number("alpha"),
            index,
            matte,
            film: Ggx { roughness: parameters.number("roughness") },
            transmittance: 1.0 - film,
            choice: [shares[0] / sum, shares[1] / sum],
        })
    }

    fn value(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) {
        values.fill(self.value_and_pdf(outgoing, incident).0);
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: DVec3, values: &mut [f64]) -> f64 {
        let (value, pdf) = self.value_and_pdf(outgoing, incident);
        values.fill(value);
        pdf
    }

    fn sample_direction(&self, outgoing: DVec3, u: [f64; 3]) -> Option<DVec3> {
        if outgoing.z <= 0.0 {
            return None;
        }
        if u[2] < self.choice[0] {
            let delta = 2.0 * self.width * (-(1.0 - u[0]).ln()).sqrt();
            return (delta < PI).then(|| direction_near(outgoing, delta, TAU * u[1]));
        }
        if u[2] < self.choice[0] + self.choice[1] {
            return Some(self.film.sample(outgoing, u[0], u[1]));
        }
        Some(cosine_hemisphere(u[0], u[1]))
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Sample {
        let Some(incident) = self.sample_direction(outgoing, u) else { return Sample::Absorbed };
        let (value, pdf) = self.value_and_pdf(outgoing, incident);
        if pdf <= 0.0 {
            return Sample::Absorbed;
        }
        weights.fill(value * incident.z / pdf);
        Sample::Continuous { incident, pdf }
    }
}

radsight_brdf_sdk::export!(manual = include_str!("lib.rs"); BeadSheet);

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_brdf_sdk::Band;

    const LED: [Band; 1] = [Band { centre_m: 650e-9, low_m: 640e-9, high_m: 660e-9 }];

    fn sheet(numbers: [f64; 5]) -> BeadSheet {
        BeadSheet::create(&Parameters::new::<BeadSheet>(&numbers, &[], &LED)).unwrap()
    }

    fn value(sheet: &BeadSheet, outgoing: DVec3, incident: DVec3) -> f64 {
        let mut value = [0.0];
        sheet.value(outgoing, incident, &mut value);
        value[0]
    }

    /// The paper's section 2: the sheeting is over 300 times as bright as a white diffuse surface.
    #[test]
    fn retro_peak_of_the_papers_sheeting_is_over_300_times_a_white_surface() {
        let sheet = sheet([0.086, 0.00612, 1.0, 0.0, 0.1]);
        let ratio = value(&sheet, DVec3::Z, DVec3::Z) * PI;
        assert!((ratio - 0.086 / (4.0 * 0.00612 * 0.00612)).abs() < 1e-9 && ratio > 300.0, "{ratio}");
    }

    #[test]
    fn retro_peak_is_at_zero_observation_angle_and_falls_by_e_at_two_alpha() {
        let sheet = sheet([0.086, 0.00612, 1.0, 0.0, 0.1]);
        let axis = DVec3::new(0.5, 0.0, 0.75f64.sqrt());
        let peak = value(&sheet, axis, axis);
        let aside = direction_near(axis, 2.0 * 0.00612, std::f64::consts::FRAC_PI_2);
        let ratio = value(&sheet, axis, aside) / peak * axis.z.max(aside.z) / axis.z;
        assert!((ratio * std::f64::consts::E - 1.0).abs() < 1e-6, "{ratio}");
    }

    #[test]
    fn too_much_reflectance_is_refused_at_its_parameter() {
        let refused = BeadSheet::create(&Parameters::new::<BeadSheet>(&[0.9, 0.01, 1.5, 0.2, 0.1], &[], &LED));
        assert!(matches!(refused, Err(CreateError::Parameter { name: "rho_s", .. })));
    }
}
