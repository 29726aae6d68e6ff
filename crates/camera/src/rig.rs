//! A ring of LEDs around the pinhole.

use crate::{Alignment, AngularTable, LedAlignment, lobe_pattern};
use glam::{DQuat, DVec3};
use radsight_pinhole::PinholeCamera;
use std::f64::consts::{FRAC_PI_4, TAU};
use std::fmt::Write;

/// Length of a `spotlight`'s aim vector, scene units. It is also a distance F by which Radiance
/// scales direct light by (r/(r+F))², so it is made too small to matter.
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

/// LEDs as flat disks on a circle around the pinhole, in its plane, facing the camera's direction.
/// LED k stands at the angle 2π·k/leds from the picture's right towards its up.
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
    /// How far ring and LEDs are from their nominal places, where they are; the camera has its own
    /// part of it.
    pub alignment: Option<Alignment>,
}

/// Where an LED is, scene frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Led {
    centre_m: DVec3,
    axis: DVec3,
    intensity: f64,
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
        match &self.alignment {
            None => self.nominal_centre_m(index),
            Some(alignment) => self.aligned(index, alignment).centre_m,
        }
    }

    fn nominal_centre_m(&self, index: u32) -> DVec3 {
        let camera = &self.camera;
        let (sin, cos) = (TAU * f64::from(index) / f64::from(self.leds)).sin_cos();
        camera.position_m() + (camera.right() * cos + camera.up() * sin) * (0.5 * self.ring_diameter_m)
    }

    fn aligned(&self, index: u32, alignment: &Alignment) -> Led {
        let camera = &self.camera;
        let frame = |vector: DVec3| camera.right() * vector.x + camera.up() * vector.y + camera.direction() * vector.z;
        let turn = |[x, y, z]: [f64; 3]| {
            DQuat::from_scaled_axis(frame(DVec3::new(x.to_radians(), y.to_radians(), z.to_radians())))
        };
        let own = alignment.leds.get(index as usize).copied().unwrap_or_default();
        let LedAlignment { shift_mm, tilt_deg: [about_right, about_up], intensity } = own;
        let ring = turn(alignment.ring_turn_deg);
        let from_middle = self.nominal_centre_m(index) - camera.position_m() + frame(DVec3::from(shift_mm) * 1e-3);
        let middle = camera.position_m() + frame(DVec3::from(alignment.ring_shift_mm) * 1e-3);
        let axis = ring * (turn([about_right, about_up, 0.0]) * camera.direction());
        Led { centre_m: middle + ring * from_middle, axis: axis.normalize(), intensity }
    }

    /// The ring as Radiance scene text that needs no other file. Names begin with `radsight_led`.
    #[must_use]
    pub fn scene_text(&self) -> String {
        let mut out = self.header();
        let Some(alignment) = &self.alignment else {
            let axis = self.camera.direction();
            self.write_light("radsight_led", axis, self.axial_radiance(), &mut out);
            for index in 0..self.leds {
                self.write_disk("radsight_led", index, self.nominal_centre_m(index), axis, &mut out);
            }
            return out;
        };
        // Each LED has a direction and an intensity of its own.
        for index in 0..self.leds {
            let led = self.aligned(index, alignment);
            let name = format!("radsight_led_{index}");
            self.write_light(&name, led.axis, self.axial_radiance() * led.intensity, &mut out);
            self.write_disk(&name, index, led.centre_m, led.axis, &mut out);
        }
        out
    }

    fn write_light(&self, name: &str, axis: DVec3, radiance: f64, out: &mut String) {
        match &self.emission {
            LedEmission::Cone { full_angle_deg } => {
                let aim = axis * AIM_LENGTH;
                let _ = write!(
                    out,
                    "void spotlight {name}_light\n0\n0\n7 {radiance} {radiance} {radiance}\n  {full_angle_deg} {} {} {}\n\n",
                    aim.x, aim.y, aim.z
                );
            }
            LedEmission::Table(table) => {
                let pattern = lobe_pattern::write(table, axis, &format!("{name}_lobe"), out);
                let _ = write!(out, "{pattern} light {name}_light\n0\n0\n3 {radiance} {radiance} {radiance}\n\n");
            }
        }
    }

    fn write_disk(&self, light: &str, index: u32, centre_m: DVec3, axis: DVec3, out: &mut String) {
        let per_unit = self.camera.scene_unit_m().recip();
        let radius = 0.5 * self.led_diameter_m * per_unit;
        let centre = centre_m * per_unit;
        let _ = write!(
            out,
            "{light}_light ring radsight_led_{index}\n0\n0\n8\n  {} {} {}\n  {} {} {}\n  0 {radius}\n\n",
            centre.x, centre.y, centre.z, axis.x, axis.y, axis.z
        );
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
