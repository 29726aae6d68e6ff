//! Variants of TIFF that this crate does not write: planes, tiles, other numbers, alpha.
#![cfg(feature = "tiff")]

use radsight_picture::{Tiff, TiffPixels, read_tiff_pixels};

const PHOTOMETRIC: u16 = 262;
const FILL_ORDER: u16 = 266;
const PLANAR: u16 = 284;
const EXTRA_SAMPLES: u16 = 338;
const SAMPLE_FORMAT: u16 = 339;
/// Tags of 32-bit numbers: sizes, offsets and lengths.
const LONGS: [u16; 9] = [256, 257, 273, 278, 279, 322, 323, 324, 325];

/// A file of 4 x 2 pixels in uncompressed chunks, by the number and bits of samples.
struct File {
    samples: u32,
    bits: u32,
    tags: Vec<(u16, Vec<u32>)>,
    chunks: Vec<Vec<u8>>,
    /// Width and height of tiles; strips if there are none.
    tiles: Option<[u32; 2]>,
}

impl File {
    fn new(samples: u32, bits: u32, chunks: &[&[u8]]) -> File {
        let photometric = if samples < 3 { 1 } else { 2 };
        let chunks = chunks.iter().map(|chunk| chunk.to_vec()).collect();
        File { samples, bits, tags: vec![(PHOTOMETRIC, vec![photometric])], chunks, tiles: None }
    }

    fn with(mut self, tag: u16, values: &[u32]) -> File {
        self.tags.retain(|(known, _)| *known != tag);
        self.tags.push((tag, values.to_vec()));
        self
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = b"II\x2a\0\0\0\0\0".to_vec();
        let (mut offsets, mut lengths) = (Vec::new(), Vec::new());
        for chunk in &self.chunks {
            offsets.push(bytes.len() as u32);
            lengths.push(chunk.len() as u32);
            bytes.extend(chunk);
        }
        let mut tags = self.tags.clone();
        tags.extend([(256, vec![4]), (257, vec![2]), (258, vec![self.bits; self.samples as usize])]);
        tags.push((277, vec![self.samples]));
        match self.tiles {
            None => tags.extend([(273, offsets), (278, vec![2]), (279, lengths)]),
            Some([width, height]) => {
                tags.extend([(322, vec![width]), (323, vec![height]), (324, offsets), (325, lengths)]);
            }
        }
        tags.sort_unstable();
        let mut directory = (tags.len() as u16).to_le_bytes().to_vec();
        for (tag, values) in &tags {
            let is_long = LONGS.contains(tag);
            directory.extend([*tag, if is_long { 4 } else { 3 }].map(u16::to_le_bytes).concat());
            directory.extend((values.len() as u32).to_le_bytes());
            let size = if is_long { 4 } else { 2 };
            let mut stored: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()[..size].to_vec()).collect();
            if stored.len() > 4 {
                let offset = bytes.len() as u32;
                bytes.append(&mut stored);
                stored.extend(offset.to_le_bytes());
            }
            stored.resize(4, 0);
            directory.extend(stored);
        }
        let start = bytes.len() as u32;
        bytes[4..8].copy_from_slice(&start.to_le_bytes());
        bytes.extend(directory);
        bytes.extend([0; 4]);
        bytes
    }

    #[track_caller]
    fn read(&self) -> Tiff {
        read_tiff_pixels(&self.bytes()).expect("a TIFF")
    }

    #[track_caller]
    fn error(&self) -> String {
        read_tiff_pixels(&self.bytes()).expect_err("an error").to_string()
    }
}

/// 4 x 2 samples from a number.
fn plane(first: u8) -> Vec<u8> {
    (first..first + 8).collect()
}

#[test]
fn planes_of_bytes_and_words_are_interleaved() {
    let planes = [plane(0), plane(100), plane(200)];
    let planes: Vec<&[u8]> = planes.iter().map(Vec::as_slice).collect();
    let tiff = File::new(3, 8, &planes).with(PLANAR, &[2]).read();
    let expected: Vec<u8> = (0..8).flat_map(|i| [i, 100 + i, 200 + i]).collect();
    assert_eq!((tiff.components, tiff.pixels), (3, TiffPixels::Bytes(expected.clone())));

    let words: Vec<Vec<u8>> = planes.iter().map(|plane| plane.iter().flat_map(|byte| [7, *byte]).collect()).collect();
    let words: Vec<&[u8]> = words.iter().map(Vec::as_slice).collect();
    let tiff = File::new(3, 16, &words).with(PLANAR, &[2]).read();
    assert_eq!(tiff.pixels, TiffPixels::Words(expected.iter().map(|byte| u16::from(*byte) << 8 | 7).collect()));
}

