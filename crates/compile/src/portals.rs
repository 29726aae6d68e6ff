//! Portals: panes with sky behind them, and glows that are not sampled as lights.
//!
//! Hemisphere samples at a point in a room find its windows by chance only. Half of the rays that
//! are traced one by one, and some of those of a final gather, are sent towards portals instead.
//! All are weighted with the balance heuristic (Veach and Guibas, SIGGRAPH 1995), so that nothing
//! counts twice and a portal that turns out to be dark costs little.
//!
//! Each portal's radiance is estimated before the first ray. Guarantees: `pdf` is the density of
//! `sample`, even where portals overlap as seen from a point.

use glam::DVec3;
use radsight_light::LightForm;

/// The portals of a scene.
#[derive(Debug, Default)]
pub struct Portals(pub Vec<Portal>);

/// Where light comes from: a flat surface, or a region that contains bright surfaces.
#[derive(Clone, Debug)]
pub enum PortalForm {
    /// One side of a flat surface, oriented to where the light goes.
    Flat(LightForm),
    /// An axis-aligned box (minimum, maximum) around bright surfaces of any form.
    Box([DVec3; 2]),
}

impl PortalForm {
    /// Samples a point of it from a point of the unit cube.
    pub fn point(&self, [u, v, w]: [f64; 3]) -> Option<DVec3> {
        match self {
            PortalForm::Flat(form) => form.point([u, v]).map(|(_, point)| point),
            PortalForm::Box([least, most]) => Some(*least + (*most - *least) * DVec3::new(u, v, w)),
        }
    }

    /// Pdf of the unit direction from a point to [`PortalForm::point`], 1/sr, times a weight.
    pub fn weighted_pdf(&self, weight: f64, from: DVec3, direction: DVec3) -> f64 {
        match self {
            PortalForm::Flat(form) => {
                let hit = form.intersect(from, direction);
                hit.map_or(0.0, |(distance, cosine)| weight * distance * distance / (form.area() * cosine))
            }
            PortalForm::Box([least, most]) => {
                let inverse = direction.recip();
                let [one, two] = [(*least - from) * inverse, (*most - from) * inverse];
                let [enters, leaves] = [one.min(two).max_element().max(0.0), one.max(two).min_element()];
                // The integral of the squared distance along the ray, over the volume.
                let volume = (*most - *least).element_product();
                if leaves > enters { weight * (leaves.powi(3) - enters.powi(3)) / (3.0 * volume) } else { 0.0 }
            }
        }
    }
}

/// One side of a flat surface through which light enters, or a region from which much light comes.
#[derive(Clone, Debug)]
pub struct Portal {
    /// Its shape.
    pub form: PortalForm,
    /// Unit normal on that side, and a point of the plane, scene units; `None` for a box.
    pub plane: Option<(DVec3, DVec3)>,
    /// Area, square scene units; of a box the mean projected area over all directions.
    pub area: f64,
    /// Centre of its bounding sphere.
    pub center: DVec3,
    /// Radius of the bounding sphere, scene units.
    pub radius: f64,
    /// Estimated radiance that enters, W/(sr·m²).
    pub radiance: f64,
}

/// The bounding spheres of portals are enlarged by this factor of their area, and by this fraction
/// of the squared distance.
const SPHERE_MARGIN: f64 = 1.001;
const ROUNDING: f64 = 1e-12;

/// The portals visible from a point.
#[derive(Debug)]
pub struct VisiblePortals<'p> {
    portals: &'p [Portal],
    point: DVec3,
    /// Index and importance of each.
    importances: [(u32, f64); MOST_PORTALS],
    len: usize,
    total: f64,
    /// Fraction of the rays that are sent towards portals.
    pub chance: f64,
}

/// Maximum number of portals: the brightest ones.
pub const MOST_PORTALS: usize = 48;

