//! OpenEXR pictures in single precision: one channel `Y`, or three channels `R`, `G`, `B`. Written
//! with zip compression.
//!
//! The Radiance header is stored as the comments of the layer.

use crate::{Header, Image, PictureError};
use exr::meta::BlockDescription;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, ReadChannels, ReadLayers, Text,
    WritableImage,
};
use std::io::Cursor;

/// Reads the first layer of a file: its channels `R`, `G`, `B`, or else `Y`, or its only channel.
///
/// # Errors
/// When the bytes are not such a picture, or declare more pixels than they can hold.
pub fn read_exr(bytes: &[u8]) -> Result<(Image<f32>, Option<Header>), PictureError> {
    check_sizes(bytes)?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(codec)?;
    let layer = image.layer_data;
    let header = layer.attributes.comments.map(|text| text.to_string());
    let header = header.filter(|text| text.starts_with("#?")).map(|text| Header::read_text(text.as_bytes()));
    let channels = layer.channel_data.list;
    let named = |name: &str| channels.iter().find(|channel| channel.name.to_string().eq_ignore_ascii_case(name));
    let chosen: Vec<&AnyChannel<FlatSamples>> = match (named("R"), named("G"), named("B"), named("Y")) {
        (Some(red), Some(green), Some(blue), _) => vec![red, green, blue],
        (_, _, _, Some(luminance)) => vec![luminance],
        _ if channels.len() == 1 => vec![&channels[0]],
        _ => {
            let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
            let what = format!("channels {}", names.join(", ").chars().take(80).collect::<String>());
            return Err(PictureError::Unsupported {
                format: "exr",
                what,
                expected: "R, G and B, or Y, or one channel",
            });
        }
    };
    let (width, height) = (layer.size.width(), layer.size.height());
    let planes: Vec<Vec<f32>> = chosen.iter().map(|channel| channel.sample_data.values_as_f32().collect()).collect();
    if planes.iter().any(|plane| plane.len() != width * height) {
        let what = "channels of fewer pixels than the picture".to_owned();
        return Err(PictureError::Unsupported { format: "exr", what, expected: "one value for each pixel" });
    }
    let data = (0..width * height).flat_map(|i| planes.iter().map(move |plane| plane[i])).collect();
    Ok((Image::new(width, height, planes.len(), data)?, header))
}

/// Rejects sizes that no compression could make true.
fn check_sizes(bytes: &[u8]) -> Result<(), PictureError> {
    const SMALL: usize = 1 << 24;
    const LARGEST_RATIO: usize = 1032;
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(codec)?;
    let budget = bytes.len().saturating_mul(LARGEST_RATIO).max(SMALL);
    for header in &meta.headers {
        let channels = header.channels.list.len();
        // A tile is stored whole even where it extends beyond the picture.
        let tile = match header.blocks {
            BlockDescription::Tiles(tiles) => tiles.tile_size,
            BlockDescription::ScanLines => header.layer_size,
        };
        for (width, height) in [header.layer_size, tile].map(|size| (size.width(), size.height())) {
            let values = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(channels));
            if values.and_then(|values| values.checked_mul(4)).is_none_or(|size| size > budget) {
                let (width, height, components) = (width as u64, height as u64, channels as u64);
                return Err(PictureError::TooLarge { offset: 0, width, height, components, available: bytes.len() });
            }
        }
    }
    Ok(())
}

/// Writes single-precision values.
///
/// # Errors
/// [`PictureError::Shape`] unless there are one or three components.
pub fn write_exr(image: &Image<f32>, header: Option<&Header>) -> Result<Vec<u8>, PictureError> {
    let names: &[&str] = match image.components() {
        1 => &["Y"],
        3 => &["R", "G", "B"],
        components => {
            let (width, height, values) = (image.width(), image.height(), image.data().len());
            return Err(PictureError::Shape {
                width,
                height,
                components,
                values,
                expected: "1 or 3 components for exr",
            });
        }
    };
    let channel = |(index, name): (usize, &&str)| {
        AnyChannel::new(Text::from(*name), FlatSamples::F32(image.component(index).into_data()))
    };
    let channels = AnyChannels::sort(names.iter().enumerate().map(channel).collect());
    let comments = header.and_then(|header| Text::new_or_none(header.to_text()));
    let attributes = LayerAttributes { comments, ..LayerAttributes::default() };
    let layer = Layer::new((image.width(), image.height()), attributes, Encoding::SMALL_FAST_LOSSLESS, channels);
    let mut out = Cursor::new(Vec::new());
    exr::prelude::Image::from_layer(layer).write().non_parallel().to_buffered(&mut out).map_err(codec)?;
    Ok(out.into_inner())
}

fn codec(error: exr::error::Error) -> PictureError {
    PictureError::Codec { format: "exr", reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_and_history_survive_a_round_trip() {
        let mut header = Header::new("RADIANCE");
        header.push_command(["pinhole", "average"]);
        for components in [1, 3] {
            let image =
                Image::new(5, 3, components, (0..15 * components).map(|i| i as f32 * 1e-7 - 1e-6).collect()).unwrap();
            let (read, history) = read_exr(&write_exr(&image, Some(&header)).unwrap()).unwrap();
            assert_eq!((read, history), (image, Some(header.clone())));
        }
    }

    #[test]
    fn a_tile_beyond_all_bytes_is_refused() {
        let mut bytes = write_exr(&Image::filled(5, 3, 1, 1.0).unwrap(), None).unwrap();
        let at = bytes.windows(9).position(|nine| nine == b"tiledesc\0").unwrap();
        // The type of the attribute is followed by its size in four bytes.
        let width = at + b"tiledesc\0".len() + 4;
        bytes[width..width + 4].copy_from_slice(&[0, 0, 0, 0x28]);
        assert!(matches!(read_exr(&bytes), Err(PictureError::TooLarge { .. })));
    }

    #[test]
    fn other_shapes_are_refused() {
        assert!(write_exr(&Image::filled(2, 2, 2, 0.0).unwrap(), None).is_err());
        assert!(read_exr(b"\x76\x2f\x31\x01").is_err());
    }
}
