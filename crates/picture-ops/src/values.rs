//! `pvalue`: pixels as numbers, and back.

use crate::brightness::Brightness;
use radsight_picture::put_scientific;

/// The format of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberForm {
    /// Text with four digits.
    Text,
    /// Integers as text, 256 for 1.
    Integer,
    /// A byte, 256 for 1.
    Byte,
    /// Sixteen bits, 65536 for 1.
    Word,
    /// Single precision.
    Float,
    /// Double precision.
    Double,
}

/// The printed part of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All three components.
    All,
    /// Its brightness.
    Brightness,
    /// One component, from 0.
    Component(usize),
}

/// The order of the components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComponentOrder {
    /// Red, green, blue.
    Forward,
    /// Blue, green, red.
    Backward,
}

/// The byte order of binary numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ByteOrder {
    /// The machine's order.
    Native,
    /// The opposite order.
    Swapped,
}

/// The layout of pixels as numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValueLayout {
    /// The format of a number.
    pub form: NumberForm,
    /// The printed part of a pixel.
    pub part: Part,
    /// The order of the components.
    pub order: ComponentOrder,
    /// The byte order of binary numbers.
    pub bytes: ByteOrder,
}

/// A word that is not a number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{found}\" is not a number")]
pub struct NotANumber {
    found: String,
}

impl NumberForm {
    /// The value of the header's `FORMAT` line, for one or three numbers per pixel.
    #[must_use]
    pub fn format_name(self, part: Part) -> &'static str {
        match (self, part) {
            (NumberForm::Text | NumberForm::Integer, _) => "ascii",
            (NumberForm::Byte, Part::All) => "24-bit_rgb",
            (NumberForm::Byte, _) => "8-bit_grey",
            (NumberForm::Word, Part::All) => "48-bit_rgb",
            (NumberForm::Word, _) => "16-bit_grey",
            (NumberForm::Float, _) => "float",
            (NumberForm::Double, _) => "double",
        }
    }

    /// Size of a binary number in bytes; `None` for text.
    #[must_use]
    pub fn size(self) -> Option<usize> {
        match self {
            NumberForm::Text | NumberForm::Integer => None,
            NumberForm::Byte => Some(1),
            NumberForm::Word => Some(2),
            NumberForm::Float => Some(4),
            NumberForm::Double => Some(8),
        }
    }
}

impl ValueLayout {
    /// Numbers per pixel.
    #[must_use]
    pub fn numbers(&self) -> usize {
        if self.part == Part::All { 3 } else { 1 }
    }

    /// Writes a pixel.
    pub fn put(&self, pixel: [f32; 3], brightness: &Brightness, out: &mut Vec<u8>) {
        match self.part {
            Part::All => {
                let [red, green, blue] = pixel.map(f64::from);
                match self.order {
                    ComponentOrder::Forward => self.put_numbers(&[red, green, blue], out),
                    ComponentOrder::Backward => self.put_numbers(&[blue, green, red], out),
                }
            }
            Part::Brightness => self.put_numbers(&[brightness.of(&pixel)], out),
            Part::Component(index) => self.put_numbers(&[f64::from(pixel[index])], out),
        }
    }

    fn put_numbers(&self, numbers: &[f64], out: &mut Vec<u8>) {
        match self.form {
            NumberForm::Text => put_text(numbers, out, put_wide),
            NumberForm::Integer => put_text(numbers, out, |number, out| {
                out.extend_from_slice(((number * 256.0) as i32).to_string().as_bytes());
            }),
            NumberForm::Byte => out.extend(numbers.iter().map(|number| (number * 256.0) as u8)),
            NumberForm::Word => {
                self.put_bytes(numbers.iter().map(|number| ((number * 65536.0) as u16).to_ne_bytes()), out)
            }
            NumberForm::Float => self.put_bytes(numbers.iter().map(|number| (*number as f32).to_ne_bytes()), out),
            NumberForm::Double => self.put_bytes(numbers.iter().map(|number| number.to_ne_bytes()), out),
        }
    }

    fn put_bytes<const N: usize>(&self, numbers: impl Iterator<Item = [u8; N]>, out: &mut Vec<u8>) {
        for mut bytes in numbers {
            if self.bytes == ByteOrder::Swapped {
                bytes.reverse();
            }
            out.extend_from_slice(&bytes);
        }
    }

