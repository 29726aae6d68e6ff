//! `radsight report` and the outputs of `capture` and `rpict` for it: the numbers, the mistakes,
//! and the page in a browser.

use crate::program::{Folder, ROOM, command, gripps, radsight, run_with};
use radsight_picture::{Image, read_image, read_png, write_pfm};
use radsight_report::RunRecord;
use std::process::Command;

const VIEW: [&str; 14] = ["-vp", "0", "-1", "1.5", "-vd", "0", "1", "-.1", "-vh", "50", "-vv", "40", "-x", "64"];

fn values(folder: &Folder, name: &str) -> Vec<f64> {
    let image = read_image(&folder.read(name)).expect("an image").image;
    image.data().iter().map(|value| f64::from(*value)).collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

/// Captures Fig. 10 with all additional outputs.
fn captured(folder: &Folder) {
    let (camera, sheet) = (gripps("fig10.toml"), gripps("sheet-retro.rad"));
    let mut words: Vec<String> = ["capture", &camera, &sheet, "--error", "0.05"].map(str::to_owned).to_vec();
    for (option, name) in [
        ("--output", "grey.png"),
        ("--exposure", "e.pfm"),
        ("--error-map", "error.exr"),
        ("--ray-map", "rays.npy"),
        ("--record", "run.json"),
        ("--report", "run.html"),
    ] {
        words.extend([option.to_owned(), folder.word(name)]);
    }
    radsight(&words.iter().map(String::as_str).collect::<Vec<_>>()).done();
}

#[test]
fn a_captures_accounts_agree_with_each_other_and_cost_no_bit() {
    let folder = Folder::new();
    captured(&folder);
    let plain = folder.word("plain.pfm");
    radsight(&["capture", &gripps("fig10.toml"), &gripps("sheet-retro.rad"), "--error", "0.05", "--exposure", &plain])
        .done();
    assert_eq!(folder.read("plain.pfm"), folder.read("e.pfm"), "the exposure has other bits");

    let record = RunRecord::from_json(&folder.read("run.json")).expect("a record");
    let (exposure, errors) = (values(&folder, "e.pfm"), values(&folder, "error.exr"));
    let reached = record.error.expect("an estimate").reached;
    let of_map = mean(errors.iter().map(|error| error * error)).sqrt() / mean(exposure.iter().copied());
    assert!((of_map / reached - 1.0).abs() < 1e-4, "map {of_map}, record {reached}");
    let rays: f64 = values(&folder, "rays.npy").iter().sum();
    assert_eq!(record.rays.expect("a number of rays") as f64, rays);
    assert!(record.stages.len() >= 3 && record.stages.iter().all(|stage| stage.elapsed_s >= 0.0));
    assert!(record.decisions.iter().any(|decision| decision.skipped));
    assert!(record.settings.iter().any(|setting| setting.name == "requested error" && setting.value == "0.05"));
}

#[test]
fn a_pictures_accounts_agree_with_each_other_and_cost_no_bit() {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    let run = |extra: &[&str]| {
        let words =
            [&["rpict", "-w-", "--error", ".1", "-ab", "1", "-ad", "64"], &VIEW[..], extra, &["room.rad"]].concat();
        run_with(command(&words).current_dir(folder.path("")), b"").done()
    };
    run(&["-o", "plain.hdr"]);
    run(&["-o", "p.hdr", "--error-map", "error.pfm", "--ray-map", "rays.mtx", "--record", "run.json"]);
    let pixels = |name: &str| values(&folder, name);
    assert_eq!(pixels("plain.hdr"), pixels("p.hdr"));
    let record = RunRecord::from_json(&folder.read("run.json")).expect("a record");
    let error = record.error.expect("an estimate");
    let of_map = mean(pixels("error.pfm").iter().map(|error| error * error)).sqrt();
    assert!((of_map / error.reached - 1.0).abs() < 1e-4, "map {of_map}, record {error:?}");
    assert!(error.asked == Some(0.1) && error.uncertainty.expect("an interval") > 0.0);
    assert_eq!(record.rays.expect("a number of rays") as f64, pixels("rays.mtx").iter().sum::<f64>());
    assert!(record.cache_noise.is_some(), "a bounce was followed");
    let header = String::from_utf8_lossy(&folder.read("rays.mtx")[..200]).into_owned();
    assert!(header.contains("rpict"), "{header}");
}

#[test]
fn pages_of_a_run_and_of_its_files_say_the_same() {
    let folder = Folder::new();
    captured(&folder);
    let file = |name: &str| folder.word(name);
    let words = ["report", &file("e.pfm"), "-o", &file("files.html"), "--error-map", &file("error.exr")];
    let more = ["--ray-map", &file("rays.npy"), "--record", &file("run.json"), "--grey", &file("grey.png")];
    radsight(&[&words[..], &more, &["--camera", &gripps("fig10.toml")]].concat()).done();
    let data = |name: &str| {
        let text = String::from_utf8(folder.read(name)).expect("UTF-8");
        text.split("id=\"model\"").nth(1).expect("data").to_owned()
    };
    assert_eq!(data("run.html"), data("files.html"), "model and values");
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = Folder::new();
    let pfm = |columns, rows| write_pfm(&Image::filled(columns, rows, 1, 1.0).expect("an image")).expect("bytes");
    let picture = folder.file("p.pfm", pfm(4, 3));
    let other = folder.file("other.pfm", pfm(3, 4));
    let text = folder.file("t.txt", "no picture");
    let record = folder.file("r.json", "{\n  \"format\": 1,\n  \"colour\": 3\n}");
    let page = folder.word("out.html");
    for (words, code, said) in [
        (vec!["--error-map", other.as_str()], 1, "3 by 4"),
        (vec!["--ray-map", &other], 1, "expected 1 component and the picture's 4 by 3"),
        (vec!["--grey", &picture], 1, "grey picture"),
        (vec!["--record", &record], 1, "r.json:3:"),
        (vec!["--camera", &gripps("fig10.toml")], 1, "192 by 165 pixels"),
        (vec!["--error-map-kind", "relative"], 2, "--error-map"),
        (vec!["--quantity", "colour"], 2, "radiance"),
    ] {
        let run = radsight(&[&["report", &picture, "-o", &page][..], &words].concat());
        assert_eq!((run.code, run.messages.contains(said)), (code, true), "{words:?}: {}", run.messages);
        assert!(!folder.path("out.html").exists());
    }
    for (words, code) in [
        (["report", text.as_str(), "-o", page.as_str()], 1),
        (["report", &picture, "-o", &picture], 2),
        (["report", &folder.word("none.hdr"), "-o", &page], 1),
    ] {
        assert_eq!(radsight(&words).code, code, "{words:?}");
    }
    let room = folder.file("room.rad", ROOM);
    for options in [&["--error-map", "e.pfm"][..], &["--ray-map", "r.pfm"], &["-S", "1", "--record", "r"]] {
        let words = [&["rpict"], &VIEW[..], options, &[room.as_str()]].concat();
        assert_eq!(radsight(&words).code, 2, "{options:?}");
    }
    let fixed = ["capture", &gripps("fig10.toml"), &gripps("sheet-retro.rad"), "--samples", "1"];
    assert_eq!(radsight(&[&fixed[..], &["--exposure", "-", "--error-map", "e.pfm"]].concat()).code, 2);
}

#[test]
fn a_partial_picture_says_so() {
    let folder = Folder::new();
    let mut bytes = b"#?RADIANCE\nPARTIAL= 1 of 2 rows\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n".to_vec();
    bytes.extend([128, 64, 32, 129].repeat(3));
    let picture = folder.file("p.hdr", &bytes);
    let page = radsight(&["report", &picture, "-o", "-"]).text();
    assert!(page.contains("the picture is partial: 1 of 2 scanlines"), "a note");
    let whole = folder.file("q.hdr", bytes.iter().copied().filter(|byte| *byte != b'P').collect::<Vec<u8>>());
    assert_eq!(radsight(&["report", &whole, "-o", "-"]).code, 1, "a picture that is cut by accident");
}

#[test]
fn whole_numbers_are_no_radiance() {
    let folder = Folder::new();
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".to_vec();
    bytes.extend([128, 64, 32, 129, 90, 90, 90, 129]);
    let (picture, tiff, floats) = (folder.file("p.hdr", &bytes), folder.word("p.tif"), folder.word("f.tif"));
    radsight(&["ra_tiff", &picture, &tiff]).done();
    radsight(&["ra_tiff", "-f", &picture, &floats]).done();
    for (file, has_unit) in [(&picture, true), (&tiff, false), (&floats, true)] {
        let page = radsight(&["report", file, "-o", "-"]).text();
        assert_eq!(page.contains("<td>radiance, W/(sr·m²)</td>"), has_unit, "{file}");
    }
}

/// A headless browser: `RADSIGHT_CHROMIUM`, or one on the path. Without one, a test prints a note
/// and passes, or with `RADSIGHT_REQUIRE_CHROMIUM=1` fails.
struct Browser(String);

impl Browser {
    fn find() -> Option<Browser> {
        let names =
            ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"].map(str::to_owned);
        let mut all = std::env::var("RADSIGHT_CHROMIUM").into_iter().chain(names);
        let runs = |name: &String| Command::new(name).arg("--version").output().is_ok_and(|run| run.status.success());
        let found = all.find(runs).map(Browser);
        if found.is_none() {
            let is_required = std::env::var_os("RADSIGHT_REQUIRE_CHROMIUM").is_some_and(|value| value == "1");
            assert!(!is_required, "no Chromium found, and RADSIGHT_REQUIRE_CHROMIUM=1");
            println!("skipped: no Chromium found");
        }
        found
    }

    /// Opens a page of a folder as a file, in a window of this size, with these options.
    fn open(&self, folder: &Folder, page: &str, [width, height]: [u32; 2], words: &[&str]) -> Vec<u8> {
        let profile = format!("--user-data-dir={}", folder.word("profile"));
        let window = format!("--window-size={width},{height}");
        let url = format!("file://{}/{page}", folder.path("").display().to_string().trim_end_matches('/'));
        let run = Command::new(&self.0)
            .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run"])
            .args(["--disable-dev-shm-usage", "--force-device-scale-factor=1", "--virtual-time-budget=20000"])
            .args([&profile, &window])
            .args(words)
            .arg(url)
            .output()
            .expect("the browser starts");
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        run.stdout
    }

    /// The page after its script has run.
    fn text(&self, folder: &Folder, page: &str) -> String {
        String::from_utf8_lossy(&self.open(folder, page, [800, 900], &["--dump-dom"])).into_owned()
    }
}

/// The cell of the table under the picture.
fn cell<'p>(page: &'p str, name: &str) -> &'p str {
    let (_, readout) = page.split_once("id=\"readout\"").expect("a table");
    let (_, behind) =
        readout.split_once(&format!("{name}</th><td>")).unwrap_or_else(|| panic!("no {name}: {readout:.900}"));
    behind.split_once('<').expect("an end").0
}

