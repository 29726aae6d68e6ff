//! The BSDF at a shading point: its components, evaluated and sampled.

use crate::diffuse_lobe::DiffuseLobe;
use crate::frame::Frame;
use crate::function_lobe::FunctionLobe;
use crate::glossy::GlossyKind;
use crate::measured_lobe::MeasuredLobe;
use crate::sample::{BsdfSample, BsdfValue, PdfRequest};
use crate::specular_threshold::{BelowThreshold, LobeStrength};
use crate::transmission_lobe::{Transmission, chance_of_second};
use glam::DVec3;
use radsight_brdf::{AshikhminShirley, Brdf, BrdfSample, Density, WardAnisotropic, WardIsotropic};
use radsight_cal::Scratch;
use radsight_ir::Rgb;
use radsight_light::{LightSampleCount, LobePeak, ReceiverCosine, Reception};
use radsight_retro::{Paper1991, observation_angle};
use radsight_texture::{bands, not_negative, spread, strongest};
use std::f64::consts::FRAC_1_PI;

/// The direction of a glossy highlight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HighlightShape {
    /// Around the mirror direction.
    Mirror,
    /// Around the direction from which the light arrives.
    Retro,
}

/// A specular lobe of finite width.
#[derive(Clone, Copy, Debug)]
pub enum Highlight<'a, const BANDS: usize> {
    /// No highlight.
    None,
    /// Ward's isotropic highlight.
    Ward(WardIsotropic<BANDS>),
    /// Ward's highlight with two roughnesses.
    WardAnisotropic(WardAnisotropic<BANDS>),
    /// Ashikhmin and Shirley's highlight.
    Ashikhmin(AshikhminShirley<BANDS>),
    /// The retroreflecting lobe of the paper.
    Retro(Paper1991<BANDS>),
    /// A scattering function: lit by light sources only, and never sampled.
    Function(FunctionLobe<'a, BANDS>),
    /// Measured data, which reflect and transmit.
    Measured(MeasuredLobe<'a, BANDS>),
    /// A model from a plugin, which reflects and transmits.
    Model(&'a dyn Brdf),
}

/// How a Fresnel coat over the diffuse component attenuates direct light, by the incident angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FresnelCoat {
    /// No coat.
    None,
    /// A smooth coat, with Radiance's estimate of its Fresnel reflectance.
    Coat,
    /// Schlick's term of Ashikhmin and Shirley's model.
    Schlick,
}

impl FresnelCoat {
    /// Fraction of the light that reaches the diffuse component at this cosine of the incident
    /// angle.
    #[inline]
    fn transmittance(self, cosine: f64) -> f64 {
        match self {
            FresnelCoat::None => 1.0,
            FresnelCoat::Coat => 1.0 - fresnel_estimate(cosine.abs()),
            FresnelCoat::Schlick => 1.0 - schlick(cosine),
        }
    }
}

/// BSDF at one shading point, for one outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf<'a, const BANDS: usize> {
    /// Unit vector towards the viewer.
    pub outgoing: DVec3,
    /// Unit geometric normal on the viewer's side.
    pub normal: DVec3,
    /// Frame on the shading normal.
    pub frame: Frame,
    /// Unit normal of the diffuse component: the shading normal, except on a retroreflector, whose
    /// texture turns only this normal.
    pub diffuse_normal: DVec3,
    /// Diffuse reflectance at normal incidence.
    pub diffuse: [f64; BANDS],
    /// Coat over the diffuse component.
    pub coat: FresnelCoat,
    /// Lobe about the mirror direction, or about the viewer's direction.
    pub highlight: Highlight<'a, BANDS>,
    /// Highlights of both sides below the specular threshold (`-st`), which only direct light
    /// meets.
    pub below_threshold: BelowThreshold<BANDS>,
    /// Reflectance of a perfect mirror; zero for rough surfaces.
    pub mirror: [f64; BANDS],
    /// Transmission; none for an opaque surface.
    pub transmission: Option<Transmission<BANDS>>,
    /// Whether indirect light comes as to the surface without its texture.
    pub indirect_ignores_texture: bool,
}

