//! Small scenes, one a primitive type, argument variant or option.
//!
//! A case is a scene file in `cases` whose first lines say how it is looked at:
//!
//! ```text
//! #@ view -vp 0 -3 1 -vd 0 1 -.2 -vh 40 -vv 40    (else the usual one)
//! #@ options -ab 1                                (options for both programs)
//! #@ real -ds .01                                 (options for real Radiance, to make it converge)
//! #@ samples 256                                  (rays a pixel of ours)
//! #@ instead lib/other.rad                        (the scene of the reference, where real Radiance only approximates the other)
//! ```
//!
//! Files that a scene names stand in `cases/lib`. The reference is the mean of many rays a pixel of
//! real `rtrace`, told to integrate, and the standard error of each mean.

use crate::blocks::{Agreement, Noise};
use crate::commands::radiance_values;
use crate::program::{Folder, command, finish_command, root, run_with};
use crate::{pictures_folder, side_by_side};
use radsight_picture::{Header, Image, Picture};
use radsight_test_support::Radiance;
use rayon::prelude::*;
use std::fs;
use std::path::PathBuf;

/// Pixels a side.
const SIDE: usize = 32;

/// Pixels a side of a block.
const BLOCK: usize = 4;

/// Rays a pixel of a reference.
const REFERENCE_RAYS: usize = 64;

const USUAL_VIEW: &str = "-vp 2.2 -3.2 1.9 -vd -2.2 3.2 -1.4 -vu 0 0 1 -vh 36 -vv 36";

/// Real `rtrace` told to integrate: lights in small pieces, all of them tested, highlights sampled,
/// nothing cached.
const INTEGRATE: &str = "-ds .02 -dj 1 -dt 0 -dc 1 -ss 1 -st 0 -aa 0 -ad 1 -lr -12 -lw 1e-5";

struct Case {
    name: String,
    view: String,
    options: String,
    real: String,
    samples: String,
    instead: String,
}

impl Case {
    fn read(name: &str) -> Case {
        let text = fs::read_to_string(folder().join(format!("{name}.rad"))).expect("a case");
        let said = |key: &str, usual: &str| {
            let prefix = format!("#@ {key} ");
            text.lines().find_map(|line| line.strip_prefix(&prefix)).unwrap_or(usual).trim().to_owned()
        };
        Case {
            name: name.to_owned(),
            view: said("view", USUAL_VIEW),
            options: said("options", ""),
            real: said("real", ""),
            samples: said("samples", "64"),
            instead: said("instead", &format!("{name}.rad")),
        }
    }

    fn all() -> Vec<Case> {
        let mut names: Vec<String> = fs::read_dir(folder())
            .expect("the cases")
            .filter_map(|entry| {
                entry.expect("an entry").file_name().to_string_lossy().strip_suffix(".rad").map(str::to_owned)
            })
            .collect();
        names.sort();
        names.iter().map(|name| Case::read(name)).collect()
    }

    fn scene(&self) -> String {
        format!("{}.rad", self.name)
    }

    /// Mean and standard error, both pictures.
    fn reference(&self) -> Option<[Image<f32>; 2]> {
        let read = |kind: &str| fs::read(self.reference_path(kind)).ok().map(|bytes| radiance_values(&bytes));
        Some([read("mean")?, read("error")?])
    }

    fn reference_path(&self, kind: &str) -> PathBuf {
        root().join("tests/conformance/references").join(format!("{}-{kind}.hdr", self.name))
    }

    fn ours(&self) -> Result<Image<f32>, String> {
        let side = SIDE.to_string();
        let mut words = vec!["rpict", "-x", &side, "-y", &side, "-pa", "0", "-pj", "1", "--samples", &self.samples];
        words.extend(["-st", "0"]);
        words.extend(self.view.split_whitespace().chain(self.options.split_whitespace()));
        let scene = self.scene();
        words.push(&scene);
        let mut command = command(&words);
        let run = finish_command(command.env("RAYPATH", ".:lib").current_dir(folder()));
        if run.code == 0 { Ok(radiance_values(&run.output)) } else { Err(run.messages) }
    }

