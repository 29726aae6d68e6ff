//! No input makes the reader panic, hang or use more memory than its size justifies; errors are
//! reported.

use proptest::prelude::*;
use radsight_measured::{MeasuredBsdf, Mistake};
use radsight_test_support::bsdf_files::{DIRECTIONS, Recipe, block, file, tensor};

fn mistake(text: &str) -> String {
    MeasuredBsdf::read(text.as_bytes()).unwrap_err().to_string()
}

/// The text at an error's position.
fn pointed_at(text: &str) -> String {
    let mistake = MeasuredBsdf::read(text.as_bytes()).unwrap_err();
    text[mistake.place()].to_owned()
}

const KLEMS: &str =
    "<ColumnAngleBasis>LBNL/Klems Quarter</ColumnAngleBasis><RowAngleBasis>LBNL/Klems Quarter</RowAngleBasis>";

fn quarter(data: &str) -> String {
    file("Columns", "", &block("Visible", DIRECTIONS[1], KLEMS, data))
}

#[test]
fn errors_name_what_was_expected_and_where() {
    let numbers = vec!["0.1"; 41 * 41];
    let with = |at: usize, word: &'static str| {
        let mut numbers = numbers.clone();
        numbers[at] = word;
        quarter(&numbers.join(","))
    };
    let tree = |data: &str| {
        let basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";
        file("TensorTree3", "", &block("Visible", DIRECTIONS[1], basis, data))
    };
    for (text, expected, place) in [
        ("<a/>".to_owned(), "the top element is \"a\", expected \"WindowElement\"", "<a"),
        ("<WindowElement/>".to_owned(), "there is no <Optical> in <WindowElement>", "<WindowElement"),
        (
            file("Rings", "", ""),
            "<IncidentDataStructure> is \"Rings\", expected \"Columns\", \"Rows\", \"TensorTree3\", \"TensorTree4\"",
            "Rings",
        ),
        (with(1000, "x"), "a scattering value is \"x\", expected a finite number", "x"),
        (with(1000, "nan"), "a scattering value is \"nan\", expected a finite number", "nan"),
        (quarter(&numbers[1..].join(" ")), "the scattering data hold 1680 numbers, expected 1681", ""),
        (quarter("1, 2"), "the scattering data hold 2 numbers, expected 1681", "\n1, 2\n"),
        (tree("{ {1} {2} }"), "the tensor tree has \"}\", expected \"{\"", "}"),
        (tree("{ 1 2 }"), "the scattering data hold 2 numbers, expected a power of 8", "{"),
    ] {
        assert_eq!(mistake(&text), expected);
        assert_eq!(pointed_at(&text), place, "{expected}");
    }
}

#[test]
fn text_around_the_xml_is_ignored_and_errors_keep_their_positions() {
    let numbers = vec!["0.1"; 41 * 41];
    let right = quarter(&numbers.join(","));
    let wrong = quarter(&[&numbers[1..], &["x"]].concat().join(","));
    for words in ["genBSDF -n 4 +f < room.rad > a.xml\n", "1 < 2\n<- here:", "G\u{e9}n\u{e9}ral\n"] {
        let read = |text: &str| format!("{:?}", MeasuredBsdf::read(text.as_bytes()).expect("a BSDF").bsdf);
        assert_eq!(read(&format!("{words}{right}\ndone\n")), read(&right));
        assert_eq!(pointed_at(&format!("{words}{wrong} done")), "x");
    }
    for nothing in ["", "\n", "genBSDF: cannot open room.rad\nexit 1\n", "a < b > c", "<"] {
        assert_eq!(mistake(nothing), "there is no XML in it", "{nothing:?}");
    }
    assert_eq!(pointed_at("genBSDF: fails\nexit 1\n"), "genBSDF: fails");
}

#[test]
fn a_basis_is_known_by_its_name_or_from_the_file() {
    let text = quarter("").replace("LBNL/Klems Quarter</Row", "Tregenza</Row");
    let expected =
        "<RowAngleBasis> is \"Tregenza\", expected \"LBNL/Klems Full\", \"LBNL/Klems Half\", \"LBNL/Klems Quarter\"";
    assert_eq!(mistake(&text), expected);
}

#[test]
fn more_numbers_than_pairs_are_ignored_with_a_warning() {
    let reading = MeasuredBsdf::read(quarter(&vec!["0.1"; 41 * 41 + 3].join(",")).as_bytes()).unwrap();
    assert!(matches!(reading.warnings[..], [Mistake::Count { .. }]));
}

#[test]
fn a_file_without_visible_data_is_black_with_a_warning() {
    let text = file("Columns", "", &block("Solar", DIRECTIONS[1], KLEMS, "none of it is read"));
    let reading = MeasuredBsdf::read(text.as_bytes()).unwrap();
    assert_eq!(reading.bsdf.value(glam::DVec3::Z, glam::DVec3::Z), [0.0; 3]);
    assert!(matches!(reading.warnings[..], [Mistake::Missing { element: "Visible", .. }]));
}