    /// Parses a number from bytes or a word of text.
    ///
    /// # Errors
    /// [`NotANumber`] for a word that is not a number.
    ///
    /// # Panics
    /// If a binary number does not have [`NumberForm::size`] bytes.
    pub fn number(&self, bytes: &[u8]) -> Result<f64, NotANumber> {
        let text = || {
            let number = std::str::from_utf8(bytes).ok().and_then(|text| text.parse::<f64>().ok());
            number.ok_or_else(|| NotANumber { found: String::from_utf8_lossy(bytes).chars().take(40).collect() })
        };
        Ok(match self.form {
            NumberForm::Text => text()?,
            NumberForm::Integer => (text()?.trunc() + 0.5) / 256.0,
            NumberForm::Byte => (f64::from(bytes[0]) + 0.5) / 256.0,
            NumberForm::Word => (f64::from(u16::from_ne_bytes(self.ordered(bytes))) + 0.5) / 65536.0,
            NumberForm::Float => f64::from(f32::from_ne_bytes(self.ordered(bytes))),
            NumberForm::Double => f64::from_ne_bytes(self.ordered(bytes)),
        })
    }

    fn ordered<const N: usize>(&self, bytes: &[u8]) -> [u8; N] {
        let mut ordered = [0; N];
        ordered.copy_from_slice(bytes);
        if self.bytes == ByteOrder::Swapped {
            ordered.reverse();
        }
        ordered
    }

    /// The pixel of three numbers, in their order.
    #[must_use]
    pub fn pixel(&self, numbers: [f64; 3]) -> [f32; 3] {
        let [first, second, third] = numbers.map(|number| number as f32);
        match self.order {
            ComponentOrder::Forward => [first, second, third],
            ComponentOrder::Backward => [third, second, first],
        }
    }
}

fn put_text(numbers: &[f64], out: &mut Vec<u8>, put: impl Fn(f64, &mut Vec<u8>)) {
    for (index, number) in numbers.iter().enumerate() {
        if index > 0 {
            out.push(b' ');
        }
        put(*number, out);
    }
    out.push(b'\n');
}

/// Format `%15.3e`.
fn put_wide(number: f64, out: &mut Vec<u8>) {
    const WIDTH: usize = 15;
    let start = out.len();
    out.extend_from_slice(&[b' '; WIDTH]);
    put_scientific(number, 3, out);
    let surplus = (out.len() - start - WIDTH).min(WIDTH);
    out.drain(start..start + surplus);
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_picture::Encoding;

    fn layout(form: NumberForm) -> ValueLayout {
        ValueLayout { form, part: Part::All, order: ComponentOrder::Backward, bytes: ByteOrder::Swapped }
    }

    #[test]
    fn binary_numbers_come_back_to_their_precision() {
        let brightness = Brightness::new(Encoding::Rgbe, 3);
        let pixel = [0.25f32, 0.5, 0.125];
        for (form, tolerance) in [
            (NumberForm::Byte, 0.5 / 256.0),
            (NumberForm::Word, 0.5 / 65536.0),
            (NumberForm::Float, 0.0),
            (NumberForm::Double, 0.0),
        ] {
            let layout = layout(form);
            let mut bytes = Vec::new();
            layout.put(pixel, &brightness, &mut bytes);
            let size = form.size().unwrap();
            assert_eq!(bytes.len(), 3 * size);
            let numbers: Vec<f64> = bytes.chunks(size).map(|bytes| layout.number(bytes).unwrap()).collect();
            let back = layout.pixel([numbers[0], numbers[1], numbers[2]]);
            for (value, there) in pixel.iter().zip(back) {
                assert!((value - there).abs() <= tolerance, "{form:?}: {value} {there}");
            }
        }
    }

    #[test]
    fn bright_pixels_stop_at_the_largest_byte() {
        let mut bytes = Vec::new();
        layout(NumberForm::Byte).put([3.0, 0.5, 0.0], &Brightness::new(Encoding::Rgbe, 3), &mut bytes);
        assert_eq!(bytes, [0, 128, 255]);
    }
}
