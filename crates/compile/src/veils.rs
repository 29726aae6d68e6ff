//! Veils: surfaces that transmit light, count as opaque in Radiance, and lie on other surfaces; for
//! example a mixture with holes on a wall.
//!
//! Where Radiance's rule prefers the veil, rays do not hit the surface below it, not even shadow
//! rays. The test is needed only in scenes with veils, which are collected once before the first
//! ray.

use crate::shader::Shader;
use glam::DVec3;
use radsight_accel::{Geometry, MemberId, flat_normal};
use radsight_ir::{Scene, SurfaceHandle};

/// Maximum number of tested pairs of surfaces.
const MAX_TESTS: usize = 4_000_000;

/// Normals whose cosine exceeds this are parallel.
const PARALLEL: f64 = 1.0 - 1e-6;

/// A flat member of the scene.
struct Flat {
    member: MemberId,
    normal: DVec3,
    low: DVec3,
    high: DVec3,
}

/// Flat surfaces that transmit light, count as opaque, and may lie on another flat surface.
pub(crate) fn find_veils<'a>(
    scene: &Scene,
    geometry: &Geometry,
    shader: impl Fn(SurfaceHandle) -> &'a Shader,
) -> Vec<MemberId> {
    let is_veil = |surface| shader(surface).lets_light_through() && geometry.counts_as_opaque(scene, surface);
    let is_candidate: Vec<bool> = geometry.members().map(|(_, surface)| is_veil(surface)).collect();
    let candidates = is_candidate.iter().filter(|is| **is).count();
    if candidates == 0 || candidates.saturating_mul(geometry.len()) > MAX_TESTS {
        return Vec::new();
    }
    let touch = DVec3::splat(geometry.tolerance());
    let veils = geometry.members().zip(&is_candidate).filter(|(_, is)| **is);
    let veils: Vec<Flat> = veils.filter_map(|(of, _)| flat(scene, geometry, of)).collect();
    // Most surfaces of a large scene lie beside all veils.
    let low = veils.iter().fold(DVec3::INFINITY, |low, veil| low.min(veil.low)) - touch;
    let high = veils.iter().fold(DVec3::NEG_INFINITY, |high, veil| high.max(veil.high)) + touch;
    let is_near = |surface: SurfaceHandle| {
        let bounds = geometry.bounds(scene, scene.surfaces[surface].shape);
        bounds.is_some_and(|bounds| bounds.min.cmple(high).all() && bounds.max.cmpge(low).all())
    };
    let near = geometry.members().filter(|(_, surface)| is_near(*surface));
    let flats: Vec<Flat> = near.filter_map(|of| flat(scene, geometry, of)).collect();
    let touches = |a: &Flat, b: &Flat| {
        a.member != b.member
            && a.normal.dot(b.normal).abs() > PARALLEL
            && a.low.cmple(b.high + touch).all()
            && b.low.cmple(a.high + touch).all()
    };
    veils.iter().filter(|veil| flats.iter().any(|other| touches(veil, other))).map(|veil| veil.member).collect()
}

fn flat(scene: &Scene, geometry: &Geometry, (member, surface): (MemberId, SurfaceHandle)) -> Option<Flat> {
    let shape = scene.surfaces[surface].shape;
    let normal = flat_normal(scene, shape)?;
    let bounds = geometry.bounds(scene, shape)?;
    Some(Flat { member, normal, low: bounds.min, high: bounds.max })
}
