//! Scenes of any size, written as text.

use crate::error::BenchError;
use glam::Vec3;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// A unit square under a uniform grid of small lights.
pub(super) fn floor_under_lights(folder: &Path, lights: u32) -> Result<PathBuf, BenchError> {
    let mut text = "void plastic floor 0 0 5 .5 .5 .5 0 0\nfloor polygon square 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n\
        void light lamp 0 0 3 100 100 100\n"
        .to_owned();
    let side = f64::from(lights).sqrt().ceil() as u32;
    for light in 0..lights {
        let [x, y] = [light % side, light / side].map(|place| (f64::from(place) + 0.5) / f64::from(side));
        let _ = writeln!(text, "lamp sphere lamp.{light} 0 0 4 {x} {y} .3 {}", 0.1 / f64::from(side));
    }
    write(folder, "lights.rad", text.as_bytes())
}

/// Streams of one ray and of `count`, from above down to the floor, in single precision.
pub(super) fn rays_to_the_floor(folder: &Path, count: usize) -> Result<[PathBuf; 2], BenchError> {
    let side = count.isqrt();
    let ray = |index: usize| {
        let [x, y] = [index % side, index / side].map(|place| (place as f32 + 0.4) / side as f32);
        [Vec3::new(x, y, 0.1), Vec3::NEG_Z]
    };
    let stream = |count: usize| -> Vec<u8> {
        (0..count).flat_map(ray).flat_map(|vector| vector.to_array()).flat_map(f32::to_ne_bytes).collect()
    };
    Ok([write(folder, "one.f32", &stream(1))?, write(folder, "all.f32", &stream(count))?])
}

const ROOM: &str = "void plastic white 0 0 5 .7 .7 .7 0 0
void plastic shiny 0 0 5 .4 .2 .2 .05 .1
void light lamp 0 0 3 15 15 15
white polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0
white polygon ceiling 0 0 12 0 0 3 0 4 3 4 4 3 4 0 3
white polygon back 0 0 12 0 4 0 4 4 0 4 4 3 0 4 3
white polygon left 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3
white polygon right 0 0 12 4 0 0 4 0 3 4 4 3 4 4 0
lamp polygon window 0 0 12 1.5 1.5 2.99 1.5 2.5 2.99 2.5 2.5 2.99 2.5 1.5 2.99
shiny sphere ball 0 0 4 2.6 2.4 .7 .7
!genbox shiny box .8 .8 1.2 | xform -rz 20 -t .8 2 0
";

pub(super) const ROOM_VIEW: [&str; 13] =
    ["-vtv", "-vp", "2", "-3", "1.5", "-vd", "0", "1", "0", "-vh", "45", "-vv", "45"];

/// A room with a ball and a box under a lamp.
pub(super) fn room(folder: &Path) -> Result<PathBuf, BenchError> {
    write(folder, "room.rad", ROOM.as_bytes())
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> Result<PathBuf, BenchError> {
    let path = folder.join(name);
    fs::write(&path, bytes).map_err(|reason| BenchError::Write { path: path.clone(), reason })?;
    Ok(path)
}
