//! `radsight job`: parts in files, merged to the result of one process, and rejected parts.

use crate::program::{Folder, ROOM, gripps, radsight, radsight_with};
use radsight_picture::read_image;

fn capture_job(folder: &Folder) -> String {
    let (camera, sheet) = (gripps("fig10.toml"), gripps("sheet-retro.rad"));
    let text =
        format!("{{\"format\": 1, \"scenes\": [{sheet:?}], \"capture\": {{\"camera\": {camera:?}}}, \"samples\": 2}}");
    folder.file("job.json", text)
}

fn picture_job(folder: &Folder, samples: u32) -> String {
    let scene = folder.file("room.rad", ROOM);
    let view = "-vp 0 -1 1.5 -vd 0 1 -.1 -vh 50 -vv 40";
    let text = format!(
        "{{\"format\": 1, \"scenes\": [{scene:?}], \"picture\": {{\"view\": {view:?}, \"columns\": 48, \"rows\": 36}}, \"samples\": {samples}, \"ambient_bounces\": 1}}"
    );
    folder.file("job.json", text)
}

fn values(folder: &Folder, name: &str) -> Vec<f32> {
    read_image(&folder.read(name)).expect("an image").image.data().to_vec()
}

#[test]
fn parts_of_a_capture_merge_to_its_bits() {
    let folder = Folder::new();
    let (job, pattern) = (capture_job(&folder), folder.word("part%d.json"));
    radsight(&["job", "split", &job, "--parts", "3", "-o", &pattern]).done();
    let mut merge = vec!["job".to_owned(), "merge".to_owned()];
    for part in ["part2", "part0", "part1"] {
        let (json, values) = (folder.word(&format!("{part}.json")), folder.word(&format!("{part}.mtx")));
        radsight(&["job", "run", &json, "-o", &values]).done();
        merge.push(values);
    }
    let (merged, map, whole) = (folder.word("merged.mtx"), folder.word("error.npy"), folder.word("whole.mtx"));
    merge.extend(["-o", &merged, "--error-map", &map].map(str::to_owned));
    radsight(&merge.iter().map(String::as_str).collect::<Vec<_>>()).done();
    let (camera, sheet) = (gripps("fig10.toml"), gripps("sheet-retro.rad"));
    radsight(&["capture", &camera, &sheet, "--samples", "2", "--exposure", &whole]).done();
    assert_eq!(values(&folder, "merged.mtx"), values(&folder, "whole.mtx"));
    assert!(values(&folder, "error.npy").iter().any(|error| *error > 0.0));
}

#[test]
fn tasks_of_an_array_share_one_job_and_missing_parts_are_reported() {
    let folder = Folder::new();
    let job = picture_job(&folder, 4);
    let (first, second) = (folder.word("0.mtx"), folder.word("1.mtx"));
    let (picture, whole) = (folder.word("picture.pfm"), folder.word("whole.pfm"));
    radsight(&["job", "run", &job, "--part", "1/2", "-o", &second]).done();
    let missing = radsight(&["job", "merge", &second, "-o", &picture]);
    assert_eq!(missing.code, 1);
    assert!(missing.messages.contains("rows 0 to 17 of 36"), "{}", missing.messages);
    let partial = folder.word("partial.exr");
    let merged = radsight(&["job", "merge", &second, "-o", &partial, "--partial"]);
    assert!(merged.code == 0 && merged.messages.contains("estimated error"), "{}", merged.messages);
    radsight(&["job", "run", &job, "--part", "0/2", "-o", &first]).done();
    radsight(&["job", "merge", &second, &first, "-o", &picture]).done();
    // A single task with all rows.
    let all = folder.word("all.mtx");
    radsight(&["job", "run", &job, "-o", &all, "--threads", "1"]).done();
    radsight(&["job", "merge", &all, "-o", &whole]).done();
    assert_eq!(values(&folder, "picture.pfm"), values(&folder, "whole.pfm"));
}

#[test]
fn parts_of_another_scene_or_seed_are_refused() {
    let folder = Folder::new();
    let job = picture_job(&folder, 1);
    let (first, second, out) = (folder.word("0.mtx"), folder.word("1.mtx"), folder.word("out.pfm"));
    radsight(&["job", "run", &job, "--part", "0/2", "-o", &first]).done();
    folder.file("room.rad", ROOM.replace("20 20 20", "30 20 20"));
    radsight(&["job", "run", &job, "--part", "1/2", "-o", &second]).done();
    let refused = radsight(&["job", "merge", &first, &second, "-o", &out]);
    assert_eq!(refused.code, 1);
    assert!(refused.messages.contains("1.mtx") && refused.messages.contains("another job"), "{}", refused.messages);
}

