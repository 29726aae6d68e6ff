//! Reads rays from a stream of numbers.

use crate::failure::{Failure, reason};
use glam::DVec3;
use radsight_pinhole::stream::NumberFormat;
use radsight_render::Ray;
use std::io::{ErrorKind, Read};

/// A ray of the stream; `ray` is `None` for a direction of zero, which means "flush" in Radiance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InputRay {
    pub(crate) origin: DVec3,
    pub(crate) ray: Option<Ray>,
    /// Length of the direction.
    pub(crate) length: f64,
}

/// Reads rays, six numbers each.
#[derive(Debug)]
pub(crate) struct RayReader<R> {
    input: R,
    format: NumberFormat,
    buffer: Vec<u8>,
    /// First unread byte of the buffer.
    start: usize,
    ended: bool,
    rays: u64,
    /// Name of the source, for messages.
    source: String,
}

/// Number of bytes per read.
const READ_SIZE: usize = 1 << 16;

/// Longest number in text, bytes.
const LONGEST_WORD: usize = 4096;

impl<R: Read> RayReader<R> {
    pub(crate) fn new(program: &'static str, input: R, format: NumberFormat) -> Self {
        RayReader::of(format!("{program}: standard input"), input, format)
    }

    /// Of a source that has this name in messages.
    pub(crate) fn of(source: String, input: R, format: NumberFormat) -> Self {
        RayReader { input, format, buffer: Vec::new(), start: 0, ended: false, rays: 0, source }
    }

    /// Reads up to `most` rays; fewer only at the end of the stream or before a mistake. Blocks for
    /// one ray at most, if the writer waits for its result.
    pub(crate) fn read(&mut self, most: usize, rays: &mut Vec<InputRay>) -> Result<(), Failure> {
        rays.clear();
        while rays.len() < most {
            match self.next_ray()? {
                Some(ray) => {
                    let flush = ray.ray.is_none();
                    rays.push(ray);
                    if flush {
                        return Ok(());
                    }
                }
                None => return Ok(()),
            }
        }
        Ok(())
    }

    fn next_ray(&mut self) -> Result<Option<InputRay>, Failure> {
        let mut numbers = [0.0; 6];
        for (index, number) in numbers.iter_mut().enumerate() {
            match self.next_number()? {
                Some(value) if value.is_finite() => *number = value,
                Some(value) => {
                    return Err(self.wrong(&format!("number {} is {value}, expected a finite one", index + 1)));
                }
                None if index == 0 => return Ok(None),
                None => return Err(self.wrong(&format!("the stream ends after {index} of 6 numbers"))),
            }
        }
        self.rays += 1;
        let [x, y, z, dx, dy, dz] = numbers;
        let (origin, direction) = (DVec3::new(x, y, z), DVec3::new(dx, dy, dz));
        Ok(Some(InputRay { origin, ray: Ray::new(origin, direction), length: direction.length() }))
    }

    fn wrong(&self, what: &str) -> Failure {
        Failure::input(format!("{}, ray {}: {what}", self.source, self.rays + 1))
    }

    fn next_number(&mut self) -> Result<Option<f64>, Failure> {
        match self.format {
            NumberFormat::Ascii => self.next_word(),
            NumberFormat::Float => {
                self.next_bytes().map(|bytes| bytes.map(|b: [u8; 4]| f64::from(f32::from_ne_bytes(b))))
            }
            NumberFormat::Double => self.next_bytes().map(|bytes| bytes.map(f64::from_ne_bytes)),
        }
    }

    fn next_bytes<const N: usize>(&mut self) -> Result<Option<[u8; N]>, Failure> {
        while self.buffer.len() - self.start < N && !self.ended {
            self.fill()?;
        }
        let Some(bytes) = self.buffer.get(self.start..self.start + N) else {
            let left = self.buffer.len() - self.start;
            return if left == 0 {
                Ok(None)
            } else {
                Err(self.wrong(&format!("the stream ends within a number ({left} of {N} bytes)")))
            };
        };
        self.start += N;
        Ok(bytes.try_into().ok())
    }

    fn next_word(&mut self) -> Result<Option<f64>, Failure> {
        loop {
            let unread = &self.buffer[self.start..];
            let lead = unread.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
            let word = &unread[lead..];
            let length = word.iter().position(u8::is_ascii_whitespace);
            match length {
                Some(length) if length > 0 => {
                    let text = String::from_utf8_lossy(&word[..length]).into_owned();
                    self.start += lead + length;
                    return self.number(&text);
                }
                _ if word.len() > LONGEST_WORD => return Err(self.wrong("a number is longer than 4096 characters")),
                _ if !self.ended => self.fill()?,
                _ if word.is_empty() => return Ok(None),
                _ => {
                    let text = String::from_utf8_lossy(word).into_owned();
                    self.start = self.buffer.len();
                    return self.number(&text);
                }
            }
        }
    }

    fn number(&self, text: &str) -> Result<Option<f64>, Failure> {
        text.parse().map(Some).map_err(|_| self.wrong(&format!("\"{text}\" is not a number")))
    }

    fn fill(&mut self) -> Result<(), Failure> {
        self.buffer.drain(..self.start);
        self.start = 0;
        let before = self.buffer.len();
        self.buffer.resize(before + READ_SIZE, 0);
        let read = loop {
            match self.input.read(&mut self.buffer[before..]) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                other => break other,
            }
        };
        self.buffer.truncate(before + *read.as_ref().unwrap_or(&0));
        match read {
            Ok(0) => self.ended = true,
            Ok(_) => {}
            Err(error) => {
                return Err(Failure::input(format!("cannot read standard input: {}", reason(&error))));
            }
        }
        Ok(())
    }
}
