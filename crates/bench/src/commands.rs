//! `radsight-bench commands`: published `rpict` commands, unchanged, with real Radiance.
//!
//! A folder has a script `run.sh` that makes octrees and pictures. It is run once with each
//! program's `oconv` and with an `rpict` that only records its calls; then each program renders
//! every picture. The truth is a picture of independent paths with many rays per pixel, without a
//! cache or interpolation.

use crate::args::Commands;
use crate::error::BenchError;
use crate::machine;
use crate::radiance::Radiance;
use crate::radsight::Radsight;
use crate::table::Table;
use crate::taken::{Taken, taken};
use radsight_picture::read_image;
use radsight_units::color::LUMINANCE_WEIGHTS;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Smallest time that can be measured, s.
const MIN_TIME: f64 = 0.1;

/// Side of the compared blocks, pixels, and their tolerance.
const BLOCK: usize = 8;
const NEAR: f64 = 0.05;

/// Luminances below this share of the median are raised to it in relative errors.
const DARK_FRACTION: f64 = 0.01;

/// A recorded call of `rpict`.
#[derive(Debug)]
struct Call {
    folder: PathBuf,
    words: Vec<String>,
}

/// The error of a picture relative to the truth.
#[derive(Clone, Copy, Debug)]
struct Nearness {
    /// Share of blocks within [`NEAR`].
    blocks: f64,
    /// Rms of the blocks' relative errors.
    error: f64,
}

/// Measures all scripts and prints a table.
pub(crate) fn run(arguments: &Commands) -> Result<(), BenchError> {
    let folder = tempfile::tempdir().map_err(|reason| BenchError::Temporary { reason })?;
    let radsight = Radsight::find();
    let radiance = Radiance::find().map_err(|reason| BenchError::Read { path: PathBuf::from("Radiance"), reason })?;
    print(&machine::describe(&radsight, &Ok(radiance.version().to_owned())));
    let shims = Shims::make(&radsight, folder.path())?;
    let mut table = Table::new(
        &[
            "picture",
            "real s",
            "radsight s",
            "ratio",
            "real blocks %",
            "radsight blocks %",
            "real rms %",
            "radsight rms %",
        ],
        1,
    );
    let mut ratios = Vec::new();
    for (number, scripts) in arguments.folders.iter().enumerate() {
        let place = folder.path().join(number.to_string());
        copy(scripts, &place)?;
        let calls = ["real", "radsight"].map(|program| shims.calls(&radiance, &place, program));
        let [real, own] = calls;
        for (index, (real, own)) in real?.iter().zip(&own?).enumerate() {
            let file = |name: &str| place.join(format!("{index}.{name}"));
            let peer = rpict(radiance.command("rpict").args(&real.words), real, &radiance, &file("real.hdr"))?;
            let ours = rpict(radsight.command(&["rpict"]).args(&own.words), own, &radiance, &file("radsight.hdr"))?;
            let truth = truth_words(&own.words, arguments.truth);
            rpict(radsight.command(&["rpict"]).args(&truth), own, &radiance, &file("truth.hdr"))?;
            let truth = luminances(&file("truth.hdr"))?;
            let [peer_near, own_near] =
                ["real.hdr", "radsight.hdr"].map(|name| luminances(&file(name)).map(|picture| near(&picture, &truth)));
            let (peer_near, own_near) = (peer_near?, own_near?);
            let ratio = ours.processor / peer.processor.max(MIN_TIME);
            ratios.push(ratio);
            let name = scripts.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            table.push(vec![
                format!("{name} {}", index + 1),
                format!("{:.2}", peer.processor),
                format!("{:.2}", ours.processor),
                format!("{ratio:.2}"),
                format!("{:.1}", 100.0 * peer_near.blocks),
                format!("{:.1}", 100.0 * own_near.blocks),
                format!("{:.1}", 100.0 * peer_near.error),
                format!("{:.1}", 100.0 * own_near.error),
            ]);
        }
    }
    let mean = (ratios.iter().map(|ratio| ratio.max(1e-3).ln()).sum::<f64>() / ratios.len().max(1) as f64).exp();
    print(&format!(
        "\n{}\ngeometric mean of {} ratios (times below {MIN_TIME} s count as that): {mean:.2}\n",
        table.to_text(),
        ratios.len()
    ));
    Ok(())
}

