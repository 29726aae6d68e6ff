//! Prepares the scene: tracked emitters get a radiance of 1 if coefficients are requested.

use super::options::{Options, Wanted};
use crate::failure::say;
use radsight_ir::{Rgb, Scene};
use std::collections::HashSet;
use std::sync::Arc;

/// Changes the scene, and checks that it has the requested modifiers.
pub(super) fn prepare(scene: &mut Scene, options: &Options) {
    let wanted: HashSet<&str> = options.tracked.iter().map(|tracked| tracked.name.as_str()).collect();
    let mut met = HashSet::new();
    change(scene, &wanted, options.wanted, &mut met);
    let mut missing = options.tracked.iter().map(|tracked| &tracked.name).filter(|name| !met.contains(*name));
    if let Some(first) = missing.next()
        && !options.reading.no_warnings
    {
        let more = match missing.count() {
            0 => String::new(),
            more => format!(" and {more} others"),
        };
        say(&format!("rcontrib: warning - the scene has no modifier \"{first}\"{more}\n"));
    }
}

fn change(scene: &mut Scene, names: &HashSet<&str>, wanted: Wanted, met: &mut HashSet<String>) {
    for modifier in scene.modifiers.items_mut() {
        let name = scene.names.get(modifier.name);
        if !names.contains(name) {
            continue;
        }
        met.insert(name.to_owned());
        if let (Wanted::Coefficients, Some(radiance)) = (wanted, modifier.radiance_mut()) {
            *radiance = Rgb::WHITE;
            // Patterns are part of its radiance.
            modifier.modifier = None;
        }
    }
    for octree in scene.octrees.items_mut() {
        change(Arc::make_mut(&mut octree.scene), names, wanted, met);
    }
}
