//! What a user can ask of the renderer.

use radsight_ir::Rgb;
use radsight_spectrum::Sampling;

/// Options of every program that traces rays; the names in brackets are Radiance's.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Chooses the sample sequence. Default 0.
    pub seed: u64,
    /// Camera rays that are expected, about: many rays are worth better hierarchies of boxes, few are not. Never changes what is
    /// seen. Default 0, which is for as few as can be.
    pub camera_rays: f64,
    /// Diffuse interreflections that are followed (`-ab`). Default 0, as in Radiance.
    pub ambient_bounces: u32,
    /// Radiance of diffuse surroundings where they are not followed, W/(sr·m²) (`-av`). Default 0.
    pub ambient_value: Rgb,
    /// How interreflection is found at the first diffuse surface on a ray's way (`-aa`, `-ar`, `-ad`). Default one ray each time.
    pub gathering: Gathering,
    /// Rough highlights of no more than this share are not looked into for anything but sources: their share joins the diffuse
    /// component (`-st`). Default 0, which draws from all.
    pub highlight_threshold: f64,
    /// Size of a light over its distance from which a ray that counts by itself
    /// ([`Uncached::Split`]) samples more than one place on it (`-ds`); 0 always samples one.
    /// Default 0.2, as in Radiance.
    pub source_sampling: f64,
    /// Whether lights are divided at the surfaces that pixels show. Default not.
    pub light_division: LightDivision,
    /// How many rays look into the highlight at the first surface (`-ss`); fewer where it counts less, one at least, 16 at most. Default 1.
    pub highlight_samples: f64,
    /// On which surfaces diffuse interreflections are followed (`-ae`, `-ai`). Default all.
    pub ambient_surfaces: AmbientSurfaces,
    /// Where paths end (`-lr`). Default roulette, and no more than ten reflections.
    pub path_limit: PathLimit,
    /// Share of the picture's radiance below which a path ends or is put to roulette (`-lw`). Default 1e-4.
    pub least_weight: f64,
    /// How many plane mirrors may relay a light (`-dr`). Default 2.
    pub mirror_sources: u32,
    /// Whether lights are seen directly (`-dv`).
    pub lights: Lights,
    /// What fills the scene (`-me`, `-ma`, `-mg`). Default nothing.
    pub medium: GlobalMedium,
    /// Length of a ray in mist for each sample of its light, scene units (`-ms`); 0 is one sample a ray. Default 0.
    pub mist_sample_length: f64,
    /// Whether diffuse surfaces get light of lamps by way of curved mirrors and refracting bodies. Default not, as in Radiance.
    pub caustics: Caustics,
    /// In which bands light is followed (`-cs`, `-cw`). Default red, green and blue.
    pub sampling: Sampling,
    /// Whether surfaces are seen from behind (`-bv`).
    pub back_faces: BackFaces,
    /// What is wanted of a ray (`-i`, `-I`).
    pub quantity: Quantity,
    /// Modifiers whose contributions are wanted, by name (`rcontrib -m`). Default none.
    pub tracked_modifiers: Vec<String>,
    /// What is told of those that emit nothing (`rcontrib -V`).
    pub tracked_value: TrackedValue,
    /// Which of the rays are told that come of a ray (`rtrace -ot`, `-oT`). Default none.
    pub ray_tree: Option<RayTreeOutput>,
    /// Whether rays tell of surfaces without a material. Default not.
    pub bare_surfaces: BareSurfaces,
    /// Which work the plan may leave out where it cannot change the picture. Less than all only to test that it does not, and to measure it.
    pub skipping: Skipping,
}

