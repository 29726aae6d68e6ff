//! The plan's decisions, as text.

use crate::options::{Caustics, Skip};
use crate::plan::{PlanDecision, RenderPlan};
use crate::shader::Kind;

impl RenderPlan {
    /// Lists what is done and skipped, and why.
    pub fn decide(&self) -> Vec<PlanDecision> {
        let mut decisions = Decisions::default();
        if !self.layout.sampling().is_rgb() {
            decisions.add(format!("{} bands are traced", self.bands()), "-cs");
        } else if self.bands == 1 {
            decisions.skip(Skip::EqualBands, "one band is traced".into(), "every colour that a surface uses is grey");
        } else {
            decisions.add("three bands are traced".into(), "some surface uses a colour or a colour pattern");
        }
        let primitives = self.geometry.len();
        let unseen = self.scene.surfaces.len() - primitives - self.scene.sources.len().min(self.scene.surfaces.len());
        decisions.add(
            format!("{primitives} surfaces are in the acceleration structure"),
            "they have a material and a finite distance",
        );
        let (what, why) = self.hierarchy.words();
        decisions.add(what, &why);
        if unseen > 0 {
            decisions.add(format!("{unseen} surfaces are left out"), "rays pass through surfaces without a material");
        }
        let images = self.lights.iter().filter(|light| !light.virtual_sources.is_empty()).count();
        decisions.add(
            format!("{} lights are sampled", self.lights.len() - images),
            "they are lights, spotlights or near glows",
        );
        if images > 0 {
            decisions.add(
                format!("{images} virtual images of lights are sampled"),
                "plane mirrors and prisms make virtual sources (-dr)",
            );
        }
        let [first, scattered] = self.light_draws;
        if first > 0 {
            let what = format!("{first} lights are selected at a visible point, {scattered} on a scattered path");
            decisions.add(what, "they are many; a light tree estimates the importance of each");
        }
        for (count, what, why) in self.visibility.summary() {
            if count > 0 {
                decisions.skip(Skip::Unreached, format!("{what}: {count}"), why);
            }
        }
        if self.options.ambient_bounces == 0 {
            decisions.add("diffuse interreflection is not computed".into(), "-ab 0");
        }
        if !self.portals.is_empty() {
            let what = format!("rays are sent towards {} portals", self.portals.len());
            decisions.add(what, "light of glows or of the sky enters there");
        }
        if self.options.caustics == Caustics::Sampled {
            if self.samples_caustics() {
                decisions.add(
                    format!("caustic paths through {} specular surfaces are sampled", self.reflectors.len()),
                    "caustics are requested",
                );
            } else {
                decisions.add(
                    "caustics are not sampled".into(),
                    "there is no curved mirror or refracting object, or there is mist or antimatter",
                );
            }
        }
        if self.has_caustics {
            decisions.add(
                "indirect irradiance is sampled at every pixel where cached values disagree".into(),
                "refracting objects make caustics",
            );
        }
        if !self.see_through {
            decisions.skip(
                Skip::BehindShadows,
                "a shadow ray ends at its first hit".into(),
                "no surface transmits light",
            );
        }
        if !self.shadow_rays_interact {
            decisions.skip(
                Skip::RefractedShadows,
                "shadow rays are straight".into(),
                "nothing refracts or attenuates them",
            );
        }
        if !self.has_media {
            decisions.skip(Skip::Media, "rays cross empty space".into(), "there are no absorbing objects and no mist");
        }
        if !self.has_antimatter {
            decisions.skip(
                Skip::Antimatter,
                "surfaces are not tested for subtraction".into(),
                "there is no antimatter",
            );
        }
        let functions = self.shaders.iter().flat_map(|shader| &shader.textures.steps).count();
        let textures = self.shaders.iter().flat_map(|s| &s.textures.steps).filter(|step| step.is_texture()).count();
        decisions
            .add(format!("{functions} patterns and textures are evaluated ({textures} textures)"), "surfaces use them");
        let mixtures = self.shaders.iter().filter(|shader| matches!(shader.kind, Kind::Mixture(_))).count();
        if mixtures > 0 {
            let mixtures = counted(mixtures, "mixture of materials is", "mixtures of materials are");
            decisions.add(format!("{mixtures} evaluated"), "surfaces use them");
        }
        let retro = self.shaders.iter().filter(|shader| matches!(shader.kind, Kind::Retro(_))).count();
        if retro > 0 {
            decisions.add(
                format!("{} sampled as a retroreflecting lobe", counted(retro, "material is", "materials are")),
                "their texture turns the normal to the viewer under a rough highlight",
            );
        }
        decisions.0
    }
}

/// A number of things, with the word for one or for several.
fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// Decisions in the order of the report.
#[derive(Default)]
struct Decisions(Vec<PlanDecision>);

impl Decisions {
    fn add(&mut self, what: String, why: &str) {
        self.0.push(PlanDecision { what, why: why.to_owned(), skip: None });
    }

    /// A decision that skips work.
    fn skip(&mut self, skip: Skip, what: String, why: &str) {
        self.0.push(PlanDecision { what, why: why.to_owned(), skip: Some(skip) });
    }
}
