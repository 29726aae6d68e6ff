//! Textures turn the normal, patterns colour the material, mixtures choose between modifiers.

use crate::{Font, FunctionCall, GridCall, Handle, MixtureArms, PictureCall, Rgb};
use glam::DVec3;

/// A perturbation of the surface normal.
#[derive(Clone, Debug)]
pub enum Texture {
    /// `texfunc`: three roots, the vector added to the unit normal.
    Function(FunctionCall),
    /// `texdata`: three functions of (x, y, z) values, three grids, coordinates.
    Data(GridCall),
}

/// A multiplier of the material's colour.
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
    /// `specdata`: a function of (value, wavelength), then the coordinates; the grid's last axis is the wavelength in nm.
    SpectrumData(GridCall),
    /// `specpict`: the grid's axes are v, u and the wavelength in nm.
    SpectrumPicture(GridCall),
}

/// Values in equal steps of wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Wavelength of the first and of the last edge, nm.
    pub range_nm: [f64; 2],
    /// From the first edge to the last.
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
    /// From one character to the next, scene units.
    pub right: DVec3,
    /// From one line to the next, scene units; not along `right`.
    pub down: DVec3,
    /// Space between characters, in cells: above zero lines keep the columns of their words, below zero they do not, zero sets
    /// each character into a whole cell. With any of them cells are as narrow as the font's characters; `None` keeps them square.
    pub spacing: Option<f64>,
    /// Multiplier where there is ink; in a mixture it means nothing.
    pub foreground: Rgb,
    /// Multiplier elsewhere; likewise.
    pub background: Rgb,
    /// The words as written, for writing back.
    pub words: Vec<String>,
}

/// A choice between two modifiers.
#[derive(Clone, Debug)]
pub struct Mixture {
    /// Foreground and background.
    pub arms: MixtureArms,
    /// How much of the foreground, in 0…1.
    pub amount: MixtureAmount,
}

/// How a mixture's share of foreground is found.
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
