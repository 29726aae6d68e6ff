//! Small files of every format and random mutations of them; used by property tests and the stress
//! example.

use radsight_picture::{
    FloatMatrix, Header, Image, MatrixFormat, Picture, Resolution, View, ViewOptions, read_image, read_npy, read_pfm,
    read_png, write_npy, write_npy_f64, write_pfm, write_png_grey16, write_png_rgb8,
};

/// One small file of each format.
pub(crate) fn seeds() -> Vec<Vec<u8>> {
    let image = |width: usize, height: usize, components: usize| {
        let data = (0..width * height * components).map(|i| ((i / 5) as f32 * 0.7).sin().abs() + 0.01).collect();
        Image::new(width, height, components, data).unwrap()
    };
    let mut header = Header::new("RADIANCE");
    header.push_command(["rpict", "-vtv", "-vp", "1", "2", "3", "-vd", "1", "0", "-.5"]);
    header.push_variable("EXPOSURE", "1.5");
    header.push_variable("COLORCORR", " 1 2 3");
    header.push_variable("PRIMARIES", " .64 .33 .29 .6 .15 .06 .3333 .3333");
    header.push_variable("PIXASPECT", "1.1");
    header.push_variable("VIEW", " -vta -vh 180 -vv 180 -vo 1 -va 9 -vs .1 -vl .1");
    let rgb = image(20, 6, 3);
    let picture = Picture::from_rgb(header.clone(), &rgb).unwrap();
    let resolution = picture.resolution();
    let turned = Resolution::read(b"+X 20 -Y 6\n", 0).unwrap().0;
    assert_eq!((turned.width, turned.height), (resolution.width, resolution.height));
    let old = b"cabin:\n\trpict\nEXPOSURE=2\n\n-Y 2 +X 9    \n\x80\x70\x60\x81\x01\x01\x01\x08\x80\x70\x60\x81\x90\x70\x60\x81\x01\x01\x01\x07";
    let mut seeds = vec![
        picture.to_bytes(),
        picture.to_bytes_in(turned),
        Picture::from_rgb(header.clone(), &image(4, 3, 1)).unwrap().to_bytes(),
        Picture::from_xyz(header.clone(), &rgb).unwrap().to_bytes(),
        Picture::from_spectra(header.clone(), &image(4, 3, 6), [780.0, 588.0, 480.0, 380.0]).unwrap().to_bytes(),
        old.to_vec(),
        write_pfm(&rgb).unwrap(),
        write_npy(&image(3, 4, 2)),
        write_npy_f64(&image(3, 4, 1).map(f64::from)),
        write_png_grey16(&image(6, 5, 1).map(|value| (value * 60000.0) as u16), Some(&header)).unwrap(),
        write_png_rgb8(&image(6, 5, 3).map(|value| (value * 200.0) as u8), None).unwrap(),
        b"# eye\nrvu -vtv -vp 1 2 3 -vd -1e-3 .5 1. -vu 0 0 1 -vh 45 -vv 30 -vo 0 -va 0 -vs 0 -vl 0\nVIEW= -vtc -vh 300\n".to_vec(),
    ];
    for format in [MatrixFormat::Ascii, MatrixFormat::Float, MatrixFormat::Double] {
        seeds.push(FloatMatrix::write_f32(&header, &image(3, 4, 2), format));
    }
    #[cfg(feature = "tiff")]
    seeds.push(radsight_picture::write_tiff(&image(5, 3, 3), Some(&header)).unwrap());
    #[cfg(feature = "exr")]
    seeds.push(radsight_picture::write_exr(&image(5, 3, 3), Some(&header)).unwrap());
    seeds
}