impl<const BANDS: usize> Highlight<'_, BANDS> {
    /// Estimate of the total reflectance and transmittance, 0…1.
    pub fn strength(&self) -> f64 {
        match self {
            Highlight::None | Highlight::Function(_) => 0.0,
            Highlight::Ward(ward) => strongest(&ward.specularity),
            Highlight::WardAnisotropic(ward) => strongest(&ward.specularity),
            Highlight::Ashikhmin(lobe) => strongest(&lobe.specularity),
            Highlight::Retro(retro) => strongest(&retro.reflectance),
            Highlight::Measured(_) | Highlight::Model(_) => 1.0,
        }
    }
}

/// Sum, band by band.
pub fn sum<const BANDS: usize>(a: [f64; BANDS], b: [f64; BANDS]) -> [f64; BANDS] {
    std::array::from_fn(|band| a[band] + b[band])
}

/// Radiance's estimate of how far the Fresnel reflectance of a smooth coat at this cosine exceeds
/// the one at normal incidence.
pub(crate) fn fresnel_estimate(cosine: f64) -> f64 {
    (-5.85 * cosine).exp() - 0.002_029_430_64
}

/// Specularities below this value get no Fresnel estimate in Radiance.
pub(crate) const FRESNEL_THRESHOLD: f64 = 0.017_999;

/// Schlick, "An Inexpensive BRDF Model for Physically-Based Rendering", Eurographics 1994: the part
/// that grows towards grazing incidence, (1 − cos θ)⁵.
pub(crate) fn schlick(cosine: f64) -> f64 {
    (1.0 - cosine).powi(5)
}

impl<'a, const BANDS: usize> Bsdf<'a, BANDS> {
    /// A BSDF without components, seen from `outgoing`.
    pub fn new(outgoing: DVec3, normal: DVec3, frame: Frame) -> Self {
        Bsdf {
            outgoing,
            normal,
            frame,
            diffuse_normal: frame.z,
            diffuse: [0.0; BANDS],
            coat: FresnelCoat::None,
            highlight: Highlight::None,
            below_threshold: BelowThreshold::NOTHING,
            mirror: [0.0; BANDS],
            transmission: None,
            indirect_ignores_texture: false,
        }
    }

    /// A plastic or metal with this shading normal and this colour, patterns included.
    pub fn glossy(
        kind: &GlossyKind,
        shape: HighlightShape,
        color: [f64; BANDS],
        outgoing: DVec3,
        normal: DVec3,
        shading_normal: DVec3,
    ) -> Self {
        let smooth = kind.is_smooth();
        let cosine = outgoing.dot(shading_normal).max(0.001);
        let coated = smooth && kind.specularity >= FRESNEL_THRESHOLD;
        let fresnel = if coated { fresnel_estimate(cosine) } else { 0.0 };
        let specularity = kind.specularity + fresnel * (1.0 - kind.specularity);
        let specular: [f64; BANDS] = match kind.metallic {
            true => not_negative(color.map(|band| fresnel + band * kind.specularity * (1.0 - fresnel))),
            false => [specularity; BANDS],
        };
        let highlight = if smooth || kind.specularity <= 0.0 {
            Highlight::None
        } else if shape == HighlightShape::Retro {
            Highlight::Retro(Paper1991 { reflectance: specular, spread: kind.roughness })
        } else {
            Highlight::Ward(WardIsotropic { specularity: specular, roughness: kind.roughness })
        };
        Bsdf {
            outgoing,
            normal,
            frame: Frame::new(shading_normal),
            diffuse_normal: if shape == HighlightShape::Retro { outgoing } else { shading_normal },
            diffuse: not_negative(color.map(|band| band * (1.0 - specularity))),
            coat: if coated { FresnelCoat::Coat } else { FresnelCoat::None },
            highlight,
            below_threshold: BelowThreshold::NOTHING,
            mirror: if smooth && kind.specularity > 0.0 { specular } else { [0.0; BANDS] },
            transmission: None,
            indirect_ignores_texture: false,
        }
    }

