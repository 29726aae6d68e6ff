//! `[rig]`.

use crate::section::{Placed, Range, Section, load_beside};
use crate::{AngularTable, Found, LedEmission, Rig};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_loader::Loader;
use radsight_pinhole::PinholeCamera;
use std::f64::consts::PI;

/// The largest radiance of an LED, W/sr/m²: what it lights is finite in single precision.
const LARGEST_RADIANCE: f64 = 1e30;

/// The most LEDs of a ring.
const MOST_LEDS: i64 = 10_000;

pub(crate) fn read(
    section: Section<'_>,
    camera: Option<&PinholeCamera>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<Rig> {
    let rig = read_keys(&section, camera, file, sources, loader, found);
    section.close(sources, found);
    rig
}

fn read_keys(
    section: &Section<'_>,
    camera: Option<&PinholeCamera>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<Rig> {
    let leds = section.whole("leds", [1, MOST_LEDS], "12", sources, found);
    let ring_mm = section.number("ring_diameter_mm", Range::Positive, "25.4", sources, found);
    let led_mm = section.number("led_diameter_mm", Range::Positive, "5.0", sources, found);
    let intensity = section.number("led_intensity_w_per_sr", Range::Positive, "0.055", sources, found);
    let emission = emission(section, file, sources, loader, found);
    let rig = Rig {
        camera: camera?.clone(),
        leds: u32::try_from(leds?).ok()?,
        ring_diameter_m: ring_mm? * 1e-3,
        led_diameter_m: led_mm? * 1e-3,
        led_intensity_w_per_sr: intensity?,
        emission: emission?,
        alignment: None,
    };
    let radiance = rig.axial_radiance();
    if radiance > LARGEST_RADIANCE || !radiance.is_finite() {
        let span = section.span_of(section.most_extreme(&["led_diameter_mm", "led_intensity_w_per_sr"]), sources);
        let message = format!("the LEDs are too bright: their radiance is {radiance:.1e} W/sr/m2");
        found.errors.push(Diagnostic::error(message).at(span));
        return None;
    }
    warn(&rig, section, sources, found);
    Some(rig)
}

/// The table where there is one, else the cone.
fn emission(
    section: &Section<'_>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<LedEmission> {
    let cone = section.optional_number("led_cone_deg", Range::Positive, sources, found);
    if let Some(angle) = cone.filter(|angle| *angle > 180.0) {
        let message = format!("\"led_cone_deg\" must be at most 180, the full angle of a half space, not {angle}");
        found.errors.push(Diagnostic::error(message).at(section.span_of("led_cone_deg", sources)));
        return None;
    }
    if section.has("led_table") {
        let name = section.optional_string("led_table", sources, found)?;
        if section.has("led_cone_deg") {
            let message = "\"led_cone_deg\" has no effect: \"led_table\" replaces it";
            found.warnings.push(Diagnostic::warning(message).at(section.span_of("led_cone_deg", sources)));
        }
        return load_table(name, file, sources, loader, found).map(LedEmission::Table);
    }
    section.optional_string("led_table", sources, found);
    if !section.has("led_cone_deg") {
        let error = Diagnostic::error("[rig] has neither \"led_cone_deg\" nor \"led_table\"");
        found.errors.push(error.at(section.header_span(sources)).hint("for example led_cone_deg = 7.0"));
    }
    cone.map(|full_angle_deg| LedEmission::Cone { full_angle_deg })
}

fn load_table(
    name: Placed<&str>,
    file: &str,
    sources: &mut SourceMap,
    loader: &dyn Loader,
    found: &mut Found,
) -> Option<AngularTable> {
    let source = load_beside(&name, file, sources, loader, found)?;
    match AngularTable::read(source, sources) {
        Ok((table, warnings)) => {
            found.warnings.extend(warnings);
            Some(table)
        }
        Err(errors) => {
            found.errors.extend(errors);
            None
        }
    }
}

fn warn(rig: &Rig, section: &Section<'_>, sources: &SourceMap, found: &mut Found) {
    let span = section.span_of("led_diameter_mm", sources);
    // Neighbours on the ring are a chord apart.
    let chord = rig.ring_diameter_m * (PI / f64::from(rig.leds)).sin();
    if rig.leds > 1 && chord < rig.led_diameter_m {
        let message = format!("LEDs of {} mm overlap: they are {:.3} mm apart", rig.led_diameter_m * 1e3, chord * 1e3);
        found.warnings.push(Diagnostic::warning(message).at(span));
    }
    if rig.ring_diameter_m < rig.led_diameter_m + rig.camera.pinhole_diameter_m() {
        found.warnings.push(Diagnostic::warning("the LEDs reach over the pinhole").at(span));
    }
}