impl Portals {
    /// Number of portals.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are no portals.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Portals on the side of a point's unit normal, with their importance; `None` if there are
    /// none.
    pub fn seen_from(&self, point: DVec3, normal: DVec3) -> Option<VisiblePortals<'_>> {
        if self.0.is_empty() {
            return None;
        }
        self.weighted(point, VisiblePortals::SINGLE_RAY_FRACTION, |_, portal| portal.importance(point, normal))
    }

    /// The same with learned `factors` on the importance of each portal, and the fraction of single
    /// rays that sample portals.
    ///
    /// # Panics
    /// If there is not one factor per portal, or there are more portals than [`MOST_PORTALS`].
    pub fn seen_by(&self, point: DVec3, normal: DVec3, factors: &[f64], chance: f64) -> Option<VisiblePortals<'_>> {
        assert!(factors.len() == self.0.len() && factors.len() <= MOST_PORTALS, "{} factors", factors.len());
        self.weighted(point, chance, |index, portal| factors[index] * portal.importance(point, normal))
    }

    fn weighted(
        &self,
        point: DVec3,
        chance: f64,
        importance: impl Fn(usize, &Portal) -> f64,
    ) -> Option<VisiblePortals<'_>> {
        let importances = [(0, 0.0); MOST_PORTALS];
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
    /// One side of a flat shape, with unknown radiance.
    pub fn new(form: LightForm) -> Option<Portal> {
        let plane = Some(form.plane()?);
        let (center, radius) = form.bounding_sphere();
        Some(Portal { area: form.area(), form: PortalForm::Flat(form), plane, center, radius, radiance: 0.0 })
    }

    /// A box of this mean radiance; `None` for a box without volume.
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

    /// Whether a ray in a unit direction misses the bounding sphere. Cheaper than to intersect the
    /// shape, and true for most portals.
    #[inline]
    fn is_beside(&self, point: DVec3, direction: DVec3) -> bool {
        let offset = self.center - point;
        let (along, squared) = (offset.dot(direction), offset.length_squared());
        // Enough for the rounding of both.
        let reach = self.radius * self.radius * SPHERE_MARGIN + ROUNDING * squared;
        let nearest = if along > 0.0 { squared - along * along } else { squared };
        nearest > reach
    }

    /// Estimated irradiance at a point with this unit normal.
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
    /// Fraction of single rays that are sent towards portals.
    const SINGLE_RAY_FRACTION: f64 = 0.5;

    /// Density of a single ray that is sampled by the cosine, with `diffuse_pdf`, or towards a
    /// portal, 1/sr.
    pub fn mixed_pdf(&self, direction: DVec3, diffuse_pdf: f64) -> f64 {
        self.chance * self.pdf(direction) + (1.0 - self.chance) * diffuse_pdf
    }

    /// Samples a unit direction towards a portal.
    pub fn sample(&self, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
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
        // The remainder of the random number is uniform again.
        let depth = (left / importance).clamp(0.0, 1.0);
        let place = self.portals[index as usize].form.point([u, v, depth])?;
        (place - self.point).try_normalize()
    }

    /// Nearest portal along a unit direction: its distance, and its unit normal on the side of the
    /// point.
    pub fn crossed(&self, direction: DVec3) -> Option<(f64, DVec3)> {
        let hit = |(index, _): &(u32, f64)| {
            let portal = &self.portals[*index as usize];
            if portal.is_beside(self.point, direction) {
                return None;
            }
            let (PortalForm::Flat(form), Some((normal, _))) = (&portal.form, portal.plane) else { return None };
            form.intersect(self.point, direction).map(|(distance, _)| (distance, normal))
        };
        let nearer = |one: &(f64, DVec3), two: &(f64, DVec3)| one.0.total_cmp(&two.0);
        self.importances[..self.len].iter().filter_map(hit).min_by(nearer)
    }

    /// Density of [`VisiblePortals::sample`], 1/sr.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.importances[..self.len].iter().map(|seen| self.pdf_of(seen, direction)).sum::<f64>() / self.total
    }

    /// Index, selection probability and contribution to [`VisiblePortals::pdf`] of each visible
    /// portal.
    pub fn parts(&self, direction: DVec3) -> impl Iterator<Item = (usize, f64, f64)> + Clone {
        self.importances[..self.len]
            .iter()
            .map(move |seen| (seen.0 as usize, seen.1 / self.total, self.pdf_of(seen, direction) / self.total))
    }

    fn pdf_of(&self, (index, importance): &(u32, f64), direction: DVec3) -> f64 {
        let portal = &self.portals[*index as usize];
        if portal.is_beside(self.point, direction) {
            return 0.0;
        }
        portal.form.weighted_pdf(*importance, self.point, direction)
    }
}

/// The opposite side of a flat shape.
pub(crate) fn turned(form: &LightForm) -> LightForm {
    let mut form = form.clone();
    match &mut form {
        LightForm::Disk { normal, .. }
        | LightForm::Parallelogram { normal, .. }
        | LightForm::Polygon { normal, .. } => *normal = -*normal,
        _ => {}
    }
    form
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_sampling::{DimensionSet, RaySampler};

    #[test]
    fn rays_beside_a_portal_miss_it() {
        let portals = portals();
        let (mut beside, mut hits) = (0, 0);
        for index in 0..4000 {
            let sampler = RaySampler::new(0, index);
            let [a, b, c, d] = sampler.take(DimensionSet::render(0));
            let point = DVec3::new(a - 0.5, b - 0.5, c - 0.5) * 8.0;
            let [e, f, ..] = sampler.take(DimensionSet::render(1));
            let Some(direction) = DVec3::new(d - 0.5, e - 0.5, f - 0.5).try_normalize() else { continue };
            for portal in &portals.0 {
                let hit = portal.form.weighted_pdf(1.0, point, direction) > 0.0;
                hits += u32::from(hit);
                beside += u32::from(portal.is_beside(point, direction));
                assert!(!(hit && portal.is_beside(point, direction)), "{portal:?} from {point} along {direction}");
            }
        }
        assert!(hits > 20 && beside > 1000, "{hits} hits, {beside} beside");
    }

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
        let gable = [[1.0, -1.0, 0.1], [1.0, -1.0, 0.8], [1.0, 0.0, 1.0], [1.0, 1.0, 0.1]];
        let gable = LightForm::polygon(&gable.map(DVec3::from_array)).expect("it has an area");
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
    fn portal_samples_have_the_density_of_pdf() {
        let cases = [(DVec3::ZERO, DVec3::Z), (DVec3::new(0.2, -0.4, 0.1), DVec3::new(0.6, 0.0, 0.8))];
        let both = [portals(), boxes()];
        for (portals, (point, normal)) in both.iter().flat_map(|portals| cases.map(|case| (portals, case))) {
            let factors: Vec<f64> = (1..=portals.len()).map(|index| index as f64).collect();
            let visible_portals = portals.seen_by(point, normal, &factors, 0.5).expect("some portal is visible");
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
                let direction = visible_portals.sample([choice, u, v]).expect("every sample hits a portal");
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
