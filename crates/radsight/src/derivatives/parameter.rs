//! Parameters by which exposures are differentiated.

use crate::error::Error;
use radsight_camera::{Alignment, CameraFile, LedAlignment, Rig};
use radsight_diag::hint_nearest;
use radsight_pinhole::{CameraError, PinholeCamera};
use std::fmt;

/// A parameter of a capture: the pose of a part, the light ring or the camera.
///
/// | name | parameter | derivative per |
/// |---|---|---|
/// | `NAME.x`, `.y`, `.z` | position of the surfaces NAME (`*` at its end: a prefix) along a scene axis | m |
/// | `NAME.rx`, `.ry`, `.rz` | their rotation about an axis through the centre of their bounding box | degree |
/// | `led.intensity` | intensity of all LEDs | W/sr |
/// | `led[K].intensity` | intensity of LED K, from 0 | W/sr |
/// | `ring.diameter` | diameter of the light ring | m |
/// | `distance` | distance of camera and ring, moved back along the viewing direction | m |
/// | `pinhole.diameter` | diameter of the pinhole | m |
/// | `focal.distance` | distance from the pinhole to the sensor | m |
/// | `exposure.time` | exposure time | s |
///
/// ```
/// use radsight::Parameter;
/// let parameter: Parameter = "washer_*.rz".parse().unwrap();
/// assert_eq!((parameter.name(), parameter.unit()), ("washer_*.rz", "degree"));
/// let error = "distanse".parse::<Parameter>().unwrap_err();
/// assert!(error.to_string().contains("did you mean \"distance\"?"), "{error}");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    name: String,
    pub(super) kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    Part(PartParameter),
    LedIntensity(Option<u32>),
    RingDiameter,
    Distance,
    PinholeDiameter,
    FocalDistance,
    ExposureTime,
}

/// One degree of freedom of a part.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PartParameter {
    /// The name of its surfaces, or a prefix followed by `*`.
    pub(super) surfaces: String,
    pub(super) axis: glam::DVec3,
    /// A rotation about the axis, instead of a translation along it.
    pub(super) turns: bool,
}

/// Names without a part or the number of an LED.
const NAMES: [(&str, Kind); 6] = [
    ("led.intensity", Kind::LedIntensity(None)),
    ("ring.diameter", Kind::RingDiameter),
    ("distance", Kind::Distance),
    ("pinhole.diameter", Kind::PinholeDiameter),
    ("focal.distance", Kind::FocalDistance),
    ("exposure.time", Kind::ExposureTime),
];

/// Step of smooth parameters, relative to their value.
const RELATIVE_STEP: f64 = 1e-3;

/// Step of a ring's diameter, relative to the diameter of its LEDs, over which light and shadows
/// change smoothly; and its largest value, relative to the ring's diameter.
const STEP_OF_LED: f64 = 0.05;
const LARGEST_RING_STEP: f64 = 0.1;

/// Step of an intensity, relative to its value. The exposure is linear in it, so any step is exact.
const INTENSITY_STEP: f64 = 0.5;

impl std::str::FromStr for Parameter {
    type Err = Error;

    fn from_str(name: &str) -> Result<Parameter, Error> {
        let known = NAMES.iter().find(|(known, _)| *known == name).map(|(_, kind)| kind.clone());
        let kind = known.or_else(|| led(name)).or_else(|| part(name));
        let kind = kind.ok_or_else(|| {
            let hint = hint_nearest(name, NAMES.iter().map(|(name, _)| *name));
            let hint = hint.map_or_else(String::new, |hint| format!("\nhint: {hint}"));
            let expected = "expected NAME.x, .y, .z, .rx, .ry, .rz of a part, led.intensity, led[K].intensity, \
                            ring.diameter, distance, pinhole.diameter, focal.distance or exposure.time";
            wrong(name, format!("unknown parameter, {expected}{hint}"))
        })?;
        Ok(Parameter { name: name.to_owned(), kind })
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.name)
    }
}

impl Parameter {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether it is the exposure time, with which the sensor's dark current counts.
    pub(super) fn is_exposure_time(&self) -> bool {
        matches!(self.kind, Kind::ExposureTime)
    }

