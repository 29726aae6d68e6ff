//! Our own `rpict`.

use super::program::{Program, Series, Setting, Team, read_picture};
use super::scene::{Light, Scene};
use crate::error::BenchError;
use crate::radsight::Radsight;
use crate::taken::{Taken, taken};
use radsight_picture::Image;
use std::path::Path;
use std::process::Command;

/// `radsight rpict`.
#[derive(Debug)]
pub(crate) struct Own {
    pub(crate) radsight: Radsight,
}

/// Independent paths: one ray per light sample, without a cache, and so unbiased.
const PATHS: &str = "-aa 0 -ad 1";

impl Own {
    /// An unbiased picture with a given seed.
    pub(crate) fn unbiased(
        &self,
        scene: &Scene,
        samples: u32,
        seed: u32,
        folder: &Path,
    ) -> Result<(Taken, Image<f32>), BenchError> {
        let setting = Setting::of("", &format!("{PATHS} --samples {samples} --seed {seed}"), samples);
        self.render(scene, &setting, folder)
    }
}

impl Program for Own {
    fn team(&self) -> Team {
        Team::Radsight
    }

    fn name(&self) -> String {
        "radsight".to_owned()
    }

    fn series(&self, scene: &Scene) -> Vec<Series> {
        let samples = |options: &str| {
            let setting = |rays: u32| Setting::of(format!("{rays} rays"), &format!("{options} --samples {rays}"), rays);
            [1, 4, 16, 64, 256, 1024].map(setting).to_vec()
        };
        let errors = |options: &str| {
            let setting =
                |error: &f64| Setting::of(format!("--error {error}"), &format!("{options} --error {error}"), 0);
            [0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002].iter().map(setting).collect()
        };
        let series = |name: &str, unbiased: bool, settings| Series { name: name.to_owned(), unbiased, settings };
        match scene.light {
            Light::Direct => vec![series("samples", true, samples("")), series("error", false, errors(""))],
            Light::Indirect => vec![series("paths", true, samples(PATHS)), series("error", false, errors(""))],
        }
    }

    fn prepare(&mut self, _: &Scene, _: &Path) -> Result<(), BenchError> {
        Ok(())
    }

    fn reading(&self, scene: &Scene) -> Option<Command> {
        let mut command = self.radsight.command(&["rtrace", "-h"]);
        command.args(&scene.task).args(&scene.own_task).args(&scene.files);
        Some(command)
    }

    fn render(&self, scene: &Scene, setting: &Setting, folder: &Path) -> Result<(Taken, Image<f32>), BenchError> {
        let output = folder.join("own.floats");
        let mut command = self.radsight.command(&["rpict", "-w-", "-ff", "-pj", "1"]);
        command.args(scene.frame()).args(&scene.task).args(&scene.own_task).args(&setting.options).args(&scene.files);
        scene.place(&mut command);
        let taken = taken(&mut command, &scene.folder, None, Some(&output))?;
        Ok((taken, read_picture(&output)?))
    }
}
