//! Where light from outside comes in: panes with sky behind them, and glows that are not sampled as lights.
//!
//! Hemisphere samples of a point in a room find its windows by chance only. Half of those that are drawn one by one, and some more of those
//! that are taken together, are sent towards portals instead; all are weighted with the balance heuristic (Veach and Guibas, SIGGRAPH
//! 1995), so that nothing is counted twice and an opening that turns out to be dark costs little.
//!
//! What an opening promises is looked up before the first ray. Guarantees: densities are those of the draws, with regard to openings
//! that are seen behind each other.

use glam::DVec3;
use radsight_light::LightForm;

/// The openings of a scene.
#[derive(Debug, Default)]
pub struct Portals(pub Vec<Portal>);

/// Where light comes from.
#[derive(Clone, Debug)]
pub enum PortalForm {
    /// One side of a flat surface, turned to where the light goes.
    Flat(LightForm),
    /// All that is in a box along the axes, least and most: what shines in there may be of any form.
    Box([DVec3; 2]),
}

impl PortalForm {
    /// A point of it, from a point of the unit cube.
    pub fn point(&self, [u, v, w]: [f64; 3]) -> Option<DVec3> {
        match self {
            PortalForm::Flat(form) => form.point([u, v]).map(|(_, point)| point),
            PortalForm::Box([least, most]) => Some(*least + (*most - *least) * DVec3::new(u, v, w)),
        }
    }

    /// The density of the unit direction in which [`PortalForm::point`] is seen from a point, 1/sr, times a weight.
    pub fn weighted_pdf(&self, weight: f64, from: DVec3, direction: DVec3) -> f64 {
        match self {
            PortalForm::Flat(form) => {
                let met = form.met(from, direction);
                met.map_or(0.0, |(distance, cosine)| weight * distance * distance / (form.area() * cosine))
            }
            PortalForm::Box([least, most]) => {
                let inverse = direction.recip();
                let [one, two] = [(*least - from) * inverse, (*most - from) * inverse];
                let [enters, leaves] = [one.min(two).max_element().max(0.0), one.max(two).min_element()];
                // All points along the ray, each with its squared distance.
                let volume = (*most - *least).element_product();
                if leaves > enters { weight * (leaves.powi(3) - enters.powi(3)) / (3.0 * volume) } else { 0.0 }
            }
        }
    }
}

/// One side of a flat surface through which light comes, or another place from which much light comes.
#[derive(Clone, Debug)]
pub struct Portal {
    /// What shines.
    pub form: PortalForm,
    /// Unit normal on that side, and a point of the plane, scene units; of a box nothing.
    pub plane: Option<(DVec3, DVec3)>,
    /// Square scene units; of a box what it shows in the mean over all directions.
    pub area: f64,
    /// Sphere around it.
    pub center: DVec3,
    /// Of that sphere.
    pub radius: f64,
    /// Radiance that comes through, about.
    pub radiance: f64,
}

/// The openings as they are seen from a point.
#[derive(Debug)]
pub struct VisiblePortals<'p> {
    portals: &'p [Portal],
    point: DVec3,
    /// Those that promise something, and what.
    importances: [(u32, f64); MOST_OPENINGS],
    len: usize,
    total: f64,
    /// The share of rays that are sent towards openings.
    pub chance: f64,
}

/// No more openings are known: the brightest ones.
pub const MOST_OPENINGS: usize = 48;

impl Portals {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What a point of a surface sees of them on the side of its unit normal; `None` where it is nothing.
    pub fn seen_from(&self, point: DVec3, normal: DVec3) -> Option<VisiblePortals<'_>> {
        if self.0.is_empty() {
            return None;
        }
        self.weighted(point, VisiblePortals::OF_SINGLE_RAYS, |_, portal| portal.importance(point, normal))
    }

    /// The same where it was learned how much more or less each opening brings than it promises, and with which share of single
    /// rays openings are worth looking at.
    ///
    /// # Panics
    /// If there is not one factor an opening, or there are more openings than [`MOST_OPENINGS`].
    pub fn seen_by(&self, point: DVec3, normal: DVec3, factors: &[f64], chance: f64) -> Option<VisiblePortals<'_>> {
        assert!(factors.len() == self.0.len() && factors.len() <= MOST_OPENINGS, "{} factors", factors.len());
        self.weighted(point, chance, |index, portal| factors[index] * portal.importance(point, normal))
    }

    fn weighted(
        &self,
        point: DVec3,
        chance: f64,
        importance: impl Fn(usize, &Portal) -> f64,
    ) -> Option<VisiblePortals<'_>> {
        let importances = [(0, 0.0); MOST_OPENINGS];
        let mut visible_portals = VisiblePortals { portals: &self.0, point, importances, len: 0, total: 0.0, chance };
        for (index, portal) in self.0.iter().enumerate() {
            let importance = importance(index, portal);
            if importance > 0.0 {
                visible_portals.importances[visible_portals.len] = (index as u32, importance);
                visible_portals.len += 1;
                visible_portals.total += importance;
            }
        }
        (visible_portals.total > 0.0).then_some(visible_portals)
    }
}

