//! Transform options: `-t -rx -ry -rz -s -mx -my -mz -i`.
//!
//! They stand after the options of `xform`, and at the end of the string arguments of functions,
//! data and instances. Transforms apply from left to right; `-i n` ends a group and repeats the
//! next one `n` times.

use crate::syntax::{is_space, parse_integer, parse_real};
use glam::{DMat3, DVec3};
use radsight_ir::Transform;

/// A transform, and the number of words that describe it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TransformWords {
    pub(crate) transform: Transform,
    pub(crate) taken: usize,
    /// Why the next word is not part of the transform, if it looks like an option.
    pub(crate) stopped: Option<Stopped>,
}

/// A word that looks like part of a transform but is not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Stopped {
    /// Index of the faulty word; one past the last word if one is missing.
    pub(crate) index: usize,
    pub(crate) mistake: String,
}

/// Parses a transform in the notation of `xform`, such as `-rz 30 -t 1 0 0`. Options apply from
/// left to right.
///
/// # Errors
/// The index of the faulty word and the reason.
pub fn transform<W: AsRef<str>>(words: &[W]) -> Result<Transform, (usize, String)> {
    let read = read(words);
    match (read.stopped, words.get(read.taken)) {
        (Some(stopped), _) => Err((stopped.index, stopped.mistake)),
        (None, Some(word)) => {
            let mistake =
                format!("\"{}\" is not a transform option, expected an option such as -t or -rz", word.as_ref());
            Err((read.taken, mistake))
        }
        (None, None) => Ok(read.transform),
    }
}

/// Whether a word begins a transform.
pub(crate) fn begins_transform(word: &str) -> bool {
    matches!(word, "-t" | "-s" | "-i" | "-rx" | "-ry" | "-rz" | "-mx" | "-my" | "-mz")
}

/// Reads words up to the first that is not part of a transform.
pub(crate) fn read<W: AsRef<str>>(words: &[W]) -> TransformWords {
    let mut reader = Reader { words, next: 0 };
    let mut before = Transform::IDENTITY;
    let mut group = Transform::IDENTITY;
    let mut repeats = 1;
    let stopped = loop {
        let start = reader.next;
        match reader.step() {
            Ok(Step::Part(part)) => group = group.then(&part),
            Ok(Step::Repeat(count)) => {
                before = before.then(&power(group, repeats));
                (group, repeats) = (Transform::IDENTITY, count);
            }
            Ok(Step::End) => {
                reader.next = start;
                break None;
            }
            Err(stopped) => {
                reader.next = start;
                break Some(stopped);
            }
        }
    };
    TransformWords { transform: before.then(&power(group, repeats)), taken: reader.next, stopped }
}

enum Step {
    Part(Transform),
    Repeat(i64),
    End,
}

struct Reader<'a, W> {
    words: &'a [W],
    next: usize,
}

impl<W: AsRef<str>> Reader<'_, W> {
    fn step(&mut self) -> Result<Step, Stopped> {
        let Some(word) = self.words.get(self.next).map(AsRef::as_ref) else { return Ok(Step::End) };
        if !word.starts_with('-') {
            return Ok(Step::End);
        }
        let index = self.next;
        self.next += 1;
        Ok(Step::Part(match word {
            "-t" => {
                let offset = [self.real("x of -t")?, self.real("y of -t")?, self.real("z of -t")?];
                Transform { translation: DVec3::from_array(offset), ..Transform::IDENTITY }
            }
            "-rx" => rotation(DVec3::X, self.real("the angle of -rx")?),
            "-ry" => rotation(DVec3::Y, self.real("the angle of -ry")?),
            "-rz" => rotation(DVec3::Z, self.real("the angle of -rz")?),
            "-s" => self.scale()?,
            "-mx" => mirror(DVec3::X),
            "-my" => mirror(DVec3::Y),
            "-mz" => mirror(DVec3::Z),
            "-i" => return self.integer("the count of -i").map(Step::Repeat),
            _ => return Err(Stopped { index, mistake: format!("unknown transform option \"{word}\"") }),
        }))
    }

    fn scale(&mut self) -> Result<Transform, Stopped> {
        let index = self.next;
        let factor = self.real("the factor of -s")?;
        if factor == 0.0 {
            return Err(Stopped { index, mistake: "the factor of -s is 0".to_owned() });
        }
        // A negative factor also inverts the object.
        let rotation = if factor < 0.0 { -DMat3::IDENTITY } else { DMat3::IDENTITY };
        Ok(Transform { rotation, scale: factor.abs(), translation: DVec3::ZERO })
    }

    fn real(&mut self, what: &str) -> Result<f64, Stopped> {
        self.value(what, "a number", |word| parse_real(word).filter(|value| value.is_finite()))
    }

    fn integer(&mut self, what: &str) -> Result<i64, Stopped> {
        self.value(what, "an integer", parse_integer)
    }

    fn value<T>(&mut self, what: &str, form: &str, parse: impl Fn(&[u8]) -> Option<T>) -> Result<T, Stopped> {
        let index = self.next;
        let Some(word) = self.words.get(index).map(AsRef::as_ref) else {
            return Err(Stopped { index, mistake: format!("missing {what}") });
        };
        self.next += 1;
        let number = word.trim_matches(|character: char| character.is_ascii() && is_space(character as u8));
        let mistake = || Stopped { index, mistake: format!("{what} is \"{word}\", expected {form}") };
        parse(number.as_bytes()).ok_or_else(mistake)
    }
}

