//! `radsight job`: parts in files, merged to the result of one process, and rejected parts.

use crate::program::{Folder, ROOM, gripps, radsight};
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
