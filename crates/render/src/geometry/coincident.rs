//! Surfaces that lie on each other: which of them a ray meets.
//!
//! Radiance takes what a ray hits within 1e-6 scene units of the nearest hit for equally near and decides by rule (`rayreject` in
//! `rt/raytrace.c`): what has a material before what has none, opaque before transparent, the side that faces the ray before the
//! other, then the modifier that is defined last. Of two with one modifier the one that stands last in the scene stays. A mesh or
//! an instance has already chosen among its own surfaces. It takes the place of what stands after it in the scene only where it is
//! really nearer; what stands before it has to win by the rule.
//!
//! The rays' search only notes which hits are equally near; the choice is made here, once per such ray.

use super::{Geometry, Limits, RayFrame, mesh, surface_point};
use crate::ray::{Crossing, MemberId, PrimitiveId, Ray};
use glam::DVec3;
use radsight_ir::{BsdfForm, Material, ModifierHandle, ModifierKind, Scene, Shape, SurfaceHandle, ValidScene};
use std::cmp::Reverse;

/// Hits no farther apart than this are equally near, scene units: Radiance's `FTINY`.
const TOLERANCE: f64 = 1e-6;

/// The tolerance is never more than this share of the scene's largest coordinate, or a tiny scene would be all one surface.
const LARGEST_SHARE: f64 = 1e-4;

/// Surfaces whose normals have a cosine above this lie along each other.
const ALONG: f64 = 1.0 - 1e-6;

/// Rounding of distances, as a share of the largest numbers that they are computed from.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The tolerance of a scene whose largest coordinate is `reach`.
pub(super) fn tolerance(reach: f64) -> f64 {
    TOLERANCE.min(LARGEST_SHARE * reach)
}

/// How far rounding takes apart the distances of what is equally near, for a ray that was followed so far.
pub(super) fn rounding(ray: &Ray, distance: f64) -> f64 {
    ROUNDING * (ray.origin.abs().max_element() + distance.abs())
}

/// What a material is to the rule, the weakest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Substance {
    Nothing,
    Transparent,
    /// All that Radiance does not call transparent, whether light passes or not.
    Opaque,
}

/// By what a surface wins over another that is as near; the greater one does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Standing {
    substance: Substance,
    faces_the_ray: bool,
    /// How late the modifier is defined. Those within meshes and instances are read after all others.
    modifier: (u32, usize),
}

/// Notes a hit that is about as near as the best one.
#[cold]
pub(super) fn note(ties: &mut Vec<Crossing>, best: Option<Crossing>, hit: Crossing) {
    if ties.is_empty() {
        ties.extend(best);
    }
    ties.push(hit);
}

impl Geometry {
    /// Which of hits that are about as near as the first the ray meets, of those before `farthest`.
    #[cold]
    pub(super) fn choose(&self, scene: &Scene, ray: &Ray, mut hits: Vec<Crossing>, farthest: f64) -> Option<Crossing> {
        hits.retain(|hit| hit.distance < farthest);
        // Radiance tries those first that stand last in the scene.
        hits.sort_unstable_by_key(|hit| Reverse(self.surface_of(self.member_of(hit.primitive).0).index()));
        hits.into_iter().reduce(|best, next| if self.displaces(scene, ray, best, next) { next } else { best })
    }

    /// Whether `next`, which stands before `best` in the scene, takes its place.
    fn displaces(&self, scene: &Scene, ray: &Ray, best: Crossing, next: Crossing) -> bool {
        if !self.is_plain(self.member_of(next.primitive).0) {
            return next.distance < best.distance - rounding(ray, best.distance);
        }
        if (next.distance - best.distance).abs() > self.tolerance {
            return next.distance < best.distance;
        }
        self.standing(scene, ray, next) > self.standing(scene, ray, best)
    }

    /// Which surface a ray meets first of those no more than the tolerance from `distance` on it.
    #[cold]
    pub(crate) fn chosen_near(
        &self,
        scene: &ValidScene,
        ray: &Ray,
        from: Option<PrimitiveId>,
        distance: f64,
    ) -> Option<PrimitiveId> {
        let nearest = (distance - self.tolerance).max(self.nearest);
        let limits = Limits { nearest, farthest: distance + self.tolerance };
        let frame = RayFrame::new(ray);
        let mut hits = Vec::new();
        self.hierarchy.visit(ray, limits.farthest, |index| {
            hits.extend(self.crossing(scene, MemberId(index), ray, &frame, from, &limits));
            limits.farthest
        });
        self.choose(scene, ray, hits, limits.farthest).map(|crossing| crossing.primitive)
    }