impl Default for RenderOptions {
    fn default() -> Self {
        RenderOptions {
            seed: 0,
            camera_rays: 0.0,
            ambient_bounces: 0,
            ambient_value: Rgb::BLACK,
            gathering: Gathering::default(),
            highlight_threshold: 0.0,
            source_sampling: 0.2,
            light_division: LightDivision::Whole,
            highlight_samples: 1.0,
            ambient_surfaces: AmbientSurfaces::All,
            path_limit: PathLimit::RouletteUpTo(10),
            least_weight: 1e-4,
            mirror_sources: 2,
            lights: Lights::Visible,
            medium: GlobalMedium::default(),
            mist_sample_length: 0.0,
            caustics: Caustics::Discarded,
            sampling: Sampling::RGB,
            back_faces: BackFaces::Visible,
            quantity: Quantity::Radiance,
            tracked_modifiers: Vec::new(),
            tracked_value: TrackedValue::Share,
            ray_tree: None,
            bare_surfaces: BareSurfaces::LeftOut,
            skipping: Skipping::ALLOWED,
        }
    }
}

/// Looking around from a point for its irradiance, and sharing it with the points around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gathering {
    /// Error that sharing aims at, as a share (`-aa`); 0 shares nothing. Default 0.
    pub accuracy: f64,
    /// Standard error that cached irradiance may keep, as a share; it gets up to four times `divisions` rays for that, more
    /// where this is less than 0.03, and fewer, a quarter at least, where it is more than 0.01. Default 0.02.
    pub noise: f64,
    /// The scene's size over the least distance at which details of irradiance are wanted, times `accuracy` (`-ar`); 0 is no bound. Default 256.
    pub resolution: u32,
    /// Hemisphere samples of a cache point (`-ad`). Default 1024.
    pub divisions: u32,
    /// Further ones, spread like the others (`-as`). Default 0.
    pub super_samples: u32,
    /// What a point does that no cached irradiance reaches.
    pub uncached: Uncached,
    /// The share by which records may disagree around a point of a scene with caustics before it does the same: single rays hardly find those, so this is
    /// only for pixels that get as many as they need. Default infinite.
    pub caustic_error: f64,
    /// Relative fit residual above which cached irradiance is not used and single rays are traced
    /// instead. Infinite for pictures whose pixels have few rays. Default 0.2.
    pub most_residual: f64,
    /// Rays that cache records trace in the mean, as a share of `divisions` and `super_samples`, at
    /// most; the noise that is left then stays. Default infinite.
    pub record_share: f64,
    /// Cache points have the more samples the more of the picture they serve; those that serve nothing do so as if it were this share of what places serve in
    /// the mean. More makes noise more even, less makes less of it in all. Default 0.5.
    pub evenness: f64,
}

impl Default for Gathering {
    fn default() -> Self {
        Gathering {
            accuracy: 0.0,
            noise: 0.02,
            resolution: 256,
            divisions: 1024,
            super_samples: 0,
            uncached: Uncached::DrawOne,
            caustic_error: f64::INFINITY,
            most_residual: Gathering::MAX_INTERPOLATION_ERROR,
            record_share: f64::INFINITY,
            evenness: 0.5,
        }
    }
}

impl Gathering {
    /// Where records disagree by more than this share, drawing single rays is more exact.
    pub const MAX_INTERPOLATION_ERROR: f64 = 0.2;

    /// All hemisphere samples of a point; with fewer than two a single one is drawn instead.
    pub fn rays(&self) -> usize {
        self.divisions as usize + self.super_samples as usize
    }
}

/// What a point does that no cached irradiance reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncached {
    /// Draws one ray: for pictures, whose pixels are means over many.
    DrawOne,
    /// Splits into as many rays as `-ad` gives to a ray of its weight: for single rays, whose value
    /// counts by itself.
    Split,
}

/// On which surfaces diffuse interreflections are followed. The names are those of the modifiers that surfaces name themselves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AmbientSurfaces {
    /// On all.
    All,
    /// On all but those of these modifiers (`-ae`).
    Except(Vec<String>),
    /// On those of these modifiers (`-ai`).
    Only(Vec<String>),
}

/// What is told of tracked modifiers that emit nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackedValue {
    /// The share of the radiance there that would come (`-V-`).
    Share,
    /// The radiance that has come from there (`-V+`).
    Radiance,
}

