//! A ring of LEDs around the pinhole.

use crate::{AngularTable, lobe_pattern};
use glam::DVec3;
use radsight_pinhole::PinholeCamera;
use std::f64::consts::{FRAC_PI_4, TAU};
use std::fmt::Write;

/// Length of a `spotlight`'s aim vector, scene units. It is also a distance F by which Radiance scales direct light by
/// (r/(r+F))², so it is made too small to matter.
const AIM_LENGTH: f64 = 1e-9;

/// How an LED emits.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LedEmission {
    /// Uniform radiance I₀/A within a cone, none outside.
    Cone {
        /// Full angle of the cone, degrees, above 0, at most 180.
        full_angle_deg: f64,
    },
    /// Radiance I₀·g(θ)/(A·cosθ).
    Table(AngularTable),
}

/// LEDs as flat disks on a circle around the pinhole, in its plane, facing the camera's direction. LED k stands at the angle
/// 2π·k/leds from the picture's right towards its up.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Where the ring is and which way it faces.
    pub camera: PinholeCamera,
    /// How many, at least 1.
    pub leds: u32,
    /// Diameter of the circle through their centres, metres.
    pub ring_diameter_m: f64,
    /// Diameter of a disk, metres.
    pub led_diameter_m: f64,
    /// I₀, radiant intensity on the axis of each, W/sr.
    pub led_intensity_w_per_sr: f64,
    /// How each emits.
    pub emission: LedEmission,
}

impl Rig {
    /// I₀/A, the radiance on the axis of an LED, W/(sr·m²).
    #[must_use]
    pub fn axial_radiance(&self) -> f64 {
        self.led_intensity_w_per_sr / (FRAC_PI_4 * self.led_diameter_m * self.led_diameter_m)
    }

    /// The centre of LED `index`, scene frame, metres.
    #[must_use]
    pub fn led_centre_m(&self, index: u32) -> DVec3 {
        let camera = &self.camera;
        let (sin, cos) = (TAU * f64::from(index) / f64::from(self.leds)).sin_cos();
        camera.position_m() + (camera.right() * cos + camera.up() * sin) * (0.5 * self.ring_diameter_m)
    }

    /// The ring as Radiance scene text that needs no other file. Names begin with `radsight_led`.
    #[must_use]
    pub fn scene_text(&self) -> String {
        let mut out = self.header();
        let radiance = self.axial_radiance();
        let axis = self.camera.direction();
        match &self.emission {
            LedEmission::Cone { full_angle_deg } => {
                let aim = axis * AIM_LENGTH;
                let _ = write!(
                    out,
                    "void spotlight radsight_led_light\n0\n0\n7 {radiance} {radiance} {radiance}\n  {full_angle_deg} {} {} {}\n\n",
                    aim.x, aim.y, aim.z
                );
            }
            LedEmission::Table(table) => {
                let pattern = lobe_pattern::write(table, axis, "radsight_led_lobe", &mut out);
                let _ = write!(out, "{pattern} light radsight_led_light\n0\n0\n3 {radiance} {radiance} {radiance}\n\n");
            }
        }
        let per_unit = self.camera.scene_unit_m().recip();
        let radius = 0.5 * self.led_diameter_m * per_unit;
        for index in 0..self.leds {
            let centre = self.led_centre_m(index) * per_unit;
            let _ = write!(
                out,
                "radsight_led_light ring radsight_led_{index}\n0\n0\n8\n  {} {} {}\n  {} {} {}\n  0 {radius}\n\n",
                centre.x, centre.y, centre.z, axis.x, axis.y, axis.z
            );
        }
        out
    }

    fn header(&self) -> String {
        let emission = match &self.emission {
            LedEmission::Cone { full_angle_deg } => format!(
                "# Assumed: radiance I0/A within {} degrees of the axis, none outside; A is the area of the disk.",
                0.5 * full_angle_deg
            ),
            LedEmission::Table(table) => format!(
                "# Assumed: radiance I0 g(t)/(A cos t) at t from the axis; A is the area of the disk, g has {} rows.",
                table.rows().len()
            ),
        };
        format!(
            "# Light ring made by radsight: {} LED(s) on a circle of {} mm around the pinhole.\n\
             # Each is a flat disk of {} mm with I0 = {} W/sr on its axis, in the pinhole's plane, facing as the camera does.\n\
             {emission}\n\
             # Lengths are in scene units of {} m, radiance is in W/(sr m2), equal in all bands.\n\n",
            self.leds,
            millimetres(self.ring_diameter_m),
            millimetres(self.led_diameter_m),
            self.led_intensity_w_per_sr,
            self.camera.scene_unit_m()
        )
    }
}

/// For people: metres as millimetres, without the digits that the change of unit makes up.
fn millimetres(metres: f64) -> f64 {
    (metres * 1e12).round() / 1e9
}