    /// Real Radiance's mean and standard error.
    fn real(&self, radiance: &Radiance) -> Result<[Image<f32>; 2], String> {
        let place = Folder::new();
        let octree = place.word("case.oct");
        let font = root().join("crates/formats/library");
        let raypath = format!(".:lib:{}:{}", font.display(), radiance.raypath());
        let mut oconv = radiance.command("oconv", &[&self.instead]);
        let built = finish_command(oconv.env("RAYPATH", &raypath).current_dir(folder()));
        assert_eq!(built.code, 0, "{}: {}", self.name, built.messages);
        fs::write(&octree, &built.output).expect("the octree is written");
        let (side, rays) = (SIDE.to_string(), REFERENCE_RAYS.to_string());
        let mut words = vec!["-ff", "-x", &side, "-y", &side, "-pa", "0", "-c", &rays, "-pj", "1"];
        words.extend(self.view.split_whitespace());
        let rays = finish_command(&mut radiance.command("vwrays", &words)).done();
        let mut words = vec!["-h", "-w", "-ff", "-n", "2"];
        words.extend(INTEGRATE.split_whitespace());
        words.extend(self.options.split_whitespace().chain(self.real.split_whitespace()));
        words.push(&octree);
        let mut rtrace = radiance.command("rtrace", &words);
        let traced = run_with(rtrace.env("RAYPATH", &raypath).current_dir(folder()), &rays);
        let values = traced.output;
        let values: Vec<f32> =
            values.chunks_exact(4).map(|bytes| f32::from_le_bytes(bytes.try_into().expect("four bytes"))).collect();
        if traced.code != 0 || values.len() != SIDE * SIDE * REFERENCE_RAYS * 3 {
            return Err(traced.messages);
        }
        Ok(mean_and_error(&values))
    }
}

fn folder() -> PathBuf {
    root().join("tests/conformance/cases")
}

fn mean_and_error(values: &[f32]) -> [Image<f32>; 2] {
    let count = REFERENCE_RAYS as f64;
    let mut both = [Vec::new(), Vec::new()];
    for pixel in values.chunks(3 * REFERENCE_RAYS) {
        for band in 0..3 {
            let of_band = || pixel.iter().skip(band).step_by(3).map(|value| f64::from(*value));
            let mean = of_band().sum::<f64>() / count;
            let variance = of_band().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
            both[0].push(mean as f32);
            both[1].push((variance / count).sqrt() as f32);
        }
    }
    both.map(|data| Image::new(SIDE, SIDE, 3, data).expect("a picture"))
}

fn wanted(case: &Case) -> bool {
    std::env::var("RADSIGHT_ONLY").map_or(true, |only| only.split(',').any(|part| case.name.contains(part)))
}

/// `RADSIGHT_AGAIN=1` makes those that exist again.
#[test]
#[ignore = "makes the references that are missing, with real Radiance"]
fn make_references() {
    let Some(radiance) = Radiance::find() else { return };
    let again = std::env::var_os("RADSIGHT_AGAIN").is_some();
    let mut failed = Vec::new();
    for case in Case::all().iter().filter(|case| wanted(case)) {
        if case.reference().is_some() && !again {
            continue;
        }
        println!("{}", case.name);
        let images = match case.real(&radiance) {
            Ok(images) => images,
            Err(messages) => {
                failed.push(format!("{}: {messages}", case.name));
                continue;
            }
        };
        for (image, kind) in images.iter().zip(["mean", "error"]) {
            let picture = Picture::from_rgb(Header::new("RADIANCE"), image).expect("a picture");
            fs::write(case.reference_path(kind), picture.to_bytes()).expect("the reference is written");
        }
    }
    assert!(failed.is_empty(), "real Radiance stopped: {failed:#?}");
}

#[test]
fn small_scenes_agree_with_real_radiance() {
    let cases: Vec<Case> = Case::all().into_iter().filter(wanted).collect();
    assert!(!cases.is_empty(), "there are cases");
    let lines: Vec<Result<String, String>> = cases.par_iter().map(compare).collect();
    for line in &lines {
        println!("{}", line.as_ref().unwrap_or_else(|line| line));
    }
    let failed: Vec<&String> = lines.iter().filter_map(|line| line.as_ref().err()).collect();
    assert!(failed.is_empty(), "{} of {} do not agree:\n{failed:#?}", failed.len(), lines.len());
}

/// A line of the table; an error for what does not agree.
fn compare(case: &Case) -> Result<String, String> {
    let name = &case.name;
    let Some([expected, noise]) = case.reference() else { return Err(format!("{name}: has no reference")) };
    let actual = case.ours().map_err(|messages| format!("{name}: {messages}"))?;
    // Our picture has noise of its own, as much as a reference of so many rays.
    let samples: f64 = case.samples.parse().expect("a number of rays");
    let both = (1.0 + REFERENCE_RAYS as f64 / samples).sqrt() as f32;
    let noise = noise.map(|error| error * both);
    let agreement = Agreement::new(&actual, &expected, Noise::OfValues(&noise), BLOCK);
    if agreement.is_good() {
        return Ok(format!("{name:32} {agreement}"));
    }
    let path = side_by_side::write(&pictures_folder(), name, &actual, &expected);
    Err(format!("{name:32} {agreement}, see {}", path.display()))
}
