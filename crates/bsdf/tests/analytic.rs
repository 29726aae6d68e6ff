//! Plastic, metal and the retroreflector of the paper: furnace tests, and the densities that
//! multiple importance sampling needs.

use glam::DVec3;
use radsight_brdf::Density;
use radsight_bsdf::HighlightShape::{Mirror, Retro};
use radsight_bsdf::{Bsdf, BsdfValue, GlossyKind, HighlightShape, PdfRequest, pane};
use radsight_cal::Scratch;
use radsight_ir::Rgb;

/// The R₂ sequence (Roberts 2018), with a third dimension.
fn points(count: u32) -> impl Iterator<Item = [f64; 3]> {
    const STEPS: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_970_4];
    (0..count).map(|n| STEPS.map(|step| (f64::from(n) * step + 0.5).fract()))
}

fn viewed(angle: f64) -> DVec3 {
    DVec3::new(angle.sin(), 0.0, angle.cos())
}

fn plastic(specularity: f64, roughness: f64) -> GlossyKind {
    GlossyKind { color: Rgb::WHITE, specularity, roughness, metallic: false }
}

fn metal(specularity: f64, roughness: f64) -> GlossyKind {
    GlossyKind { metallic: true, ..plastic(specularity, roughness) }
}

fn bsdf(kind: &GlossyKind, shape: HighlightShape, angle: f64) -> Bsdf<'static, 1> {
    Bsdf::glossy(kind, shape, [1.0], viewed(angle), DVec3::Z, DVec3::Z)
}

fn eval(bsdf: &Bsdf<'_, 1>, incident: DVec3) -> BsdfValue<1> {
    bsdf.eval(incident, 1.0, PdfRequest::Wanted, &mut Scratch::default())
}

const COUNT: u32 = 1 << 14;

/// Albedo of each component, estimated by its own samples.
fn albedo(bsdf: &Bsdf<'_, 1>) -> [f64; 2] {
    let diffuse: f64 = points(COUNT).filter_map(|[u, v, _]| bsdf.sample_diffuse(u, v)).map(|s| s.weight[0]).sum();
    let highlight: f64 = points(COUNT).filter_map(|u| bsdf.sample_highlight(u)).map(|s| s.weight[0]).sum();
    [diffuse, highlight].map(|sum| sum / f64::from(COUNT))
}

#[test]
fn a_white_lambertian_surface_reflects_all_light() {
    for angle in [0.0, 0.7, 1.5] {
        let white = Bsdf::<1>::white(viewed(angle), DVec3::Z);
        assert!((albedo(&white)[0] - 1.0).abs() < 1e-12);
        // Uniform directions instead of samples: 2π times the mean value.
        let mean = points(COUNT)
            .map(|[u, v, _]| {
                let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
                let rim = (1.0 - u * u).sqrt();
                eval(&white, DVec3::new(rim * cos, rim * sin, u)).diffuse[0]
            })
            .sum::<f64>()
            / f64::from(COUNT);
        assert!((std::f64::consts::TAU * mean - 1.0).abs() < 1e-3);
    }
}

#[test]
fn plastic_and_metal_conserve_energy() {
    for (specularity, roughness, metallic) in
        [(0.05, 0.0, false), (0.05, 0.1, false), (0.9, 0.2, true), (1.0, 0.05, true), (0.3, 0.3, false)]
    {
        for angle in [0.0, 0.5, 1.0, 1.3, 1.5] {
            let bsdf = bsdf(&GlossyKind { metallic, ..plastic(specularity, roughness) }, Mirror, angle);
            let [diffuse, highlight] = albedo(&bsdf);
            let sum = diffuse + highlight + bsdf.mirror[0];
            assert!(sum <= 1.0 + 2e-3, "{sum} of {specularity}, {roughness} at {angle}");
        }
    }
}

#[test]
fn a_rough_metal_loses_almost_no_energy_at_normal_incidence() {
    let bsdf = bsdf(&metal(1.0, 0.05), Mirror, 0.0);
    assert!((albedo(&bsdf)[1] - 1.0).abs() < 0.01);
}

#[test]
fn the_retroreflector_of_the_paper_returns_its_specularity() {
    // At 0.3° the lobe lies within the hemisphere and returns its albedo.
    let bsdf = bsdf(&metal(0.4, 0.005), Retro, 0.3);
    let [_, highlight] = albedo(&bsdf);
    assert!((highlight - 0.4).abs() < 0.4 * 0.01, "{highlight}");
    let back = points(100).filter_map(|u| bsdf.sample_highlight(u));
    assert!(back.into_iter().all(|sample| sample.direction.dot(viewed(0.3)) > 0.99));
}

#[test]
fn samples_have_the_density_and_weight_of_eval() {
    for (kind, shape) in [(plastic(0.05, 0.1), Mirror), (metal(0.8, 0.25), Mirror), (metal(0.3, 0.01), Retro)] {
        let bsdf = bsdf(&kind, shape, 0.8);
        let mut samples = 0;
        for u in points(500) {
            if let Some(sample) = bsdf.sample_highlight(u) {
                let value = eval(&bsdf, sample.direction);
                let Density::Continuous(pdf) = sample.pdf else { panic!("a rough highlight has a density") };
                assert!((value.highlight_pdf / pdf - 1.0).abs() < 1e-6, "{} and {pdf}", value.highlight_pdf);
                let weight = value.highlight[0] / pdf;
                assert!((sample.weight[0] - weight).abs() <= 1e-6 * weight, "{} and {weight}", sample.weight[0]);
                samples += 1;
            }
        }
        assert!(samples > 250);
    }
}

#[test]
fn balance_weighted_samples_estimate_both_components() {
    // The balance heuristic (Veach 1997): the weights of one direction sum to one, so both sums
    // estimate the whole.
    for roughness in [0.08, 0.3] {
        let bsdf = bsdf(&plastic(0.4, roughness), Mirror, 0.6);
        let [diffuse, highlight] = albedo(&bsdf);
        let weighted = |direction: DVec3| {
            let value = eval(&bsdf, direction);
            let sum = value.diffuse_pdf + value.highlight_pdf;
            // Weight: one density over the sum. Estimate: value over that density.
            (value.diffuse[0] + value.highlight[0]) / sum
        };
        let by_diffuse = points(COUNT).filter_map(|[u, v, _]| bsdf.sample_diffuse(u, v));
        let by_highlight = points(COUNT).filter_map(|u| bsdf.sample_highlight(u));
        let [by_diffuse, by_highlight] =
            [by_diffuse.map(|s| weighted(s.direction)).sum::<f64>(), by_highlight.map(|s| weighted(s.direction)).sum()];
        let both = (by_diffuse + by_highlight) / f64::from(COUNT);
        assert!((both / (diffuse + highlight) - 1.0).abs() < 0.01, "{both} and {}", diffuse + highlight);
    }
}

#[test]
fn a_clear_pane_reflects_by_fresnel_and_absorbs_nothing() {
    let index: f64 = 1.52;
    let [[reflected], [transmitted]] = pane([1.0], index, 1.0);
    let once = ((index - 1.0) / (index + 1.0)).powi(2);
    assert!((reflected - 2.0 * once / (1.0 + once)).abs() < 1e-12);
    for cosine in [1.0, 0.7, 0.3, 0.05] {
        let [[reflected], [transmitted]] = pane([1.0], index, cosine);
        assert!((reflected + transmitted - 1.0).abs() < 1e-12);
    }
    assert!(transmitted < 1.0);
}