    /// A white Lambertian surface, seen from this unit direction.
    pub fn white(outgoing: DVec3, normal: DVec3) -> Self {
        let white = GlossyKind { color: Rgb::WHITE, specularity: 0.0, roughness: 0.0, metallic: false };
        Bsdf::glossy(&white, HighlightShape::Mirror, [1.0; BANDS], outgoing, normal, normal)
    }

    /// Leaves the highlight unsampled if it is no stronger than the specular threshold (`-st`).
    pub fn set_threshold(&mut self, kind: &GlossyKind, threshold: f64) {
        let Highlight::Ward(ward) = &self.highlight else { return };
        let share = kind.specularity;
        let highlight = LobeStrength { share, color: ward.specularity, diffuse: 1.0 - share };
        self.below_threshold = BelowThreshold::new(threshold, [highlight, LobeStrength::NONE]);
    }

    /// A reflectance model from a plugin.
    pub fn model(model: &'a dyn Brdf, outgoing: DVec3, normal: DVec3, shading_normal: DVec3) -> Self {
        let highlight = Highlight::Model(model);
        Bsdf { highlight, ..Bsdf::new(outgoing, normal, Frame::level(shading_normal)) }
    }

    /// Adds transmission. The probability of sampling a side is proportional to what that side
    /// scatters.
    pub fn with_transmission(self, mut transmission: Transmission<BANDS>) -> Self {
        let ambient = self.ambient();
        let carried = |own: &[f64; BANDS], ambient: &[f64; BANDS]| strongest(own) + strongest(ambient);
        let transmitted = carried(&transmission.diffuse, &ambient[1]);
        transmission.diffuse_chance = chance_of_second(carried(&self.diffuse, &ambient[0]), transmitted);
        let through = transmission.lobe.map_or(0.0, |lobe| strongest(&lobe.shape.transmittance));
        let [own_left_out, through_left_out] = self.below_threshold.is_left_out();
        let sampled = |strength: f64, left_out: bool| if left_out { 0.0 } else { strength };
        let own = sampled(self.highlight.strength(), own_left_out);
        let transmission_sampled = sampled(through, through_left_out);
        transmission.lobe_chance =
            if transmission_sampled > 0.0 { chance_of_second(own, transmission_sampled) } else { 0.0 };
        let transmission = (transmitted > 0.0 || through > 0.0).then_some(transmission);
        Bsdf { transmission, ..self }
    }

    /// Shape of the highlight, for sampling points on lights.
    pub fn peak(&self) -> LobePeak {
        let diffuse_through = self.transmission.map_or(0.0, |transmission| strongest(&transmission.diffuse));
        let lobe_through = self.transmission.and_then(|transmission| transmission.lobe);
        // Lights that the other side sees are not in the lobe, and must not be sampled by its slope.
        let diffuse = strongest(&self.diffuse).max(diffuse_through);
        let through = lobe_through.map_or(0.0, |lobe| strongest(&lobe.shape.transmittance));
        let floor = diffuse.max(through) * FRAC_1_PI;
        let cosine = match self.transmission {
            Some(_) => ReceiverCosine::Both(self.diffuse_normal),
            None => ReceiverCosine::Front(self.diffuse_normal),
        };
        let about_mirror = |width: f64, specularity: &[f64; BANDS]| {
            let height = strongest(specularity) * width * FRAC_1_PI;
            LobePeak { axis: self.mirror_direction(), width, height, floor, cosine }
        };
        let reflected = match &self.highlight {
            Highlight::Retro(retro) => {
                let height = strongest(&retro.reflectance) * retro.reflected_density(0.0);
                LobePeak { axis: self.outgoing, width: 0.25 / (retro.spread * retro.spread), height, floor, cosine }
            }
            // Reflected about the mirror direction, the half vector turns half as fast as the
            // incident direction.
            Highlight::Ward(ward) => about_mirror(0.25 / (ward.roughness * ward.roughness), &ward.specularity),
            Highlight::WardAnisotropic(ward) => {
                let widest = ward.roughness[0].max(ward.roughness[1]);
                about_mirror(0.25 / (widest * widest), &ward.specularity)
            }
            // The n-th power of a cosine is close to a Gaussian of variance 1/n.
            Highlight::Ashikhmin(lobe) => {
                about_mirror(0.125 * lobe.exponents[0].min(lobe.exponents[1]), &lobe.specularity)
            }
            Highlight::None | Highlight::Function(_) | Highlight::Measured(_) | Highlight::Model(_) => {
                LobePeak { cosine, ..LobePeak::NONE }
            }
        };
        let Some(lobe) = lobe_through else { return reflected };
        let transmitted = lobe.peak(diffuse.max(self.highlight.strength()) * FRAC_1_PI);
        if transmitted.height > reflected.height { LobePeak { cosine, ..transmitted } } else { reflected }
    }