#[test]
fn tiles_and_ranges_of_rays_merge_to_the_bits_of_the_whole() {
    let folder = Folder::new();
    let picture = picture_job(&folder, 2);
    let scene = folder.word("room.rad");
    let points: String = (0..40).map(|x| format!("{} 2 .1 0 0 1\n", 0.02 * f64::from(x) - 0.4)).collect();
    let points = folder.file("points.txt", points);
    let text = format!(
        "{{\"format\": 1, \"scenes\": [{scene:?}], \"trace\": {{\"rays\": {points:?}, \"quantity\": \"irradiance\"}}, \"samples\": 1}}"
    );
    let trace = folder.file("trace.json", text);
    for (job, size, parts, gone) in
        [(&picture, ["--tiles", "20x20"], 6, "columns 0 to 19"), (&trace, ["--rays", "17"], 3, "rays 0 to 16")]
    {
        radsight(&["job", "split", job, size[0], size[1], "-o", &folder.word("tile%d.json")]).done();
        let (merged, whole, all) = (folder.word("merged.npy"), folder.word("all.npy"), folder.word("all.mtx"));
        let mut merge = vec!["job".to_owned(), "merge".to_owned(), "-o".to_owned(), merged];
        for part in 0..parts {
            let (json, values) = (folder.word(&format!("tile{part}.json")), folder.word(&format!("tile{part}.mtx")));
            radsight(&["job", "run", &json, "-o", &values]).done();
            merge.push(values);
        }
        radsight(&merge.iter().map(String::as_str).collect::<Vec<_>>()).done();
        radsight(&["job", "run", job, "-o", &all]).done();
        radsight(&["job", "merge", &all, "-o", &whole]).done();
        assert_eq!(values(&folder, "merged.npy"), values(&folder, "all.npy"), "{size:?}");
        let missing = radsight(&["job", "merge", &folder.word("tile1.mtx"), "-o", &folder.word("one.npy")]);
        assert!(missing.code == 1 && missing.messages.contains(gone), "{}", missing.messages);
    }
    // The same light as `rtrace` finds with its own defaults.
    let told = radsight_with(&["rtrace", "-h", "-I", &scene], &folder.read("points.txt")).text();
    let told: Vec<f64> = told.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    let own = values(&folder, "all.npy");
    assert_eq!(own.len(), told.len());
    let near = |(own, told): (&f32, &f64)| (f64::from(*own) - told).abs() <= 0.05 * told;
    assert!(own.iter().zip(&told).all(near) && own.iter().any(|value| *value > 0.0), "{own:?} {told:?}");
}

#[test]
fn parts_share_an_irradiance_cache_that_is_made_once() {
    let folder = Folder::new();
    let job = picture_job(&folder, 2);
    let text = String::from_utf8(folder.read("job.json")).expect("text");
    let cache = folder.word("room.cache");
    let keys = "\"ambient_accuracy\": 0.2, \"ambient_divisions\": 64, \"ambient_super_samples\": 0";
    let without =
        folder.file("without.json", text.replace("\"ambient_bounces\": 1", &format!("\"ambient_bounces\": 1, {keys}")));
    let with = format!("\"ambient_bounces\": 1, {keys}, \"irradiance_cache\": {cache:?}");
    let with = folder.file("with.json", text.replace("\"ambient_bounces\": 1", &with));
    let refused = radsight(&["job", "run", &without, "-o", &folder.word("none.mtx")]);
    assert!(refused.code == 1 && refused.messages.contains("radsight job cache"), "{}", refused.messages);
    radsight(&["job", "cache", &with, "-o", &cache]).done();
    let (first, second, merged) = (folder.word("0.mtx"), folder.word("1.mtx"), folder.word("merged.pfm"));
    for (part, out) in [("0/2", &first), ("1/2", &second)] {
        radsight(&["job", "run", &with, "--part", part, "-o", out]).done();
    }
    radsight(&["job", "merge", &first, &second, "-o", &merged]).done();
    let (all, whole, path_by_path) = (folder.word("all.mtx"), folder.word("whole.pfm"), folder.word("paths.pfm"));
    radsight(&["job", "run", &with, "-o", &all, "--threads", "1"]).done();
    radsight(&["job", "merge", &all, "-o", &whole]).done();
    assert_eq!(values(&folder, "merged.pfm"), values(&folder, "whole.pfm"));
    radsight(&["job", "run", &job, "-o", &all]).done();
    radsight(&["job", "merge", &all, "-o", &path_by_path]).done();
    assert_ne!(values(&folder, "paths.pfm"), values(&folder, "whole.pfm"), "the cache is used");
    // Parts with another cache are not merged.
    let other = text.replace("\"ambient_bounces\": 1", &format!("\"seed\": 5, \"ambient_bounces\": 1, {keys}"));
    folder.file("other.json", other);
    radsight(&["job", "cache", &folder.word("other.json"), "-o", &folder.word("other.cache")]).done();
    std::fs::copy(folder.path("other.cache"), folder.path("room.cache")).expect("a copy");
    radsight(&["job", "run", &with, "--part", "1/2", "-o", &second]).done();
    assert_eq!(radsight(&["job", "merge", &first, &second, "-o", &merged]).code, 1);
}

#[test]
fn mistakes_in_jobs_have_their_position_and_run_nothing() {
    let folder = Folder::new();
    let out = folder.word("out.mtx");
    let run = |text: &str| radsight(&["job", "run", &folder.file("bad.json", text), "-o", &out]);
    let bad = run("{\"format\": 1,\n \"samples\": \"many\"}");
    assert_eq!(bad.code, 1);
    assert!(bad.messages.contains("bad.json:2:") && bad.messages.contains('^'), "{}", bad.messages);
    let marker = folder.word("ran");
    let command = format!(
        "{{\"format\": 1, \"scenes\": [\"!touch {marker}\"], \"picture\": {{\"view\": \"\", \"columns\": 8, \"rows\": 8}}, \"samples\": 1}}"
    );
    let refused = run(&command);
    assert!(refused.code == 1 && refused.messages.contains("is no file"), "{}", refused.messages);
    assert!(!folder.path("ran").exists());
    let job = picture_job(&folder, 1);
    assert_eq!(radsight(&["job", "run", &job, "--part", "2/2", "-o", &out]).code, 2);
    assert_eq!(radsight(&["job", "split", &job, "--parts", "2", "-o", &folder.word("no-number.json")]).code, 2);
}
