//! Parts of pictures and captures: equal bits, mistakes, and missing parts.

use glam::DVec3;
use radsight::{
    Capture, Error, FileLoader, JobResult, JobTarget, MergedJob, Ray, RenderJob, Renderer, Scene, Silent, View,
};

const TABLE: &str = "void light lamp 0 0 3 100 100 100  void plastic grey 0 0 5 .5 .4 .3 0 0
    lamp ring bulb 0 0 8 0 0 4 0 0 -1 0 .05  grey ring table 0 0 8 0 0 0 0 0 1 0 6  grey sphere ball 0 0 4 .5 .5 .4 .4";

const CAMERA: &str = "[camera]\nposition_m = [0, 0, 3]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\nfocal_distance_mm = 20\n\
    pinhole_diameter_mm = 0.5\npinhole_model = \"finite\"\npixel_pitch_um = [200, 200]\npixels = [24, 18]\nexposure_ms = 10\n";

fn picture() -> RenderJob {
    let view = View::from_args("-vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 45").unwrap();
    RenderJob { seed: 7, ambient_bounces: 1, ..RenderJob::new(JobTarget::picture(&view, 40, 31), 8) }
}

fn results(job: &RenderJob, parts: usize) -> Vec<JobResult> {
    let scene = Scene::from_text(TABLE).unwrap();
    let jobs = job.split(parts, job.picture_size().unwrap()).unwrap();
    // Each job in a renderer of its own, as on another machine, and in another order.
    jobs.iter().rev().map(|job| Renderer::new(&scene).unwrap().run_job(job).unwrap()).collect()
}

#[test]
fn parts_of_a_picture_merge_to_the_bits_of_the_whole() {
    let job = picture();
    let scene = Scene::from_text(TABLE).unwrap();
    let renderer = Renderer::new(&scene).unwrap().ambient_bounces(1).ambient_accuracy(0.0).seed(7).samples(8);
    let JobTarget::Picture { view, .. } = &job.target else { panic!("a picture") };
    let whole = { renderer }.render(&View::from_args(view).unwrap(), 40, 31).unwrap();
    for parts in [1, 2, 5, 1000] {
        let merged = MergedJob::of(&results(&job, parts)).unwrap();
        assert!(merged.missing().is_empty());
        assert_eq!(merged.values, whole.pixels().concat(), "{parts} parts");
    }
}

#[test]
fn parts_of_a_capture_merge_to_the_bits_of_the_whole() {
    let capture = Capture::from_text("c.toml", CAMERA.as_bytes(), &FileLoader::default()).unwrap().samples(8).seed(3);
    let scene = capture.with_ring(Scene::builder().text("table.rad", TABLE)).build().unwrap();
    let job = RenderJob { seed: 3, ..RenderJob::new(JobTarget::capture("c.toml"), 8) };
    let parts = job.split(3, [24, 18]).unwrap();
    let mut renderer = Renderer::new(&scene).unwrap();
    let parts: Vec<JobResult> =
        parts.iter().map(|job| capture.run_job(&mut renderer, job, &Silent).unwrap().unwrap()).collect();
    let whole = capture.expose(&scene).unwrap();
    let whole: Vec<f32> = whole.exposure_j_per_m2.iter().map(|value| *value as f32).collect();
    assert_eq!(MergedJob::of(&parts).unwrap().values, whole);
}

#[test]
fn tiles_merge_to_the_bits_of_the_whole_and_what_is_missing_is_rectangles() {
    let job = picture();
    let size = job.picture_size().unwrap();
    let scene = Scene::from_text(TABLE).unwrap();
    let whole = Renderer::new(&scene).unwrap().run_job(&job).unwrap();
    let tiles = job.split_tiles([16, 10], size).unwrap();
    assert_eq!(tiles.len(), size[0].div_ceil(16) * size[1].div_ceil(10));
    let mut renderer = Renderer::new(&scene).unwrap();
    let mut parts: Vec<JobResult> = tiles.iter().rev().map(|tile| renderer.run_job(tile).unwrap()).collect();
    assert_eq!(MergedJob::of(&parts).unwrap().values, whole.values);
    let again = JobResult::from_bytes("tile", &parts[1].to_bytes().unwrap()).unwrap();
    assert_eq!(again, parts[1]);
    let gone = [parts.remove(5), parts.remove(0)].map(|part| part.tile().unwrap());
    assert_eq!(MergedJob::of(&parts).unwrap().missing(), gone);
    // Tiles of the camera's pixels, too.
    let capture = Capture::from_text("c.toml", CAMERA.as_bytes(), &FileLoader::default()).unwrap();
    let scene = capture.with_ring(Scene::builder().text("table.rad", TABLE)).build().unwrap();
    let job = RenderJob::new(JobTarget::capture("c.toml"), 4);
    let mut renderer = Renderer::new(&scene).unwrap();
    let mut run = |job: &RenderJob| capture.run_job(&mut renderer, job, &Silent).unwrap().unwrap();
    let parts: Vec<JobResult> = job.split_tiles([7, 7], [24, 18]).unwrap().iter().map(&mut run).collect();
    assert_eq!(MergedJob::of(&parts).unwrap().values, run(&job).values);
}

