//! Still pictures, for print and for browsers without scripts.

use crate::color_map::{NO_VALUE, VIRIDIS, grey, srgb, viridis};
use crate::escape::Escaped;
use crate::layer::{Choice, Colors, Layers};
use crate::number::short;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use radsight_picture::{Image, write_png_rgb8};

/// Largest number of pixels of a still picture.
const MOST_STILL_PIXELS: f64 = 6e5;

/// A small picture is enlarged to at least about this side in pixels, so that its pixels stay sharp
/// in print.
const LEAST_SIDE: f64 = 300.0;

/// The picture in natural colours, tone mapped by a linear factor.
pub(crate) fn as_seen(layers: &Layers, pixel_aspect: f64) -> String {
    let image = &layers.layers[0].image;
    let gain = unit_gain(layers);
    let shown = |pixel: &[f64]| -> [u8; 3] {
        std::array::from_fn(|i| {
            let value = pixel[i.min(pixel.len() - 1)];
            if value.is_nan() { NO_VALUE[i] } else { srgb(value * gain) }
        })
    };
    figure("as seen: 98 % of the pixels are darker than white", &png(image, pixel_aspect, shown), "")
}

/// The factor that maps the white brightness to 1.
fn unit_gain(layers: &Layers) -> f64 {
    layers.choices[0].weights.iter().sum::<f64>() / layers.white
}

/// A quantity in false colours, with its scale.
pub(crate) fn in_colors(layers: &Layers, choice: usize, pixel_aspect: f64) -> String {
    let [columns, rows] = layers.size();
    let data: Vec<f32> = layers.values(choice).map(|value| value as f32).collect();
    let image = Image::new(columns, rows, 1, data).expect("a value for every pixel");
    let choice = &layers.choices[choice];
    let color = |pixel: &[f64]| match choice.colors {
        Colors::False => viridis(choice.scale.place(pixel[0])),
        Colors::Grey => grey(choice.scale.place(pixel[0])),
    };
    let name = match choice.unit.as_str() {
        "" => choice.name.clone(),
        unit => format!("{}, {unit}", choice.name),
    };
    figure(&name, &png(&image, pixel_aspect, color), &legend(choice))
}

fn figure(caption: &str, png: &[u8], legend: &str) -> String {
    let caption = Escaped(caption);
    let data = STANDARD.encode(png);
    format!(
        "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{data}\" />{legend}<figcaption>{caption}</figcaption></figure>\n"
    )
}

/// The scale with labels, 1000 units wide.
fn legend(choice: &Choice) -> String {
    let id = choice.id;
    let stops: String = match choice.colors {
        Colors::False => (0..VIRIDIS.len())
            .map(|i| (i as f64 / (VIRIDIS.len() - 1) as f64, VIRIDIS[i]))
            .map(|(place, [r, g, b])| format!("<stop offset=\"{place}\" stop-color=\"#{r:02x}{g:02x}{b:02x}\" />"))
            .collect(),
        Colors::Grey => "<stop offset=\"0\" stop-color=\"#000\" /><stop offset=\"1\" stop-color=\"#fff\" />".to_owned(),
    };
    let ticks: String = choice
        .scale
        .ticks()
        .into_iter()
        .map(|tick| (1000.0 * choice.scale.place(tick), short(tick)))
        .map(|(x, label)| {
            let anchor = if x < 40.0 {
                "start"
            } else if x > 960.0 {
                "end"
            } else {
                "middle"
            };
            format!(
                "<path d=\"M{x:.1} 30v10\" stroke=\"currentColor\" stroke-width=\"2\" />\
                 <text x=\"{x:.1}\" y=\"72\" text-anchor=\"{anchor}\">{label}</text>"
            )
        })
        .collect();
    format!(
        "<svg class=\"legend\" viewBox=\"0 0 1000 84\" role=\"img\" aria-label=\"scale\"><defs><linearGradient id=\"ramp-{id}\">\
         {stops}</linearGradient></defs><rect width=\"1000\" height=\"30\" fill=\"url(#ramp-{id})\" />{ticks}</svg>"
    )
}

/// A picture in colours with square pixels, of bounded size.
fn png(image: &Image<f32>, pixel_aspect: f64, color: impl Fn(&[f64]) -> [u8; 3]) -> Vec<u8> {
    let [width, height] = still_size(image, pixel_aspect);
    let columns = shares(image.width(), width);
    let mut data = Vec::with_capacity(3 * width * height);
    for shares_of_rows in &shares(image.height(), height) {
        // Average first over rows, then over columns: the filter is separable.
        let mut line = vec![0.0; image.width() * image.components()];
        for (row, share) in shares_of_rows {
            line.iter_mut().zip(image.row(*row)).for_each(|(sum, value)| *sum += share * f64::from(*value));
        }
        for shares_of_columns in &columns {
            let mut pixel = vec![0.0; image.components()];
            for (column, share) in shares_of_columns {
                let values = &line[column * image.components()..][..image.components()];
                pixel.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value);
            }
            data.extend(color(&pixel));
        }
    }
    let image = Image::new(width, height, 3, data).expect("three components for every pixel");
    write_png_rgb8(&image, None).expect("the picture has three components and a small size")
}

fn still_size(image: &Image<f32>, pixel_aspect: f64) -> [usize; 2] {
    let (width, height) = (image.width() as f64, image.height() as f64);
    let [across, along] = if pixel_aspect >= 1.0 { [1.0, pixel_aspect] } else { [1.0 / pixel_aspect, 1.0] };
    let (width, height) = (width * across, height * along);
    let shrink = (MOST_STILL_PIXELS / (width * height)).sqrt().min(1.0);
    let enlarge = (LEAST_SIDE / width.max(height)).floor().max(1.0);
    // At least one row remains.
    let most = MOST_STILL_PIXELS;
    [width, height].map(|side| (side * shrink * enlarge).round().clamp(1.0, most) as usize)
}

/// For each new pixel, the old pixels that it covers and their weights.
fn shares(old: usize, new: usize) -> Vec<Vec<(usize, f64)>> {
    let ratio = old as f64 / new as f64;
    let of_place = |place: usize| {
        let (from, to) = (place as f64 * ratio, (place + 1) as f64 * ratio);
        let last = (to.ceil() as usize).clamp(1, old);
        (from as usize..last)
            .map(|i| (i, ((i + 1) as f64).min(to) - (i as f64).max(from)))
            .map(|(i, covered)| (i, covered.max(0.0) / ratio))
            .filter(|(_, share)| *share > 0.0)
            .collect()
    };
    (0..new).map(of_place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_a_pixel_add_up_to_one() {
        for (old, new) in [(10, 3), (3, 10), (7, 7), (1, 5), (4097, 1000)] {
            for place in shares(old, new) {
                assert!((place.iter().map(|(_, share)| share).sum::<f64>() - 1.0).abs() < 1e-9, "{old} to {new}");
                assert!(place.iter().all(|(i, _)| *i < old));
            }
        }
    }

    #[test]
    fn still_pictures_are_bounded_and_have_square_pixels() {
        let size = |width: usize, height: usize, aspect: f64| {
            still_size(&Image::filled(width, height, 1, 0.0).unwrap(), aspect)
        };
        assert_eq!(size(192, 165, 16.0 / 13.75), [192, 192]);
        assert_eq!(size(10, 10, 0.5), [300, 150]);
        let [width, height] = size(4000, 2000, 1.0);
        assert!(width * height <= 610_000 && width.abs_diff(2 * height) <= 2);
        assert_eq!(size(100_000, 1, 1.0)[1], 1);
    }
}
