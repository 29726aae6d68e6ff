//! `genskyvec [-m MF] [-c r g b] [-d] [-5] [-h] < sky.rad`: a sky as a vector of Reinhart's
//! patches, for `dctimestep`.
//!
//! The sky is scene text with a pattern `skyfunc`, as written by `gensky` and `gendaylit`. Each
//! Tregenza patch is divided `MF` times along each axis (default 4). The radiance of a patch is the
//! mean over 16 directions, times the colour of `-c`; the first patch is the ground. The sun is
//! distributed over the three nearest patches by angle; with `-5` the nearest one gets all of it.
//! `-d` leaves the sky black, `-h` omits the header.
//!
//! Sky radiances need a renderer, which this crate may not know: the caller provides it.

use std::f64::consts::PI;
use std::fmt::Write;

use radsight_cal::random;
use radsight_sky::SkyDivision;

use crate::arguments::Arguments;
use crate::scene_words::SceneWords;
use crate::sky_patches::{SkyPatches, towards};
use crate::text::{Text, general};
use crate::{EnvironmentRadiance, Error, Output, StandardInput};

/// Opens the environment that scene text describes.
pub type OpenSky<'o, 'a> = dyn Fn(Vec<u8>) -> Result<Box<EnvironmentRadiance<'a>>, Error> + 'o;

/// The colour of a sky of average turbidity.
const SKY_COLOR: [f64; 3] = [0.960, 1.004, 1.118];

/// Sample directions per patch.
const SAMPLES: u32 = 16;

/// Number of patches over which the sun is distributed.
const SHARERS: usize = 3;

/// Added to angles before their inverse becomes a weight, radians.
const SOFTENING: f64 = 0.02;

/// Largest subdivision; a finer one would exceed a million patches.
const MOST_SUBDIVISION: usize = 64;

struct Options {
    subdivision: usize,
    color: [f64; 3],
    has_sky: bool,
    sun_in_one: bool,
    has_header: bool,
}

