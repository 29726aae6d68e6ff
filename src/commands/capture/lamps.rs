//! Lamps that flicker: what they give while each row is exposed.
//!
//! Light adds up. Under a global shutter a lamp is scaled by its mean over the exposure, which
//! costs nothing. Under a rolling one the lamps that flicker alike become a scene of their own,
//! whose light is weighted row by row and added.

use crate::failure::{Failure, Outcome};
use crate::input::camera_mistake;
use radsight_camera::{CameraFile, Flicker};
use radsight_diag::Diagnostic;
use radsight_ir::{Rgb, Scene};

/// A scene divided by the flicker of its lamps.
#[derive(Debug, Default)]
pub(crate) struct FlickeringScenes {
    /// Scenes of the lamps whose light differs from row to row, and their brightness by row.
    pub(crate) by_row: Vec<(Scene, Vec<f64>)>,
}

impl FlickeringScenes {
    /// Takes the lamps of the camera file out of a scene, or scales them where all rows see them
    /// alike. `path` names the camera file.
    pub(crate) fn split(scene: &mut Scene, camera: &CameraFile, path: &str) -> Result<FlickeringScenes, Failure> {
        check_names(scene, camera, path)?;
        let mut groups: Vec<(Flicker, Vec<&str>)> = Vec::new();
        for lamp in &camera.flickering {
            match groups.iter_mut().find(|(flicker, _)| *flicker == lamp.flicker) {
                Some((_, names)) => names.push(&lamp.modifier),
                None => groups.push((lamp.flicker, vec![&lamp.modifier])),
            }
        }
        let whole = scene.clone();
        let mut by_row = Vec::new();
        for (flicker, names) in groups {
            let brightness = camera.brightness_by_row(&flicker);
            let is_even = brightness.iter().all(|share| *share == brightness[0]);
            scale(scene, |name| {
                if !names.contains(&name) {
                    1.0
                } else if is_even {
                    brightness[0]
                } else {
                    0.0
                }
            });
            if !is_even {
                let mut alone = whole.clone();
                scale(&mut alone, |name| f64::from(u8::from(names.contains(&name))));
                by_row.push((alone, brightness));
            }
        }
        Ok(FlickeringScenes { by_row })
    }
}

fn scale(scene: &mut Scene, share: impl Fn(&str) -> f64) {
    let Scene { names, modifiers, .. } = scene;
    for modifier in modifiers.items_mut() {
        let share = share(names.get(modifier.name));
        if share != 1.0
            && let Some(Rgb(bands)) = modifier.radiance_mut()
        {
            bands.iter_mut().for_each(|band| *band *= share);
        }
    }
}

/// Whether each lamp is there.
fn check_names(scene: &mut Scene, camera: &CameraFile, path: &str) -> Outcome {
    let Scene { names, modifiers, .. } = scene;
    let mut lamps: Vec<&str> = Vec::new();
    for modifier in modifiers.items_mut() {
        let name = modifier.name;
        if modifier.radiance_mut().is_some() && !lamps.contains(&names.get(name)) {
            lamps.push(names.get(name));
        }
    }
    match camera.flickering.iter().find(|lamp| !lamps.contains(&lamp.modifier.as_str())) {
        None => Ok(()),
        Some(missing) => {
            let name = &missing.modifier;
            let mistake = format!("[flicker.{name}]: the scene has no light, illum, glow or spotlight of this name");
            let hint =
                if lamps.is_empty() { "it has none at all".to_owned() } else { format!("it has {}", lamps.join(", ")) };
            Err(camera_mistake(path, &["flicker", name], Diagnostic::error(mistake).hint(hint)))
        }
    }
}
