//! What a user can ask of the renderer.

/// Options of every program that traces rays; the names in brackets are Radiance's.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Chooses the sample sequence. Default 0.
    pub seed: u64,
    /// Diffuse interreflections that are followed (`-ab`). Default 0, as in Radiance.
    pub ambient_bounces: u32,
    /// How many plane mirrors may relay a light (`-dr`). Default 2.
    pub mirror_relays: u32,
    /// Whether surfaces are seen from behind (`-bv`).
    pub back_faces: BackFaces,
    /// Whether the input rays are points and normals whose irradiance is wanted (`-I`).
    pub quantity: Quantity,
    /// Whether the plan may leave work out that cannot change the picture. Off only to test that it does not.
    pub skipping: Skipping,
}

impl Default for RenderOptions {
    fn default() -> Self {
        RenderOptions {
            seed: 0,
            ambient_bounces: 0,
            mirror_relays: 2,
            back_faces: BackFaces::Visible,
            quantity: Quantity::Radiance,
            skipping: Skipping::Allowed,
        }
    }
}

/// What a ray meets from behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BackFaces {
    /// The same material.
    Visible,
    /// Nothing.
    Invisible,
}

/// What an input ray asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Radiance along the ray, W/(sr·m²).
    Radiance,
    /// Irradiance at the ray's origin on a surface that faces the ray's direction, W/m².
    Irradiance,
}

/// Whether the plan may skip work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skipping {
    /// What cannot matter is left out.
    Allowed,
    /// Everything is computed.
    Forbidden,
}