    /// Hits no farther apart than this are equally near, scene units.
    pub(crate) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Whether a surface without others in it is opaque to the rule.
    pub(crate) fn counts_as_opaque(&self, scene: &Scene, surface: SurfaceHandle) -> bool {
        substance(scene, scene.surfaces[surface].modifier) == Substance::Opaque
    }

    /// Whether a ray that starts on the surface `from` crosses right there another one that lies on it: Radiance never meets that.
    #[inline]
    pub(super) fn lies_on_start(&self, scene: &Scene, ray: &Ray, from: Option<PrimitiveId>, met: &Crossing) -> bool {
        met.distance <= self.tolerance && self.lies_along(scene, ray, from, met)
    }

    #[cold]
    fn lies_along(&self, scene: &Scene, ray: &Ray, from: Option<PrimitiveId>, met: &Crossing) -> bool {
        let Some(from) = from.filter(|from| *from != met.primitive && from.0 < self.primitive_count()) else {
            return false;
        };
        let [start, here] = [(from, ray.origin), (met.primitive, ray.at(met.distance))]
            .map(|(primitive, point)| self.front(scene, primitive, point));
        start.dot(here).abs() > ALONG
    }

    fn standing(&self, scene: &Scene, ray: &Ray, crossing: Crossing) -> Standing {
        let front = self.front(scene, crossing.primitive, ray.at(crossing.distance));
        let (substance, modifier) = self.substance(scene, crossing.primitive, 0);
        Standing { substance, faces_the_ray: ray.direction.dot(front) < 0.0, modifier }
    }

    /// The material of a primitive, and how late its modifier is defined, `depth` scenes within another.
    fn substance(&self, scene: &Scene, primitive: PrimitiveId, depth: u32) -> (Substance, (u32, usize)) {
        let (member, inner) = self.member_of(primitive);
        let surface = &scene.surfaces[self.surface_of(member)];
        let of = |modifier: Option<ModifierHandle>, depth| {
            (substance(scene, modifier), modifier.map_or((0, 0), |handle| (depth, handle.index() + 1)))
        };
        match surface.shape {
            Shape::Mesh(placed) if surface.modifier.is_none() => {
                let mesh = scene.mesh_instances[placed].mesh;
                of(self.meshes[mesh.index()].triangle(&scene.meshes[mesh], inner).modifier, depth + 1)
            }
            Shape::Instance(placed) if surface.modifier.is_none() => {
                let octree = scene.instances[placed].octree;
                let geometry = &self.octrees[octree.index()];
                geometry.substance(&scene.octrees[octree].scene, inner, depth + 1)
            }
            _ => of(surface.modifier, depth),
        }
    }

    /// The unit normal of a primitive on its front side.
    fn front(&self, scene: &Scene, primitive: PrimitiveId, point: DVec3) -> DVec3 {
        let (member, inner) = self.member_of(primitive);
        match self.shapes[member.0 as usize] {
            Shape::Mesh(handle) => {
                let placed = &scene.mesh_instances[handle];
                let mesh = &scene.meshes[placed.mesh];
                let triangle = self.meshes[placed.mesh.index()].triangle(mesh, inner);
                placed.to_scene.direction(mesh::front(mesh, triangle))
            }
            Shape::Instance(handle) => {
                let placed = &scene.instances[handle];
                let geometry = &self.octrees[placed.octree.index()];
                let point = placed.to_scene.inverse().point(point);
                placed.to_scene.direction(geometry.front(&scene.octrees[placed.octree].scene, inner, point))
            }
            shape => surface_point(scene, shape, point).1,
        }
    }
}

/// What the material at the end of a chain of modifiers is to the rule.
fn substance(scene: &Scene, first: Option<ModifierHandle>) -> Substance {
    let mut last = None;
    for (_, modifier) in scene.chain(first) {
        if let ModifierKind::Material(material) = &modifier.kind {
            return if is_transparent(material) { Substance::Transparent } else { Substance::Opaque };
        }
        last = Some(&modifier.kind);
    }
    // A mixture counts for a material, whatever it mixes.
    if matches!(last, Some(ModifierKind::Mixture(_))) { Substance::Opaque } else { Substance::Nothing }
}

/// What Radiance calls transparent (`istransp` in `rt/otspecial.h`).
fn is_transparent(material: &Material) -> bool {
    match material {
        Material::Trans(_)
        | Material::AnisotropicTrans(_)
        | Material::Dielectric(_)
        | Material::Interface(_)
        | Material::Mist(_)
        | Material::Glass { .. }
        | Material::Bsdf { form: BsdfForm::Aperture, .. } => true,
        // By the words alone: the colours that these let straight through.
        Material::BrtdFunction(function) => function.call.words.iter().skip(3).take(3).any(|word| word != "0"),
        Material::WardFunction(function) => function.call.words.get(5).is_some_and(|word| word != "0"),
        _ => false,
    }
}
