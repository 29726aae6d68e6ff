//! Tests the page with a parser: structure, escaping, references, and size.

use proptest::prelude::*;
use radsight_picture::{Image, read_png};
use radsight_report::{
    Decision, ErrorEstimate, ErrorMap, GreyPicture, MOST_PIXELS, Page, ProgressLog, Quantity, ReportError, RunRecord,
    Stage,
};
use roxmltree::{Document, Node, ParsingOptions};

/// Text that would end an element, an attribute, a comment, a script or data, or control a
/// terminal.
const HOSTILE: &str =
    "</title></pre></script>]]><script>alert(1)</script>\" onload='x' &amp; \u{0}\u{1b}[31m\u{202e}--> é";

fn image(components: usize, value: impl Fn(usize) -> f32) -> Image<f32> {
    Image::new(6, 4, components, (0..24 * components).map(value).collect()).unwrap()
}

/// A page with every section, whose texts are all `text`.
fn full_page(text: &str) -> Page {
    let text = || text.to_owned();
    let mut record = RunRecord {
        software: text(),
        command: vec![text(), text()],
        date: Some(text()),
        stages: vec![Stage { name: text(), elapsed_s: 2.0, processor_s: Some(3.0) }],
        error: Some(ErrorEstimate { asked: Some(0.01), reached: 0.0123, uncertainty: Some(0.0004) }),
        rays: Some(123_456),
        cache_noise: Some(0.03),
        decisions: vec![
            Decision { what: text(), why: text(), skipped: true },
            Decision { what: text(), why: text(), skipped: false },
        ],
        notes: vec![text()],
        ..RunRecord::default()
    };
    record.push_setting(text(), text());
    let log = format!("{}\nrpict: 24 rays, 100.00% after 0.001u 0.000s 0.002r hours on h (PID 1)", text());
    let quantity = Quantity::Other { name: text(), unit: text() };
    let page = Page::new(text(), image(3, |i| i as f32 * 0.1), quantity).unwrap();
    let page = page.error_map(ErrorMap::Absolute(image(1, |i| 1e-3 * i as f32))).unwrap();
    let page = page.ray_map(image(1, |i| i as f32)).unwrap();
    let values = Image::new(6, 4, 1, (0..24).map(|i| i * 10).collect()).unwrap();
    let page = page.grey_picture(GreyPicture { values, largest: 255 }).unwrap();
    page.record(record).log(ProgressLog::read(&log)).fact(text(), text()).text(text(), text())
}

/// Parses a page as XML, which is stricter than HTML, so that missing escapes are found.
fn with_document<T>(html: &str, check: impl FnOnce(&Document<'_>) -> T) -> T {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(html, options).unwrap_or_else(|error| panic!("{error}\n{html}"));
    check(&document)
}

fn elements<'a, 'd>(document: &'a Document<'d>, name: &'a str) -> impl Iterator<Item = Node<'a, 'd>> {
    document.descendants().filter(move |node| node.is_element() && node.tag_name().name() == name)
}

fn text_of(node: Node<'_, '_>) -> String {
    node.descendants().filter_map(|part| part.text().filter(|_| part.is_text())).collect()
}

#[test]
fn all_parts_are_there_and_named() {
    with_document(&full_page("words").to_html(), |document| {
        let headings: Vec<String> = elements(document, "h2").map(text_of).collect();
        for expected in ["Values", "Error", "Time", "Skipped", "Settings", "Messages", "Versions"] {
            assert!(headings.iter().any(|heading| heading == expected), "{expected} in {headings:?}");
        }
        let stills = elements(document, "img").count();
        // Natural colours, brightness, error and relative error, rays, grey.
        assert_eq!(stills, 6);
        assert!(elements(document, "img").all(|img| !img.attribute("alt").unwrap_or("").is_empty()));
        assert_eq!(document.root_element().attribute("lang"), Some("en"));
        assert!(elements(document, "meta").any(|meta| meta.attribute("name") == Some("viewport")));
        let style = text_of(elements(document, "style").next().unwrap());
        assert!(style.contains("@media print") && style.contains("@media (max-width"), "print and phones");
    });
}

#[test]
fn ids_are_unique_and_those_of_the_script_exist() {
    with_document(&full_page("words").to_html(), |document| {
        let mut ids: Vec<&str> = document.descendants().filter_map(|node| node.attribute("id")).collect();
        let count = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), count, "an id is used twice");
        let script = text_of(elements(document, "script").last().unwrap());
        let wanted: Vec<&str> = script.split("byId('").skip(1).filter_map(|rest| rest.split('\'').next()).collect();
        assert!(wanted.len() > 10, "{wanted:?}");
        for id in wanted.into_iter().filter(|id| *id != "layer-") {
            assert!(ids.contains(&id), "no element has the id {id}");
        }
    });
}

