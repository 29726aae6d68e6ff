//! Real Radiance: `rtrace` with two processes, whose rays per pixel are averaged here, and `rpict`,
//! whose pixels are averaged.

use super::program::{Program, Series, Setting, Team, read_picture};
use super::scene::{Light, Scene, words};
use crate::cost::measure;
use crate::error::BenchError;
use crate::figure::read;
use crate::radiance::Radiance;
use crate::taken::{Taken, taken_within};
use radsight_picture::Image;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Larger numbers of rays per pixel are traced in batches, so that files stay small.
const RAYS_AT_ONCE: u32 = 256;

const HINT: &str = "; RADSIGHT_RADIANCE names a folder with bin and lib";

/// One jittered shadow ray to every light, none estimated: unbiased, and cheap for many rays. The
/// specular threshold (`-st`) keeps its default, as in ours.
pub(crate) const UNBIASED: &str = "-dt 0 -ds 0 -dj 1 -aa 0 -ad 1 -as 0";

/// Common options with a cache.
const SOFT: &str = "-dt .05 -ds .2 -dj 1";

/// Common options for pictures.
const INTERPOLATED: &str = "-ps 4 -pt .04 -ds .1 -dj .9 -dt .05";

/// Real `rtrace`, or real `rpict`.
#[derive(Debug)]
pub(crate) struct Real<'a> {
    pub(crate) radiance: &'a Radiance,
    pub(crate) kind: RealKind,
    /// Limit of processor time of a process, seconds.
    limit: u64,
    /// Options of the last prepared scene.
    octree: PathBuf,
}

/// A program of Radiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RealKind {
    Rtrace,
    Rpict,
}

/// The rays of a picture: the mean of each pixel, and the standard error of each mean.
#[derive(Clone, Debug)]
pub(crate) struct Traced {
    pub(crate) taken: Taken,
    pub(crate) mean: Image<f32>,
    pub(crate) error: Image<f32>,
}

impl<'a> Real<'a> {
    pub(crate) fn new(radiance: &'a Radiance, kind: RealKind, limit: u64) -> Real<'a> {
        Real { radiance, kind, limit, octree: PathBuf::new() }
    }

    /// Traces a number of rays per pixel through `rtrace`, each at a random position of the pixel.
    pub(crate) fn trace(
        &self,
        scene: &Scene,
        options: &[String],
        rays: u32,
        folder: &Path,
    ) -> Result<Traced, BenchError> {
        let [input, output] = ["rays", "radiance"].map(|name| folder.join(name));
        let values = scene.size[0] * scene.size[1] * 3;
        let (mut sums, mut squares) = (vec![0.0; values], vec![0.0; values]);
        let mut total = Taken { processor: 0.0, wall: 0.0, peak: 0.0 };
        let mut left = rays;
        while left > 0 {
            let now = left.min(RAYS_AT_ONCE);
            left -= now;
            let mut make_rays = self.radiance.command("vwrays");
            make_rays.args(["-ff", "-pj", "1", "-c", &now.to_string()]).args(scene.frame());
            scene.place(&mut make_rays);
            measure(&mut make_rays, None, Some(&input), HINT)?;
            let mut trace = self.radiance.command("rtrace");
            trace.args(["-n", "2", "-h", "-fff"]).args(&scene.task).args(options).arg(&self.octree);
            scene.place(&mut trace);
            let taken = taken_within(Some(self.limit), &mut trace, &scene.folder, (Some(&input), Some(&output)))?;
            total.processor += taken.processor;
            total.wall += taken.wall;
            total.peak = total.peak.max(taken.peak);
            add(&read(&output)?, now as usize, &mut sums, &mut squares);
        }
        let count = f64::from(rays);
        // Pictures hold no negative colour.
        let means: Vec<f32> = sums.iter().map(|sum| (sum / count).max(0.0) as f32).collect();
        let errors = sums.iter().zip(&squares).map(|(sum, square)| {
            let variance = (square - sum * sum / count).max(0.0) / (count - 1.0).max(1.0);
            (variance / count).sqrt() as f32
        });
        Ok(Traced { taken: total, mean: image(scene, means)?, error: image(scene, errors.collect())? })
    }
}

/// Accumulates `rays` values of three floats for each pixel in turn.
fn add(bytes: &[u8], rays: usize, sums: &mut [f64], squares: &mut [f64]) {
    let floats = bytes.as_chunks::<4>().0;
    for (pixel, values) in floats.chunks(3 * rays).enumerate().take(sums.len() / 3) {
        for (at, value) in values.iter().enumerate() {
            let (value, place) = (f64::from(f32::from_ne_bytes(*value)), 3 * pixel + at % 3);
            sums[place] += value;
            squares[place] += value * value;
        }
    }
}

fn image(scene: &Scene, values: Vec<f32>) -> Result<Image<f32>, BenchError> {
    Image::new(scene.size[0], scene.size[1], 3, values)
        .map_err(|error| BenchError::Read { path: "rtrace".into(), reason: error.to_string() })
}

/// Options of the ambient cache with increasing numbers of rays.
const SHARED: [(&str, u32); 7] = [
    ("-aa .3 -ad 64 -as 16", 4),
    ("-aa .25 -ad 128 -as 32", 8),
    ("-aa .2 -ad 256 -as 64", 16),
    ("-aa .15 -ad 512 -as 128", 16),
    ("-aa .1 -ad 1024 -as 256", 32),
    ("-aa .1 -ad 4096 -as 1024", 64),
    ("-aa .05 -ad 4096 -as 1024", 64),
];

impl Program for Real<'_> {
    fn team(&self) -> Team {
        Team::Radiance
    }

