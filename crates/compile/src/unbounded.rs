//! Rays whose radiance no picture can hold.

use crate::first_hit::{DISTANT, FirstHit, material_name};
use crate::plan::RenderPlan;
use radsight_diag::Diagnostic;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// The largest value of a band, 2¹²⁷: what the pixels of Radiance's pictures hold, with room below
/// the end of single precision for filters.
const MOST: f64 = 1.701_411_834_604_692_3e38;

/// Counts rays whose radiance was not a number that pictures can hold, and keeps them in bounds.
#[derive(Debug, Default)]
pub struct Unbounded {
    count: AtomicU64,
    first: OnceLock<Option<FirstHit>>,
}

impl Unbounded {
    /// Brings values into ±2¹²⁷, with 0 for what is no number.
    #[inline]
    pub fn bound(&self, values: &mut [f64], first_hit: Option<&FirstHit>) {
        if !values.iter().all(|value| value.abs() <= MOST) {
            self.bring_back(values, first_hit);
        }
    }

    #[cold]
    fn bring_back(&self, values: &mut [f64], first_hit: Option<&FirstHit>) {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.first.get_or_init(|| first_hit.copied());
        for value in values {
            *value = if value.is_nan() { 0.0 } else { value.clamp(-MOST, MOST) };
        }
    }
}

impl RenderPlan {
    /// Whether rays brought radiance that no picture can hold.
    #[must_use]
    pub fn has_unbounded_radiance(&self) -> bool {
        self.unbounded.first.get().is_some()
    }

    /// A warning of rays that brought radiance that no picture can hold: how many, and where one of
    /// the first met what.
    #[must_use]
    pub fn unbounded_radiance(&self) -> Option<Diagnostic> {
        let first = self.unbounded.first.get()?;
        let place = first.as_ref().map_or(String::new(), |hit| self.described(hit));
        let count = self.unbounded.count.load(Ordering::Relaxed);
        let rays = if count == 1 { "1 ray".to_owned() } else { format!("{count} rays") };
        let warning = Diagnostic::warning(format!("the radiance of {rays} is beyond {MOST:.1e} or no number{place}"));
        let span = first.as_ref().and_then(|hit| self.scene.surfaces[hit.surface].span);
        Some(span.into_iter().fold(warning, Diagnostic::at))
    }

    fn described(&self, hit: &FirstHit) -> String {
        if hit.material == DISTANT {
            return format!(", such as towards \"{}\"", self.scene.surface_name(hit.surface));
        }
        let shader = &self.shaders[hit.material as usize];
        let scene = shader.textures.home.scene(&self.scene);
        let [x, y, z] = hit.point.to_array();
        format!(
            ", such as at ({x:.6} {y:.6} {z:.6}) on \"{}\" of \"{}\"",
            self.scene.surface_name(hit.surface),
            material_name(scene, shader.modifier)
        )
    }
}