#[test]
fn nothing_outside_of_the_page_is_referred_to() {
    with_document(&full_page("words").to_html(), |document| {
        for node in document.descendants() {
            for attribute in node.attributes() {
                let (name, value) = (attribute.name(), attribute.value());
                let is_reference = ["src", "href", "action", "data", "poster", "srcset", "background"].contains(&name);
                assert!(!is_reference || value.starts_with("data:image/png;base64,"), "{name}={value:.80}");
                assert!(!name.starts_with("on") && name != "style", "{name} would need a policy that allows it");
            }
        }
        assert_eq!(elements(document, "link").count() + elements(document, "iframe").count(), 0);
        let style = text_of(elements(document, "style").next().unwrap());
        assert!(!style.contains("url(") && !style.contains("@import"));
        let policy = elements(document, "meta").find_map(|meta| {
            (meta.attribute("http-equiv") == Some("Content-Security-Policy"))
                .then(|| meta.attribute("content").unwrap())
        });
        let policy = policy.expect("a policy");
        assert!(policy.starts_with("default-src 'none'; img-src data:;") && !policy.contains("unsafe"), "{policy}");
    });
}

#[test]
fn hostile_text_is_text_wherever_it_stands() {
    let (plain, hostile) = (full_page("words").to_html(), full_page(HOSTILE).to_html());
    let shape = |html: &str| {
        with_document(html, |document| {
            let names = document.descendants().filter(Node::is_element);
            names.map(|node| (node.tag_name().name().to_owned(), node.attributes().len())).collect::<Vec<_>>()
        })
    };
    assert_eq!(shape(&plain), shape(&hostile), "the text made or changed an element");
    let shown = HOSTILE.replace(['\u{0}', '\u{1b}', '\u{202e}'], "\u{fffd}");
    with_document(&hostile, |document| {
        assert_eq!(text_of(elements(document, "h1").next().unwrap()), shown);
        assert_eq!(text_of(elements(document, "title").next().unwrap()), shown);
        // Facts twice, note, date, stage, two decisions, setting, name and text, versions, message.
        let text: String = document.descendants().filter(Node::is_text).filter_map(|node| node.text()).collect();
        assert!(text.matches(&shown).count() >= 15, "{}", text.matches(&shown).count());
    });
    // Scripts end at the first such bytes, whatever an XML parser reports.
    let scripts = hostile.matches("<script").count();
    assert_eq!((scripts, hostile.matches("</script").count()), (plain.matches("<script").count(), scripts));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_text_and_any_values_make_a_well_formed_page(
        text in "\\PC{0,12}|[<>&\"'/!\\]\\[\\-]{0,12}|.{0,8}",
        values in proptest::collection::vec(proptest::num::f32::ANY, 24),
        times in proptest::array::uniform2(proptest::num::f64::ANY),
    ) {
        let map = Image::new(6, 4, 1, values.clone()).unwrap();
        let [elapsed_s, processor_s] = times;
        let stage = Stage { name: text.clone(), elapsed_s, processor_s: Some(processor_s) };
        let page = full_page(&text).error_map(ErrorMap::Relative(map.clone())).unwrap().ray_map(map).unwrap();
        with_document(&page.stage(stage).to_html(), |_| ());
    }

    #[test]
    fn no_log_and_no_record_is_too_odd(bytes in proptest::collection::vec(any::<u8>(), 0..200), numbers in "[0-9.eu sr%,:A-Za-z]{0,60}") {
        let _ = RunRecord::from_json(&bytes);
        for text in [String::from_utf8_lossy(&bytes).into_owned(), format!("rpict: {numbers}"), format!("rpict: 1 rays, 2% after {numbers} hours")] {
            let log = ProgressLog::read(&text);
            prop_assert!(log.progress.iter().all(|at| at.rays.is_finite() && at.elapsed_s >= 0.0));
        }
    }
}

