//! The values stored in a page: a picture and its maps, and how they are displayed.

use crate::escape::json_in_element;
use crate::map::{ErrorMap, GreyPicture, Pooling, Quantity, pooled};
use crate::scale::{Scale, Spacing, quantile};
use crate::stored_values::StoredValues;
use radsight_picture::Image;
use serde_json::json;

/// The share of pixels displayed darker than white.
const DARKER_THAN_WHITE: f64 = 0.98;

/// One stored picture or map.
pub(crate) struct Layer {
    pub(crate) image: Image<f32>,
    /// Whether values are integers up to 65535.
    whole: bool,
}

/// A displayable quantity of each pixel.
pub(crate) struct Choice {
    /// Identifier in links and in the script.
    pub(crate) id: &'static str,
    pub(crate) name: String,
    pub(crate) unit: String,
    /// The layer from which it is computed, and the weights of its components.
    pub(crate) layer: usize,
    pub(crate) weights: Vec<f64>,
    /// Whether it is divided by the magnitude of the first quantity, in percent.
    pub(crate) ratio: Ratio,
    pub(crate) scale: Scale,
    pub(crate) colors: Colors,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ratio {
    None,
    PercentOfFirst,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Colors {
    False,
    Grey,
}

/// All layers and quantities.
pub(crate) struct Layers {
    pub(crate) layers: Vec<Layer>,
    /// The first quantity is the brightness.
    pub(crate) choices: Vec<Choice>,
    /// The brightness displayed as white.
    pub(crate) white: f64,
}

impl Layers {
    /// Adds the picture; `side` is the side of the averaged squares of pixels.
    pub(crate) fn new(picture: &Image<f32>, quantity: &Quantity, luminance_weights: [f64; 3], side: usize) -> Layers {
        let image = pooled(picture, side, Pooling::Mean);
        let is_color = image.components() == 3;
        let mut layers = Layers { layers: vec![Layer { image, whole: false }], choices: Vec::new(), white: 1.0 };
        let (name, unit) = (quantity.name(), quantity.unit());
        if is_color {
            let (photometric, of_light, factor) = quantity.photometric();
            let weights = luminance_weights.map(|weight| factor * weight).to_vec();
            layers.choose("luminance", photometric, of_light, 0, weights);
            for (band, (id, color)) in [("red", "red"), ("green", "green"), ("blue", "blue")].into_iter().enumerate() {
                let weights = (0..3).map(|i| f64::from(u8::from(i == band))).collect();
                layers.choose(id, &format!("{color} {name}"), unit, 0, weights);
            }
        } else {
            layers.choose("value", name, unit, 0, vec![1.0]);
        }
        let mut brightness: Vec<f32> = layers.values(0).map(|v| v as f32).filter(|v| v.is_finite()).collect();
        let white = if brightness.is_empty() { 0.0 } else { quantile(&mut brightness, DARKER_THAN_WHITE) };
        let brightest = brightness.iter().fold(0.0_f32, |brightest, value| brightest.max(*value));
        layers.white = [white, f64::from(brightest)].into_iter().find(|white| *white > 0.0).unwrap_or(1.0);
        layers
    }

    /// Adds the standard errors.
    pub(crate) fn add_error(&mut self, map: &ErrorMap, unit: &str, side: usize) {
        let layer = self.layers.len();
        let image = pooled(map.image(), side, Pooling::StandardError);
        self.layers.push(Layer { image, whole: false });
        match map {
            ErrorMap::Absolute(_) => {
                self.choose("error", "standard error", unit, layer, vec![1.0]);
                let relative = Choice { ratio: Ratio::PercentOfFirst, ..self.choice(layer, vec![1.0]) };
                self.push("relative-error", "relative standard error", "%", relative);
            }
            ErrorMap::Relative(_) => self.choose("relative-error", "relative standard error", "%", layer, vec![100.0]),
        }
    }

    /// Adds the number of rays of each pixel.
    pub(crate) fn add_rays(&mut self, map: &Image<f32>, side: usize) {
        let layer = self.layers.len();
        self.layers.push(Layer { image: pooled(map, side, Pooling::Mean), whole: false });
        self.choose("rays", "rays per pixel", "", layer, vec![1.0]);
    }

    /// Adds the sensor's grey values.
    pub(crate) fn add_grey(&mut self, grey: &GreyPicture, side: usize) {
        let layer = self.layers.len();
        let image = pooled(&grey.values.clone().map(f32::from), side, Pooling::Mean).map(f32::round);
        self.layers.push(Layer { image, whole: true });
        let scale = Scale { low: 0.0, high: f64::from(grey.largest.max(1)), spacing: Spacing::Linear };
        let choice = Choice { scale, colors: Colors::Grey, ..self.choice(layer, vec![1.0]) };
        self.push("grey", "sensor's grey value", "DN", choice);
    }

    fn choose(&mut self, id: &'static str, name: &str, unit: &str, layer: usize, weights: Vec<f64>) {
        let choice = self.choice(layer, weights);
        self.push(id, name, unit, choice);
    }

    fn choice(&self, layer: usize, weights: Vec<f64>) -> Choice {
        Choice {
            id: "",
            name: String::new(),
            unit: String::new(),
            layer,
            weights,
            ratio: Ratio::None,
            scale: Scale { low: 0.0, high: 1.0, spacing: Spacing::Linear },
            colors: Colors::False,
        }
    }

    fn push(&mut self, id: &'static str, name: &str, unit: &str, choice: Choice) {
        let is_scaled = choice.colors == Colors::Grey;
        self.choices.push(Choice { id, name: name.to_owned(), unit: unit.to_owned(), ..choice });
        if !is_scaled {
            let last = self.choices.len() - 1;
            self.choices[last].scale = Scale::of(self.values(last).map(|value| value as f32));
        }
    }

    /// Columns and rows.
    pub(crate) fn size(&self) -> [usize; 2] {
        let image = &self.layers[0].image;
        [image.width(), image.height()]
    }

    /// The values of a quantity, from the top left. A ratio to a first quantity of 0 is NaN.
    pub(crate) fn values(&self, choice: usize) -> impl Iterator<Item = f64> + '_ {
        let choice = &self.choices[choice];
        let weighted = |choice: &Choice, pixel: &[f32]| {
            let pairs = pixel.iter().zip(&choice.weights).filter(|(_, weight)| **weight != 0.0);
            pairs.map(|(value, weight)| f64::from(*value) * weight).sum::<f64>()
        };
        let pairs = self.layers[choice.layer].image.pixels().zip(self.layers[0].image.pixels());
        pairs.map(move |(own, picture)| match choice.ratio {
            Ratio::None => weighted(choice, own),
            Ratio::PercentOfFirst => match weighted(&self.choices[0], picture).abs() {
                0.0 => f64::NAN,
                first => 100.0 * weighted(choice, own) / first,
            },
        })
    }

    /// The description for the script, followed by the values.
    pub(crate) fn elements(&self, pixel_aspect: f64, side: usize) -> String {
        let stored: Vec<StoredValues> = self.layers.iter().map(Layer::stored).collect();
        let layers: Vec<_> = self
            .layers
            .iter()
            .zip(&stored)
            .map(|(layer, stored)| json!({"components": layer.image.components(), "factor": stored.factor}))
            .collect();
        let choices: Vec<_> = self.choices.iter().map(Choice::description).collect();
        let [columns, rows] = self.size();
        let model = json!({
            "columns": columns, "rows": rows, "side": side, "pixelAspect": pixel_aspect, "white": self.white,
            "layers": layers, "choices": choices, "palette": crate::color_map::VIRIDIS,
            "noValue": crate::color_map::NO_VALUE,
        });
        let mut out = format!(
            "<script type=\"application/json\" id=\"model\">{}</script>\n",
            json_in_element(&model.to_string())
        );
        for (index, stored) in stored.iter().enumerate() {
            out.push_str(&format!("<script type=\"text/plain\" id=\"layer-{index}\">{}</script>\n", stored.text));
        }
        out
    }
}

impl Layer {
    fn stored(&self) -> StoredValues {
        if self.whole {
            StoredValues::of_whole(&self.image.clone().map(|value| value as u16))
        } else {
            StoredValues::of_numbers(&self.image)
        }
    }
}

impl Choice {
    fn description(&self) -> serde_json::Value {
        json!({
            "id": self.id, "name": self.name, "unit": self.unit, "layer": self.layer, "weights": self.weights,
            "isRatio": self.ratio == Ratio::PercentOfFirst,
            "low": self.scale.low, "high": self.scale.high,
            "isLogarithmic": self.scale.spacing == Spacing::Logarithmic,
            "isGrey": self.colors == Colors::Grey,
        })
    }
}