    /// Shape of the whole BSDF, for choosing `draws` lights.
    pub fn reception(&self, draws: u32) -> Reception {
        let peak = self.peak();
        if draws == 0 {
            return Reception { peak, ..Reception::NONE };
        }
        let from_anywhere = match &self.highlight {
            Highlight::Function(_) | Highlight::Measured(_) | Highlight::Model(_) => 0.5,
            highlight => BESIDE_PEAK * highlight.strength(),
        };
        let transmission = self.transmission.map_or(0.0, |transmission| {
            strongest(&transmission.diffuse)
                + BESIDE_PEAK * transmission.lobe.map_or(0.0, |lobe| strongest(&lobe.shape.transmittance))
        });
        Reception {
            normal: self.diffuse_normal,
            diffuse: strongest(&self.diffuse) * FRAC_1_PI,
            peak,
            floor: (from_anywhere + transmission) * FRAC_1_PI,
            draws,
            samples: LightSampleCount::ONE,
        }
    }

    /// Whether either side has a highlight that only BSDF sampling finds.
    pub fn has_highlight(&self) -> bool {
        let [own_left_out, through_left_out] = self.below_threshold.is_left_out();
        let own = match &self.highlight {
            Highlight::None | Highlight::Function(_) => false,
            Highlight::Measured(lobe) => lobe.is_sampled,
            _ => !own_left_out,
        };
        own || self.transmission.is_some_and(|transmission| transmission.lobe.is_some() && !through_left_out)
    }

    /// Unit normal, if the surface is purely diffuse on the viewer's side and opaque.
    pub fn facing(&self) -> Option<DVec3> {
        let is_diffuse = matches!(self.highlight, Highlight::None) && self.transmission.is_none();
        is_diffuse.then_some(self.diffuse_normal)
    }

    /// Estimate of the albedo of both sides' highlights.
    pub fn highlight_strength(&self) -> f64 {
        let through = self
            .transmission
            .and_then(|transmission| transmission.lobe)
            .map_or(0.0, |lobe| strongest(&lobe.shape.transmittance));
        self.highlight.strength() + through
    }

    /// Whether the highlight is the retroreflecting lobe.
    pub fn is_retroreflector(&self) -> bool {
        matches!(self.highlight, Highlight::Retro(_))
    }

    /// Whether the highlight may be about the retroreflection direction. A plugin's model may have
    /// such a lobe.
    pub fn may_retroreflect(&self) -> bool {
        matches!(self.highlight, Highlight::Retro(_) | Highlight::Model(_))
    }

    /// Whether there is a diffuse component.
    pub fn has_diffuse(&self) -> bool {
        let any = |bands: &[f64; BANDS]| bands.iter().any(|band| *band > 0.0);
        any(&self.diffuse)
            || self.transmission.is_some_and(|transmission| any(&transmission.diffuse))
            || self.ambient().iter().any(any)
    }

