//! BSDF files as matrices.

use crate::{Matrix, MatrixError, Stored};
use radsight_measured::{MeasuredBsdf, Side};

/// Part of the scattering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Transmission from the back to the front: from the sky into the room.
    Transmission,
    /// Reflection on a side.
    Reflection(Side),
}

/// The matrix of a BSDF file between angle bases: rows are outgoing patches, columns incident ones.
/// Values are those of the BSDF times the projected solid angle of the incident patch. A Lambertian
/// component becomes a matrix of Klems' full basis.
///
/// # Errors
/// If the file is malformed, or holds no matrix.
pub fn bsdf_matrix(bytes: &[u8], wanted: Wanted) -> Result<Matrix, MatrixError> {
    let bsdf = MeasuredBsdf::read(bytes).map_err(|mistake| MatrixError::Bsdf(mistake.to_string()))?.bsdf;
    let (scattering, diffuse) = match wanted {
        Wanted::Transmission => (bsdf.transmission(Side::Back), bsdf.diffuse_transmittance(Side::Back)),
        Wanted::Reflection(side) => (bsdf.reflection(side), bsdf.diffuse_reflectance(side)),
    };
    let arriving = match wanted {
        Wanted::Transmission => Side::Back,
        Wanted::Reflection(side) => side,
    };
    let patches = match scattering {
        Some(scattering) => scattering.patches(arriving),
        None => Some(radsight_measured::Patches::lambertian(diffuse)),
    };
    let Some(patches) = patches else {
        return Err(MatrixError::Bsdf("a tensor tree is no matrix, expected data between angle bases".to_owned()));
    };
    let values = patches.values.iter().flatten().map(|value| *value as f32).collect();
    let mut matrix = Matrix::new([patches.rows, patches.columns], 3, values)?;
    matrix.stored = Stored::Ascii;
    Ok(matrix)
}
