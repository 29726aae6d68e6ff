//! Maps colours that a display cannot show into its gamut, as in Radiance's converters.

/// The limits of components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gamut {
    /// No component is negative.
    Positive,
    /// Components are from 0 to 1.
    Cube,
}

/// A colour mixed with the grey of its brightness until all components are within the gamut. A
/// colour of negative brightness is black; in a cube, one brighter than 1 is white.
#[must_use]
pub fn within_gamut(rgb: [f32; 3], brightness: f64, gamut: Gamut) -> [f32; 3] {
    let is_cube = gamut == Gamut::Cube;
    if brightness < 0.0 {
        return [0.0; 3];
    }
    if is_cube && brightness > 1.0 {
        return [1.0; 3];
    }
    // The colour's part of the mixture at which a component reaches its limit.
    let part = |limit: f64, component: f32| (limit - brightness) / (f64::from(component) - brightness);
    let kept = rgb.into_iter().fold(1.0f64, |kept, component| match component {
        component if component < 0.0 => kept.min(part(0.0, component)),
        component if is_cube && component > 1.0 => kept.min(part(1.0, component)),
        _ => kept,
    });
    if kept == 1.0 {
        return rgb;
    }
    let largest = if is_cube { 1.0 } else { f64::INFINITY };
    rgb.map(|component| (kept * f64::from(component) + (1.0 - kept) * brightness).clamp(0.0, largest) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_within_the_gamut_are_kept() {
        assert_eq!(within_gamut([0.0, 0.5, 1.0], 0.4, Gamut::Cube), [0.0, 0.5, 1.0]);
        assert_eq!(within_gamut([0.0, 7.0, 1.0], 4.0, Gamut::Positive), [0.0, 7.0, 1.0]);
    }

    #[test]
    fn other_colours_are_mixed_with_grey_up_to_the_nearest_limit() {
        assert_eq!(within_gamut([-0.5, 0.5, 1.0], 0.5, Gamut::Positive), [0.0, 0.5, 0.75]);
        assert_eq!(within_gamut([-0.5, 0.5, 2.5], 0.5, Gamut::Cube), [0.25, 0.5, 1.0]);
        assert_eq!(within_gamut([0.5, 0.2, 0.1], -0.1, Gamut::Cube), [0.0; 3]);
        assert_eq!(within_gamut([0.5, 3.0, 0.1], 1.5, Gamut::Cube), [1.0; 3]);
    }
}
