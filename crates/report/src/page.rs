//! Builds the page.

use crate::escape::Escaped;
use crate::layer::Layers;
use crate::map::{ErrorMap, GreyPicture, Quantity, check_size, square_side};
use crate::record::RunRecord;
use crate::{ProgressLog, ReportError, Setting, Stage, sections, still};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use radsight_picture::{Image, RgbPrimaries};
use sha2::{Digest, Sha256};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
const VIEWER: &str = include_str!("viewer.html");

/// A page under construction.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    title: String,
    picture: Image<f32>,
    quantity: Quantity,
    luminance_weights: [f64; 3],
    pixel_aspect: f64,
    error: Option<ErrorMap>,
    rays: Option<Image<f32>>,
    grey: Option<GreyPicture>,
    record: RunRecord,
    log: ProgressLog,
    facts: Vec<Setting>,
    texts: Vec<(String, String)>,
}

impl Page {
    /// A page of a picture of 1 or 3 components (red, green, blue).
    ///
    /// # Errors
    /// [`ReportError::Components`].
    pub fn new(title: impl Into<String>, picture: Image<f32>, quantity: Quantity) -> Result<Page, ReportError> {
        if !matches!(picture.components(), 1 | 3) || picture.data().is_empty() {
            return Err(ReportError::Components { components: picture.components() });
        }
        Ok(Page {
            title: title.into(),
            picture,
            quantity,
            luminance_weights: RgbPrimaries::STANDARD.luminance_weights().unwrap_or([1.0 / 3.0; 3]),
            pixel_aspect: 1.0,
            error: None,
            rays: None,
            grey: None,
            record: RunRecord::default(),
            log: ProgressLog::default(),
            facts: Vec::new(),
            texts: Vec::new(),
        })
    }

    /// The primaries of the picture's components. Default: Radiance's.
    #[must_use]
    pub fn primaries(mut self, primaries: &RgbPrimaries) -> Page {
        if let Some(weights) = primaries.luminance_weights() {
            self.luminance_weights = weights;
        }
        self
    }

    /// The pixel aspect, height divided by width, 0.001 to 1000. Default 1.
    ///
    /// # Errors
    /// [`ReportError::PixelAspect`].
    pub fn pixel_aspect(mut self, aspect: f64) -> Result<Page, ReportError> {
        if !(1e-3..=1e3).contains(&aspect) {
            return Err(ReportError::PixelAspect { aspect });
        }
        self.pixel_aspect = aspect;
        Ok(self)
    }

    /// Adds the standard error of each pixel.
    ///
    /// # Errors
    /// [`ReportError::Size`].
    pub fn error_map(mut self, map: ErrorMap) -> Result<Page, ReportError> {
        check_size("error map", map.image(), &self.picture)?;
        self.error = Some(map);
        Ok(self)
    }

    /// Adds the number of rays of each pixel.
    ///
    /// # Errors
    /// [`ReportError::Size`].
    pub fn ray_map(mut self, map: Image<f32>) -> Result<Page, ReportError> {
        check_size("ray map", &map, &self.picture)?;
        self.rays = Some(map);
        Ok(self)
    }

    /// Adds the sensor's grey values.
    ///
    /// # Errors
    /// [`ReportError::Size`].
    pub fn grey_picture(mut self, grey: GreyPicture) -> Result<Page, ReportError> {
        check_size("grey picture", &grey.values, &self.picture)?;
        self.grey = Some(grey);
        Ok(self)
    }

    /// Adds the record of how the picture was made.
    #[must_use]
    pub fn record(mut self, record: RunRecord) -> Page {
        self.record = record;
        self
    }

    /// Adds a stage to the record: its name and its duration.
    #[must_use]
    pub fn stage(mut self, stage: Stage) -> Page {
        self.record.stages.push(stage);
        self
    }

    /// Adds the output of the program during rendering.
    #[must_use]
    pub fn log(mut self, log: ProgressLog) -> Page {
        self.log = log;
        self
    }