/// Wrappers that precede other programs in PATH while a script runs.
struct Shims {
    /// For `rpict` alone, and for radsight's other programs.
    folders: [PathBuf; 2],
}

impl Shims {
    fn make(radsight: &Radsight, folder: &Path) -> Result<Shims, BenchError> {
        let folders = ["real", "radsight"].map(|name| folder.join(format!("{name}-programs")));
        let program = radsight.command(&[]).get_program().to_string_lossy().into_owned();
        for (number, folder) in folders.iter().enumerate() {
            make_folder(folder)?;
            script(
                &folder.join("rpict"),
                "n=$(ls \"$CALLS\" | wc -l)\nmkdir \"$CALLS/$n\"\npwd > \"$CALLS/$n/folder\"\nprintf '%s\\n' \"$@\" > \"$CALLS/$n/words\"",
            )?;
            if number == 1 {
                for name in ["xform", "getbbox"] {
                    script(&folder.join(name), &format!("exec '{program}' {name} \"$@\""))?;
                }
                // The scripts' own commands are trusted.
                script(&folder.join("oconv"), &format!("exec '{program}' oconv --allow-commands \"$@\""))?;
            }
        }
        Ok(Shims { folders })
    }

    /// The calls of `rpict` by a script, with the octrees of one of the programs.
    fn calls(&self, radiance: &Radiance, place: &Path, program: &str) -> Result<Vec<Call>, BenchError> {
        let (calls, made) = (place.join(format!("{program}-calls")), place.join(format!("{program}-made")));
        make_folder(&calls)?;
        make_folder(&made)?;
        let mut path = vec![self.folders[usize::from(program == "radsight")].clone()];
        let probe = radiance.command("rpict");
        let known =
            probe.get_envs().find(|(name, _)| *name == "PATH").and_then(|(_, value)| value.map(ToOwned::to_owned));
        path.extend(known.or_else(|| std::env::var_os("PATH")).iter().flat_map(std::env::split_paths));
        let path = std::env::join_paths(path).map_err(|error| read_error(place, error.to_string()))?;
        let mut command = Command::new("sh");
        command.arg("run.sh").current_dir(place).env("PATH", path).env("CALLS", &calls).env("OUT", &made);
        command.env("RADLIB", library(radiance));
        let done = command.output().map_err(|error| read_error(&place.join("run.sh"), error.to_string()))?;
        if !done.status.success() {
            let message = String::from_utf8_lossy(&done.stderr).into_owned();
            return Err(BenchError::Failed { command: "run.sh".to_owned(), status: done.status, message });
        }
        let mut found = Vec::new();
        while let Ok(folder) = fs::read_to_string(calls.join(format!("{}/folder", found.len()))) {
            let words = read(&calls.join(format!("{}/words", found.len())))?;
            let words = String::from_utf8_lossy(&words).lines().map(str::to_owned).collect();
            found.push(Call { folder: PathBuf::from(folder.trim_end()), words });
        }
        Ok(found)
    }
}

/// The folder with real Radiance's function files.
fn library(radiance: &Radiance) -> PathBuf {
    let command = radiance.command("rpict");
    let path = command.get_envs().find(|(name, _)| *name == "RAYPATH").and_then(|(_, value)| value);
    path.and_then(|path| std::env::split_paths(path).last()).unwrap_or_else(|| PathBuf::from("."))
}

/// The same picture by independent paths.
fn truth_words(words: &[String], samples: u32) -> Vec<String> {
    let (octree, options) = words.split_last().map_or((None, words), |(last, rest)| (Some(last.clone()), rest));
    let further = ["-aa", "0", "-ff", "-pj", "1", "-lr", "-16", "-lw", "1e-6", "-st", "0", "--samples"];
    let further = further.iter().map(|word| (*word).to_owned()).chain([samples.to_string()]);
    options.iter().cloned().chain(further).chain(octree).collect()
}

fn rpict(command: &mut Command, call: &Call, radiance: &Radiance, output: &Path) -> Result<Taken, BenchError> {
    let path = [Path::new("."), Path::new("lib"), &library(radiance)].map(Path::to_owned);
    if let Ok(path) = std::env::join_paths(path) {
        command.env("RAYPATH", path);
    }
    taken(command, &call.folder, None, Some(output))
}