#[test]
fn the_browser_shows_the_values_under_the_pointer() {
    let Some(browser) = Browser::find() else { return };
    let folder = Folder::new();
    // From 3e-7 to 3e+1 and below 0, so that a wrong predictor, factor or byte order is detected.
    let value = |i: usize| if i == 0 { -0.5 } else { 3e-7 * 10f32.powf(8.0 * i as f32 / 34.0) };
    let image = Image::new(7, 5, 1, (0..35).map(value).collect()).expect("an image");
    let errors = image.clone().map(|value| 0.01 * value.abs());
    folder.file("p.pfm", write_pfm(&image).expect("bytes"));
    folder.file("e.pfm", write_pfm(&errors).expect("bytes"));
    let (picture, map, page) = (folder.word("p.pfm"), folder.word("e.pfm"), folder.word("p.html"));
    radsight(&["report", &picture, "--error-map", &map, "-o", &page, "--quantity", "irradiance"]).done();
    for [x, y] in [[0, 0], [6, 4], [0, 1], [3, 2], [6, 0]] {
        let text = browser.text(&folder, &format!("p.html#pixel={x},{y}&show=relative-error"));
        assert!(text.contains("data-state=\"ready\""), "the script came to its end");
        let number = |name: &str| {
            let cell = cell(&text, name);
            cell.split(' ').next().and_then(|word| word.parse::<f64>().ok()).unwrap_or_else(|| panic!("{name}: {cell}"))
        };
        let expected = f64::from(image.pixel(x, y)[0]);
        assert!((number("irradiance") / expected - 1.0).abs() < 1e-3, "pixel {x}, {y}: {}", cell(&text, "irradiance"));
        assert!((number(">relative standard error") - 1.0).abs() < 2e-3);
        assert!(cell(&text, "irradiance").ends_with(" W/m²"));
        let low = expected - 1.96 * 0.01 * expected.abs();
        assert!((number("95 % interval") / low - 1.0).abs() < 2e-3, "{}", cell(&text, "95 % interval"));
    }
}

