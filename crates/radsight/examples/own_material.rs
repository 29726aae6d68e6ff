//! A custom material without a shared library: the Lommel-Seeliger model, which describes the moon.

use glam::DVec3;
use radsight::{BrdfSample, Density, Error, Lobes, Material, Renderer, Scene, View};
use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

/// f = w / (4 π (μ + μ₀)): single scattering in a half space of dark grains (Seeliger 1887).
#[derive(Debug)]
struct LommelSeeliger {
    /// Single scattering albedo, 0 to 1.
    albedo: f64,
}

impl LommelSeeliger {
    fn value(&self, outgoing: DVec3, incident: DVec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 { 0.0 } else { self.albedo / (4.0 * PI * (outgoing.z + incident.z)) }
    }
}

impl Material for LommelSeeliger {
    fn lobes(&self) -> Lobes {
        Lobes { diffuse: true, ..Lobes::default() }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        let bands = values.len() / incident.len().max(1);
        for ((direction, values), pdf) in incident.iter().zip(values.chunks_mut(bands.max(1))).zip(pdfs) {
            values.fill(self.value(outgoing, *direction));
            *pdf = direction.z.max(0.0) * FRAC_1_PI;
        }
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        let (radius, angle) = (u[0].sqrt(), TAU * u[1]);
        let incident = DVec3::new(radius * angle.cos(), radius * angle.sin(), (1.0 - u[0]).max(1e-12).sqrt());
        weights.fill(PI * self.value(outgoing, incident));
        Some(BrdfSample { incident, density: Density::Continuous(incident.z * FRAC_1_PI) })
    }
}

pub(crate) fn main() -> Result<(), Error> {
    let text = "void light sun 0 0 3 3e4 3e4 3e4  sun source sunlight 0 0 4 .3 -1 .2 .53
                void plastic regolith 0 0 5 .2 .2 .2 0 0  regolith sphere moon 0 0 4 0 0 0 1";
    let moon = Arc::new(LommelSeeliger { albedo: 0.6 });
    let scene = Scene::builder().text("moon.rad", text).material("regolith", moon).build()?;
    let view = View::from_args("-vp 0 -5 0 -vd 0 1 0 -vh 26 -vv 26")?;
    let image = Renderer::new(&scene)?.error(0.02).render(&view, 64, 64)?;
    println!("{:.3} W/(sr·m²) in the middle", image.pixel(32, 32)[1]);
    Ok(())
}