/// Columns, and the luminance of each pixel.
fn luminances(path: &Path) -> Result<(usize, Vec<f64>), BenchError> {
    let image = read_image(&read(path)?).map_err(|error| read_error(path, error.to_string()))?.image;
    let luminance =
        |pixel: &[f32]| LUMINANCE_WEIGHTS.iter().zip(pixel).map(|(weight, value)| weight * f64::from(*value)).sum();
    Ok((image.width(), image.data().chunks(image.components()).map(luminance).collect()))
}

/// Compares the means of blocks.
fn near((columns, picture): &(usize, Vec<f64>), (_, truth): &(usize, Vec<f64>)) -> Nearness {
    let mut lit: Vec<f64> = truth.iter().copied().filter(|value| *value > 0.0).collect();
    lit.sort_by(f64::total_cmp);
    let dark = DARK_FRACTION * lit.get(lit.len() / 2).copied().unwrap_or(0.0);
    let rows = picture.len().min(truth.len()) / columns.max(&1);
    let (mut count, mut close, mut squares) = (0.0, 0.0, 0.0);
    for top in (0..(rows / BLOCK) * BLOCK).step_by(BLOCK) {
        for left in (0..(columns / BLOCK) * BLOCK).step_by(BLOCK) {
            let mean = |pixels: &[f64]| {
                let pixel = |at: usize| pixels[(top + at / BLOCK) * columns + left + at % BLOCK];
                (0..BLOCK * BLOCK).map(pixel).sum::<f64>() / (BLOCK * BLOCK) as f64
            };
            let expected = mean(truth);
            let error = (mean(picture) - expected) / (expected + dark).max(f64::MIN_POSITIVE);
            count += 1.0;
            close += f64::from(u8::from(error.abs() < NEAR));
            squares += error.powi(2).min(1.0);
        }
    }
    let count = f64::max(count, 1.0);
    Nearness { blocks: close / count, error: (squares / count).sqrt() }
}

fn read_error(path: &Path, reason: String) -> BenchError {
    BenchError::Read { path: path.to_owned(), reason }
}

fn read(path: &Path) -> Result<Vec<u8>, BenchError> {
    fs::read(path).map_err(|error| read_error(path, error.to_string()))
}

fn write_error(path: &Path) -> impl Fn(std::io::Error) -> BenchError + use<> {
    let path = path.to_owned();
    move |reason| BenchError::Write { path: path.clone(), reason }
}

fn make_folder(path: &Path) -> Result<(), BenchError> {
    fs::create_dir_all(path).map_err(write_error(path))
}

fn script(path: &Path, text: &str) -> Result<(), BenchError> {
    fs::write(path, format!("#!/bin/sh\n{text}\n")).map_err(write_error(path))?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).map_err(write_error(path))?;
    }
    Ok(())
}

/// Copies a folder recursively.
fn copy(from: &Path, to: &Path) -> Result<(), BenchError> {
    make_folder(to)?;
    let entries = fs::read_dir(from).map_err(|error| read_error(from, error.to_string()))?;
    for entry in entries.filter_map(Result::ok) {
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        if source.is_dir() {
            copy(&source, &target)?;
        } else {
            fs::copy(&source, &target).map_err(write_error(&target))?;
        }
    }
    Ok(())
}

fn print(text: &str) {
    // A closed pipe is success.
    let _ = std::io::stdout().write_all(text.as_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearness_counts_blocks_and_their_error() {
        let truth = (16, vec![1.0; 256]);
        let mut picture = truth.clone();
        (0..8).for_each(|row| picture.1[16 * row..16 * row + 8].fill(1.5));
        let found = near(&picture, &truth);
        assert_eq!(found.blocks, 0.75);
        assert!((found.error - 0.25 / 1.01).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn the_truth_keeps_the_octree_last() {
        let words = ["-ab", "1", "a.oct"].map(str::to_owned);
        let truth = truth_words(&words, 64);
        assert_eq!((truth.first().unwrap().as_str(), truth.last().unwrap().as_str()), ("-ab", "a.oct"));
        assert!(truth.ends_with(&["--samples".to_owned(), "64".to_owned(), "a.oct".to_owned()]));
    }
}