    /// Whether the diffuse component scatters direct and indirect light alike. Radiance subtracts a
    /// coat's reflection from direct light only, adds scattering functions and highlights below the
    /// threshold to indirect light only, and has a cosine about a turned normal for direct light
    /// only ([`DiffuseLobe`]).
    pub fn diffuse_finds_lights(&self) -> bool {
        self.coat == FresnelCoat::None
            && (self.diffuse_normal == self.normal || self.is_retroreflector())
            && !self.below_threshold.has_any()
            && !matches!(&self.highlight, Highlight::Function(lobe) if lobe.has_ambient())
    }

    /// Albedo of the diffuse component for indirect light from the viewer's side.
    pub fn ambient_reflectance(&self) -> [f64; BANDS] {
        let [own, transmission] = self.ambient();
        let through = self.transmission.map_or([0.0; BANDS], |transmission| transmission.diffuse);
        sum(sum(self.diffuse, own), sum(through, transmission))
    }

    /// Diffuse albedo for indirect light from each side: unit surface normal, unit normal of the
    /// facet, albedo.
    pub fn ambient_sides(&self) -> [(DVec3, DVec3, [f64; BANDS]); 2] {
        let [own, transmission] = self.ambient();
        let (facet, through) = self
            .transmission
            .map_or((-self.diffuse_normal, [0.0; BANDS]), |transmission| (-transmission.normal, transmission.diffuse));
        [(self.normal, self.diffuse_normal, sum(self.diffuse, own)), (-self.normal, facet, sum(through, transmission))]
    }

    /// Diffuse albedo for indirect light, for both sides.
    fn ambient(&self) -> [[f64; BANDS]; 2] {
        match &self.highlight {
            Highlight::Function(lobe) => lobe.ambient,
            _ => self.below_threshold.as_diffuse(),
        }
    }

    /// Evaluates all components for light from `incident`, where light sampling has the density
    /// `light_pdf` (1/sr). The densities in the result are valid only if `pdfs` asks for them.
    #[inline]
    pub fn eval(&self, incident: DVec3, light_pdf: f64, pdfs: PdfRequest, scratch: &mut Scratch) -> BsdfValue<BANDS> {
        let mut bsdf_value = BsdfValue::NONE;
        let cosine = self.diffuse_normal.dot(incident);
        if cosine > 0.0 {
            let coat = self.coat_share(incident);
            bsdf_value.diffuse_pdf = cosine * FRAC_1_PI;
            bsdf_value.diffuse = self.diffuse.map(|band| band * cosine * FRAC_1_PI * coat);
        }
        match &self.highlight {
            Highlight::None => {}
            Highlight::Ward(ward) => {
                let local = self.frame.to_local(incident);
                let shape = ward.shape(self.frame.to_local(self.outgoing), local);
                bsdf_value.set_highlight(&ward.specularity, shape, local.z);
            }
            Highlight::WardAnisotropic(ward) => {
                let local = self.frame.to_local(incident);
                let shape = ward.shape(self.frame.to_local(self.outgoing), local);
                bsdf_value.set_highlight(&ward.specularity, shape, local.z);
            }
            Highlight::Ashikhmin(lobe) => {
                let local = self.frame.to_local(incident);
                let shape = lobe.shape(self.frame.to_local(self.outgoing), local);
                bsdf_value.set_highlight(&lobe.specularity, shape, local.z);
            }
            Highlight::Retro(retro) => {
                if self.normal.dot(incident) > 0.0 {
                    let angle = observation_angle(self.outgoing, incident);
                    let shape = retro.reflected_density(angle);
                    if pdfs == PdfRequest::Wanted {
                        bsdf_value.highlight_pdf = retro_pdf(retro, angle);
                    }
                    bsdf_value.highlight = retro.reflectance.map(|band| band * shape);
                }
            }
            Highlight::Measured(lobe) => (bsdf_value.highlight, bsdf_value.highlight_pdf) = lobe.eval(incident),
            Highlight::Function(lobe) => bsdf_value.highlight = lobe.eval(incident, light_pdf.recip(), scratch),
            Highlight::Model(model) => {
                let local = self.frame.to_local(incident);
                let mut pdf = [0.0];
                let values = &mut bsdf_value.highlight[..model_bands::<BANDS>()];
                model.eval_pdf(self.frame.to_local(self.outgoing), &[local], values, &mut pdf);
                bsdf_value.highlight_pdf = pdf[0];
                bsdf_value.highlight = of_model(&bsdf_value.highlight).map(|band| band * local.z.abs());
            }
        }
        if let Some(transmission) = &self.transmission {
            self.eval_transmission(transmission, incident, &mut bsdf_value);
        }
        if pdfs == PdfRequest::Wanted && !self.sides_agree(incident) {
            bsdf_value.diffuse_pdf = 0.0;
            bsdf_value.highlight_pdf = 0.0;
        }
        bsdf_value
    }

