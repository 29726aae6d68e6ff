//! Models by name, as in a scene: `brdfplugin NAME  n retro MODEL words…  0  m numbers…`.
//!
//! The library name `retro` refers to the built-in models: no file is loaded and no call crosses
//! the plugin interface.

use crate::coefficient::Geometry;
use crate::fresnel::fresnel_dielectric;
use crate::gaussian::{Paper1991, ReciprocalGaussian};
use crate::glass_bead::{Binder, GlassBead};
use crate::mrm::Mrm;
use crate::prism::{CubeCornerSheeting, Faces};
use crate::sharp::SharpLobe;
use crate::sheeting::{Core, Sheeting, Surroundings};
use crate::table::{RetroTable, Row, TableError};
use radsight_brdf::native::{ModelError, Parameter, complete_numbers};

/// Library name of the built-in models.
pub const LIBRARY: &str = "retro";

/// Description of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelInfo {
    /// Name in a scene.
    pub name: &'static str,
    /// Description in one line.
    pub summary: &'static str,
    /// Options (words) of the model; the first is the default. Empty if there are none.
    pub words: &'static [&'static str],
    /// Parameters in the order of a scene's numbers.
    pub parameters: &'static [Parameter],
    /// Whether `f(o, i) = f(i, o)`.
    pub reciprocal: bool,
}

const RHO_S: Parameter = Parameter::required(
    "rho_s",
    "1",
    [0.0, 1.0],
    "fraction of the light returned at normal incidence by a narrow lobe",
);
const ALPHA: Parameter =
    Parameter::required("alpha", "rad", [1e-5, 0.2], "width: the lobe falls to 1/e at an angle of 2 alpha");
const RHO_D: Parameter = Parameter {
    default: Some(0.0),
    ..Parameter::required("rho_d", "1", [0.0, 1.0], "diffuse reflectance of the base")
};
const INDEX: Parameter = Parameter {
    default: Some(1.0),
    ..Parameter::required("film_index", "1", [1.0, 2.5], "refractive index of the top film, 1 for none")
};
const ROUGHNESS: Parameter = Parameter {
    default: Some(0.1),
    ..Parameter::required("film_roughness", "1", [5e-4, 1.0], "roughness of the top film, for its sheen")
};

/// All built-in models.
pub const MODELS: [ModelInfo; 7] = [
    ModelInfo {
        name: "paper1991",
        summary: "the Gaussian lobe of Rushmeier, Parker and Lee, 1991, eq. 6, verbatim",
        words: &[],
        parameters: &[RHO_S, ALPHA, RHO_D, INDEX, ROUGHNESS],
        reciprocal: false,
    },
    ModelInfo {
        name: "gauss_reciprocal",
        summary: "the same lobe, made reciprocal",
        words: &[],
        parameters: &[RHO_S, ALPHA, RHO_D, INDEX, ROUGHNESS],
        reciprocal: true,
    },
    ModelInfo {
        name: "sharp",
        summary: "a flat top and a steep fall-off",
        words: &[],
        parameters: &[
            RHO_S,
            Parameter::required("half_width", "rad", [1e-5, 0.5], "observation angle at half the peak"),
            Parameter::required("order", "1", [1.0, 64.0], "steepness: 2 is a Gaussian, a large one a disk"),
            RHO_D,
            INDEX,
            ROUGHNESS,
        ],
        reciprocal: true,
    },
    ModelInfo {
        name: "mrm",
        summary: "minimal retroreflective microfacets, as in glTF and OpenPBR",
        words: &[],
        parameters: &[
            Parameter::required("f0", "1", [0.0, 1.0], "reflectance of a facet at normal incidence"),
            Parameter::required("roughness", "1", [5e-4, 1.0], "roughness of the facets"),
            Parameter::required("retro_share", "1", [0.0, 1.0], "fraction of the facets that retroreflect"),
            RHO_D,
            INDEX,
            ROUGHNESS,
        ],
        reciprocal: true,
    },
    ModelInfo {
        name: "glass_bead",
        summary: "Ward's fit to a ray simulation of glass beads (retrorefl.cal)",
        words: &["sheet", "paint"],
        parameters: &[
            Parameter::required(
                "r_half",
                "cd/(lx m2)",
                [0.0, 5000.0],
                "R_A at normal incidence and 0.5 degrees of observation",
            ),
            RHO_D,
            INDEX,
            ROUGHNESS,
        ],
        reciprocal: false,
    },
    ModelInfo {
        name: "cube_corner",
        summary: "sheeting of corner prisms, by ray optics",
        words: &["air", "metal"],
        parameters: &[
            Parameter::required("index", "1", [1.3, 2.2], "refractive index of the prisms"),
            Parameter::required(
                "dihedral_error",
                "rad",
                [-0.002, 0.002],
                "excess of the angles between faces over 90 degrees",
            ),
            Parameter::required("spread", "rad", [5e-4, 0.05], "rms width of a spot"),
            Parameter {
                default: Some(0.85),
                ..Parameter::required("metal_reflectance", "1", [0.0, 1.0], "reflectance of a coated face")
            },
            RHO_D,
            INDEX,
            ROUGHNESS,
        ],
        reciprocal: true,
    },
    ModelInfo {
        name: "table",
        summary: "measured R_A: after these numbers, rows of observation, entrance, [rotation,] R_A (degrees, cd/(lx m2))",
        words: &["two_angles", "three_angles"],
        parameters: &[
            Parameter { default: None, ..RHO_D },
            Parameter { default: None, ..INDEX },
            Parameter { default: None, ..ROUGHNESS },
        ],
        reciprocal: false,
    },
];

