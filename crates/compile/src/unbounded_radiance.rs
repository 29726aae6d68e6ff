//! Warning about rays whose radiance exceeds the range of pictures.

use crate::first_hit::{DISTANT, FirstHit, material_name};
use crate::plan::RenderPlan;
use crate::unbounded::MOST;
use radsight_diag::Diagnostic;

impl RenderPlan {
    /// Whether any ray's radiance exceeded the range of pictures.
    #[must_use]
    pub fn has_unbounded_radiance(&self) -> bool {
        self.unbounded.found().is_some()
    }

    /// A warning about such rays: their number, and the first hit of one of the first.
    #[must_use]
    pub fn unbounded_radiance(&self) -> Option<Diagnostic> {
        let (count, first) = self.unbounded.found()?;
        let place = first.as_ref().map_or(String::new(), |hit| self.described(hit));
        let rays = if count == 1 { "1 ray".to_owned() } else { format!("{count} rays") };
        let warning =
            Diagnostic::warning(format!("the radiance of {rays} exceeds {MOST:.1e} or is not a number{place}"));
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
