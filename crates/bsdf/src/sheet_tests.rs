//! Tests of sheets: samples have the density that `eval` gives, on both sides and with a perturbed
//! normal; no sheet creates energy.

use crate::bsdf::Bsdf;
use crate::context::BsdfContext;
use crate::sample::PdfRequest;
use crate::sheet::Sheet;
use glam::DVec3;
use radsight_brdf::check::{self, CheckLevel, CheckOptions};
use radsight_brdf::{Brdf, BrdfSample, Density, Lobes};
use radsight_cal::Scratch;
use radsight_ir::{Rgb, Scene};
use radsight_texture::{Appearance, SurfaceInteraction, TransmittedRays, shading_normal};

/// One component of a sheet, as a model in the frame of the surface.
#[derive(Debug)]
struct Part<'a> {
    scene: &'a Scene,
    sheet: &'a Sheet,
    /// Perturbation of the normal by a texture.
    perturbation: DVec3,
    component: Component,
}

#[derive(Debug, PartialEq)]
enum Component {
    Highlight,
    Diffuse,
}

impl Part<'_> {
    fn point<T>(&self, outgoing: DVec3, see: impl FnOnce(&Bsdf<'_, 1>) -> T) -> T {
        let ray = radsight_accel::Ray { origin: outgoing, direction: -outgoing };
        let interaction = SurfaceInteraction::new(&ray, DVec3::ZERO, DVec3::Z, 1.0, 1.0);
        let turned = interaction.turned();
        let appearance =
            Appearance { color: [1.0], perturbation: self.perturbation, transmitted: TransmittedRays::Turned };
        let normal = shading_normal(&interaction, self.perturbation);
        let context = BsdfContext {
            scene: self.scene,
            interaction: &interaction,
            turned: &turned,
            appearance,
            normal,
            threshold: 0.0,
        };
        see(&self.sheet.bsdf_at(&context, &mut Scratch::default()).point)
    }
}

impl Brdf for Part<'_> {
    fn lobes(&self) -> Lobes {
        Lobes { diffuse: true, glossy: true, transmission: true, delta: false }
    }

    fn eval_pdf(&self, outgoing: DVec3, incident: &[DVec3], values: &mut [f64], pdfs: &mut [f64]) {
        if outgoing.z <= 0.0 {
            values.fill(0.0);
            pdfs.fill(0.0);
            return;
        }
        self.point(outgoing, |point| {
            for ((incident, value), pdf) in incident.iter().zip(values).zip(pdfs) {
                let bsdf_value = point.eval(*incident, 1.0, PdfRequest::Wanted, &mut Scratch::default());
                let (product, density) = match self.component {
                    Component::Highlight => (bsdf_value.highlight[0], bsdf_value.highlight_pdf),
                    Component::Diffuse => (bsdf_value.diffuse[0], bsdf_value.diffuse_pdf),
                };
                // A direction that the texture puts on the other side is not sampled.
                *value = if density > 0.0 { product / incident.z.abs() } else { 0.0 };
                *pdf = density;
            }
        });
    }

    fn sample(&self, outgoing: DVec3, u: [f64; 3], weights: &mut [f64]) -> Option<BrdfSample> {
        if outgoing.z <= 0.0 {
            return None;
        }
        let sample = self.point(outgoing, |point| match self.component {
            Component::Highlight => point.sample_highlight(u),
            Component::Diffuse => point.sample_diffuse(u[0], u[1]),
        })?;
        weights.copy_from_slice(&sample.weight);
        let Density::Continuous(density) = sample.pdf else { return None };
        Some(BrdfSample { incident: sample.direction, density: Density::Continuous(density) })
    }
}

fn sheet(specularity: f64, roughness: f64, transmissivity: f64, transmitted_specularity: f64) -> Sheet {
    Sheet {
        color: Rgb::WHITE,
        specularity,
        roughness: [roughness; 2],
        metallic: false,
        transmissivity,
        transmitted_specularity,
        orientation: None,
    }
}

#[test]
fn samples_of_both_sides_have_the_density_of_eval() {
    let options = CheckOptions { isotropic: false, level: CheckLevel::Quick, ..CheckOptions::default() };
    let scene = Scene::default();
    for sheet in [sheet(0.1, 0.15, 0.6, 0.7), sheet(0.3, 0.01, 0.5, 0.5)] {
        for perturbation in [DVec3::ZERO, DVec3::new(0.3, -0.2, 0.1)] {
            for component in [Component::Highlight, Component::Diffuse] {
                // A turned normal receives direct and indirect light differently.
                if component == Component::Diffuse && perturbation != DVec3::ZERO {
                    continue;
                }
                let part = Part { scene: &scene, sheet: &sheet, perturbation, component };
                let findings = check::sampling(&part, &options);
                assert!(findings.is_empty(), "{sheet:?} {perturbation}: {findings:#?}");
            }
        }
    }
}

#[test]
fn a_white_sheet_conserves_energy() {
    let options = CheckOptions { level: CheckLevel::Quick, ..CheckOptions::default() };
    let scene = Scene::default();
    for (sheet, least) in
        [(sheet(0.1, 0.05, 0.5, 0.5), 0.99), (sheet(0.5, 0.2, 0.5, 0.8), 0.93), (sheet(0.0, 0.0, 1.0, 0.0), 0.999)]
    {
        for degrees in [0.0f64, 30.0, 50.0] {
            let outgoing = DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
            let total: f64 = [Component::Highlight, Component::Diffuse]
                .map(|component| {
                    let part = Part { scene: &scene, sheet: &sheet, perturbation: DVec3::ZERO, component };
                    check::albedo(&part, outgoing, &options).total(0)
                })
                .iter()
                .sum();
            assert!(total > least && total < 1.005, "{sheet:?} at {degrees}°: {total}");
        }
    }
}
