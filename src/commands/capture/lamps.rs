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
        let lamps = lamps(scene, camera);
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
            scale((scene, &lamps), |name| {
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
                scale((&mut alone, &lamps), |name| f64::from(u8::from(names.contains(&name))));
                by_row.push((alone, brightness));
            }
        }
        Ok(FlickeringScenes { by_row })
    }
}

/// The lamp of the camera file that each modifier of a scene is. An alias without a section of its own
/// is the lamp whose name it stands for.
fn lamps(scene: &Scene, camera: &CameraFile) -> Vec<String> {
    let is_listed = |name: &str| camera.flickering.iter().any(|lamp| lamp.modifier == name);
    let of_modifier = |handle| {
        let own = scene.modifier_name(Some(handle));
        if is_listed(own) { own } else { scene.original_name(Some(handle)) }.to_owned()
    };
    scene.modifiers.iter().map(|(handle, _)| of_modifier(handle)).collect()
}

fn scale((scene, lamps): (&mut Scene, &[String]), share: impl Fn(&str) -> f64) {
    for (modifier, lamp) in scene.modifiers.items_mut().iter_mut().zip(lamps) {
        let share = share(lamp);
        if share != 1.0
            && let Some(Rgb(bands)) = modifier.radiance_mut()
        {
            bands.iter_mut().for_each(|band| *band *= share);
        }
    }
}

/// Whether each lamp is there, be it as the name behind an alias.
fn check_names(scene: &mut Scene, camera: &CameraFile, path: &str) -> Outcome {
    let gives_light: Vec<bool> =
        scene.modifiers.items_mut().iter_mut().map(|modifier| modifier.radiance_mut().is_some()).collect();
    let mut lamps: Vec<&str> = Vec::new();
    for ((handle, _), _) in scene.modifiers.iter().zip(gives_light).filter(|(_, gives_light)| *gives_light) {
        for name in [scene.modifier_name(Some(handle)), scene.original_name(Some(handle))] {
            if !lamps.contains(&name) {
                lamps.push(name);
            }
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