#[test]
fn names_in_latin_1_are_read_and_later_positions_are_right() {
    let text = quarter("1, x").replace("nobody", "M\u{fc}ller");
    let bytes: Vec<u8> = text.chars().map(|character| character as u8).collect();
    let mistake = MeasuredBsdf::read(&bytes).unwrap_err();
    assert_eq!(&bytes[mistake.place()], b"\n1, x\n");
}

#[test]
fn utf_16_is_read_and_positions_are_right() {
    let encodings: [fn(u16) -> [u8; 2]; 2] = [u16::to_le_bytes, u16::to_be_bytes];
    for to_bytes in encodings {
        let encoded = |text: &str| text.encode_utf16().flat_map(to_bytes).collect::<Vec<u8>>();
        let file =
            |numbers: &str| encoded(&format!("\u{feff}{}", quarter(numbers).replace("nobody", "M\u{fc}\u{1f600}")));
        let mistake = MeasuredBsdf::read(&file("1, x")).unwrap_err();
        assert_eq!(file("1, x")[mistake.place()], encoded("\n1, x\n"));
        let reading = MeasuredBsdf::read(&file(&vec!["0.1"; 41 * 41].join(","))).unwrap();
        assert_eq!(reading.bsdf.maker, "M\u{fc}\u{1f600}");
        assert!(MeasuredBsdf::read(&to_bytes(0xfeff)).is_err());
        assert!(MeasuredBsdf::read(&[&to_bytes(0xfeff)[..], &to_bytes(0xd800), b"<"].concat()).is_err());
    }
}

#[test]
fn bombs_are_refused() {
    let entities = "<!DOCTYPE a [<!ENTITY b \"xxxxxxxx\">]><WindowElement>&b;</WindowElement>";
    assert!(mistake(entities).starts_with("this is not XML that can be read"));
    let deep = "<WindowElement>".repeat(200_000);
    assert!(MeasuredBsdf::read(deep.as_bytes()).is_err());
    let closed = format!("{}{}", "<a>".repeat(100_000), "</a>".repeat(100_000));
    assert!(MeasuredBsdf::read(closed.as_bytes()).is_err());
    let many = "<a/>".repeat(2_000_000);
    assert!(MeasuredBsdf::read(format!("<WindowElement>{many}</WindowElement>").as_bytes()).is_err());
}

#[test]
fn a_basis_of_a_million_patches_needs_as_many_numbers() {
    let ring = "<AngleBasisBlock><nPhis>1000000</nPhis><ThetaBounds><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock>";
    let basis = format!("<AngleBasis><AngleBasisName>big</AngleBasisName>{ring}</AngleBasis>");
    let bases = "<ColumnAngleBasis>big</ColumnAngleBasis><RowAngleBasis>big</RowAngleBasis>";
    let text = file("Columns", &basis, &block("Visible", DIRECTIONS[1], bases, "1 2 3"));
    assert_eq!(mistake(&text), "the scattering data hold 3 numbers, expected 1000000000000");
    let text = text.replace("1000000", "1e99");
    assert!(mistake(&text).starts_with("<nPhis> is"));
}

#[test]
fn a_tree_with_one_deep_branch_is_sampled() {
    let mut tree = "{ 3 }".to_owned();
    for depth in 0..14 {
        let beside = format!("{{ {} }} ", 0.1 + 0.02 * f64::from(depth));
        tree = format!("{{ {tree} {} }}", beside.repeat(7));
    }
    let basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";
    let text = file("TensorTree3", "", &block("Visible", DIRECTIONS[1], basis, &tree));
    let bsdf = MeasuredBsdf::read(text.as_bytes()).unwrap().bsdf;
    let reflection = bsdf.reflection(radsight_measured::Side::Front).unwrap();
    assert!(reflection.sample(glam::DVec3::new(0.6, 0.0, 0.8), [0.5, 0.5]).is_some());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_are_an_answer(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = MeasuredBsdf::read(&bytes);
    }

    #[test]
    fn a_damaged_file_is_an_answer_too(at in 0.0..1.0_f64, length in 0_usize..60, new in ".{0,20}", seed in 0_u64..4) {
        let dimensions = 3 + (seed % 2) as usize;
        let recipe = Recipe { directions: &DIRECTIONS[..2], is_colored: seed > 1, seed };
        let mut bytes = tensor(dimensions, 2, &recipe).into_bytes();
        let start = (at * bytes.len() as f64) as usize;
        let end = (start + length).min(bytes.len());
        bytes.splice(start..end, new.bytes());
        if let Ok(reading) = MeasuredBsdf::read(&bytes) {
            for direction in [glam::DVec3::Z, glam::DVec3::new(0.8, 0.0, -0.6)] {
                let value = reading.bsdf.value(direction, glam::DVec3::new(0.0, 0.6, 0.8));
                prop_assert!(value.iter().all(|band| band.is_finite() && *band >= 0.0));
                let reflection = reading.bsdf.reflection(radsight_measured::Side::of(direction));
                let _ = reflection.and_then(|reflection| reflection.sample(direction, [0.3, 0.999]));
            }
        }
    }
}
