//! Rendering options.

use crate::direct_threshold::DirectThreshold;
use radsight_ir::Rgb;
use radsight_spectrum::Sampling;

/// Options of every program that traces rays; Radiance's names are in brackets.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Seed of the sample sequences. Default 0.
    pub seed: u64,
    /// Number of camera rays that are expected: many rays justify a hierarchy that takes longer to
    /// build. Has no influence on the result. Default 0: the quick builder.
    pub camera_rays: f64,
    /// Number of diffuse interreflections (`-ab`). Default 0, as in Radiance.
    pub ambient_bounces: u32,
    /// Ambient value: radiance of indirect light beyond the last bounce, W/(sr·m²) (`-av`). Default
    /// 0.
    pub ambient_value: Rgb,
    /// How indirect irradiance is estimated at a path's first diffuse surface (`-aa`, `-ar`,
    /// `-ad`). Default one ray per sample.
    pub gathering: Gathering,
    /// Specular threshold (`-st`): rough highlights up to this albedo are not sampled; their
    /// indirect light joins the diffuse component. Default 0, which samples every highlight.
    pub highlight_threshold: f64,
    /// Size of a light over its distance above which a ray that counts by itself
    /// ([`Uncached::Split`]) samples more than one point on it (`-ds`). 0 always samples one.
    /// Default 0.2, as in Radiance.
    pub source_sampling: f64,
    /// How exactly shadows of weak lights are tested where lights are subdivided (`-dt`). Default
    /// [`DirectThreshold::DEFAULT`].
    pub direct_threshold: DirectThreshold,
    /// Whether lights are subdivided at the surfaces that pixels show. Default
    /// [`LightDivision::Whole`].
    pub light_division: LightDivision,
    /// Number of rays that sample the highlight at the first surface (`-ss`), 1…16; fewer if the
    /// highlight contributes less. Default 1.
    pub highlight_samples: f64,
    /// Surfaces with diffuse interreflection (`-ae`, `-ai`). Default all.
    pub ambient_surfaces: AmbientSurfaces,
    /// Where paths end (`-lr`). Default Russian roulette, and at most ten reflections.
    pub path_limit: PathLimit,
    /// Path weight below which a path ends or undergoes Russian roulette, relative to the picture's
    /// radiance (`-lw`). Default 1e-4.
    pub least_weight: f64,
    /// Maximum number of plane mirrors of a virtual light (`-dr`). Default 2.
    pub mirror_sources: u32,
    /// Whether view rays see lights (`-dv`).
    pub lights: Lights,
    /// Medium around the scene (`-me`, `-ma`, `-mg`). Default none.
    pub medium: GlobalMedium,
    /// Length of a ray in mist per sample of its scattered light, scene units (`-ms`); 0 takes one
    /// sample per ray. Default 0.
    pub mist_sample_length: f64,
    /// Whether lamps light diffuse surfaces through curved mirrors and refracting objects. Default
    /// not, as in Radiance.
    pub caustics: Caustics,
    /// Spectral bands (`-cs`, `-cw`). Default red, green and blue.
    pub sampling: Sampling,
    /// Whether back faces are visible (`-bv`).
    pub back_faces: BackFaces,
    /// Quantity computed for a ray (`-i`, `-I`).
    pub quantity: Quantity,
    /// Modifiers whose contributions are reported, by name (`rcontrib -m`). Default none.
    pub tracked_modifiers: Vec<String>,
    /// Value reported for tracked modifiers that do not emit (`rcontrib -V`).
    pub tracked_value: TrackedValue,
    /// Which rays of the ray tree are reported (`rtrace -ot`, `-oT`). Default none.
    pub ray_tree: Option<RayTreeOutput>,
    /// Whether surfaces without a material are reported. Default not.
    pub bare_surfaces: BareSurfaces,
    /// Work that the plan may skip where it cannot change the picture. Less than all is for tests
    /// and measurements.
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
            direct_threshold: DirectThreshold::DEFAULT,
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

