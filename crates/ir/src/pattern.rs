//! Textures perturb the normal, patterns colour the material, mixtures blend modifiers.

use crate::{Font, FunctionCall, GridCall, Handle, MixtureArms, PictureCall, Rgb};
use glam::DVec3;

/// A perturbation of the surface normal.
#[derive(Clone, Debug)]
pub enum Texture {
    /// `texfunc`: three roots, a vector added to the unit normal.
    Function(FunctionCall),
    /// `texdata`: three functions of the (x, y, z) values, three grids, coordinates.
    Data(GridCall),
}

/// A factor of the material's colour.
#[derive(Clone, Debug)]
pub enum Pattern {
    /// `brightfunc`: one root.
    BrightFunction(FunctionCall),
    /// `colorfunc`: three roots.
    ColorFunction(FunctionCall),
    /// `brightdata`.
    BrightData(GridCall),
    /// `colordata`.
    ColorData(GridCall),
    /// `colorpict`.
    ColorPicture(PictureCall),
    /// `brighttext` and `colortext`.
    Text(TextPattern),
    /// `spectrum` and `specfile`: the same spectrum everywhere.
    Spectrum(Spectrum),
    /// `specfunc`: one root, a function of the wavelength in nm.
    SpectrumFunction {
        /// The function.
        call: FunctionCall,
        /// Shortest and longest wavelength, nm.
        range_nm: [f64; 2],
    },
    /// `specdata`: a function of (value, wavelength), then the coordinates; the grid's last axis is
    /// the wavelength in nm.
    SpectrumData(GridCall),
    /// `specpict`: the grid's axes are v, u and the wavelength in nm.
    SpectrumPicture(GridCall),
}

/// Values in equal steps of wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Wavelengths of the first and of the last edge, nm.
    pub range_nm: [f64; 2],
    /// Values from the first edge to the last.
    pub values: Vec<f64>,
}

/// Text on a plane.
#[derive(Clone, Debug)]
pub struct TextPattern {
    /// The font.
    pub font: Handle<Font>,
    /// Lines of character codes.
    pub lines: Vec<Vec<u8>>,
    /// Upper left corner of the first character, scene units.
    pub origin: DVec3,
    /// Advance to the next character, scene units.
    pub right: DVec3,
    /// Advance to the next line, scene units; not parallel to `right`.
    pub down: DVec3,
    /// Space between characters, in cells. Positive values preserve the columns of words, negative
    /// ones do not, and zero sets each character into a whole cell. With any of them cells are as
    /// narrow as the font's characters; with `None` they are square.
    pub spacing: Option<f64>,
    /// Factor of the colour on letters; unused in a mixture.
    pub foreground: Rgb,
    /// Factor elsewhere; unused in a mixture.
    pub background: Rgb,
    /// String arguments as written, for output.
    pub words: Vec<String>,
}

/// A mixture of two modifiers.
#[derive(Clone, Debug)]
pub struct Mixture {
    /// Foreground and background.
    pub arms: MixtureArms,
    /// Weight of the foreground, 0…1.
    pub amount: MixtureAmount,
}

/// How the weight of a mixture's foreground is computed.
#[derive(Clone, Debug)]
pub enum MixtureAmount {
    /// `mixfunc`: one root.
    Function(FunctionCall),
    /// `mixdata`.
    Data(GridCall),
    /// `mixpict`: one function of (red, green, blue), then u and v.
    Picture(PictureCall),
    /// `mixtext`.
    Text(TextPattern),
}
