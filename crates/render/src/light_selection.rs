//! The expected number of samples of a light.

use glam::DVec3;
use radsight_compile::RenderPlan;
use radsight_light::{LightId, Reception, TreeCut};

/// The expected number of samples of a light at a point.
pub(crate) fn selection_pdf(plan: &RenderPlan, point: DVec3, reception: &Reception, id: LightId) -> f64 {
    match &plan.light_tree {
        Some(tree) if reception.draws > 0 => {
            f64::from(reception.draws) * TreeCut::new(tree, &plan.lights, point, reception).chance(id)
        }
        _ => f64::from(reception.samples_on(&plan.lights[id.0 as usize], point)),
    }
}
