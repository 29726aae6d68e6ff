//! Rays of a sender.

use crate::basis::Directions;
use crate::{FluxError, Group, Hand};
use glam::DVec3;
use radsight_sampling::{DimensionSet, RaySampler};

/// Surfaces that emit a number of rays for each patch of a basis. Rays leave against the mean
/// normal, since light for a receiver enters there.
#[derive(Clone, Debug)]
pub struct Sender {
    group: Group,
    directions: Directions,
    /// Unit vectors u, v and the mean normal.
    axes: [DVec3; 3],
    samples: u64,
    seed: u64,
}

impl Sender {
    /// A sender with `samples` rays per patch, at least one.
    ///
    /// # Errors
    /// If the group has no surface, basis or frame, or cannot send with its basis.
    pub fn new(group: &Group, samples: u64) -> Result<Sender, FluxError> {
        if group.surfaces.is_empty() {
            return Err(FluxError::Nothing);
        }
        if let Some(source) = group.surfaces.iter().find(|surface| surface.is_distant()) {
            return Err(FluxError::SendingSource { surface: source.name.clone() });
        }
        let missing = || FluxError::NoBasis { modifier: group.modifier.clone() };
        let directions = Directions::new(group.parameters.basis.ok_or_else(missing)?)?;
        let [normal, up] = group.frame()?;
        let across =
            up.cross(normal).try_normalize().ok_or_else(|| FluxError::Up { modifier: group.modifier.clone() })?;
        let v = normal.cross(across);
        let u = if group.parameters.hand == Hand::Left { -across } else { across };
        Ok(Sender { group: group.clone(), directions, axes: [u, v, normal], samples: samples.max(1), seed: SEED })
    }

    /// Samples with the seed of a command; 0 is the one of [`Sender::new`].
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Sender {
        Sender { seed: SEED ^ seed, ..self }
    }

    /// Number of patches of the basis.
    #[must_use]
    pub fn bins(&self) -> u64 {
        self.directions.len()
    }

    /// Number of rays: those of a patch are consecutive, in the order of the patches.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.bins().saturating_mul(self.samples)
    }

    /// Origin and unit direction of ray number `number`.
    ///
    /// # Errors
    /// If no surface faces that direction.
    pub fn ray(&self, number: u64) -> Result<([f64; 3], [f64; 3]), FluxError> {
        let [a, b, c, d] = RaySampler::new(self.seed, number).take(DimensionSet::CAMERA);
        let [along_u, along_v, along_normal] = self.directions.sample(number / self.samples, [a, b]);
        let [u, v, normal] = self.axes;
        let direction = -(u * along_u + v * along_v + normal * along_normal);
        let seen = |surface: &crate::FluxSurface| (-surface.normal.dot(direction)).max(0.0) * surface.area;
        let total: f64 = self.group.surfaces.iter().map(seen).sum();
        let mut left = c * total;
        let mut facing =
            self.group.surfaces.iter().map(|surface| (surface, seen(surface))).filter(|(_, area)| *area > 0.0);
        let mut chosen = facing.next();
        while let Some((_, area)) = chosen
            && left >= area
            && let Some(next) = facing.next()
        {
            left -= area;
            chosen = Some(next);
        }
        if let Some((surface, area)) = chosen {
            return Ok((surface.point([(left / area).min(1.0), d]).to_array(), direction.to_array()));
        }
        // For a direction along the horizon of a single surface any point is as good.
        if let [surface] = &self.group.surfaces[..] {
            return Ok((surface.point([c, d]).to_array(), direction.to_array()));
        }
        Err(FluxError::Behind { modifier: self.group.modifier.clone() })
    }
}

/// Distinguishes the samples of senders from those of other rays.
const SEED: u64 = 0x666c_7578;
