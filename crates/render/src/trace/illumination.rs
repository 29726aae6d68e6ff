//! Light at a point of a surface, and the rays that look for more of it.

use super::segment::Segment;
use super::split::Branches;
use super::{Tracer, product};
use crate::direct::DirectSampler;
use crate::indirect::Indirect;
use crate::link::{Link, Lobe};
use crate::ray::{PrimitiveId, Ray};
use crate::surface_light::{Drawn, LitPoint, sum};
use crate::tree::Course;
use glam::DVec3;
use radsight_brdf::Density;
use radsight_sampling::DimensionSet;

/// A retroreflector that is seen by way of a mirror is lit by way of it too, and no light sampling finds that: its highlight is drawn
/// from this often, down to this depth.
const SPLIT_DRAWS: u32 = 8;
const LAST_SPLIT_DEPTH: u32 = 2;

/// No highlight is looked into by more rays (`-ss`): they have to wait for each other.
const MOST_HIGHLIGHT_SAMPLES: f64 = 16.0;

impl<const BANDS: usize> Tracer<'_, BANDS> {
    /// Direct light, and the rays that look for the rest.
    pub(crate) fn light_and_scatter(
        &mut self,
        segment: &Segment<BANDS>,
        at: DVec3,
        primitive: Option<PrimitiveId>,
        point: &LitPoint<'_, BANDS>,
        travelled: f64,
    ) {
        let receiver = primitive.and_then(|primitive| self.plan.receiver(primitive));
        let lights_suffice = receiver.is_some_and(|receiver| receiver.sees_only_lights && receiver.lights_suffice);
        let follow_highlight = point.has_highlight() && !lights_suffice;
        let alone = receiver.is_some_and(|receiver| receiver.sees_only_lights);
        let bounces = if segment.follows_no_diffuse { 0 } else { segment.ambient_bounces };
        let indirect = Indirect::after(bounces);
        let wants_indirect = point.has_diffuse() && indirect == Indirect::Followed && !alone;
        let gathered = if wants_indirect { self.gathered(segment, at, primitive, point, travelled) } else { None };
        if self.survey.is_some() {
            return;
        }
        let follow_diffuse = wants_indirect && gathered.is_none();
        let asked = Branches {
            diffuse: u32::from(follow_diffuse),
            highlight: if follow_highlight { self.highlight_draws(segment, point) } else { 0 },
        };
        let branches = if self.splits { self.branches(segment, point, asked) } else { asked };
        let set = self.next_set;
        // A ray that does not split takes its points as those of pictures do.
        let is_split = branches != asked;
        self.next_set += if is_split { Branches::SETS } else { branches.highlight.max(1) };
        let mut reception = point.reception(self.plan.light_draws[usize::from(segment.is_scattered())]);
        reception.places = self.places(segment, branches);
        // Light from mist comes to shadow rays less dimmed than to others: then the two cannot share the work.
        let shared = !self.plan.lights_are_covered;
        let mut outlook = if follow_diffuse { point.outlook(self.plan, at) } else { None };
        let outward = branches.outward();
        if let (Some(outlook), 2..) = (&mut outlook, branches.diffuse) {
            outlook.chance = f64::from(outward) / f64::from(branches.diffuse);
        }
        let direct = DirectSampler {
            point: at,
            primitive,
            highlight_draws: if shared { branches.shared_highlight(is_split) } else { 0 },
            shares_diffuse: shared && follow_diffuse && point.diffuse_finds_lights(),
            outlook: outlook.as_ref(),
            reception,
            travelled,
            medium: segment.medium,
            cuts: [segment.cut, segment.cut_beyond],
            normal: point.normal,
            drawn: segment.link.is_some(),
            facing: point.facing(),
        };
        if let Some(tree) = &mut self.tree {
            tree.light(segment.throughput, segment.node);
        }
        let mut light = direct.sample(self, point);
        if let Some(contributions) = &mut self.contributions {
            contributions.settle(segment.throughput);
        }
        if indirect == Indirect::Constant {
            self.add_constant(&mut light, &point.ambient_reflectance());
        }
        if let Some(gathered) = gathered {
            light = sum(light, gathered);
        }
        self.add(segment, product(segment.throughput, light));
        if branches.highlight > 1 && is_split {
            self.split_highlight(segment, &direct, point, (set, branches.highlight));
        } else {
            self.draw_highlight(segment, &direct, point, (set, branches.highlight));
        }
        match branches.diffuse {
            0 => {}
            1 => self.draw_diffuse(segment, &direct, point, set + u32::from(is_split)),
            rays => self.split_diffuse(segment, &direct, point, (set + 1, rays)),
        }
    }

    /// Sends rays into the highlight, which wait for each other.
    fn draw_highlight(
        &mut self,
        segment: &Segment<BANDS>,
        direct: &DirectSampler<'_>,
        point: &LitPoint<'_, BANDS>,
        (set, draws): (u32, u32),
    ) {
        for draw in 0..draws {
            let u = self.sampler.take(DimensionSet::render(set + draw));
            if let Some(drawn) = point.draw_highlight([u[0], u[1], u[2]]) {
                let share = f64::from(draws);
                self.scatter(segment, direct, (drawn.split(share), Lobe::Highlight), segment.ambient_bounces);
            }
        }
    }

    /// Sends rays into the highlight and follows one after the other.
    fn split_highlight(
        &mut self,
        segment: &Segment<BANDS>,
        direct: &DirectSampler<'_>,
        point: &LitPoint<'_, BANDS>,
        (set, rays): (u32, u32),
    ) {
        let share = f64::from(rays);
        let part = Segment { split: segment.split * share, ..*segment };
        let next_set = self.next_set;
        let trunk = self.split(set);
        for branch in 0..rays {
            let u = self.begin_branch(&trunk, branch, rays);
            if let Some(drawn) = point.draw_highlight([u[0], u[1], u[2]]) {
                self.scatter(&part, direct, (drawn.branch(share), Lobe::Highlight), segment.ambient_bounces);
                self.end_branch(&trunk);
            }
        }
        self.end_split(&trunk, next_set);
    }

    /// Sends one ray on from the diffuse component.
    fn draw_diffuse(
        &mut self,
        segment: &Segment<BANDS>,
        direct: &DirectSampler<'_>,
        point: &LitPoint<'_, BANDS>,
        set: u32,
    ) {
        let u = self.sampler.take(DimensionSet::render(set));
        if let Some(drawn) = diffuse_ray(direct, point, u) {
            self.scatter(segment, direct, (drawn, Lobe::Diffuse), segment.ambient_bounces - 1);
        }
    }

    /// Sends rays on from the diffuse component and follows one after the other: first those
    /// towards openings, then the others, each group spread evenly by itself.
    fn split_diffuse(
        &mut self,
        segment: &Segment<BANDS>,
        direct: &DirectSampler<'_>,
        point: &LitPoint<'_, BANDS>,
        (set, rays): (u32, u32),
    ) {
        let share = f64::from(rays);
        let part = Segment { split: segment.split * share, ..*segment };
        let next_set = self.next_set;
        let (outward, chance) =
            direct.outlook.map_or((0, 0.0), |outlook| ((outlook.chance * share).round() as u32, outlook.chance));
        for (set, group, choices) in [(set, outward, [0.0, chance]), (set + 1, rays - outward, [chance, 1.0])] {
            let trunk = self.split(set);
            for branch in 0..group {
                let [u, v, choice, _] = self.begin_branch(&trunk, branch, group);
                let choice = choices[0] + choice * (choices[1] - choices[0]);
                if let Some(drawn) = diffuse_ray(direct, point, [choice, 0.0, u, v]) {
                    self.scatter(&part, direct, (drawn.branch(share), Lobe::Diffuse), segment.ambient_bounces - 1);
                    self.end_branch(&trunk);
                }
            }
            self.end_split(&trunk, next_set);
        }
    }

    /// How many rays look into the highlight of a point where rays do not split.
    fn highlight_draws(&self, segment: &Segment<BANDS>, point: &LitPoint<'_, BANDS>) -> u32 {
        if point.is_retroreflector() && (1..=LAST_SPLIT_DEPTH).contains(&segment.depth) {
            SPLIT_DRAWS
        } else {
            self.highlight_samples(segment)
        }
    }

    /// How many rays look into a highlight: as many as are asked for, times what the path carries.
    fn highlight_samples(&self, segment: &Segment<BANDS>) -> u32 {
        let strongest = segment.throughput.iter().copied().fold(0.0, f64::max).min(1.0);
        (self.plan.options.highlight_samples * strongest + 0.5).clamp(1.0, MOST_HIGHLIGHT_SAMPLES) as u32
    }

    /// Sends a drawn ray on from a lit point.
    fn scatter(
        &mut self,
        segment: &Segment<BANDS>,
        from: &DirectSampler<'_>,
        (drawn, lobe): (Drawn<BANDS>, Lobe),
        ambient_bounces: u32,
    ) {
        let throughput = product(segment.throughput, drawn.weight);
        let reflections = segment.reflections + 1;
        let share = (throughput, drawn.favour);
        let Some(throughput) = self.go_on(share, segment, reflections, Some(lobe)) else { return };
        let mut link = match drawn.density {
            Density::Continuous(density) => {
                let at = (from.point, drawn.direction);
                let mut link = Link::new(density, at, from.reception, from.primitive, lobe);
                link.favour = drawn.favour;
                Some(link)
            }
            Density::Delta => segment.link,
        };
        match (&mut link, drawn.density) {
            (Some(link), Density::Continuous(_)) if self.plan.lights_are_covered => link.covered(),
            (Some(link), Density::Delta) => link.lost(),
            _ => {}
        }
        let next = Segment {
            ray: Ray { origin: from.point, direction: drawn.direction.normalize() },
            from: from.primitive,
            throughput,
            split: segment.split,
            travelled: from.travelled,
            link,
            depth: segment.depth + 1,
            reflections,
            ambient_bounces,
            medium: segment.medium,
            cut: from.cut_towards(drawn.direction),
            cut_beyond: from.cut_towards(drawn.direction),
            follows_no_diffuse: false,
            direct_view: false,
            node: segment.node,
        };
        self.push_on(next, Course::Drawn);
    }
}

/// A ray from the diffuse component, or towards an opening that it sees.
fn diffuse_ray<const BANDS: usize>(
    direct: &DirectSampler<'_>,
    point: &LitPoint<'_, BANDS>,
    u: [f64; 4],
) -> Option<Drawn<BANDS>> {
    match direct.outlook {
        Some(outlook) => point.draw_outward(outlook, u),
        None => point.draw_diffuse(u[2], u[3]),
    }
}
