//! Contributions of modifiers to rays.

use crate::error::Error;
use crate::renderer::{RAYS_AT_A_TIME, Renderer};
use radsight_capture::{Progress, Silent};
use radsight_render::{Contribution, Ray, Sampling, TrackedValue, Uncached};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The contribution of one of the requested modifiers to a ray.
///
/// ```
/// use glam::DVec3;
/// use radsight::{Ray, Renderer, Scene};
/// let scene = Scene::from_text("void glow white 0 0 4 1 2 3 0 white sphere ball 0 0 4 0 9 0 2")?;
/// let ahead = Ray::new(DVec3::ZERO, DVec3::Y).unwrap();
/// let found = Renderer::new(&scene)?.contributions(&[ahead], &["white"])?;
/// assert_eq!((found[0][0].modifier, found[0][0].value), (0, [1.0, 2.0, 3.0]));
/// # Ok::<(), radsight::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModifierContribution {
    /// Index of the modifier in the request.
    pub modifier: usize,
    /// Red, green and blue, W/(sr·m²), or W/m² if irradiance is requested. In spectral rendering it
    /// is the colour of the traced bands.
    pub value: [f64; 3],
}

impl Renderer {
    /// The contributions of modifiers with these names to each ray: the radiance of their emitters
    /// times its coefficient, as in `rcontrib`. A name that the scene does not have contributes 0; a
    /// name that is given twice has its contribution at both places.
    ///
    /// ```
    /// # use radsight::example::scene;
    /// use glam::DVec3;
    /// use radsight::{Ray, Renderer};
    /// let ahead = Ray::new(DVec3::ZERO, DVec3::Y).unwrap();
    /// let found = Renderer::new(&scene())?.contributions(&[ahead], &["sky", "white"])?;
    /// assert_eq!((found[0][0].value, found[0][1].value), ([0.0; 3], [1.0; 3]));
    /// # Ok::<(), radsight::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Renderer::trace`].
    pub fn contributions(&mut self, rays: &[Ray], modifiers: &[&str]) -> Result<Vec<Vec<ModifierContribution>>, Error> {
        Ok(self.contributions_part(0, rays, modifiers, &Silent)?.expect("nobody stopped it"))
    }

    /// The same for a part of a longer list, as in [`Renderer::trace_part`].
    ///
    /// # Errors
    /// As [`Renderer::trace`].
    pub fn contributions_part(
        &mut self,
        first: u64,
        rays: &[Ray],
        modifiers: &[&str],
        progress: &dyn Progress,
    ) -> Result<Option<Vec<Vec<ModifierContribution>>>, Error> {
        let mut options = self.options.clone();
        let (names, requests) = numbered_names(modifiers);
        options.tracked_modifiers = names.iter().map(|name| (*name).to_owned()).collect();
        options.tracked_value = TrackedValue::Radiance;
        options.gathering.accuracy = 0.0;
        options.gathering.uncached = Uncached::Split;
        let sampling = options.sampling;
        let renderer = &*self.prepare(options)?;
        let mut contributions = Vec::with_capacity(rays.len());
        for some in rays.chunks(RAYS_AT_A_TIME) {
            if progress.stops() {
                return Ok(None);
            }
            let before = contributions.len() as u64;
            let of_rays = some.par_iter().enumerate().map_init(
                || renderer.worker(),
                |worker, (index, ray)| {
                    let mut sums = vec![[0.0; 3]; names.len()];
                    let number = first.wrapping_add(before + index as u64);
                    worker.contributions(number, ray, |found| add(&mut sums[found.modifier], sampling, &found));
                    let contribution =
                        |(modifier, name): (usize, &usize)| ModifierContribution { modifier, value: sums[*name] };
                    requests.iter().enumerate().map(contribution).collect()
                },
            );
            contributions.extend(of_rays.collect::<Vec<_>>());
            progress.report(contributions.len() as u64, rays.len() as u64);
        }
        self.check_met()?;
        Ok(Some(contributions))
    }
}

/// Adds the colour of a contribution; a grey one has one band.
fn add(sum: &mut [f64; 3], sampling: Sampling, contribution: &Contribution) {
    let color = match contribution.value.as_slice() {
        [grey] => [f64::from(*grey); 3],
        bands => sampling.rgb(&bands.iter().map(|band| f64::from(*band)).collect::<Vec<_>>()),
    };
    *sum = std::array::from_fn(|band| sum[band] + color[band]);
}

/// The different names, and the index of each requested one among them.
fn numbered_names<'n>(requested: &[&'n str]) -> (Vec<&'n str>, Vec<usize>) {
    let mut names = Vec::new();
    let mut numbers = BTreeMap::new();
    let number = |name: &&'n str| {
        *numbers.entry(*name).or_insert_with(|| {
            names.push(*name);
            names.len() - 1
        })
    };
    let requests = requested.iter().map(number).collect();
    (names, requests)
}