    /// Its unit.
    ///
    /// ```
    /// let parameter: radsight::Parameter = "pinhole.diameter".parse()?;
    /// assert_eq!(parameter.name(), "pinhole.diameter");
    /// assert!(!parameter.unit().is_empty());
    /// # Ok::<(), radsight::Error>(())
    /// ```
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match &self.kind {
            Kind::Part(part) if part.turns => "degree",
            Kind::LedIntensity(_) => "W/sr",
            Kind::ExposureTime => "s",
            Kind::Part(_) | Kind::RingDiameter | Kind::Distance | Kind::PinholeDiameter | Kind::FocalDistance => "m",
        }
    }

    pub(super) fn wrong(&self, reason: impl fmt::Display) -> Error {
        wrong(&self.name, reason.to_string())
    }

    /// The step of its central difference, where it is no part's. `distance_m` is the distance of
    /// what the camera sees.
    pub(super) fn step(&self, file: &CameraFile, distance_m: f64) -> Result<f64, Error> {
        let camera = &file.camera;
        Ok(match &self.kind {
            Kind::Part(_) => f64::NAN,
            Kind::LedIntensity(led) => INTENSITY_STEP * self.intensity(file, *led)?,
            Kind::RingDiameter => ring_step(self.rig(file)?),
            Kind::Distance => RELATIVE_STEP * distance_m,
            Kind::PinholeDiameter => RELATIVE_STEP * camera.pinhole_diameter_m(),
            Kind::FocalDistance => RELATIVE_STEP * camera.focal_distance_m(),
            Kind::ExposureTime => INTENSITY_STEP * camera.exposure_s(),
        })
    }

    /// The camera file with the parameter changed by an amount in its unit.
    pub(super) fn changed(&self, file: &CameraFile, amount: f64) -> Result<CameraFile, Error> {
        let mut file = file.clone();
        let back = |camera: PinholeCamera| camera.moved([0.0, 0.0, -amount], [0.0; 3]);
        match self.kind {
            Kind::Part(_) => {}
            Kind::LedIntensity(led) => {
                let share = 1.0 + amount / self.intensity(&file, led)?;
                let rig = file.rig.as_mut().ok_or_else(|| self.no_rig())?;
                match led {
                    None => rig.led_intensity_w_per_sr *= share,
                    Some(led) => leds(rig)[led as usize].intensity *= share,
                }
            }
            Kind::RingDiameter => file.rig.as_mut().ok_or_else(|| self.no_rig())?.ring_diameter_m += amount,
            Kind::Distance => {
                file.camera = self.checked(back(file.camera))?;
                if let Some(rig) = &mut file.rig {
                    rig.camera = self.checked(back(rig.camera.clone()))?;
                }
            }
            Kind::PinholeDiameter => {
                let diameter = file.camera.pinhole_diameter_m() + amount;
                file.camera = self.checked(file.camera.with_pinhole_diameter(diameter))?;
            }
            Kind::FocalDistance => {
                let distance = file.camera.focal_distance_m() + amount;
                file.camera = self.checked(file.camera.with_focal_distance(distance))?;
            }
            Kind::ExposureTime => {
                let time = file.camera.exposure_s() + amount;
                file.camera = self.checked(file.camera.with_exposure(time))?;
            }
        }
        Ok(file)
    }

    /// The intensity of one LED or of each, W/sr.
    fn intensity(&self, file: &CameraFile, led: Option<u32>) -> Result<f64, Error> {
        let rig = self.rig(file)?;
        let Some(led) = led else { return Ok(rig.led_intensity_w_per_sr) };
        if led >= rig.leds {
            return Err(self.wrong(format!("the ring has {} LEDs, numbered from 0", rig.leds)));
        }
        let own = rig.alignment.as_ref().and_then(|alignment| alignment.leds.get(led as usize));
        let share = own.map_or(1.0, |own| own.intensity);
        if share > 0.0 { Ok(share * rig.led_intensity_w_per_sr) } else { Err(self.wrong("this LED is dark")) }
    }

    fn rig<'f>(&self, file: &'f CameraFile) -> Result<&'f Rig, Error> {
        file.rig.as_ref().ok_or_else(|| self.no_rig())
    }

    fn no_rig(&self) -> Error {
        self.wrong("the camera file has no [rig]")
    }

    fn checked(&self, camera: Result<PinholeCamera, CameraError>) -> Result<PinholeCamera, Error> {
        camera.map_err(|error| self.wrong(error))
    }
}

fn wrong(parameter: &str, reason: String) -> Error {
    Error::Parameter { parameter: parameter.to_owned(), reason }
}

/// The LEDs of a ring, each with its own intensity.
fn leds(rig: &mut Rig) -> &mut [LedAlignment] {
    let count = rig.leds as usize;
    let alignment = rig.alignment.get_or_insert_with(Alignment::default);
    alignment.leds.resize(count, LedAlignment::default());
    &mut alignment.leds
}

fn led(name: &str) -> Option<Kind> {
    let number = name.strip_prefix("led[")?.strip_suffix("].intensity")?;
    number.parse().ok().map(|number| Kind::LedIntensity(Some(number)))
}

fn part(name: &str) -> Option<Kind> {
    let (surfaces, component) = name.rsplit_once('.').filter(|(surfaces, _)| !surfaces.is_empty())?;
    let (letter, turns) = match component.strip_prefix('r') {
        Some(letter) => (letter, true),
        None => (component, false),
    };
    let axis = match letter {
        "x" => glam::DVec3::X,
        "y" => glam::DVec3::Y,
        "z" => glam::DVec3::Z,
        _ => return None,
    };
    Some(Kind::Part(PartParameter { surfaces: surfaces.to_owned(), axis, turns }))
}

fn ring_step(rig: &Rig) -> f64 {
    let of_led = (STEP_OF_LED * rig.led_diameter_m).min(LARGEST_RING_STEP * rig.ring_diameter_m);
    of_led.max(RELATIVE_STEP * rig.ring_diameter_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_parts_and_leds_are_read() {
        let kind = |name: &str| name.parse::<Parameter>().map(|parameter| parameter.kind);
        let Ok(Kind::Part(part)) = kind("a.b_*.rx") else { panic!("a part") };
        assert_eq!((&*part.surfaces, part.axis, part.turns), ("a.b_*", glam::DVec3::X, true));
        assert_eq!(kind("led[11].intensity").unwrap(), Kind::LedIntensity(Some(11)));
        for name in ["", ".x", "x", "part.w", "part.rr", "led[-1].intensity", "led[].intensity"] {
            assert!(kind(name).is_err(), "{name}");
        }
    }
}