    /// Adds the transmission. Sampling chooses between the two sides.
    fn eval_transmission(
        &self,
        transmission: &Transmission<BANDS>,
        incident: DVec3,
        bsdf_value: &mut BsdfValue<BANDS>,
    ) {
        bsdf_value.diffuse_pdf *= 1.0 - transmission.diffuse_chance;
        bsdf_value.highlight_pdf *= 1.0 - transmission.lobe_chance;
        let cosine = -transmission.normal.dot(incident);
        if cosine > 0.0 {
            let coat = self.coat_share(incident);
            bsdf_value.diffuse_pdf += transmission.diffuse_chance * cosine * FRAC_1_PI;
            for (sum, band) in bsdf_value.diffuse.iter_mut().zip(transmission.diffuse) {
                *sum += band * cosine * FRAC_1_PI * coat;
            }
        }
        if let Some(lobe) = &transmission.lobe {
            let (shape, pdf) = lobe.eval(incident);
            bsdf_value.highlight_pdf += transmission.lobe_chance * pdf;
            for (sum, band) in bsdf_value.highlight.iter_mut().zip(lobe.shape.transmittance) {
                *sum += band * shape;
            }
        }
    }

    #[inline]
    fn coat_share(&self, incident: DVec3) -> f64 {
        if self.coat == FresnelCoat::None { 1.0 } else { self.coat.transmittance(self.frame.z.dot(incident)) }
    }

    /// Whether the direction is on the same side of the geometric normal as of the shading normal.
    /// Other directions are never sampled.
    pub fn sides_agree(&self, direction: DVec3) -> bool {
        matches!(self.highlight, Highlight::Retro(_))
            || (self.normal.dot(direction) > 0.0) == (self.frame.z.dot(direction) > 0.0)
    }

    /// Samples the highlight.
    pub fn sample_highlight(&self, u: [f64; 3]) -> Option<BsdfSample<BANDS>> {
        let Some(transmission) = &self.transmission else { return self.sample_reflected(u) };
        let chance = transmission.lobe_chance;
        if u[2] >= chance {
            let sample = self.sample_reflected([u[0], u[1], (u[2] - chance) / (1.0 - chance)])?;
            return Some(sample.split(1.0 - chance));
        }
        let lobe = transmission.lobe.as_ref()?;
        let direction = lobe.sample([u[0], u[1]]);
        let (shape, pdf) = lobe.eval(direction);
        if shape <= 0.0 || !self.sides_agree(direction) {
            return None;
        }
        let weight = lobe.shape.transmittance.map(|band| band * shape / (pdf * chance));
        Some(BsdfSample { direction, weight, pdf: Density::Continuous(pdf * chance), pdf_ratio: 1.0 })
    }