impl Portal {
    /// One side of a flat form, of which nothing is known yet.
    pub fn new(form: LightForm) -> Option<Portal> {
        let plane = Some(form.plane()?);
        let (center, radius) = form.bounding_sphere();
        Some(Portal { area: form.area(), form: PortalForm::Flat(form), plane, center, radius, radiance: 0.0 })
    }

    /// What is in a box with this mean radiance; `None` for a box without volume.
    pub fn within([least, most]: [DVec3; 2], radiance: f64) -> Option<Portal> {
        let size = most - least;
        let area = 0.5 * size.dot(DVec3::new(size.y, size.z, size.x));
        let is_box = size.min_element() > 0.0 && size.is_finite();
        is_box.then(|| Portal {
            form: PortalForm::Box([least, most]),
            plane: None,
            area,
            center: 0.5 * (least + most),
            radius: 0.5 * size.length(),
            radiance,
        })
    }

    /// Radiance times area.
    pub fn power(&self) -> f64 {
        self.radiance * self.area
    }

    /// About what it gives to a point with this unit normal.
    fn importance(&self, point: DVec3, normal: DVec3) -> f64 {
        let offset = self.center - point;
        let squared = offset.length_squared().max(self.radius * self.radius);
        let above = normal.dot(offset) + self.radius;
        let height = self.plane.map(|(normal, place)| normal.dot(point - place));
        if height.is_some_and(|height| height <= 0.0) || above <= 0.0 {
            return 0.0;
        }
        let distance = squared.sqrt();
        let shown = height.map_or(1.0, |height| (height / distance).min(1.0));
        let cosine = (above / (distance + self.radius)).min(1.0);
        self.power() * shown * cosine / squared
    }
}

impl VisiblePortals<'_> {
    /// The share of rays that are drawn one by one.
    const OF_SINGLE_RAYS: f64 = 0.5;

    /// The density of a single ray that is drawn by the cosine, with `diffuse_pdf`, or towards an opening, 1/sr.
    pub fn mixed_pdf(&self, direction: DVec3, diffuse_pdf: f64) -> f64 {
        self.chance * self.pdf(direction) + (1.0 - self.chance) * diffuse_pdf
    }

    /// Draws a unit direction towards an opening.
    pub fn draw(&self, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        let mut left = choice * self.total;
        let mut chosen = None;
        for (index, importance) in &self.importances[..self.len] {
            chosen = Some((*index, *importance));
            if left < *importance {
                break;
            }
            left -= importance;
        }
        let (index, importance) = chosen?;
        // What is left of the choice is evenly spread again.
        let depth = (left / importance).clamp(0.0, 1.0);
        let place = self.portals[index as usize].form.point([u, v, depth])?;
        (place - self.point).try_normalize()
    }

    /// The nearest opening in a unit direction: how far away it is, and its unit normal on the side of the point.
    pub fn crossed(&self, direction: DVec3) -> Option<(f64, DVec3)> {
        let met = |(index, _): &(u32, f64)| {
            let portal = &self.portals[*index as usize];
            let (PortalForm::Flat(form), Some((normal, _))) = (&portal.form, portal.plane) else { return None };
            form.met(self.point, direction).map(|(distance, _)| (distance, normal))
        };
        let nearer = |one: &(f64, DVec3), two: &(f64, DVec3)| one.0.total_cmp(&two.0);
        self.importances[..self.len].iter().filter_map(met).min_by(nearer)
    }

    /// The density with which [`VisiblePortals::draw`] finds a unit direction, 1/sr.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.importances[..self.len].iter().map(|seen| self.pdf_of(seen, direction)).sum::<f64>() / self.total
    }

    /// The index of each opening that is seen, how often it is chosen, and its part of [`VisiblePortals::pdf`].
    pub fn parts(&self, direction: DVec3) -> impl Iterator<Item = (usize, f64, f64)> + Clone {
        self.importances[..self.len]
            .iter()
            .map(move |seen| (seen.0 as usize, seen.1 / self.total, self.pdf_of(seen, direction) / self.total))
    }

    fn pdf_of(&self, (index, importance): &(u32, f64), direction: DVec3) -> f64 {
        self.portals[*index as usize].form.weighted_pdf(*importance, self.point, direction)
    }
}

