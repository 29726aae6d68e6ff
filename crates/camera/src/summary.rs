//! A camera in one line, for people.

use crate::CameraFile;

impl CameraFile {
    /// Optics, focal distance, pixels and exposure time, with their units.
    #[must_use]
    pub fn summary(&self) -> String {
        let camera = &self.camera;
        let [across, along] = camera.pixel_pitch_m().map(|pitch| 1e6 * pitch);
        if let Some(lens) = camera.telecentric_lens() {
            return format!(
                "telecentric lens of f-number {}, magnification {}, pixels of {} by {} µm, exposure time {} ms",
                rounded(lens.f_number),
                rounded(lens.magnification),
                rounded(across),
                rounded(along),
                rounded(1e3 * camera.exposure_s())
            );
        }
        let optics = match camera.lens() {
            Some(_) => "thin lens".to_owned(),
            None => format!("pinhole of {} mm", rounded(1e3 * camera.pinhole_diameter_m())),
        };
        let mut text = format!(
            "{optics}, focal distance {} mm, pixels of {} by {} µm, exposure time {} ms",
            rounded(1e3 * camera.focal_distance_m()),
            rounded(across),
            rounded(along),
            rounded(1e3 * camera.exposure_s())
        );
        if let Some(wavelength) = camera.wavelength_m() {
            text.push_str(&format!(", {} nm", rounded(1e9 * wavelength)));
        }
        text
    }
}

/// With at most four digits after the point.
fn rounded(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
