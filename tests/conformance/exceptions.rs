//! Pictures of the render tests where real Radiance approximates what radsight computes, and the
//! evidence for our values (`docs/render-tests.md`).
//!
//! The evidence is mostly the truth of the blocks that differ ([`crate::truth`]). If rays of real
//! Radiance make the same approximation, it renders the same scene in another form.

use crate::blocks::{Agreement, Noise};
use crate::commands::{Reference, Scenes, radiance_values};
use crate::shared;
use radsight_test_support::Radiance;
use std::fs;

/// The evidence for our values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shown {
    /// Many rays in some of the blocks that differ ([`crate::truth`]).
    ManyRays,
    /// The same in all blocks, if some are not sufficient.
    ManyRaysEverywhere,
    /// Real Radiance with the correct solid angle of the sun's image.
    SunsImage,
    /// Single rays, with lights in place of the sky (`tests/rendering/scattering.rs`).
    SingleRays,
}

/// The exceptions with their evidence.
pub(crate) const EXCEPTIONS: [(&str, Shown); 11] = [
    ("mist_def", Shown::ManyRays),
    ("mixtex_def", Shown::ManyRaysEverywhere),
    ("mixtex_fish", Shown::ManyRaysEverywhere),
    ("mixtex_rplan", Shown::ManyRaysEverywhere),
    ("prism1_fish", Shown::SunsImage),
    ("prism2_fish", Shown::SunsImage),
    ("trans_def", Shown::ManyRays),
    ("trans_fish", Shown::ManyRays),
    ("trans2_def", Shown::ManyRays),
    ("trans2_fish", Shown::ManyRays),
    ("trans2_win", Shown::SingleRays),
];

/// The evidence for the exception of a picture; `None` if the pictures must agree.
pub(crate) fn shown(picture: &str) -> Option<Shown> {
    EXCEPTIONS.iter().find(|(name, _)| *name == picture).map(|(_, shown)| *shown)
}

/// The ratio by which each side of the prisms changes the sun's solid angle: the irradiance found
/// by rays through them, relative to a sun of unchanged width (`tests/rendering/light.rs`).
const SOLID_ANGLES: [(&str, f64); 2] = [("coef1 = ", 0.6726), ("coef2 = ", 0.8396)];

/// Real Radiance uses the sun's own solid angle for its image in a prism. Shadow rays know their
/// light (`DxA DyA DzA`), so the prism's functions can correct this.
#[test]
#[ignore = "renders with real Radiance; needs the pictures of radiance_render_tests"]
fn prisms_agree_where_radiance_knows_the_suns_image() {
    let (Some(shared), Some(radiance)) = (shared(), Radiance::find()) else { return };
    let mut scenes = Scenes::new(&shared, &radiance);
    let mut functions = fs::read_to_string(scenes.folder.path("prism.cal")).expect("the prism's functions");
    for (coefficient, share) in SOLID_ANGLES {
        let is_shadow_ray = "DxA*DxA+DyA*DyA+DzA*DzA-.5";
        functions = functions.replace(coefficient, &format!("{coefficient}if({is_shadow_ray}, {share}, 1) * "));
    }
    scenes.folder.file("prism.cal", functions);
    for reference in Reference::all(&shared) {
        if shown(&reference.name) != Some(Shown::SunsImage) {
            continue;
        }
        let Some(ours) = reference.our_picture() else { continue };
        scenes.build(&reference);
        let real = radiance_values(&scenes.real("rpict", &reference.words("")[1..], None).done());
        let agreement = Agreement::new(&ours, &real, Noise::Unknown, 8);
        println!("{:16} {agreement}, within 5 %: {:.1} %", reference.name, 100.0 * agreement.within);
        assert!(agreement.is_good(), "{} does not agree: {agreement}", reference.name);
    }
}