    fn sample_reflected(&self, u: [f64; 3]) -> Option<BsdfSample<BANDS>> {
        if let Highlight::Measured(lobe) = &self.highlight {
            return lobe.sample(u).filter(|sample| self.sides_agree(sample.direction));
        }
        // The retroreflecting lobe is about the geometric normal; its texture turns only the
        // diffuse normal.
        let frame = if matches!(self.highlight, Highlight::Retro(_)) { Frame::new(self.normal) } else { self.frame };
        let outgoing = frame.to_local(self.outgoing);
        let mut weight = [0.0; BANDS];
        let sample = match &self.highlight {
            Highlight::None | Highlight::Function(_) | Highlight::Measured(_) => None,
            Highlight::Ward(ward) => ward.sample(outgoing, u, &mut weight),
            Highlight::WardAnisotropic(ward) => ward.sample(outgoing, u, &mut weight),
            Highlight::Ashikhmin(lobe) => lobe.sample(outgoing, u, &mut weight),
            Highlight::Retro(retro) => sample_retro(retro, outgoing, u, &mut weight),
            Highlight::Model(model) => {
                let sample = model.sample(outgoing, u, &mut weight[..model_bands::<BANDS>()]);
                weight = of_model(&weight);
                sample
            }
        }?;
        let direction = frame.to_scene(sample.incident);
        self.sides_agree(direction).then_some(BsdfSample { direction, weight, pdf: sample.density, pdf_ratio: 1.0 })
    }

    /// Samples the diffuse component. The sample has no density if the component scatters direct
    /// and indirect light differently.
    pub fn sample_diffuse(&self, u: f64, v: f64) -> Option<BsdfSample<BANDS>> {
        let Some(transmission) = &self.transmission else {
            return self.diffuse_sample(&self.diffuse_lobe(), &self.reflectance_of_surroundings(), [u, v]);
        };
        let chance = transmission.diffuse_chance;
        if u >= chance {
            let u = (u - chance) / (1.0 - chance);
            let sample = self.diffuse_sample(&self.diffuse_lobe(), &self.reflectance_of_surroundings(), [u, v])?;
            return Some(sample.split(1.0 - chance));
        }
        let lobe = self.lobe_about(-self.normal, -transmission.normal);
        let reflectance = sum(transmission.diffuse, self.ambient()[1]);
        Some(self.diffuse_sample(&lobe, &reflectance, [u / chance, v])?.split(chance))
    }

    /// The kernel of indirect light on the viewer's side.
    pub fn diffuse_lobe(&self) -> DiffuseLobe {
        self.lobe_about(self.normal, self.diffuse_normal)
    }

    fn lobe_about(&self, surface: DVec3, facet: DVec3) -> DiffuseLobe {
        match self.is_retroreflector() {
            true => DiffuseLobe::above(surface, facet),
            false if self.indirect_ignores_texture => DiffuseLobe::of_facet(surface, surface),
            false => DiffuseLobe::of_facet(surface, facet),
        }
    }

    /// Diffuse albedo for indirect light from the viewer's side.
    pub fn reflectance_of_surroundings(&self) -> [f64; BANDS] {
        sum(self.diffuse, self.ambient()[0])
    }

    fn diffuse_sample(
        &self,
        lobe: &DiffuseLobe,
        reflectance: &[f64; BANDS],
        [u, v]: [f64; 2],
    ) -> Option<BsdfSample<BANDS>> {
        let sample = lobe.sample(u, v)?;
        let pdf = if self.diffuse_finds_lights() { sample.pdf } else { 0.0 };
        Some(BsdfSample {
            direction: sample.direction,
            weight: reflectance.map(|band| band * sample.weight),
            pdf: Density::Continuous(pdf),
            pdf_ratio: 1.0,
        })
    }

    /// The mirror direction. A texture that would turn it below the surface is ignored.
    pub fn mirror_direction(&self) -> DVec3 {
        let reflect = |normal: DVec3| normal * (2.0 * normal.dot(self.outgoing)) - self.outgoing;
        let direction = reflect(self.frame.z);
        if direction.dot(self.normal) > 0.0 { direction } else { reflect(self.normal) }
    }
}

