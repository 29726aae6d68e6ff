//! The decisions of a plan, in words.

use crate::options::{Caustics, Skip};
use crate::plan::{PlanDecision, RenderPlan};
use crate::shader::Kind;

impl RenderPlan {
    /// What is done and left out, and why.
    pub fn decide(&self) -> Vec<PlanDecision> {
        let mut decisions = Decisions::default();
        if !self.layout.sampling().is_rgb() {
            decisions.say(format!("{} bands are traced", self.bands()), "-cs");
        } else if self.bands == 1 {
            decisions.skip(Skip::EqualBands, "one band is traced".into(), "every colour that a surface uses is grey");
        } else {
            decisions.say("three bands are traced".into(), "some surface uses a colour or a colour pattern");
        }
        let primitives = self.geometry.len();
        let unseen = self.scene.surfaces.len() - primitives - self.scene.sources.len().min(self.scene.surfaces.len());
        decisions.say(format!("{primitives} surfaces are in the hierarchy"), "they have a place and a material");
        let (what, why) = self.hierarchy.words();
        decisions.say(what, &why);
        if unseen > 0 {
            decisions.say(format!("{unseen} surfaces are left out"), "rays pass through what has no material");
        }
        let images = self.lights.iter().filter(|light| !light.virtual_sources.is_empty()).count();
        decisions.say(
            format!("{} lights are sampled", self.lights.len() - images),
            "they are lights, spotlights or near glows",
        );
        if images > 0 {
            decisions.say(
                format!("{images} images of lights in plane mirrors are sampled"),
                "mirrors make virtual sources of lights (-dr)",
            );
        }
        let [drawn, again] = self.light_draws;
        if drawn > 0 {
            let what = format!("{drawn} of the lights are drawn at a point, {again} where light was scattered before");
            decisions.say(what, "they are many; a hierarchy of lights tells how important each is");
        }
        for (count, what, why) in self.reach.summary() {
            if count > 0 {
                decisions.skip(Skip::Unreached, format!("{count} {what}"), why);
            }
        }
        if self.options.ambient_bounces == 0 {
            decisions.say("diffuse interreflection is not followed".into(), "-ab 0");
        }
        if !self.portals.is_empty() {
            let what = format!("rays are sent towards {} portals", self.portals.len());
            decisions.say(what, "light of glows or of the sky comes in there");
        }
        if self.options.caustics == Caustics::Sampled {
            if self.samples_caustics() {
                decisions.say(
                    format!("paths to lamps are solved for by way of {} specular surfaces", self.reflectors.len()),
                    "caustics are asked for",
                );
            } else {
                decisions.say("caustics are not sampled".into(), "no curved mirror and no body, or mist or antimatter");
            }
        }
        if self.has_caustics {
            decisions
                .say("irradiance is looked for at every pixel where it bends".into(), "bodies of glass make caustics");
        }
        if !self.see_through {
            decisions.skip(
                Skip::BehindShadows,
                "a shadow ray ends at its first hit".into(),
                "nothing lets light through",
            );
        }
        if !self.shadows_bend {
            decisions.skip(Skip::BentShadows, "shadow rays are straight".into(), "nothing bends or dims them");
        }
        if !self.has_media {
            decisions.skip(Skip::Media, "rays cross empty space".into(), "no body and no mist fills it");
        }
        if !self.has_antimatter {
            decisions.skip(Skip::Antimatter, "no surface is cut away".into(), "there is no antimatter");
        }
        let functions = self.shaders.iter().flat_map(|shader| &shader.textures.steps).count();
        let textures = self.shaders.iter().flat_map(|s| &s.textures.steps).filter(|step| step.is_texture()).count();
        decisions
            .say(format!("{functions} patterns and textures are evaluated ({textures} textures)"), "surfaces use them");
        let mixtures = self.shaders.iter().filter(|shader| matches!(shader.kind, Kind::Mixture(_))).count();
        if mixtures > 0 {
            decisions.say(format!("{mixtures} mixtures of materials are evaluated"), "surfaces use them");
        }
        let retro = self.shaders.iter().filter(|shader| matches!(shader.kind, Kind::Retro(_))).count();
        if retro > 0 {
            decisions.say(
                format!("{retro} materials are sampled as a retroreflecting lobe"),
                "their texture turns the normal to the viewer under a rough highlight",
            );
        }
        decisions.0
    }
}

/// Decisions as they are made.
#[derive(Default)]
struct Decisions(Vec<PlanDecision>);

impl Decisions {
    fn say(&mut self, what: String, why: &str) {
        self.0.push(PlanDecision { what, why: why.to_owned(), skip: None });
    }

    /// One that leaves work out.
    fn skip(&mut self, skip: Skip, what: String, why: &str) {
        self.0.push(PlanDecision { what, why: why.to_owned(), skip: Some(skip) });
    }
}
