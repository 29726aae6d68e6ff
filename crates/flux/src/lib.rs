//! Senders and receivers of flux: the surfaces between which `rfluxmtx` computes a matrix of
//! coefficients, and the bases that divide their directions.
//!
//! Surfaces after a comment `#@rfluxmtx h=BASIS u=UP o=FILE` form a [`Group`]. [`ReceiverWords`]
//! makes the options with which `rcontrib` sorts the rays of a receiver by direction. A [`Sender`]
//! makes the rays that leave a surface, with a number for each of its directions. An
//! [`IllumSurface`] makes rays through a window, and arranges the radiance that they find for the
//! data files with which `mkillum` turns the window into a light source.
//!
//! Guarantees: directions are numbered as in Radiance's function files; a ray is a function of its
//! number and the seed; no input makes a function panic. The crate knows neither scene text nor files.
//!
//! ```
//! use radsight_flux::{FluxSurface, Group, ReceiverWords, Sender, Shape};
//! let square = vec![0., 0., 1., 1., 0., 1., 1., 1., 1., 0., 1., 1.];
//! let mut group = Group::new("window");
//! group.parameters.read(" h=kf u=+Y").unwrap();
//! group.surfaces.push(FluxSurface::new("pane", Shape::Polygon, &square).unwrap());
//! let words = ReceiverWords::default().of(&group).unwrap();
//! assert_eq!(words[..2], ["-f", "klems_full.cal"]);
//! let sender = Sender::new(&group, 100).unwrap();
//! let ([_, _, height], direction) = sender.ray(0).unwrap();
//! assert!(sender.bins() == 145 && height == 1.0 && direction[2] < -0.99);
//! ```
#![forbid(unsafe_code)]

mod basis;
mod error;
mod illum;
mod parameters;
mod receiver;
mod sender;
mod surface;
mod toward;

pub use basis::{Basis, Klems};
pub use error::FluxError;
pub use illum::{IllumDetail, IllumSurface, LightRay};
pub use parameters::{Hand, Parameters};
pub use receiver::ReceiverWords;
pub use sender::Sender;
pub use surface::{FluxSurface, Shape};
pub use toward::Toward;

use glam::DVec3;

/// Surfaces of one modifier, and the basis of their directions.
#[derive(Clone, Debug)]
pub struct Group {
    /// The modifier's name.
    pub modifier: String,
    /// Parameters of the surfaces' comment.
    pub parameters: Parameters,
    /// The surfaces.
    pub surfaces: Vec<FluxSurface>,
}

impl Group {
    /// An empty group of a modifier.
    #[must_use]
    pub fn new(modifier: &str) -> Group {
        Group { modifier: modifier.to_owned(), parameters: Parameters::default(), surfaces: Vec::new() }
    }

    /// Mean normal of the surfaces by area, and the up direction; both unit vectors.
    fn frame(&self) -> Result<[DVec3; 2], FluxError> {
        let sum: DVec3 = self.surfaces.iter().map(|surface| surface.normal * surface.area).sum();
        let normal = sum.try_normalize().ok_or_else(|| FluxError::NoNormal { modifier: self.modifier.clone() })?;
        // Radiance's default.
        let usual = if normal.z.abs() < 0.7 { DVec3::Z } else { DVec3::Y };
        Ok([normal, self.parameters.up.unwrap_or(usual)])
    }
}
