//! Records the current ray and its shadow rays.

use super::{Below, BounceType, Node, RayValue, Sum, Target, TreeRay};
use crate::direct::DirectSampler;
use crate::trace::PathIntegrator;
use radsight_accel::{Intersection, Ray};
use radsight_compile::FirstHit;
use radsight_ir::SurfaceHandle;
use radsight_light::{Light, LightSample};
use radsight_texture::{luminance, product};

impl<const BANDS: usize> PathIntegrator<'_, BANDS> {
    /// Begins a shadow ray with the unoccluded value `radiance`, which counts with `weight`.
    pub(crate) fn begin_shadow(
        &mut self,
        from: &DirectSampler<'_>,
        (light, sample): (&Light, &LightSample),
        weight: [f64; BANDS],
        radiance: [f64; BANDS],
    ) {
        let Some(tree) = &mut self.tree else { return };
        let (share, above) = tree.lit;
        let ray = Ray { origin: from.point, direction: sample.direction };
        tree.shadow = tree.begin(above, BounceType::Shadow, ray, product(share, weight));
        let target = Target {
            light: light.surface,
            virtual_form: !light.virtual_sources.is_empty(),
            importance: luminance(&product(weight, radiance)),
        };
        if let Some(node) = tree.nodes.last_mut() {
            node.target = Some(target);
        }
    }

    /// The shadow ray hits a surface with the remaining transmittance `left`.
    pub(crate) fn note_shadow_hit(&mut self, hit: &Intersection, left: [f64; BANDS]) {
        let Some(tree) = &mut self.tree else { return };
        let id = tree.shadow;
        tree.end(id, FirstHit::at(hit, hit.distance));
        tree.dim(id, left, [0.0; BANDS]);
    }

    /// The surface has the same material on both sides: its normal is reported on that of the ray.
    pub(crate) fn note_shadow_side(&mut self, hit: &Intersection) {
        let Some(tree) = &mut self.tree else { return };
        let id = tree.shadow;
        if tree.node(id).is_some_and(|node| node.ray.direction.dot(hit.front) > 0.0) {
            tree.note_normal(id, -hit.front);
        }
    }

    /// The shadow ray continues from there, attenuated.
    pub(crate) fn note_shadow_bounce(&mut self, ray: Ray, bounce: BounceType, weight: [f64; BANDS]) {
        let Some(tree) = &mut self.tree else { return };
        let above = tree.shadow;
        if let Some(arrival) = tree.node(above).map(|node| node.arrival) {
            tree.shadow = tree.begin(above, bounce, ray, product(arrival, weight));
        }
    }

    /// The shadow ray reaches its light.
    pub(crate) fn note_shadow_found(&mut self, distant: Option<SurfaceHandle>, radiance: [f64; BANDS]) {
        let Some(tree) = &mut self.tree else { return };
        let id = tree.shadow;
        if let Some(node) = tree.node(id) {
            if let Some(surface) = distant {
                node.hit = Some(FirstHit::distant(surface, node.ray.direction));
            }
            node.own = product(node.arrival, radiance);
        }
    }

    /// The rays of the last tree, children before their parents; the last one is the first ray.
    pub(crate) fn take_tree(&mut self) -> Vec<TreeRay> {
        let Some(tree) = &self.tree else { return Vec::new() };
        let below = Below::new(&tree.nodes);
        let sums = Sum::all(&tree.nodes, &below);
        let mut output = Vec::with_capacity(tree.nodes.len());
        // A ray is output after all its children.
        let mut open: Vec<(usize, usize)> = if tree.nodes.is_empty() { Vec::new() } else { vec![(0, 0)] };
        while let Some((id, next)) = open.last_mut() {
            if let Some(child) = below.of(*id).get(*next) {
                *next += 1;
                open.push((*child, 0));
                continue;
            }
            let (id, depth) = (*id, open.len() - 1);
            open.pop();
            let node = &tree.nodes[id];
            if node.is_output(tree.output) {
                output.push(self.output_ray(node, &sums[id], depth));
            }
        }
        output
    }

    fn output_ray(&self, node: &Node<BANDS>, sum: &Sum<BANDS>, depth: usize) -> TreeRay {
        let unmirrored = std::array::from_fn(|band| sum.value[band] - sum.mirrored[band]);
        TreeRay {
            depth,
            ray: node.ray,
            hit: node.hit,
            value: self.ray_value(&sum.value),
            coefficient: self.ray_value(&if sum.is_missed { [0.0; BANDS] } else { node.arrival }),
            weight: sum.weight,
            mirrored: self.ray_value(&sum.mirrored),
            unmirrored: self.ray_value(&unmirrored),
            mirrored_distance: sum.mirrored_distance,
            unmirrored_distance: sum.unmirrored_distance,
            effective_distance: sum.distance(),
        }
    }

    fn ray_value(&self, bands: &[f64; BANDS]) -> RayValue {
        RayValue { color: self.rgb(bands), spectrum: self.spectrum(bands) }
    }
}