    fn name(&self) -> String {
        match self.kind {
            RealKind::Rtrace => "rtrace -n 2".to_owned(),
            RealKind::Rpict => "rpict".to_owned(),
        }
    }

    fn series(&self, scene: &Scene) -> Vec<Series> {
        let rays = |options: &str, most: u32| {
            let counts = [1, 4, 16, 64, 256, 1024].into_iter().filter(|rays| *rays <= most);
            counts.map(|rays| Setting::of(format!("{rays} rays"), options, rays)).collect()
        };
        let series = |name: &str, unbiased: bool, settings| Series { name: name.to_owned(), unbiased, settings };
        match (self.kind, scene.light) {
            (RealKind::Rtrace, Light::Direct) => vec![
                series("unbiased", true, rays(UNBIASED, 1024)),
                series("-dt .05", false, rays("-dt .05 -dc .5 -ds 0 -dj 1", 256)),
                series("-dt .2", false, rays("-dt .2 -dc .25 -ds 0 -dj 1", 256)),
            ],
            (RealKind::Rtrace, Light::Indirect) => {
                let shared = SHARED.map(|(options, rays)| {
                    Setting::of(format!("{options}, {rays} rays"), &format!("{SOFT} {options}"), rays)
                });
                vec![
                    series("unbiased", true, rays(UNBIASED, 1024)),
                    series(&format!("shared {SOFT}"), false, shared.to_vec()),
                ]
            }
            (RealKind::Rpict, light) => {
                let setting = |(options, rays): (&str, u32)| {
                    let options = if light == Light::Direct { "" } else { options };
                    let label = format!("{options} {rays}×{rays} pixels in one");
                    Setting::of(label.trim(), &format!("{INTERPOLATED} {options}"), rays)
                };
                let settings = [(SHARED[1].0, 1), (SHARED[2].0, 2), (SHARED[3].0, 4), (SHARED[5].0, 4)];
                vec![series(INTERPOLATED, false, settings.map(setting).to_vec())]
            }
        }
    }

    fn prepare(&mut self, scene: &Scene, folder: &Path) -> Result<(), BenchError> {
        self.octree = folder.join(format!("{}.oct", scene.name));
        let mut command = self.radiance.command("oconv");
        scene.place(command.args(scene.files_of_radiance()));
        measure(&mut command, None, Some(&self.octree), HINT).map(|_| ())
    }

    fn reading(&self, scene: &Scene) -> Option<Command> {
        let mut command = self.radiance.command("rtrace");
        command.arg("-h").args(&scene.task).arg(&self.octree);
        Some(command)
    }

    fn render(&self, scene: &Scene, setting: &Setting, folder: &Path) -> Result<(Taken, Image<f32>), BenchError> {
        if self.kind == RealKind::Rtrace {
            let traced = self.trace(scene, &setting.options, setting.rays, folder)?;
            return Ok((traced.taken, traced.mean));
        }
        let output = folder.join("rpict.hdr");
        let larger = scene.size.map(|side| side * setting.rays as usize);
        let mut command = self.radiance.command("rpict");
        command.args(&scene.view).args(words(&format!("-x {} -y {} -pa 0 -pj .9", larger[0], larger[1])));
        command.args(&scene.task).args(&setting.options).arg(&self.octree);
        scene.place(&mut command);
        let taken = taken_within(Some(self.limit), &mut command, &scene.folder, (None, Some(&output)))?;
        Ok((taken, shrunk(&read_picture(&output)?, setting.rays as usize, scene)?))
    }
}

/// The means of squares of pixels.
fn shrunk(large: &Image<f32>, side: usize, scene: &Scene) -> Result<Image<f32>, BenchError> {
    let [columns, rows] = scene.size;
    let mut values = vec![0.0; columns * rows * 3];
    for (y, row) in large.rows().enumerate().take(rows * side) {
        for (at, value) in row.iter().enumerate().take(columns * side * 3) {
            values[(y / side * columns + at / 3 / side) * 3 + at % 3] += value / (side * side) as f32;
        }
    }
    image(scene, values)
}