/// Final gathering of irradiance, and the irradiance cache.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gathering {
    /// Interpolation error of cached irradiance, relative (`-aa`); 0 turns the cache off. Default
    /// 0.
    pub accuracy: f64,
    /// Target relative standard error of a cache record. A record gets up to four times `divisions`
    /// rays (more for a target below 0.03), and as few as a quarter of them for a target above
    /// 0.01. Default 0.02.
    pub noise: f64,
    /// Size of the scene over the smallest spacing of cache records, times `accuracy` (`-ar`); 0
    /// means no limit. Default 256.
    pub resolution: u32,
    /// Hemisphere samples of a cache point (`-ad`); 0 means no interreflection, as 0
    /// [`RenderOptions::ambient_bounces`]. Default 1024.
    pub divisions: u32,
    /// Additional hemisphere samples, distributed like the others (`-as`). Default 0.
    pub super_samples: u32,
    /// How irradiance is estimated at a point that no cache record covers.
    pub uncached: Uncached,
    /// Relative disagreement of the records around a point, in a scene with caustics, above which
    /// the point is treated as uncached. Single rays hardly find caustics, so this suits only
    /// pixels that get as many rays as they need. Default infinite.
    pub caustic_error: f64,
    /// Relative fit residual above which cached irradiance is not used and single rays are traced
    /// instead. Infinite for pictures whose pixels have few rays. Default 0.2.
    pub most_residual: f64,
    /// Maximum mean number of rays of a cache record, relative to `divisions` and `super_samples`;
    /// remaining noise stays. Default infinite.
    pub record_share: f64,
    /// Whether points trace no more rays than Radiance does in about the same time: noise above `noise`
    /// stays. Default false.
    pub bounded: bool,
    /// Minimum weight of a cache point in sample allocation, relative to the mean. Samples are
    /// allocated by the number of pixels that a cache point serves; points that serve no pixel get
    /// this weight. A larger value distributes noise more uniformly, a smaller one lowers the
    /// total. Default 0.5.
    pub allocation_floor: f64,
}

impl Default for Gathering {
    fn default() -> Self {
        Gathering {
            accuracy: 0.0,
            noise: 0.02,
            resolution: 256,
            divisions: 1024,
            super_samples: 0,
            uncached: Uncached::TraceOne,
            caustic_error: f64::INFINITY,
            most_residual: Gathering::MAX_INTERPOLATION_ERROR,
            record_share: f64::INFINITY,
            bounded: false,
            allocation_floor: 0.5,
        }
    }
}

impl Gathering {
    /// Relative interpolation error above which tracing single rays is more accurate.
    pub const MAX_INTERPOLATION_ERROR: f64 = 0.2;

    /// Largest number of hemisphere samples, and of additional ones: a million takes some hundred
    /// megabytes for each thread.
    pub const MOST_RAYS: u32 = 1 << 20;

    /// Number of hemisphere samples of a cache point; with fewer than two a single ray is traced
    /// instead.
    pub fn rays(&self) -> usize {
        self.divisions as usize + self.super_samples as usize
    }
}

/// How irradiance is estimated at a point that no cache record covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncached {
    /// Trace one ray: for pictures, whose pixels average many.
    TraceOne,
    /// Split into as many rays as `-ad` gives for the ray's weight: for single rays, whose value
    /// counts by itself.
    Split,
}

/// Surfaces with diffuse interreflection, by the names of their direct modifiers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AmbientSurfaces {
    /// All surfaces.
    All,
    /// All surfaces except those of these modifiers (`-ae`).
    Except(Vec<String>),
    /// Only surfaces of these modifiers (`-ai`).
    Only(Vec<String>),
}

/// Value reported for tracked modifiers that do not emit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackedValue {
    /// Coefficient of the radiance at the surface (`-V-`).
    Share,
    /// Contribution: the radiance that arrives from the surface (`-V+`).
    Radiance,
}

/// Rays of the ray tree that are reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayTreeOutput {
    /// All except shadow rays that hit their light and nothing else (`-ot`).
    All,
    /// All, including those shadow rays (`-oT`).
    AllAndLit,
}

/// Whether surfaces without a material are reported. Rays pass through them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BareSurfaces {
    /// Surfaces without a material are not reported.
    LeftOut,
    /// Surfaces without a material are reported.
    Reported,
}