#[test]
fn the_browser_draws_false_colour_and_takes_no_script_from_files() {
    let Some(browser) = Browser::find() else { return };
    let folder = Folder::new();
    let header = "#?RADIANCE\n</pre><script>document.documentElement.dataset.state='taken'</script>\n\
        OWNER= <img src='x' onerror='document.documentElement.dataset.state=\"taken\"'>\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    let mut bytes = header.as_bytes().to_vec();
    bytes.extend([1, 1, 1, 129, 255, 255, 255, 129]);
    let name = "<script>document.documentElement.dataset.state='taken'<\\script>.hdr";
    let (picture, page) = (folder.file(name, &bytes), folder.word("p.html"));
    radsight(&["report", &picture, "-o", &page]).done();
    let text = browser.text(&folder, "p.html#pixel=1,0");
    assert!(text.contains("data-state=\"ready\""), "what stands in a file was run");
    assert!(cell(&text, "luminance").ends_with(" cd/m²"));
    let shot = format!("--screenshot={}", folder.word("shot.png"));
    for (show, colors) in [("green", [[0x44, 0x01, 0x54], [0xfd, 0xe7, 0x25]]), ("as-seen", [[8, 8, 8], [255; 3]])] {
        browser.open(&folder, &format!("p.html#show={show}"), [390, 844], &[&shot]);
        let shown = read_png(&folder.read("shot.png")).expect("a PNG").values;
        for color in colors {
            let near = |pixel: &[u16]| pixel.iter().zip(color).all(|(a, b): (&u16, u16)| a.abs_diff(b) <= 12);
            let count = shown.pixels().filter(|pixel| near(&pixel[..3])).count();
            assert!(count > 15_000, "{show}: {count} pixels of {color:?}");
        }
    }
}

