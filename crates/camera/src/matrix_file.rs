//! Files of calibrated cameras: OpenCV's `FileStorage` (YAML or JSON) and ROS' `CameraInfo` (YAML).
//!
//! Both are mappings with the camera matrix and the distortion, under one of a few names. JSON is
//! read as the YAML that it is.

use crate::section::shorten;
use radsight_diag::{Diagnostic, SourceId, SourceMap};
use radsight_pinhole::{CameraMatrix, Distortion};
use saphyr_parser::{Event, Parser};

/// The largest file that is read, bytes.
const LARGEST_FILE: usize = 1 << 20;
/// How deep lists and mappings may stand in each other.
const DEEPEST: usize = 16;

const MATRIX_NAMES: [&str; 5] = ["camera_matrix", "cameraMatrix", "Camera_Matrix", "K", "k"];
const DISTORTION_NAMES: [&str; 7] = [
    "distortion_coefficients",
    "distortionCoefficients",
    "Distortion_Coefficients",
    "dist_coeffs",
    "distCoeffs",
    "D",
    "d",
];
const WIDTH_NAMES: [&str; 3] = ["image_width", "image_Width", "width"];
const HEIGHT_NAMES: [&str; 3] = ["image_height", "image_Height", "height"];

/// The content of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MatrixFile {
    pub(crate) matrix: CameraMatrix,
    /// Columns and rows, where the file says so.
    pub(crate) pixels: Option<[u32; 2]>,
}

/// Reads the text that stands in `sources` under `source`.
pub(crate) fn read(source: SourceId, sources: &SourceMap) -> Result<MatrixFile, Diagnostic> {
    let whole = sources.span(source, 0, 0);
    let wrong = |message: String| Diagnostic::error(message).at(whole);
    let bytes = sources.text(source).clone();
    if bytes.len() > LARGEST_FILE {
        return Err(wrong(format!("the camera matrix has {} bytes, expected at most {LARGEST_FILE}", bytes.len())));
    }
    let text = std::str::from_utf8(&bytes).map_err(|_| wrong("the camera matrix is not UTF-8 text".to_owned()))?;
    // OpenCV writes `%YAML:1.0`, which is no directive of YAML's.
    let text = text.strip_prefix("%YAML:").map_or(text.to_owned(), |rest| format!("#YAML:{rest}"));
    let root = parse(&text).map_err(|(at, message)| {
        let at = text.char_indices().nth(at).map_or(text.len(), |(byte, _)| byte);
        Diagnostic::error(message).at(sources.span(source, at, at + 1))
    })?;
    understand(&root).map_err(wrong)
}

fn understand(root: &Node) -> Result<MatrixFile, String> {
    let matrix = root.any(&MATRIX_NAMES).ok_or_else(|| format!("there is no {}", MATRIX_NAMES.join(" or ")))?;
    let matrix = matrix.numbers().ok_or("the camera matrix is not made of numbers")?;
    let [fx, skew, cx, zero_a, fy, cy, zero_b, zero_c, one]: [f64; 9] = matrix
        .try_into()
        .map_err(|all: Vec<f64>| format!("the camera matrix has {} numbers, expected 9", all.len()))?;
    if [skew, zero_a, zero_b, zero_c, one - 1.0] != [0.0; 5] {
        return Err("the camera matrix is not [fx 0 cx; 0 fy cy; 0 0 1]".to_owned());
    }
    let coefficients = match root.any(&DISTORTION_NAMES) {
        Some(node) => node.numbers().ok_or("the distortion is not made of numbers")?,
        None => Vec::new(),
    };
    let model = root.get("distortion_model").and_then(Node::word);
    let matrix = CameraMatrix { focal: [fx, fy], center: [cx, cy], distortion: distortion(model, &coefficients)? };
    let count = |names: &[&str]| {
        let number = root.any(names).and_then(Node::word)?.parse::<u32>().ok()?;
        (number > 0).then_some(number)
    };
    let pixels = count(&WIDTH_NAMES).zip(count(&HEIGHT_NAMES)).map(|(width, height)| [width, height]);
    Ok(MatrixFile { matrix: matrix.checked().map_err(|error| error.to_string())?, pixels })
}

