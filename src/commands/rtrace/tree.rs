//! The output of ray trees (`-ot`, `-oT`).

use super::options::{Field, Options};
use super::record::{Found, Writer};
use crate::ray_input::InputRay;
use radsight_render::{FirstHit, RayTreeOutput, RenderPlan, Renderer, TreeRay};
use rayon::prelude::*;

/// The selection of rays and fields.
#[derive(Clone, Debug)]
pub(super) struct TreeOutput {
    pub(super) rays: RayTreeOutput,
    pub(super) fields: Vec<Field>,
}

/// The modifiers of surfaces at which written rays end (`-ti`, `-te`).
#[derive(Clone, Debug, Default)]
pub(super) enum Ends {
    #[default]
    Anywhere,
    /// Surfaces with these modifiers.
    Only(Vec<String>),
    /// All other surfaces.
    Except(Vec<String>),
}

impl Ends {
    /// Adds names; as in Radiance, the first names of the other kind start a new list.
    pub(super) fn name(&mut self, option: &str, names: Vec<String>) {
        let only = option.starts_with("-ti") || option.starts_with("-tI");
        match self {
            Ends::Only(listed) if only => listed.extend(names),
            Ends::Except(listed) if !only => listed.extend(names),
            other if only => *other = Ends::Only(names),
            other => *other = Ends::Except(names),
        }
    }

    fn include(&self, plan: &RenderPlan, hit: Option<&FirstHit>) -> bool {
        let listed = |names: &[String]| hit.is_some_and(|hit| names.iter().any(|name| name == plan.names_at(hit)[1]));
        match self {
            Ends::Anywhere => true,
            Ends::Only(names) => listed(names),
            Ends::Except(names) => !listed(names),
        }
    }
}

/// The trees and records of some rays.
pub(super) fn answers(options: &Options, renderer: &Renderer, first_index: u64, rays: &[InputRay]) -> Vec<Vec<u8>> {
    let writer = Writer::new(options, renderer.plan());
    let answered = rays.par_iter().enumerate().map_init(
        || renderer.worker(),
        |worker, (place, input)| {
            let mut bytes = Vec::new();
            let Some(ray) = &input.ray else {
                writer.write(input, None, None, &mut bytes);
                return bytes;
            };
            if options.limits_distance {
                worker.limit_distance(input.length);
            }
            let (traced, tree_rays) = worker.tree(first_index + place as u64, ray);
            if let Some(tree) = &options.tree {
                write_tree(options, renderer.plan(), tree, (&writer, &tree_rays), &mut bytes);
            }
            let found = Found::Traced(traced);
            let found = if options.limits_rays() { found.clipped(input.length) } else { found };
            writer.write(input, Some(&found), tree_rays.last(), &mut bytes);
            bytes
        },
    );
    answered.collect()
}

fn write_tree(
    options: &Options,
    plan: &RenderPlan,
    tree: &TreeOutput,
    (writer, tree_rays): (&Writer<'_>, &[TreeRay]),
    out: &mut Vec<u8>,
) {
    for ray in tree_rays.iter().filter(|ray| options.tree_ends.include(plan, ray.hit.as_ref())) {
        out.extend(std::iter::repeat_n(b'\t', ray.depth));
        writer.write_node(ray, &tree.fields, out);
    }
}
