//! Lights that mist scatters.

use crate::shader::{Kind, Shader};
use radsight_diag::Diagnostic;
use radsight_ir::Scene;
use radsight_light::{Light, LightId};

/// Maximum number of lights that the mist of a scene can name.
pub(crate) const MAX_MIST_LIGHTS: usize = 64;

/// Lights named by mist: bit k of a medium's lights is entry k.
#[derive(Debug, Default)]
pub struct MistLights(pub Vec<LightId>);

impl MistLights {
    /// Resolves the lights that the scene's mist names, and sets their bits in its shaders. Names
    /// that match no light are ignored, as in Radiance.
    pub fn new(scene: &Scene, lights: &[Light], shaders: &mut [Shader]) -> Result<MistLights, Diagnostic> {
        let mut found = MistLights::default();
        for shader in shaders {
            let Kind::Mist(mist) = &mut shader.kind else { continue };
            for name in &mist.names {
                let Some(id) = lights.iter().rposition(|light| is_named(scene, light, name)) else { continue };
                let id = LightId(id as u32);
                let bit = found.0.iter().position(|known| *known == id).unwrap_or_else(|| {
                    found.0.push(id);
                    found.0.len() - 1
                });
                if bit >= MAX_MIST_LIGHTS {
                    let most = MAX_MIST_LIGHTS;
                    return Err(Diagnostic::error(format!("mist names more than {most} different lights")));
                }
                mist.lights |= 1 << bit;
            }
        }
        Ok(found)
    }
}

/// Whether a name denotes a light: `mirror>lamp` is the image of `lamp` in `mirror`.
fn is_named(scene: &Scene, light: &Light, name: &str) -> bool {
    let mut words = name.split('>').rev();
    let own = words.next() == Some(scene.surface_name(light.surface));
    // The list of mirrors begins at the receiver; a name begins at it as well after reversal.
    let mirrors = light.virtual_sources.iter().rev().map(|mirror| scene.surface_name(mirror.surface));
    own && words.eq(mirrors)
}