fn distortion(model: Option<&str>, coefficients: &[f64]) -> Result<Distortion, String> {
    let count = coefficients.len();
    let counted = |expected: &str| format!("the distortion has {count} coefficients, expected {expected}");
    match model {
        Some("fisheye" | "equidistant") => {
            let all: Result<[f64; 4], _> = coefficients.try_into();
            all.map(Distortion::Fisheye).map_err(|_| counted("4 of a fisheye"))
        }
        None | Some("" | "plumb_bob" | "rational_polynomial" | "pinhole") => {
            // OpenCV's order; 14 are those of a tilted sensor besides.
            if ![0, 4, 5, 8, 12, 14].contains(&count) {
                return Err(counted("0, 4, 5, 8 or 12"));
            }
            if coefficients.iter().skip(12).any(|tilt| *tilt != 0.0) {
                return Err("the tilted sensor of coefficients 13 and 14 is not known; use [alignment]".to_owned());
            }
            Ok(Distortion::Rational(std::array::from_fn(|index| coefficients.get(index).copied().unwrap_or(0.0))))
        }
        Some(other) => Err(format!(
            "unknown distortion_model \"{}\", expected plumb_bob, rational_polynomial, fisheye or equidistant",
            shorten(other)
        )),
    }
}

/// A piece of a file.
#[derive(Clone, Debug, PartialEq)]
enum Node {
    Word(String),
    List(Vec<Node>),
    Map(Vec<(String, Node)>),
}

impl Node {
    fn get(&self, name: &str) -> Option<&Node> {
        let Node::Map(entries) = self else { return None };
        entries.iter().find(|(key, _)| key == name).map(|(_, node)| node)
    }

    fn any(&self, names: &[&str]) -> Option<&Node> {
        names.iter().find_map(|name| self.get(name))
    }

    fn word(&self) -> Option<&str> {
        if let Node::Word(word) = self { Some(word) } else { None }
    }

    /// The numbers of a list, of lists in a list, or of the `data` of a mapping, in order.
    fn numbers(&self) -> Option<Vec<f64>> {
        match self {
            Node::Word(word) => Some(vec![word.parse().ok()?]),
            Node::List(items) => Some(items.iter().map(Node::numbers).collect::<Option<Vec<_>>>()?.concat()),
            Node::Map(_) => self.get("data")?.numbers(),
        }
    }
}

