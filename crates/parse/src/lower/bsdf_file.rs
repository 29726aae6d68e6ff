//! BSDF files.

use super::modifiers::RawWord;
use super::reader::Reader;
use radsight_diag::{Diagnostic, Span};
use radsight_ir::{BsdfData, Handle};
use radsight_loader::{FileKind, Loaded, Loader};
use radsight_measured::{MeasuredBsdf, Mistake, Side};
use std::sync::Arc;

/// Largest plausible share of scattered light; more gives a warning.
const MOST_SCATTERED: f64 = 1.01;

impl Reader<'_> {
    /// A BSDF, loaded at its first use. `None` after a mistake, which was reported.
    pub(super) fn bsdf_data(&mut self, file: &RawWord) -> Option<Handle<BsdfData>> {
        if let Some(known) = self.bsdfs.get(&file.text) {
            return *known;
        }
        let bsdf = match self.bsdf_files.get(&file.text) {
            Some(known) => known.clone(),
            None => {
                let loaded = self.load_bsdf(file);
                self.bsdf_files.insert(file.text.clone(), loaded.clone());
                loaded
            }
        };
        let handle = bsdf.map(|bsdf| self.scene.bsdfs.add(BsdfData { file: file.text.clone(), bsdf }));
        self.bsdfs.insert(file.text.clone(), handle);
        handle
    }

    fn load_bsdf(&mut self, file: &RawWord) -> Option<Arc<MeasuredBsdf>> {
        let loaded = match self.loader.load(&file.text, FileKind::Bsdf) {
            Ok(loaded) => loaded,
            Err(error) => {
                self.log.push(Diagnostic::error(error.to_string()).at(file.span));
                return None;
            }
        };
        match MeasuredBsdf::read(&loaded.bytes) {
            Ok(reading) => {
                if !reading.warnings.is_empty() {
                    self.report_mistakes(loaded, &reading.warnings, file.span, Diagnostic::warning);
                }
                self.warn_of_gains(&reading.bsdf, file);
                Some(Arc::new(reading.bsdf))
            }
            Err(mistake) => {
                // The program that should have written the file failed; this is an error even in
                // tolerant mode.
                self.is_inexcusable |= matches!(mistake, Mistake::NoXml { .. });
                self.report_mistakes(loaded, &[mistake], file.span, Diagnostic::error);
                None
            }
        }
    }

    /// Reports the mistakes in a BSDF file. The text is kept only if there are any.
    fn report_mistakes(&mut self, file: Loaded, mistakes: &[Mistake], span: Span, severity: fn(String) -> Diagnostic) {
        let source = self.sources.add(file.path, file.bytes, Some(span));
        for mistake in mistakes {
            let place = mistake.place();
            let at = self.sources.span(source, place.start, place.end);
            let hint = mistake.hint().map(str::to_owned);
            self.log.push(severity(mistake.to_string()).at(at).maybe_hint(hint));
        }
    }

    fn warn_of_gains(&mut self, bsdf: &MeasuredBsdf, file: &RawWord) {
        for (side, name) in [(Side::Front, "front"), (Side::Back, "back")] {
            let reflected = bsdf.reflection(side).map_or(0.0, |scattering| scattering.largest_total());
            let transmitted = bsdf.transmission(side).map_or(0.0, |scattering| scattering.largest_total());
            let diffuse = [bsdf.diffuse_reflectance(side), bsdf.diffuse_transmittance(side)];
            for (share, diffuse, verb) in [(reflected, diffuse[0], "reflects"), (transmitted, diffuse[1], "transmits")]
            {
                let share = share + diffuse.into_iter().fold(0.0, f64::max);
                if share > MOST_SCATTERED {
                    let percent = 100.0 * share;
                    let message = format!("\"{}\" {verb} {percent:.1} % of the light on its {name}", file.text);
                    self.log.push(Diagnostic::warning(message).at(file.span));
                }
            }
        }
    }
}