/// A rotation about an axis; multiples of 90 degrees are exact.
fn rotation(axis: DVec3, degrees: f64) -> Transform {
    let (sine, cosine) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => degrees.to_radians().sin_cos(),
    };
    let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(|unit| {
        let along = axis * axis.dot(unit);
        along + (unit - along) * cosine + axis.cross(unit) * sine
    });
    Transform { rotation: DMat3::from_cols(columns[0], columns[1], columns[2]), ..Transform::IDENTITY }
}

fn mirror(axis: DVec3) -> Transform {
    Transform { rotation: DMat3::from_diagonal(DVec3::ONE - 2.0 * axis), ..Transform::IDENTITY }
}

/// The transform applied `count` times; the identity for zero and below.
fn power(transform: Transform, count: i64) -> Transform {
    let (mut result, mut square, mut left) = (Transform::IDENTITY, transform, count.max(0));
    while left > 0 {
        if left & 1 == 1 {
            result = result.then(&square);
        }
        square = square.then(&square);
        left >>= 1;
    }
    result
}

/// Words that parse back to the transform: mirror, scale, rotations about x, y and z, translation.
pub(crate) fn write(transform: &Transform) -> Vec<String> {
    let mut words = Vec::new();
    let mut option = |name: &str, values: &[f64]| {
        words.push(name.to_owned());
        words.extend(values.iter().map(|value| value.to_string()));
    };
    let mut turn = transform.rotation;
    if transform.is_mirror_image() {
        option("-mx", &[]);
        turn *= DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    }
    if transform.scale != 1.0 {
        option("-s", &[transform.scale]);
    }
    // turn = Rz·Ry·Rx, so that Rx is applied first.
    let about_y = (-turn.x_axis.z).atan2(turn.x_axis.x.hypot(turn.x_axis.y));
    let is_locked = turn.x_axis.x.hypot(turn.x_axis.y) < 1e-9;
    let (about_x, about_z) = if is_locked {
        ((-turn.z_axis.y).atan2(turn.y_axis.y), 0.0)
    } else {
        (turn.y_axis.z.atan2(turn.z_axis.z), turn.x_axis.y.atan2(turn.x_axis.x))
    };
    for (name, angle) in [("-rx", about_x), ("-ry", about_y), ("-rz", about_z)] {
        if angle != 0.0 {
            option(name, &[angle.to_degrees()]);
        }
    }
    if transform.translation != DVec3::ZERO {
        option("-t", &transform.translation.to_array());
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(text: &str) -> TransformWords {
        read(&text.split_whitespace().collect::<Vec<_>>())
    }

    fn point(text: &str, point: [f64; 3]) -> [f64; 3] {
        let read = of(text);
        assert_eq!(read.stopped, None);
        read.transform.point(DVec3::from_array(point)).to_array()
    }

    #[test]
    fn parts_apply_from_left_to_right() {
        assert_eq!(point("-t 1 0 0 -rz 90", [0.0; 3]), [0.0, 1.0, 0.0]);
        assert_eq!(point("-rz 90 -t 1 0 0", [0.0; 3]), [1.0, 0.0, 0.0]);
        assert_eq!(point("-s 2 -mx -t 0 0 1", [1.0, 2.0, 3.0]), [-2.0, 4.0, 7.0]);
        assert_eq!(point("-ry 90", [1.0, 0.0, 0.0]), [0.0, 0.0, -1.0]);
        assert_eq!(point("-rx -90", [0.0, 1.0, 0.0]), [0.0, 0.0, -1.0]);
    }

    #[test]
    fn a_group_is_repeated() {
        assert_eq!(point("-i 3 -t 1 0 0 -i 1 -rz 90", [0.0; 3]), [0.0, 3.0, 0.0]);
        assert_eq!(point("-t 5 5 5 -i 0 -t 1 0 0", [0.0; 3]), [5.0; 3]);
        assert_eq!(point("-i 1000000000 -t 1 0 0", [0.0; 3]), [1e9, 0.0, 0.0]);
    }

    #[test]
    fn a_negative_scale_is_a_mirror_image() {
        let transform = of("-s -2").transform;
        assert!(transform.is_mirror_image());
        assert_eq!(transform.scale, 2.0);
        assert!(!of("-s -1 -mx").transform.is_mirror_image());
    }

    #[test]
    fn reading_stops_at_the_first_other_word() {
        assert_eq!(of("-t 1 2 3 file.rad -rx 2").taken, 4);
        let wrong = of("-rx 3 -t 1 2");
        assert_eq!((wrong.taken, wrong.stopped.unwrap()), (2, Stopped { index: 5, mistake: "missing z of -t".into() }));
        let wrong = of("-rz x");
        assert_eq!(wrong.stopped.unwrap().mistake, "the angle of -rz is \"x\", expected a number");
        assert_eq!(of("-s 0").stopped.unwrap().mistake, "the factor of -s is 0");
        assert_eq!(of("-q").stopped.unwrap().index, 0);
    }

    proptest! {
        #[test]
        fn written_words_read_back(angles in prop::array::uniform3(-2_i32..=2), more in prop::array::uniform3(-180.0..180.0_f64), mirrored in any::<bool>(), scale in 0.1..10.0_f64) {
            let [x, y, z] = [0, 1, 2].map(|axis| if more[axis] > 0.0 { f64::from(angles[axis]) * 90.0 } else { more[axis] });
            let text = format!("-rx {x} -ry {y} -rz {z} {} -s {scale} -t 1 2 3", if mirrored { "-my" } else { "" });
            let transform = of(&text).transform;
            let words = write(&transform);
            let back = read(&words);
            prop_assert_eq!(back.taken, words.len());
            for corner in [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z] {
                prop_assert!(back.transform.point(corner).distance(transform.point(corner)) < 1e-8, "{:?}", words);
            }
        }
    }
}
