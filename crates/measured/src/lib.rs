//! Measured and simulated scattering: BSDF files in the XML format of LBNL's WINDOW, with matrices
//! between angle bases (Klems) and tensor trees of three or four dimensions (Ward, Kurt and
//! Bonneel, EGSR 2012).
//!
//! A [`MeasuredBsdf`] has a Lambertian part, which is split off when it is read, and up to four
//! [`Scattering`] functions for the rest.
//!
//! Conventions: directions are unit vectors away from the surface, in a frame whose z axis is the
//! normal of the front, and whose y axis is "up". The front of a file is the *back* in WINDOW's
//! terms, the inside of the room. Values are in 1/sr without the cosine, in red, green and blue of
//! Radiance's primaries. The *projected solid angle* of a set of directions is the integral of |cos
//! θ| over it.
//!
//! Guarantees: reading takes time and memory proportional to the bytes read, and no input makes it
//! panic; every query is finite and not negative; [`Scattering::density`] is the density of
//! [`Scattering::sample`]. The crate knows neither scenes nor files.
//!
//! ```
//! use glam::DVec3;
//! use radsight_measured::{MeasuredBsdf, Side};
//! let data = vec!["0.1"; 145 * 145].join(", ");
//! let xml = format!(
//!     "<WindowElement><FileType>BSDF</FileType><Optical><Layer>
//!      <DataDefinition><IncidentDataStructure>Columns</IncidentDataStructure></DataDefinition>
//!      <WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock>
//!      <WavelengthDataDirection>Reflection Back</WavelengthDataDirection>
//!      <ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis><RowAngleBasis>LBNL/Klems Full</RowAngleBasis>
//!      <ScatteringData>{data}</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>"
//! );
//! let bsdf = MeasuredBsdf::read(xml.as_bytes()).unwrap().bsdf;
//! let oblique = DVec3::new(0.6, 0.0, 0.8);
//! assert!((bsdf.value(DVec3::Z, oblique)[1] - 0.1).abs() < 1e-6);
//! assert!((bsdf.diffuse_reflectance(Side::Front)[1] - 0.1 * std::f64::consts::PI).abs() < 1e-6);
//! ```
#![forbid(unsafe_code)]

mod basis;
mod color;
mod data;
mod matrix;
mod mistake;
mod read;
mod resolution;
mod scattering;
mod slice;
mod square;
mod tensor;
mod tree;
mod tree_text;
mod xml;

pub use basis::AngleBasis;
pub use data::{MeasuredBsdf, Side};
pub use matrix::Patches;
pub use mistake::{Mistake, Place};
pub use read::Reading;
pub use resolution::Resolution;
pub use scattering::{Sample, Scattering};
pub use xml::xml_text;