/// The other side of a flat form.
pub(crate) fn turned(form: &LightForm) -> LightForm {
    let mut form = form.clone();
    match &mut form {
        LightForm::Disk { normal, .. }
        | LightForm::Parallelogram { normal, .. }
        | LightForm::Triangles { normal, .. } => *normal = -*normal,
        _ => {}
    }
    form
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::{DimensionSet, RaySampler};

    fn portals() -> Portals {
        let corner = DVec3::new(-1.0, 0.5, 0.2);
        let (x, y) = (DVec3::new(0.8, 0.1, 0.0), DVec3::new(0.0, 0.2, 0.9));
        let across = x.cross(y);
        let pane = LightForm::Parallelogram { corner, x, y, normal: -across.normalize(), area: across.length() };
        let behind = LightForm::Parallelogram {
            corner: corner + DVec3::Y * 0.3,
            x,
            y,
            normal: -across.normalize(),
            area: across.length(),
        };
        let skylight = LightForm::Disk {
            center: DVec3::new(0.3, 0.0, 1.5),
            normal: -DVec3::Z,
            x: DVec3::X,
            y: DVec3::Y,
            inner_squared: 0.04,
            outer_squared: 0.5,
        };
        let gable = LightForm::Triangles {
            triangles: vec![
                [DVec3::new(1.0, -1.0, 0.1), DVec3::new(1.0, 1.0, 0.1), DVec3::new(1.0, 0.0, 1.0)],
                [DVec3::new(1.0, -1.0, 0.1), DVec3::new(1.0, 0.0, 1.0), DVec3::new(1.0, -1.0, 0.8)],
            ],
            cumulative: vec![0.9 / 1.25, 1.0],
            normal: -DVec3::X,
            area: 1.25,
        };
        let away = turned(&gable);
        let portal = |form| Portal { radiance: 2.0, ..Portal::new(form).expect("the form is flat") };
        Portals([pane, behind, skylight, gable, away].map(portal).to_vec())
    }

    /// A box before the point, and one around it.
    fn boxes() -> Portals {
        let place = |least: [f64; 3], most: [f64; 3]| Portal::within([least, most].map(DVec3::from_array), 1.5);
        let all = [place([0.4, -0.3, 0.2], [0.9, 0.5, 1.0]), place([-0.5, -0.6, -0.4], [0.6, 0.5, 0.7])];
        Portals(all.map(|portal| portal.expect("the box has a volume")).to_vec())
    }

    #[test]
    fn a_flat_box_is_none() {
        assert!(Portal::within([DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)], 1.0).is_none());
        assert!(Portal::within([DVec3::ZERO, DVec3::splat(f64::NAN)], 1.0).is_none());
    }

    #[test]
    fn openings_are_drawn_with_the_density_that_they_claim() {
        let cases = [(DVec3::ZERO, DVec3::Z), (DVec3::new(0.2, -0.4, 0.1), DVec3::new(0.6, 0.0, 0.8))];
        let both = [portals(), boxes()];
        for (portals, (point, normal)) in both.iter().flat_map(|portals| cases.map(|case| (portals, case))) {
            let factors: Vec<f64> = (1..=portals.len()).map(|index| index as f64).collect();
            let visible_portals = portals.seen_by(point, normal, &factors, 0.5).expect("something is seen");
            let mut sums = [0.0; 3];
            let (heights, turns) = (800, 1600);
            for cell in 0..heights * turns {
                let z = (2.0 * (f64::from(cell / turns) + 0.5) / f64::from(heights)) - 1.0;
                let turn = std::f64::consts::TAU * (f64::from(cell % turns) + 0.5) / f64::from(turns);
                let rim = (1.0 - z * z).sqrt();
                let direction = DVec3::new(rim * turn.cos(), rim * turn.sin(), z);
                let share = visible_portals.pdf(direction) * 4.0 * std::f64::consts::PI / f64::from(heights * turns);
                for (sum, moment) in sums.iter_mut().zip([1.0, direction.x, direction.z * direction.y]) {
                    *sum += share * moment;
                }
            }
            let draws = 1 << 14;
            let mut means = [0.0; 3];
            for draw in 0..draws {
                let [choice, u, v, _] = RaySampler::new(1, draw).take(DimensionSet::CAMERA);
                let direction = visible_portals.draw([choice, u, v]).expect("every draw finds a place");
                assert!(visible_portals.pdf(direction) > 0.0);
                for (mean, moment) in means.iter_mut().zip([1.0, direction.x, direction.z * direction.y]) {
                    *mean += moment / draws as f64;
                }
            }
            for (sum, mean) in sums.iter().zip(means) {
                assert!((sum - mean).abs() < 3e-3, "{sums:?} is not {means:?}");
            }
        }
    }
}