/// Where paths end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathLimit {
    /// Path ends after this many reflections, and where its weight falls below the minimum (`-lr`
    /// above 0). Loses energy.
    Cut(u32),
    /// Russian roulette where the weight falls below the minimum; unbiased (`-lr 0`).
    Roulette,
    /// Russian roulette, and an end after this many reflections (`-lr` below 0).
    RouletteUpTo(u32),
}

/// Subdivision of lights at the first surface of a radiance ray that does not split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightDivision {
    /// One point on each light, or on the selected ones: pixels average many rays.
    Whole,
    /// So many points in each square whose side is the requested fraction of the distance (`-ds`),
    /// on all lights unless they are very many: pixels have few rays.
    BySize(f64),
    /// The same, where rays beside each other share what they know of the light.
    Shared(f64),
}

/// Whether view rays see light sources.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lights {
    /// Lights are visible.
    Visible,
    /// Lights are black, except for glows too far away to be sampled.
    Invisible,
}

/// Light that lamps send to diffuse surfaces through curved mirrors and refracting objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Caustics {
    /// Discarded, as in Radiance.
    Discarded,
    /// Sampled by solving for specular paths to points of lamps.
    Sampled,
}

/// Medium around the whole scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GlobalMedium {
    /// Extinction coefficient, 1/scene unit (`-me`).
    pub extinction: Rgb,
    /// Scattering albedo, 0…1 (`-ma`).
    pub albedo: Rgb,
    /// Eccentricity of Henyey and Greenstein's phase function, 0…1: 0 is isotropic (`-mg`).
    pub eccentricity: f64,
}

/// What a ray hits at a back face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BackFaces {
    /// The same material as on the front.
    Visible,
    /// Nothing: the ray continues.
    Invisible,
}

/// Quantity computed for an input ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Radiance along the ray, W/(sr·m²).
    Radiance,
    /// Irradiance at the ray's origin, on a surface that faces along the ray's direction, W/m²
    /// (`-I`).
    Irradiance,
    /// Irradiance of the first surface that is neither a light nor transparent, W/m² (`-i`).
    SurfaceIrradiance,
}

/// Work that a plan skips if no value depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skip {
    /// Two of three bands, if everything is grey.
    EqualBands,
    /// Lights that cannot illuminate a surface, and surfaces that cannot block them.
    Unreached,
    /// Hits of a shadow ray after the first, if nothing transmits light.
    BehindShadows,
    /// Tracing shadow rays from surface to surface, if nothing refracts or attenuates them.
    RefractedShadows,
    /// Participating media, if there are none.
    Media,
    /// Testing for subtracted surfaces, if there is no antimatter.
    Antimatter,
}

impl Skip {
    /// All kinds.
    pub const ALL: [Skip; 6] =
        [Skip::EqualBands, Skip::Unreached, Skip::BehindShadows, Skip::RefractedShadows, Skip::Media, Skip::Antimatter];

    /// Short description.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Skip::EqualBands => "equal bands",
            Skip::Unreached => "unreachable lights and blockers",
            Skip::BehindShadows => "hits behind opaque blockers",
            Skip::RefractedShadows => "refracted shadow rays",
            Skip::Media => "media",
            Skip::Antimatter => "antimatter",
        }
    }
}

/// Kinds of work that a plan may skip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skipping {
    /// One bit for each kind, in the order of [`Skip::ALL`].
    allowed: u8,
}

impl Skipping {
    /// Everything that cannot matter may be skipped.
    pub const ALLOWED: Skipping = Skipping { allowed: u8::MAX };
    /// Nothing may be skipped.
    pub const FORBIDDEN: Skipping = Skipping { allowed: 0 };

    /// The same, without this kind of work.
    #[must_use]
    pub const fn without(self, skip: Skip) -> Skipping {
        Skipping { allowed: self.allowed & !(1 << skip as u8) }
    }

    /// Whether this kind of work may be skipped.
    #[must_use]
    pub const fn allows(self, skip: Skip) -> bool {
        self.allowed & 1 << skip as u8 != 0
    }
}