#[test]
fn planes_in_tiles_are_interleaved() {
    // Two tiles of 2 x 2 pixels for each plane.
    let tile = |plane: u8, left: u8| [0, 1, 4, 5].map(|at| 80 * plane + left + at).to_vec();
    let tiles: Vec<Vec<u8>> = (0..3).flat_map(|number| [tile(number, 0), tile(number, 2)]).collect();
    let tiles: Vec<&[u8]> = tiles.iter().map(Vec::as_slice).collect();
    let mut file = File::new(3, 8, &tiles).with(PLANAR, &[2]);
    file.tiles = Some([2, 2]);
    let expected: Vec<u8> = (0..8).flat_map(|i| [i, 80 + i, 160 + i]).collect();
    assert_eq!(file.read().pixels, TiffPixels::Bytes(expected));
}

#[test]
fn alpha_and_other_extra_samples_do_not_move_colours() {
    let pixels: Vec<u8> = (0..8).flat_map(|i| [i, 100 + i, 200 + i, 255]).collect();
    for (extra, components) in [(0, 3), (1, 4), (2, 4)] {
        let tiff = File::new(4, 8, &[&pixels]).with(EXTRA_SAMPLES, &[extra]).read();
        assert_eq!(tiff.components, components);
        let TiffPixels::Bytes(bytes) = &tiff.pixels else { panic!("bytes") };
        assert!(bytes.chunks(components).zip(pixels.chunks(4)).all(|(a, b)| a[..3] == b[..3]), "{bytes:?}");
    }
    let planes = [plane(0), plane(100), plane(200), plane(40)];
    let planes: Vec<&[u8]> = planes.iter().map(Vec::as_slice).collect();
    for (extra, components) in [(0, 3), (2, 4)] {
        let tiff = File::new(4, 8, &planes).with(EXTRA_SAMPLES, &[extra]).with(PLANAR, &[2]).read();
        let TiffPixels::Bytes(bytes) = &tiff.pixels else { panic!("bytes") };
        assert_eq!((tiff.components, bytes.len()), (components, 8 * components));
        assert!(bytes.chunks(components).zip(pixels.chunks(4)).all(|(a, b)| a[..3] == b[..3]), "{bytes:?}");
    }
}

#[test]
fn other_numbers_become_floats() {
    // 1 and 0.5 as halves, doubles and integers of 32 bits.
    let halves = [0, 0x3c, 0, 0x38].repeat(4);
    let doubles = [1f64.to_le_bytes(), 0.5f64.to_le_bytes()].concat().repeat(4);
    let longs = [u32::MAX.to_le_bytes(), (u32::MAX / 2).to_le_bytes()].concat().repeat(4);
    for (bits, format, bytes) in [(16, 3, halves), (64, 3, doubles), (32, 1, longs)] {
        let tiff = File::new(1, bits, &[&bytes]).with(SAMPLE_FORMAT, &[format]).read();
        assert_eq!(tiff.pixels, TiffPixels::Floats([1.0, 0.5].repeat(4)), "{bits} bits");
    }
}

#[test]
fn white_may_be_zero() {
    let tiff = File::new(1, 8, &[&plane(0)]).with(PHOTOMETRIC, &[0]).read();
    assert_eq!(tiff.pixels, TiffPixels::Bytes((0..8).map(|value| 255 - value).collect()));
}

#[test]
fn what_is_not_supported_is_named() {
    let zeros = [0u8; 64];
    let pixels = |samples: u32, bits: u32| File::new(samples, bits, &[&zeros[..(samples * bits) as usize]]);
    for (file, message) in [
        (File::new(1, 1, &[&[0xf0, 0x0f]]), "1 bits per value is not supported, expected 8, 16 or 32 bits"),
        (pixels(1, 4), "4 bits per value"),
        (pixels(3, 12), "12 bits per value"),
        (pixels(1, 24), "24 bits per value"),
        (pixels(1, 8).with(SAMPLE_FORMAT, &[2]), "signed or 64-bit integers"),
        (pixels(1, 16).with(SAMPLE_FORMAT, &[2]), "signed or 64-bit integers"),
        (pixels(1, 64), "signed or 64-bit integers"),
        (pixels(2, 8).with(EXTRA_SAMPLES, &[2]), "2 values of a grey pixel"),
        (pixels(4, 8).with(PHOTOMETRIC, &[5]), "CMYK"),
        (pixels(1, 8).with(PHOTOMETRIC, &[3]), "RGBPalette"),
        (pixels(3, 8).with(PHOTOMETRIC, &[6]).with(530, &[1, 1]), "YCbCr(8) pixels is not supported"),
        (pixels(3, 8).with(PHOTOMETRIC, &[8]), "CIELab"),
        (pixels(1, 16).with(PHOTOMETRIC, &[32_844]), "tiff: "),
        (pixels(1, 8).with(FILL_ORDER, &[2]), "reversed bits (FillOrder 2)"),
        (File::new(3, 8, &[&plane(0), &plane(1)]).with(PLANAR, &[2]), "tiff: "),
        (File::new(3, 8, &[&plane(0)]), "8 bytes of pixels, expected 24"),
    ] {
        let error = file.error();
        assert!(error.contains(message), "{error}, expected {message}");
    }
}