/// Runs the command. `open` receives the text of the sky without its sun.
///
/// # Errors
/// When the arguments or the sky are wrong, or the sky cannot be opened.
pub fn genskyvec(argv: &[String], standard_input: &dyn StandardInput, open: &OpenSky<'_, '_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(argv);
    let options = Options::read(&mut arguments)?;
    let wrong = |mistake: String| Error::Input {
        program: arguments.program().to_owned(),
        source_name: "standard input".to_owned(),
        mistake,
    };
    let description = Description::read(standard_input.bytes()?).map_err(wrong)?;
    let patches = SkyPatches::new(options.subdivision);
    let mut radiances = vec![[0.0; 3]; patches.len()];
    if options.has_sky {
        let [red, green, blue] = options.color;
        let mut sky = description.without_sun;
        let glow = format!("\nskyfunc glow skyglow 0 0 4 {red} {green} {blue} 0\nskyglow source sky 0 0 4 0 0 1 360\n");
        sky.extend_from_slice(glow.as_bytes());
        sample(&mut radiances, options.subdivision, &*open(sky)?);
    }
    if let Some(sun) = description.sun.filter(|sun| sun.direction[2] > 0.0) {
        match options.sun_in_one {
            true => radiances[patches.nearest(sun.direction, 1)[0].1] = sun.radiance,
            false => sun.distribute(&mut radiances, &patches),
        }
    }
    let mut text = Text::default();
    if options.has_header {
        writeln!(text, "#?RADIANCE\n{}", argv.join(" ").replace(['\n', '\r'], " "))?;
        writeln!(text, "NROWS={}\nNCOLS=1\nNCOMP=3\nFORMAT=ascii\n", patches.len())?;
    }
    for radiance in radiances {
        let [red, green, blue] = radiance.map(|value| general(value, 9));
        writeln!(text, "{red}\t{green}\t{blue}")?;
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

impl Options {
    fn read(arguments: &mut Arguments<'_>) -> Result<Options, Error> {
        let mut options =
            Options { subdivision: 4, color: SKY_COLOR, has_sky: true, sun_in_one: false, has_header: true };
        while let Some(option) = arguments.last_options()? {
            match option.name {
                "-c" => {
                    let names = ["red (-c)", "green (-c)", "blue (-c)"];
                    for (value, name) in options.color.iter_mut().zip(names) {
                        *value = arguments.number(name)?;
                    }
                }
                "-m" => {
                    let position = arguments.position();
                    options.subdivision = arguments.count("subdivision (-m)")?;
                    if options.subdivision > MOST_SUBDIVISION {
                        let mistake =
                            format!("subdivision (-m) is {}, expected at most {MOST_SUBDIVISION}", options.subdivision);
                        return Err(arguments.mistake(position, mistake));
                    }
                }
                "-d" => options.has_sky = false,
                "-5" => options.sun_in_one = true,
                "-h" => options.has_header = false,
                _ => return Err(arguments.unknown()),
            }
        }
        Ok(options)
    }
}

/// The parsed sky description.
struct Description {
    without_sun: Vec<u8>,
    sun: Option<Sun>,
}

struct Sun {
    /// Direction towards the sun, as written.
    direction: [f64; 3],
    /// Angular diameter, degrees.
    angle: f64,
    /// Radiance of the sun, W/(sr·m²).
    radiance: [f64; 3],
}

impl Description {
    fn read(bytes: &[u8]) -> Result<Description, String> {
        let mut words = SceneWords::new(bytes);
        let (mut light, mut sun, mut has_sky) = (None, None, false);
        while let Some(first) = words.peek() {
            if first == b'#' {
                words.line();
                continue;
            }
            let begin = words.position();
            if first == b'!' {
                return Err(
                    "a line is a command, expected scene text without commands; expand it with \"xform\"".to_owned()
                );
            }
            let primitive =
                Primitive::read(&mut words).ok_or("a primitive is incomplete, expected a sky from \"gensky\"")?;
            has_sky |= primitive.name == "skyfunc";
            match (primitive.kind.as_str(), &primitive.numbers[..]) {
                ("light", &[red, green, blue]) => light = Some((primitive.name, [red, green, blue])),
                ("source", &[x, y, z, angle]) => {
                    if let Some((_, radiance)) = light.as_ref().filter(|(name, _)| *name == primitive.modifier) {
                        let found = Sun { direction: [x, y, z], angle, radiance: *radiance };
                        sun = Some((begin..words.position(), found));
                    }
                }
                _ => {}
            }
        }
        if !has_sky {
            return Err("\"skyfunc\" is missing, expected a sky from \"gensky\" or \"gendaylit\"".to_owned());
        }
        let mut without_sun = bytes.to_vec();
        let sun = sun.map(|(range, sun)| {
            without_sun.drain(range);
            sun
        });
        Ok(Description { without_sun, sun })
    }
}

struct Primitive {
    modifier: String,
    kind: String,
    name: String,
    numbers: Vec<f64>,
}

impl Primitive {
    /// `None` if the primitive is incomplete.
    fn read(words: &mut SceneWords<'_>) -> Option<Primitive> {
        let [modifier, kind, name] = [words.word()?, words.word()?, words.word()?];
        let mut numbers = Vec::new();
        if kind == "alias" {
            words.word()?;
            return Some(Primitive { modifier, kind, name, numbers });
        }
        for is_number in [false, false, true] {
            for _ in 0..words.count()? {
                if is_number {
                    numbers.push(words.number()?);
                } else {
                    words.word()?;
                }
            }
        }
        Some(Primitive { modifier, kind, name, numbers })
    }
}

/// Averages each patch over the directions that Radiance's script uses.
fn sample(radiances: &mut [[f64; 3]], subdivision: usize, environment: &EnvironmentRadiance<'_>) {
    let sky = SkyDivision::new(subdivision as u32);
    let mut number = 0.0;
    for (patch, radiance) in (0..).zip(radiances) {
        for _ in 0..SAMPLES {
            number += 1.0;
            let [up, around] = [random(number * 0.37 - 5.3), random(number * -1.47 + 0.86)];
            let [altitude, azimuth] = if patch == 0 {
                [-up.asin(), 2.0 * PI * around]
            } else {
                let (row, column) = sky.row_and_column(patch - 1);
                // The upper half of the zenith's row lies beyond the zenith.
                let altitude = (f64::from(row) + up) * sky.row_height();
                [altitude, (column as f64 + around - 0.5) * 2.0 * PI / sky.columns(row) as f64]
            };
            let found = environment(towards(altitude, azimuth));
            radiance.iter_mut().zip(found).for_each(|(sum, value)| *sum += value / f64::from(SAMPLES));
        }
    }
}

impl Sun {
    /// Adds the sun to the nearest patches.
    fn distribute(&self, radiances: &mut [[f64; 3]], patches: &SkyPatches) {
        let solid_angle = PI * (0.5 * self.angle.to_radians()).powi(2);
        let weight = |cosine: f64| 1.0 / (cosine.min(1.0).acos() + SOFTENING);
        let nearest = patches.nearest(self.direction, SHARERS);
        let weights: f64 = nearest.iter().map(|(cosine, _)| weight(*cosine)).sum();
        for (cosine, patch) in nearest {
            let share = solid_angle / patches.solid_angle(patch) * weight(cosine) / weights;
            radiances[patch].iter_mut().zip(self.radiance).for_each(|(value, sun)| *value += share * sun);
        }
    }
}