/// Description of the model of this name.
#[must_use]
pub fn model_info(name: &str) -> Option<&'static ModelInfo> {
    MODELS.iter().find(|model| model.name == name)
}

/// Makes a model from a scene's words and numbers.
///
/// # Errors
/// The first word or number that is wrong.
pub fn model(name: &str, words: &[String], numbers: &[f64]) -> Result<Sheeting, ModelError> {
    let info = model_info(name).ok_or_else(|| ModelError::Unknown { library: LIBRARY, name: name.to_owned() })?;
    let word = checked_word(info, words)?;
    let (head, rows) = if info.name == "table" { numbers.split_at(numbers.len().min(3)) } else { (numbers, &[][..]) };
    let complete = complete_numbers(info.name, info.parameters, head)?;
    let (own, last) = complete.split_at(complete.len() - 3);
    let around = Surroundings { matte: last[0], index: last[1], roughness: last[2] };
    let core = match (info.name, own) {
        ("paper1991", &[reflectance, spread]) => Core::Paper(Paper1991 { reflectance: [reflectance], spread }),
        ("gauss_reciprocal", &[reflectance, spread]) => {
            Core::Gaussian(ReciprocalGaussian { reflectance: [reflectance], spread })
        }
        ("sharp", &[reflectance, half_width, order]) => {
            Core::Sharp { reflectance, lobe: SharpLobe::new(half_width, order) }
        }
        ("mrm", &[normal_reflectance, roughness, retro_share]) => {
            Core::Mrm(Mrm { normal_reflectance, roughness, retro_share })
        }
        ("glass_bead", &[coefficient]) => {
            Core::Bead(GlassBead::new(coefficient, if word == "paint" { Binder::Paint } else { Binder::Sheet }))
        }
        ("cube_corner", &[index, error, spread, reflectance]) => {
            let faces = if word == "metal" { Faces::Coated { reflectance } } else { Faces::Bare };
            Core::CubeCorner(CubeCornerSheeting::new(index, error, spread, faces).with_tail(0.2))
        }
        _ => Core::Table(table(if word == "three_angles" { Angles::Three } else { Angles::Two }, rows, head.len())?),
    };
    check_energy(&core, around)?;
    Ok(Sheeting::new(core, around))
}

fn checked_word(info: &ModelInfo, words: &[String]) -> Result<&'static str, ModelError> {
    let Some(given) = words.first() else { return Ok(info.words.first().copied().unwrap_or_default()) };
    let wrong = |index: usize| {
        let takes = if info.words.is_empty() { "no words".to_owned() } else { info.words.join(" or ") };
        let message = format!("extra word \"{}\": model \"{}\" takes {takes}", words[index], info.name);
        Err(ModelError::Word { index, message })
    };
    match info.words.iter().find(|known| *known == given) {
        None => wrong(0),
        Some(_) if words.len() > 1 => wrong(1),
        Some(known) => Ok(known),
    }
}