    /// Adds a line to the table at the top, such as the view.
    #[must_use]
    pub fn fact(mut self, name: impl Into<String>, value: impl Into<String>) -> Page {
        self.facts.push(Setting { name: name.into(), value: value.into() });
        self
    }

    /// Adds a verbatim text, such as the picture's header or the camera file.
    #[must_use]
    pub fn text(mut self, name: impl Into<String>, text: impl Into<String>) -> Page {
        self.texts.push((name.into(), text.into()));
        self
    }

    /// The page: HTML in UTF-8.
    #[must_use]
    pub fn to_html(&self) -> String {
        let side = square_side(self.picture.width(), self.picture.height());
        let layers = self.layers(side);
        let style = format!("/*<![CDATA[*/\n{STYLE}/*]]>*/");
        let script = format!("//<![CDATA[\n{SCRIPT}//]]>\n");
        let policy = format!(
            "default-src 'none'; img-src data:; style-src '{}'; script-src '{}'; base-uri 'none'; form-action 'none'",
            hash(&style),
            hash(&script)
        );
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\"><head><meta charset=\"utf-8\" />\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\" />\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n\
             <meta name=\"referrer\" content=\"no-referrer\" />\n\
             <title>{title}</title>\n<style>{style}</style></head>\n<body><main>\n<h1>{title}</h1>\n",
            title = Escaped(&self.title),
        );
        out.push_str(&sections::facts(&self.facts_of(side), &self.record));
        out.push_str(VIEWER);
        out.push_str("<section class=\"stills\" aria-label=\"pictures with their scales\">\n");
        out.push_str(&still::as_seen(&layers, self.pixel_aspect));
        let shown = |id: &str| !matches!(id, "red" | "green" | "blue");
        for choice in (0..layers.choices.len()).filter(|choice| shown(layers.choices[*choice].id)) {
            out.push_str(&still::in_colors(&layers, choice, self.pixel_aspect));
        }
        out.push_str("</section>\n");
        out.push_str(&sections::statistics(&layers));
        out.push_str(&sections::error(&self.record, self.error.as_ref()));
        out.push_str(&sections::time(&self.record.stages, &self.log.progress));
        out.push_str(&sections::decisions(&self.record.decisions));
        out.push_str(&sections::settings(&self.record));
        out.push_str(&sections::texts(&self.texts, &self.log.messages));
        out.push_str(&sections::versions(&self.record));
        out.push_str("</main>\n");
        out.push_str(&layers.elements(self.pixel_aspect, side));
        out.push_str(&format!("<script>{script}</script>\n</body></html>\n"));
        out
    }

    fn layers(&self, side: usize) -> Layers {
        let mut layers = Layers::new(&self.picture, &self.quantity, self.luminance_weights, side);
        if let Some(map) = &self.error {
            layers.add_error(map, self.quantity.unit(), side);
        }
        if let Some(map) = &self.rays {
            layers.add_rays(map, side);
        }
        if let Some(grey) = &self.grey {
            layers.add_grey(grey, side);
        }
        layers
    }

    /// The description of the picture, followed by the added facts.
    fn facts_of(&self, side: usize) -> Vec<Setting> {
        let fact = |name: &str, value: String| Setting { name: name.to_owned(), value };
        let mut facts = vec![fact("size", format!("{} × {} pixels", self.picture.width(), self.picture.height()))];
        let unit = self.quantity.unit();
        let unit = if unit.is_empty() { String::new() } else { format!(", {unit}") };
        facts.push(fact("values", format!("{}{unit}", self.quantity.name())));
        if side > 1 {
            let values = format!("means over squares of {side} × {side} pixels: the picture has too many for one page");
            facts.push(fact("shown", values));
        }
        if self.pixel_aspect != 1.0 {
            facts.push(fact("pixel aspect", format!("{:.4} (height divided by width)", self.pixel_aspect)));
        }
        facts.extend(self.facts.iter().cloned());
        facts
    }
}

/// The hash by which a content security policy permits an inline text.
fn hash(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text)))
}