/// Which of the rays are told that come of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayTreeOutput {
    /// All but shadow rays that meet their light and nothing else (`-ot`).
    All,
    /// Those too (`-oT`).
    AllAndLit,
}

/// Whether rays tell of surfaces without a material, which they pass as if nothing were there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BareSurfaces {
    /// They are left out.
    LeftOut,
    /// They are met.
    Met,
}

/// Where paths end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathLimit {
    /// After this many reflections, and where their weight falls below the least weight (`-lr` above 0). Loses light.
    Cut(u32),
    /// At random where their weight falls below the least weight, without loss on average (`-lr 0`).
    Roulette,
    /// The same, but after this many reflections at the latest (`-lr` below 0).
    RouletteUpTo(u32),
}

/// Into how many parts lights are divided where a ray of radiance that does not split meets its first surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightDivision {
    /// One place is sampled on each, or on some where there are many: pixels are means over many rays.
    Whole,
    /// A place in each part of the size that is asked for (`-ds`), on all but very many lights: pixels have few rays.
    BySize,
}

/// Whether lights are seen by rays that do not look for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lights {
    /// They are.
    Visible,
    /// They are black, but for glows that are too far away to be sampled.
    Invisible,
}

/// Light of lamps that diffuse surfaces get by way of curved mirrors and refracting bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Caustics {
    /// It is discarded, as in Radiance.
    Discarded,
    /// Paths to points of lamps are solved for.
    Sampled,
}

/// A participating medium around everything.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GlobalMedium {
    /// Absorption and scattering, 1/scene unit (`-me`).
    pub extinction: Rgb,
    /// Share of the extinction that is scattering (`-ma`).
    pub albedo: Rgb,
    /// Henyey and Greenstein's eccentricity, 0…1: how much is scattered forward (`-mg`).
    pub eccentricity: f64,
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
    /// Irradiance at the ray's origin on a surface that faces the ray's direction, W/m² (`-I`).
    Irradiance,
    /// Irradiance of the first surface that is neither a light nor lets light through, W/m² (`-i`).
    SurfaceIrradiance,
}

/// Work that a plan leaves out where it finds that no value depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skip {
    /// Two of three bands, where everything is grey.
    EqualBands,
    /// Lights that send nothing to a surface, and what cannot stand between the two.
    Unreached,
    /// What a shadow ray meets after its first hit, where nothing lets light through.
    BehindShadows,
    /// Following shadow rays from surface to surface, where nothing bends or dims them.
    BentShadows,
    /// What fills the space that rays cross, where nothing does.
    Media,
    /// Looking for surfaces that are cut away, where nothing cuts.
    Antimatter,
}

impl Skip {
    /// All kinds.
    pub const ALL: [Skip; 6] =
        [Skip::EqualBands, Skip::Unreached, Skip::BehindShadows, Skip::BentShadows, Skip::Media, Skip::Antimatter];

    /// A few words for it.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Skip::EqualBands => "equal bands",
            Skip::Unreached => "lights and blockers out of reach",
            Skip::BehindShadows => "what stands behind shadows",
            Skip::BentShadows => "bent shadow rays",
            Skip::Media => "media",
            Skip::Antimatter => "antimatter",
        }
    }
}

/// Which work a plan may leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skipping {
    /// A bit for each kind, in the order of [`Skip::ALL`].
    allowed: u8,
}

impl Skipping {
    /// All that cannot matter is left out.
    pub const ALLOWED: Skipping = Skipping { allowed: u8::MAX };
    /// Everything is computed.
    pub const FORBIDDEN: Skipping = Skipping { allowed: 0 };

    /// The same, but this kind of work is done.
    #[must_use]
    pub const fn without(self, skip: Skip) -> Skipping {
        Skipping { allowed: self.allowed & !(1 << skip as u8) }
    }

    /// Whether this kind of work may be left out.
    #[must_use]
    pub const fn allows(self, skip: Skip) -> bool {
        self.allowed & 1 << skip as u8 != 0
    }
}