/// The angles of a table's rows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Angles {
    /// Observation and entrance.
    Two,
    /// Rotation, too.
    Three,
}

fn table(angles: Angles, numbers: &[f64], before: usize) -> Result<RetroTable, ModelError> {
    let has_rotation = angles == Angles::Three;
    let columns = if has_rotation { 4 } else { 3 };
    if !numbers.len().is_multiple_of(columns) {
        let message = format!(
            "the table has {} numbers, expected a multiple of {columns}: observation, entrance, {}R_A in each row",
            numbers.len(),
            if has_rotation { "rotation, " } else { "" }
        );
        return Err(ModelError::Numbers(message));
    }
    let rows: Vec<Row> = numbers
        .chunks_exact(columns)
        .map(|row| {
            let rotation = if has_rotation { row[2] } else { 0.0 };
            Row { geometry: Geometry::from_degrees(row[0], row[1], rotation), coefficient: row[columns - 1] }
        })
        .collect();
    RetroTable::new(&rows).map_err(|error| match error {
        TableError::Row(row, _) | TableError::Twice(_, row) => {
            ModelError::Number { index: before + row * columns, message: error.to_string() }
        }
        other => ModelError::Numbers(other.to_string()),
    })
}

/// Rejects models whose parts together reflect more than all light.
fn check_energy(core: &Core, around: Surroundings) -> Result<(), ModelError> {
    let film = fresnel_dielectric(1.0, around.index);
    let retro = match core {
        Core::Paper(lobe) => lobe.reflectance[0],
        Core::Gaussian(lobe) => lobe.reflectance[0],
        Core::Sharp { reflectance, .. } => *reflectance,
        // Schlick's reflectance tends to 1 at grazing facets, which leaves nothing for the base.
        Core::Mrm(lobe) if around.matte > 0.0 || around.index > 1.0 => lobe.normal_reflectance,
        Core::Mrm(_) => 0.0,
        Core::CubeCorner(_) => 2.0 / 3.0,
        Core::Table(table) => table.albedo(0.0),
        // Radiance's function is used unchanged.
        Core::Bead(_) => 0.0,
    };
    let total = retro + around.matte + film;
    if total > 1.0 + 1e-9 {
        let message = format!(
            "the sheeting reflects {:.1} % of the light: {retro:.4} retroreflected, {} diffuse, {film:.4} by the film, expected at most 100 %",
            total * 100.0,
            around.matte
        );
        return Err(ModelError::Numbers(message));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(name: &str, words: &[&str], numbers: &[f64]) -> ModelError {
        let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        model(name, &words, numbers).unwrap_err()
    }

    #[test]
    fn errors_are_reported_at_their_tokens() {
        assert!(matches!(error("sharpp", &[], &[]), ModelError::Unknown { .. }));
        assert!(matches!(error("sharp", &[], &[0.1, 0.01]), ModelError::Numbers(_)));
        assert!(matches!(error("sharp", &[], &[0.1, 0.01, 0.5]), ModelError::Number { index: 2, .. }));
        assert!(matches!(error("sharp", &[], &[0.1, f64::NAN, 4.0]), ModelError::Number { index: 1, .. }));
        assert!(matches!(error("sharp", &["air"], &[0.1, 0.01, 4.0]), ModelError::Word { index: 0, .. }));
        assert!(matches!(error("glass_bead", &["sheet", "x"], &[50.0]), ModelError::Word { index: 1, .. }));
        assert!(matches!(error("sharp", &[], &[0.9, 0.01, 4.0, 0.2]), ModelError::Numbers(_)));
        assert!(matches!(
            error("sharp", &[], &[0.1, 0.01, 4.0, 0.0, 1.0, 0.1, 7.0]),
            ModelError::Number { index: 6, .. }
        ));
        let bad_row = error("table", &[], &[0.0, 1.0, 0.1, 0.2, 5.0, 70.0, 0.5, 95.0, 20.0]);
        assert!(matches!(bad_row, ModelError::Number { index: 6, .. }), "{bad_row}");
        assert!(matches!(error("table", &[], &[0.0, 1.0, 0.1, 0.2]), ModelError::Numbers(_)));
        assert!(matches!(error("table", &[], &[0.0, 1.0]), ModelError::Numbers(_)));
    }
}