#[test]
fn ranges_of_rays_merge_to_the_answers_of_all() {
    let scene = Scene::from_text(TABLE).unwrap();
    let rays: Vec<Ray> =
        (0..100).map(|x| Ray::new(DVec3::new(0.05 * f64::from(x) - 2.0, 0.3, 1.0), -DVec3::Z).unwrap()).collect();
    let job =
        RenderJob { ambient_bounces: 1, ambient_divisions: Some(16), ..RenderJob::new(JobTarget::trace("rays"), 1) };
    let run =
        |job: &RenderJob| Renderer::new(&scene).unwrap().run_job_with_progress(job, &rays, &Silent).unwrap().unwrap();
    let parts: Vec<JobResult> = job.split_rays(17, 100).unwrap().iter().rev().map(run).collect();
    let merged = MergedJob::of(&parts).unwrap();
    let mut renderer =
        Renderer::new(&scene).unwrap().ambient_bounces(1).ambient_accuracy(0.0).ambient_divisions(16, 128);
    let alone = renderer.trace(&rays).unwrap().into_iter().flat_map(|traced| traced.value.map(|value| value as f32));
    assert_eq!(merged.values, alone.collect::<Vec<f32>>());
    assert_eq!((merged.size, merged.relative_error()), ([100, 1], None));
    let tiles = job.split_tiles([8, 8], [100, 1]);
    assert!(matches!(tiles, Err(Error::Option { option: "tiles", .. })), "{tiles:?}");
    assert!(matches!(picture().split_rays(8, 100), Err(Error::Option { option: "rays", .. })));
    assert!(matches!(RenderJob { samples: 2, ..job }.render_options(), Err(Error::Option { option: "samples", .. })));
}

#[test]
fn a_cache_made_once_gives_parts_the_bits_of_a_single_process() {
    let text = format!("{TABLE} grey ring ceiling 0 0 8 0 0 5 0 0 -1 0 6");
    let scene = Scene::from_text(text).unwrap();
    let job =
        RenderJob { ambient_accuracy: 0.2, ambient_divisions: Some(64), ambient_super_samples: Some(0), ..picture() };
    let JobTarget::Picture { view, .. } = &job.target else { panic!("a picture") };
    let single = || Renderer::new(&scene).unwrap().ambient_bounces(1).ambient_divisions(64, 0).seed(7).samples(8);
    let whole = single().render(&View::from_args(view).unwrap(), 40, 31).unwrap();
    let alone = Renderer::new(&scene).unwrap().run_job(&job);
    assert!(matches!(alone, Err(Error::Option { option: "irradiance_cache", .. })), "{alone:?}");
    let cache = Renderer::new(&scene).unwrap().irradiance_cache_for(&job, &[], &Silent).unwrap().unwrap();
    let run = |job: &RenderJob| {
        let mut renderer = Renderer::new(&scene).unwrap();
        renderer.only_irradiance_cache(cache.clone());
        renderer.run_job(job).unwrap()
    };
    let parts: Vec<JobResult> =
        job.split_tiles([16, 16], job.picture_size().unwrap()).unwrap().iter().map(run).collect();
    assert_eq!(MergedJob::of(&parts).unwrap().values, whole.pixels().concat());
    let uncached = Renderer::new(&scene).unwrap().run_job(&RenderJob { ambient_accuracy: 0.0, ..job.clone() }).unwrap();
    assert_ne!(uncached.values, whole.pixels().concat(), "the cache is used");
}