/// Byte sequences that make headers wrong.
const LIES: [&[u8]; 14] = [
    b"-Y 2147483647 +X 2147483647\n",
    b"+X 1 +Y 999999999\n",
    b"NROWS=2147483647\n",
    b"NCOLS=99999999\n",
    b"NCOMP=2147483647\n",
    b"FORMAT=Radiance_spectra\n",
    b"FORMAT=double\n",
    b"FORMAT=32-bit_rle_xyze\n",
    b"EXPOSURE=1e-400\n",
    b"WAVELENGTH_SPLITS= 1 1 1 1\n",
    b"\n\n",
    b"-vtz -vp nan 1e999 0 ",
    b"\x01\x01\x01\xff\x01\x01\x01\xff\x01\x01\x01\xff",
    b"\x02\x02\x7f\xff",
];

/// A random number generator without dependencies (xorshift64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// The next integer below `limit`, or 0 for a limit of 0.
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 >> 8).unwrap() % limit.max(1)
    }
}

/// Changes, removes, repeats or inserts some bytes.
pub(crate) fn spoil(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..=random.below(6) {
        let at = random.below(bytes.len());
        let length = random.below(12).min(bytes.len() - at);
        match random.below(7) {
            0 if at < bytes.len() => bytes[at] = random.below(256) as u8,
            1 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.drain(at..at + length)),
            3 => bytes.truncate(at),
            4 => {
                let piece = bytes[at..at + length].to_vec();
                bytes.splice(at..at, piece);
            }
            5 => drop(bytes.splice(at..at + length, LIES[random.below(LIES.len())].iter().copied())),
            _ => {
                let digits = random.below(usize::MAX >> 9).to_string();
                bytes.splice(at..at + length, digits.bytes());
            }
        }
    }
}

/// Reads the bytes with every reader and uses the results.
pub(crate) fn read_all_ways(bytes: &[u8]) {
    if let Ok(read) = read_image(bytes) {
        assert_eq!(read.image.data().len(), read.image.width() * read.image.height() * read.image.components());
    }
    if let Ok(partial) = Picture::read_partial(bytes) {
        assert!(partial.used <= bytes.len());
        let picture = partial.picture;
        if picture.width() * picture.height() < 1 << 16 {
            let _ = (picture.values(), picture.three_values(), picture.radiance(), picture.rgb_radiance());
            let again = Picture::read(&picture.to_bytes()).expect("what was written can be read");
            // Longer scanlines are flat, which cannot represent every pixel.
            assert!(picture.width() > 0x7fff || again.pixels() == picture.pixels());
        }
    }
    if let Ok((matrix, used)) = FloatMatrix::read_first(bytes) {
        assert!(used <= bytes.len());
        let format = matrix.format;
        let values = matrix.clone().into_f64();
        let written = FloatMatrix::write_f64(&matrix.header, &values, format);
        assert!(FloatMatrix::read(&written).is_ok());
    }
    let _ = (read_pfm(bytes).is_ok(), read_npy(bytes).is_ok(), read_png(bytes).is_ok());
    let header = Header::read_text(bytes);
    let _ = (header.exposure(), header.color_correction(), header.radiance_scale(), header.pixel_aspect());
    let _ = (header.primaries(), header.components(), header.wavelength_splits(), header.is_big_endian());
    if let Ok(Some(primaries)) = header.primaries() {
        let _ = (primaries.rgb_to_xyz(), primaries.xyz_to_rgb());
    }
    use_view(bytes);
}

fn use_view(bytes: &[u8]) {
    let mut options = ViewOptions::default();
    if options.apply_file(bytes).is_err() {
        return;
    }
    let _ = (options.to_full_string(), options.to_minimal_string());
    let Ok(view) = View::new(options) else { return };
    for place in [[0.5, 0.5], [0.0, 1.0], [0.3, 0.2], [1e9, -1e9]] {
        if let Some(ray) = view.ray(place) {
            let _ = view.locate(ray.origin + ray.direction);
        }
    }
    let _ = (view.crop([0.1, 0.1], [0.7, 0.9]), view.fit(512, 512, 1.0));
}