/// The first document of a file. Errors come with their place in characters.
fn parse(text: &str) -> Result<Node, (usize, String)> {
    let mut open: Vec<(Node, Option<String>)> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| (error.marker().index(), error.info().to_owned()))?;
        let at = span.start.index();
        let mut done = match event {
            Event::Scalar(word, ..) => Node::Word(word.into_owned()),
            Event::SequenceStart(..) | Event::MappingStart(..) => {
                if open.len() == DEEPEST {
                    return Err((at, format!("lists are deeper than {DEEPEST} in each other")));
                }
                let is_map = matches!(event, Event::MappingStart(..));
                open.push((if is_map { Node::Map(Vec::new()) } else { Node::List(Vec::new()) }, None));
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some((node, _)) => node,
                None => return Err((at, "unexpected end of a list".to_owned())),
            },
            Event::Alias(_) => return Err((at, "references (*name) are not read".to_owned())),
            _ => continue,
        };
        match open.last_mut() {
            None => return Ok(done),
            Some((Node::List(items), _)) => items.push(done),
            Some((Node::Map(entries), key)) => match (key.take(), &mut done) {
                (Some(name), _) => entries.push((name, done)),
                (None, Node::Word(word)) => *key = Some(std::mem::take(word)),
                (None, _) => return Err((at, "a list cannot be a name".to_owned())),
            },
            Some((Node::Word(_), _)) => return Err((at, "a word holds nothing".to_owned())),
        }
    }
    Err((0, "the camera matrix is empty".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<MatrixFile, String> {
        let mut sources = SourceMap::default();
        let source = sources.add("camera.yaml", text.as_bytes(), None);
        read(source, &sources).map_err(|error| error.render(&sources))
    }

    const OPENCV: &str = "%YAML:1.0\n---\ncalibration_time: \"today\"\nimage_width: 640\nimage_height: 480\n\
        camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 530., 0., 320.5, 0., 531.,\n       241., 0., 0., 1. ]\n\
        distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ -0.28, 9.0e-02, 1.0e-03, -7e-4, -0.012 ]\n";

    #[test]
    fn opencvs_yaml_and_json_and_both_forms_of_ros_are_the_same_camera() {
        let expected = read_text(OPENCV).unwrap();
        assert_eq!(expected.pixels, Some([640, 480]));
        assert_eq!((expected.matrix.focal, expected.matrix.center), ([530.0, 531.0], [320.5, 241.0]));
        let json = "{\"image_width\":640,\"image_height\":480,\"camera_matrix\":{\"type_id\":\"opencv-matrix\",\"rows\":3,\"cols\":3,\
            \"dt\":\"d\",\"data\":[530.0,0.0,320.5,0.0,531.0,241.0,0.0,0.0,1.0]},\"distortion_coefficients\":\
            {\"data\":[-0.28,0.09,0.001,-0.0007,-0.012]}}";
        let ros = "image_width: 640\nimage_height: 480\ncamera_name: c\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [530, 0, 320.5, 0, 531, 241, 0, 0, 1]\n\
            distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.28, 0.09, 0.001, -0.0007, -0.012]\n";
        let echo = "header:\n  seq: 3\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\nD: [-0.28, 0.09, 0.001, -0.0007, -0.012]\n\
            K: [530, 0, 320.5, 0, 531, 241, 0, 0, 1]\n---\n";
        for text in [json, ros, echo] {
            assert_eq!(read_text(text).as_ref(), Ok(&expected));
        }
    }

    #[test]
    fn a_fisheye_is_known_by_its_model() {
        let text = "K: [500, 0, 320, 0, 500, 240, 0, 0, 1]\ndistortion_model: equidistant\nD: [0.1, 0.02, 0, 0]\n";
        assert_eq!(read_text(text).unwrap().matrix.distortion, Distortion::Fisheye([0.1, 0.02, 0.0, 0.0]));
    }

    #[test]
    fn what_cannot_be_read_is_said_with_its_place() {
        let error = |text: &str| read_text(text).unwrap_err();
        assert!(error("").contains("is empty"));
        assert!(error("a: [1, 2\nb: 3\n").starts_with("camera.yaml:"));
        assert!(error("K: [1, 2, 3]\n").contains("has 3 numbers, expected 9"));
        assert!(error("a: 1\n").contains("there is no camera_matrix"));
        let skew = "K: [500, 3, 320, 0, 500, 240, 0, 0, 1]\n";
        assert!(error(skew).contains("is not [fx 0 cx; 0 fy cy; 0 0 1]"));
        assert!(error(&OPENCV.replace("530.", "-530.")).contains("must be positive"));
        assert!(error("K: &a [1]\nD: *a\n").contains("references"));
        assert!(error(&"[".repeat(17)).contains("deeper than 16"));
        // The parser has a limit of its own for what it must look ahead.
        assert!(error(&"[".repeat(100_000)).starts_with("camera.yaml:1:"));
        assert!(
            error("K: [500, 0, 320, 0, 500, 240, 0, 0, 1]\ndistortion_model: kannala\n")
                .contains("unknown distortion_model")
        );
    }
}