#[test]
fn a_cache_for_all_rays_gives_parts_of_them_the_same_answers() {
    let text = format!("{TABLE} grey ring ceiling 0 0 8 0 0 5 0 0 -1 0 6");
    let scene = Scene::from_text(text).unwrap();
    let rays: Vec<Ray> =
        (0..300).map(|x| Ray::new(DVec3::new(0.01 * f64::from(x) - 2.0, 0.3, 1.0), -DVec3::Z).unwrap()).collect();
    let renderer = || Renderer::new(&scene).unwrap().ambient_bounces(2).ambient_divisions(64, 0);
    let value = |traced: radsight::Traced| traced.value;
    let whole = renderer().trace_part(0, &rays, value, &Silent).unwrap().unwrap();
    let cache = renderer().irradiance_cache_of(&rays, &Silent).unwrap().unwrap();
    let part = |first: usize, last: usize| {
        let mut renderer = renderer();
        renderer.only_irradiance_cache(cache.clone());
        renderer.trace_part(first as u64, &rays[first..last], value, &Silent).unwrap().unwrap()
    };
    assert_eq!([part(0, 110), part(110, 300)].concat(), whole);
}

#[test]
fn the_estimated_error_is_about_the_true_one() {
    let few = MergedJob::of(&results(&picture(), 1)).unwrap();
    let many = MergedJob::of(&results(&RenderJob { samples: 512, ..picture() }, 1)).unwrap();
    let means: Vec<f64> = (0..3)
        .map(|band| many.values.iter().skip(band).step_by(3).map(|v| f64::from(*v)).sum::<f64>() / 1240.0)
        .collect();
    let squared = |(index, (few, many)): (usize, (&f32, &f32))| {
        (f64::from(few - many) / f64::from(*many).hypot(0.01 * means[index % 3])).powi(2)
    };
    let pairs = few.values.iter().zip(&many.values).enumerate();
    let truth = (pairs.map(squared).sum::<f64>() / few.values.len() as f64).sqrt();
    let ratio = few.relative_error().unwrap() / truth;
    assert!((0.6..3.0).contains(&ratio), "estimated over true: {ratio}, true {truth}");
}

#[test]
fn results_come_back_from_their_files() {
    let part = &results(&picture(), 3)[1];
    assert_eq!(JobResult::from_bytes("part", &part.to_bytes().unwrap()).unwrap(), *part);
    let error = JobResult::from_bytes("other.mtx", b"#?RADIANCE\n\nno part").unwrap_err();
    assert!(matches!(&error, Error::Part { name, .. } if name == "other.mtx"), "{error}");
}

#[test]
fn missing_rows_are_reported_and_foreign_parts_are_rejected() {
    let mut parts = results(&picture(), 4);
    let gone = parts.remove(1);
    let merged = MergedJob::of(&parts).unwrap();
    assert_eq!(merged.missing(), [gone.tile().unwrap()]);
    assert!(merged.relative_error().is_some());
    let stranger = results(&RenderJob { seed: 8, ..picture() }, 4).remove(1);
    parts.push(stranger);
    assert!(matches!(MergedJob::of(&parts), Err(Error::Part { name, .. }) if name == "part 3"));
    parts[3] = JobResult { values: vec![0.0; gone.values.len()], ..gone.clone() };
    parts.push(gone);
    assert!(matches!(MergedJob::of(&parts), Err(Error::Part { name, .. }) if name == "part 4"));
}

#[test]
fn jobs_come_back_from_json_and_mistakes_have_their_places() {
    let job = RenderJob { rows: Some(3..9), scenes: vec!["a.rad".to_owned()], ..picture() };
    assert_eq!(RenderJob::from_json("job", job.to_json().as_bytes()).unwrap(), job);
    let text = "{\n  \"format\": 1,\n  \"samples\": \"many\"\n}";
    let Err(Error::Job(report)) = RenderJob::from_json("job.json", text.as_bytes()) else { panic!("it is no job") };
    assert_eq!(report.position(&report.diagnostics[0]).map(|(name, line, _)| (name, line)), Some(("job.json", 3)));
    let none = job.to_json().replace("\"samples\": 8", "\"samples\": 0");
    assert!(matches!(RenderJob::from_json("job", none.as_bytes()), Err(Error::Option { option: "samples", .. })));
    let of_rays = RenderJob { rays: Some(0..2), ..picture() };
    assert!(matches!(of_rays.tile_of([40, 31]), Err(Error::Option { option: "rays", .. })));
    assert!(matches!(job.split(0, [40, 31]), Err(Error::Option { option: "parts", .. })));
    assert!(matches!(job.split(2, [40, 5]), Err(Error::Option { option: "rows", .. })));
}