#[test]
fn still_pictures_show_the_values() {
    let dark_left = Image::new(2, 1, 1, vec![0.0, 1.0]).unwrap();
    let html = Page::new("two", dark_left, Quantity::Exposure).unwrap().to_html();
    with_document(&html, |document| {
        let source = elements(document, "img").nth(1).unwrap().attribute("src").unwrap();
        let png = base64::Engine::decode(
            &base64::engine::general_purpose::STANDARD,
            source.strip_prefix("data:image/png;base64,").unwrap(),
        );
        let image = read_png(&png.unwrap()).unwrap().values;
        assert_eq!((image.width(), image.height()), (300, 150));
        assert_eq!(image.pixel(10, 75), [0x44, 0x01, 0x54]);
        assert_eq!(image.pixel(290, 75), [0xfd, 0xe7, 0x25]);
    });
}

#[test]
fn intervals_and_units_are_printed() {
    let picture = image(1, |i| 1e-5 * i as f32);
    let record = RunRecord {
        error: Some(ErrorEstimate { asked: Some(0.01), reached: 0.0123, uncertainty: Some(0.0004) }),
        ..RunRecord::default()
    };
    let html = Page::new("e.pfm", picture, Quantity::Exposure).unwrap().record(record).to_html();
    assert!(html.contains("1.23 % ± 0.040 % (95 %)") && html.contains("J/m²"));
    assert!(html.contains("The input has no error map"));
}

#[test]
fn maps_of_another_size_are_refused() {
    let page = || Page::new("p", image(1, |_| 1.0), Quantity::Exposure).unwrap();
    let other = || Image::filled(5, 4, 1, 1.0).unwrap();
    let size = |result: Result<Page, ReportError>| matches!(result, Err(ReportError::Size { .. }));
    assert!(size(page().error_map(ErrorMap::Absolute(other()))));
    assert!(size(page().ray_map(other())) && size(page().ray_map(image(3, |_| 1.0))));
    let values = Image::filled(6, 5, 1, 0_u16).unwrap();
    assert!(size(page().grey_picture(GreyPicture { values, largest: 1 })));
    let two = Page::new("p", image(2, |_| 1.0), Quantity::Exposure);
    assert_eq!(two, Err(ReportError::Components { components: 2 }));
    assert!(page().pixel_aspect(f64::NAN).is_err() && page().pixel_aspect(0.0).is_err());
}

#[test]
fn values_that_are_none_are_counted_and_shown() {
    let picture = image(1, |i| if i == 3 { f32::NAN } else { i as f32 });
    let html = Page::new("p", picture, Quantity::Exposure).unwrap().to_html();
    assert!(html.contains("exposure: 1 of 24 pixels have no finite value."));
    let nothing = Page::new("p", image(3, |_| f32::NAN), Quantity::Radiance).unwrap().to_html();
    with_document(&nothing, |_| ());
}

/// Noise of a few percent, the hardest kind of picture to compress.
fn noisy(columns: usize, rows: usize) -> Image<f32> {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    };
    let data = (0..3 * columns * rows).map(|i| (1.0 + (i / 3 % columns) as f32) * (0.9 + 0.2 * random())).collect();
    Image::new(columns, rows, 3, data).unwrap()
}

#[test]
fn a_noisy_4k_picture_stays_below_sixty_megabytes_and_keeps_its_pixels() {
    let html = Page::new("4k", noisy(3840, 2160), Quantity::Radiance).unwrap().to_html();
    assert!(html.len() < 60_000_000, "{} bytes", html.len());
    assert!(html.contains("\"columns\":3840") && html.contains("\"side\":1"));
}

#[test]
fn a_larger_picture_is_averaged_and_says_so() {
    let columns = 4 * MOST_PIXELS / 1000;
    let html = Page::new("wide", Image::filled(columns, 1000, 1, 1.0).unwrap(), Quantity::Exposure).unwrap().to_html();
    assert!(html.contains("means over squares of 2 × 2 pixels"));
    assert!(html.contains(&format!("\"columns\":{}", columns / 2)));
    assert!(html.len() < 5_000_000, "{} bytes", html.len());
}
