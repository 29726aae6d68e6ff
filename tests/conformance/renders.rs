//! Compares Radiance's own render tests with pictures of real Radiance.

use crate::blocks::{Agreement, Noise};
use crate::commands::{Reference, Scenes, oracle, radiance_values, repeats};
use crate::{exceptions, pictures_folder, shared, side_by_side};
use radsight_test_support::Radiance;
use std::fs;
use std::path::{Path, PathBuf};

/// Renders all pictures. `RADSIGHT_RPICT="--samples 16"` adds these words to each command. Our
/// pictures are kept for [`crate::truth`].
#[test]
#[ignore = "renders for minutes; run with --ignored --nocapture, in release"]
fn radiance_render_tests() {
    let (Some(shared), Some(radiance)) = (shared(), Radiance::find()) else { return };
    let mut scenes = Scenes::new(&shared, &radiance);
    let asked = std::env::var("RADSIGHT_RPICT").unwrap_or_default();
    let mut failed = Vec::new();
    for reference in Reference::all(&shared) {
        scenes.build(&reference);
        let name = &reference.name;
        let before = processor_time();
        let run = scenes.ours(&reference.words(&asked), None);
        let seconds = processor_time() - before;
        if run.code != 0 {
            println!("{name:16} failed: {}", run.messages.lines().next().unwrap_or_default());
            failed.push(name.clone());
            continue;
        }
        let actual = radiance_values(&run.output);
        side_by_side::write(&pictures_folder(), &format!("renders-{name}"), &actual, &reference.picture);
        fs::write(reference.our_path(), &run.output).expect("the picture is written");
        let repeats = oracle().map_or_else(Vec::new, |folder| repeats(&folder, &reference));
        let noise = Noise::of(&repeats);
        let agreement = Agreement::new(&actual, &reference.picture, noise, 8);
        let good = match (agreement.is_good(), exceptions::shown(name)) {
            (true, _) => "good",
            (false, Some(_)) => "the reference is off",
            (false, None) => "BAD",
        };
        let itself = repeats.first().map(|again| Agreement::new(again, &reference.picture, noise, 8));
        println!("| `{name}` | {} | {good}", row(&agreement, itself.as_ref(), [seconds, seconds_of_real(&reference)]));
        if good == "BAD" {
            failed.push(name.clone());
        }
    }
    println!("pictures are in {}", pictures_folder().display());
    assert!(failed.is_empty(), "these do not agree: {failed:?}");
}

/// A line of the table of `docs/render-tests.md`: agreement of our picture and of another picture
/// of real Radiance with the reference, and both programs' seconds.
fn row(ours: &Agreement, again: Option<&Agreement>, [seconds, of_real]: [f64; 2]) -> String {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let mean = |agreement: &Agreement| format!("{:+.1} %", 100.0 * agreement.mean);
    let again = again.map_or(" | ".to_owned(), |again| format!("{} | {}", mean(again), percent(again.within)));
    format!(
        "{} | {} | {} | {again} | {seconds:.1} | {of_real:.1} | {:.2}",
        mean(ours),
        percent(ours.within),
        percent(ours.blocks),
        seconds / of_real
    )
}

/// The file with the processor time of real `rpict`.
fn seconds_path(folder: &Path, reference: &Reference) -> PathBuf {
    folder.join(format!("{}-seconds", reference.name))
}

/// Processor time of real `rpict` for a picture, seconds: on this machine ([`repeat_references`]),
/// or else from the list of references.
fn seconds_of_real(reference: &Reference) -> f64 {
    let here = oracle().and_then(|folder| fs::read_to_string(seconds_path(&folder, reference)).ok());
    here.map_or(reference.seconds, |seconds| seconds.trim().parse().expect("seconds"))
}

/// Processor time of all ended child processes, seconds; zero if the system does not report it
/// (fields 16 and 17 of `/proc/self/stat`, in hundredths).
fn processor_time() -> f64 {
    let text = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The second field, the program's name in parentheses, may contain white space.
    let fields = text.rsplit_once(')').map_or("", |(_, fields)| fields).split_whitespace();
    fields.skip(13).take(2).map(|ticks| ticks.parse::<f64>().map_or(f64::NAN, |ticks| ticks / 100.0)).sum()
}

/// Renders each picture again with real Radiance, into the folder that `RADSIGHT_ORACLE` names,
/// until there are `RADSIGHT_TIMES` (default 1): their differences are the references' noise. The
/// processor time is stored as well.
#[test]
#[ignore = "renders with real Radiance, for an hour"]
fn repeat_references() {
    let (Some(shared), Some(radiance), Some(folder)) = (shared(), Radiance::find(), oracle()) else { return };
    let times: usize = std::env::var("RADSIGHT_TIMES").map_or(1, |times| times.parse().expect("a number of times"));
    let scenes = Scenes::new(&shared, &radiance);
    for reference in Reference::all(&shared) {
        for count in repeats(&folder, &reference).len() + 1..=times {
            let name = format!("{}-{count}.hdr", reference.name);
            println!("{name}");
            scenes.build_anew(&reference);
            let before = processor_time();
            let picture = scenes.real("rpict", &reference.words("")[1..], None).done();
            fs::write(seconds_path(&folder, &reference), format!("{:.1}\n", processor_time() - before))
                .expect("a note");
            fs::write(folder.join(format!("{name}.part")), picture).expect("the picture is written");
            fs::rename(folder.join(format!("{name}.part")), folder.join(name)).expect("the picture is renamed");
        }
    }
}