#[test]
fn a_picture_that_is_larger_than_the_window_is_shown_whole() {
    let Some(browser) = Browser::find() else { return };
    let folder = Folder::new();
    // The left and the right tenth are dark and bright, the middle is neither.
    let value = |i: usize| [0.0, 0.5, 1.0][usize::from(i % 2000 >= 200) + usize::from(i % 2000 >= 1800)];
    let image = Image::new(2000, 1000, 1, (0..2_000_000).map(value).collect()).expect("an image");
    let picture = folder.file("p.pfm", write_pfm(&image).expect("bytes"));
    radsight(&["report", &picture, "-o", &folder.word("p.html")]).done();
    let shot = format!("--screenshot={}", folder.word("shot.png"));
    browser.open(&folder, "p.html#show=value", [600, 800], &[&shot]);
    let shown = read_png(&folder.read("shot.png")).expect("a PNG").values;
    for color in [[0x44, 0x01, 0x54], [0xfd, 0xe7, 0x25]] {
        let near = |pixel: &[u16]| pixel.iter().zip(color).all(|(a, b): (&u16, u16)| a.abs_diff(b) <= 4);
        let count = shown.pixels().filter(|pixel| near(&pixel[..3])).count();
        // Approximately a tenth of 560 by 280 pixels, and an end of the scale.
        assert!((12_000..20_000).contains(&count), "{count} pixels of {color:?}");
    }
}

#[test]
fn the_browser_prints_still_pictures_of_all_maps() {
    let Some(browser) = Browser::find() else { return };
    let folder = Folder::new();
    let image = Image::new(40, 30, 1, (0..1200).map(|i| i as f32).collect()).expect("an image");
    let picture = folder.file("p.pfm", write_pfm(&image).expect("bytes"));
    let rays = folder.file("r.pfm", write_pfm(&image.map(|value| 2000.0 - value)).expect("bytes"));
    radsight(&["report", &picture, "--ray-map", &rays, "-o", &folder.word("p.html")]).done();
    let print = format!("--print-to-pdf={}", folder.word("p.pdf"));
    browser.open(&folder, "p.html", [800, 900], &[&print]);
    let pdf = folder.read("p.pdf");
    let images = pdf.windows(14).filter(|bytes| bytes == b"/Subtype /Imag").count();
    assert!(pdf.starts_with(b"%PDF") && images >= 3, "{images} pictures on paper");
}