/// Fraction of a highlight that light selection assumes outside its peak.
const BESIDE_PEAK: f64 = 0.05;

/// Caustic rays are sampled half from the lobe and half from a lobe this many times as wide. A
/// camera's lights stand in the lobe's tail, which the lobe itself would sample once in fifty rays.
const TAIL: f64 = 2.2;

fn tail<const BANDS: usize>(retro: &Paper1991<BANDS>) -> Paper1991<BANDS> {
    Paper1991 { spread: TAIL * retro.spread, ..*retro }
}

/// Density of [`sample_retro`] at an observation angle, 1/sr.
fn retro_pdf<const BANDS: usize>(retro: &Paper1991<BANDS>, angle: f64) -> f64 {
    0.5 * (retro.sampling_density(angle) + tail(retro).sampling_density(angle))
}

fn sample_retro<const BANDS: usize>(
    retro: &Paper1991<BANDS>,
    outgoing: DVec3,
    u: [f64; 3],
    weight: &mut [f64; BANDS],
) -> Option<BrdfSample> {
    let lobe = if u[2] < 0.5 { *retro } else { tail(retro) };
    let sample = lobe.sample(outgoing, u, weight)?;
    let angle = observation_angle(outgoing, sample.incident);
    let pdf = retro_pdf(retro, angle);
    let value = retro.reflected_density(angle) / pdf;
    *weight = retro.reflectance.map(|band| band * value);
    Some(BrdfSample { density: Density::Continuous(pdf), ..sample })
}

/// Reflectance and transmittance of a thin pane, with all internal reflections, averaged over both
/// polarisations (Radiance's `glass`).
pub fn pane<const BANDS: usize>(transmissivity: [f64; BANDS], index: f64, cosine: f64) -> [[f64; BANDS]; 2] {
    let inside = ((1.0 - 1.0 / (index * index)) + cosine * cosine / (index * index)).sqrt();
    let perpendicular = ((cosine - index * inside) / (cosine + index * inside)).powi(2);
    let parallel = ((1.0 / cosine - index / inside) / (1.0 / cosine + index / inside)).powi(2);
    let mut reflected = [0.0; BANDS];
    let mut transmitted = [0.0; BANDS];
    for band in 0..BANDS {
        let passage = transmissivity[band].max(1e-15).powf(1.0 / inside);
        for r in [perpendicular, parallel] {
            let twice = passage * passage;
            let echo = 1.0 - r * r * twice;
            transmitted[band] += 0.5 * (1.0 - r) * (1.0 - r) * passage / echo;
            reflected[band] += 0.5 * r * (1.0 + (1.0 - 2.0 * r) * twice) / echo;
        }
    }
    [reflected, transmitted]
}

/// Direction behind a thin pane: straight on, or refracted by a texture as Radiance's `glass` does.
#[must_use]
pub fn through_pane(direction: DVec3, perturbation: DVec3, refractive_index: f64) -> DVec3 {
    if perturbation == DVec3::ZERO {
        return direction;
    }
    (direction + perturbation * (2.0 * (1.0 - refractive_index))).normalize_or(direction)
}

/// Colour of a material with a colour of its own, times the pattern.
pub fn colored<const BANDS: usize>(kind: &GlossyKind, pattern: [f64; BANDS]) -> [f64; BANDS] {
    let own: [f64; BANDS] = bands(kind.color);
    std::array::from_fn(|band| own[band] * pattern[band])
}

/// Number of bands for which a plugin's model is made: at most three, red, green and blue.
pub const fn model_bands<const BANDS: usize>() -> usize {
    if BANDS > 3 { 3 } else { BANDS }
}

/// A model's values, in the bands of a path.
pub fn of_model<const BANDS: usize>(values: &[f64]) -> [f64; BANDS] {
    if BANDS > 3 { spread([values[0], values[1], values[2]]) } else { std::array::from_fn(|band| values[band]) }
}
