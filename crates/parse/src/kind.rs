//! The primitive types of Radiance.

use std::fmt;

/// What a primitive type is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A shape that a ray can hit.
    Surface,
    /// A transformed mesh or octree.
    Volume,
    /// How light leaves a surface.
    Material,
    /// Perturbs the normal.
    Texture,
    /// Multiplies the colour.
    Pattern,
    /// Chooses between two modifiers.
    Mixture,
    /// Another name for a modifier.
    Alias,
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $variant:ident $name:literal $role:ident $placed:literal;)*) => {
        /// A primitive type, by its keyword in scene text.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Kind {
            $($(#[$doc])* $variant,)*
        }

        /// The names, in the order of [`Kind::ALL`].
        const NAMES: [&str; Kind::ALL.len()] = [$($name,)*];

        impl Kind {
            /// All types.
            pub const ALL: &'static [Kind] = &[$(Kind::$variant,)*];

            /// The keyword of the type.
            #[must_use]
            pub fn name(self) -> &'static str {
                NAMES[self as usize]
            }

            /// The type with this keyword.
            #[must_use]
            pub fn from_word(word: &[u8]) -> Option<Kind> {
                KINDS_BY_NAME.binary_search_by(|(name, _)| (*name).as_bytes().cmp(word)).ok().map(|at| KINDS_BY_NAME[at].1)
            }

            /// What the type is used for.
            #[must_use]
            pub fn role(self) -> Role {
                match self {
                    $(Kind::$variant => Role::$role,)*
                }
            }

            /// Whether a transform is written as string arguments at the end (functions, data,
            /// instances) instead of being applied to the real arguments.
            #[must_use]
            pub fn takes_transform_words(self) -> bool {
                match self {
                    $(Kind::$variant => $placed,)*
                }
            }
        }
    };
}

kinds! {
    /// `polygon`
    Polygon "polygon" Surface false;
    /// `sphere`
    Sphere "sphere" Surface false;
    /// `bubble`: a sphere seen from inside.
    Bubble "bubble" Surface false;
    /// `cone`
    Cone "cone" Surface false;
    /// `cup`: a cone seen from inside.
    Cup "cup" Surface false;
    /// `cylinder`
    Cylinder "cylinder" Surface false;
    /// `tube`: a cylinder seen from inside.
    Tube "tube" Surface false;
    /// `ring`
    Ring "ring" Surface false;
    /// `source`: infinitely far away.
    Source "source" Surface false;
    /// `mesh`
    Mesh "mesh" Volume true;
    /// `instance`
    Instance "instance" Volume true;
    /// `alias`
    Alias "alias" Alias false;
    /// `light`
    Light "light" Material false;
    /// `illum`
    Illum "illum" Material false;
    /// `glow`
    Glow "glow" Material false;
    /// `spotlight`
    Spotlight "spotlight" Material false;
    /// `mirror`
    Mirror "mirror" Material false;
    /// `prism1`
    Prism1 "prism1" Material true;
    /// `prism2`
    Prism2 "prism2" Material true;
    /// `mist`
    Mist "mist" Material false;
    /// `plastic`
    Plastic "plastic" Material false;
    /// `metal`
    Metal "metal" Material false;
    /// `trans`
    Trans "trans" Material false;
    /// `plastic2`
    Plastic2 "plastic2" Material true;
    /// `metal2`
    Metal2 "metal2" Material true;
    /// `trans2`
    Trans2 "trans2" Material true;
    /// `ashik2`
    Ashik2 "ashik2" Material true;
    /// `WGMDfunc`
    WgmdFunc "WGMDfunc" Material true;
    /// `dielectric`
    Dielectric "dielectric" Material false;
    /// `interface`
    Interface "interface" Material false;
    /// `glass`
    Glass "glass" Material false;
    /// `plasfunc`
    PlasFunc "plasfunc" Material true;
    /// `metfunc`
    MetFunc "metfunc" Material true;
    /// `transfunc`
    TransFunc "transfunc" Material true;
    /// `BRTDfunc`
    BrtdFunc "BRTDfunc" Material true;
    /// `plasdata`
    PlasData "plasdata" Material true;
    /// `metdata`
    MetData "metdata" Material true;
    /// `transdata`
    TransData "transdata" Material true;
    /// `BSDF`
    Bsdf "BSDF" Material true;
    /// `aBSDF`
    ApertureBsdf "aBSDF" Material true;
    /// `antimatter`
    Antimatter "antimatter" Material false;
    /// `brdfplugin`: a reflectance model from a shared library. A type of radsight's own, not of
    /// Radiance.
    BrdfPlugin "brdfplugin" Material false;
    /// `texfunc`
    TexFunc "texfunc" Texture true;
    /// `texdata`
    TexData "texdata" Texture true;
    /// `brightfunc`
    BrightFunc "brightfunc" Pattern true;
    /// `brightdata`
    BrightData "brightdata" Pattern true;
    /// `brighttext`
    BrightText "brighttext" Pattern false;
    /// `colorfunc`
    ColorFunc "colorfunc" Pattern true;
    /// `colordata`
    ColorData "colordata" Pattern true;
    /// `colorpict`
    ColorPict "colorpict" Pattern true;
    /// `colortext`
    ColorText "colortext" Pattern false;
    /// `spectrum`
    Spectrum "spectrum" Pattern false;
    /// `specfile`
    SpecFile "specfile" Pattern false;
    /// `specfunc`
    SpecFunc "specfunc" Pattern true;
    /// `specdata`
    SpecData "specdata" Pattern true;
    /// `specpict`
    SpecPict "specpict" Pattern true;
    /// `mixfunc`
    MixFunc "mixfunc" Mixture true;
    /// `mixdata`
    MixData "mixdata" Mixture true;
    /// `mixpict`
    MixPict "mixpict" Mixture true;
    /// `mixtext`
    MixText "mixtext" Mixture false;
}

impl Kind {
    /// Whether primitives of this type modify others.
    #[must_use]
    pub fn is_modifier(self) -> bool {
        !matches!(self.role(), Role::Surface | Role::Volume)
    }

    /// The type that `xform -I` writes instead.
    #[must_use]
    pub fn inside_out(self) -> Kind {
        match self {
            Kind::Sphere => Kind::Bubble,
            Kind::Bubble => Kind::Sphere,
            Kind::Cone => Kind::Cup,
            Kind::Cup => Kind::Cone,
            Kind::Cylinder => Kind::Tube,
            Kind::Tube => Kind::Cylinder,
            other => other,
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// All types, sorted by name.
static KINDS_BY_NAME: [(&str, Kind); Kind::ALL.len()] = sorted();

const fn sorted() -> [(&'static str, Kind); Kind::ALL.len()] {
    let mut table = [("", Kind::Polygon); Kind::ALL.len()];
    let mut filled = 0;
    while filled < table.len() {
        let kind = Kind::ALL[filled];
        let name = NAMES[filled];
        let mut at = filled;
        while at > 0 && is_before(name.as_bytes(), table[at - 1].0.as_bytes()) {
            table[at] = table[at - 1];
            at -= 1;
        }
        table[at] = (name, kind);
        filled += 1;
    }
    table
}

const fn is_before(left: &[u8], right: &[u8]) -> bool {
    let mut at = 0;
    while at < left.len() && at < right.len() {
        if left[at] != right[at] {
            return left[at] < right[at];
        }
        at += 1;
    }
    left.len() < right.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_found() {
        for &kind in Kind::ALL {
            assert_eq!(Kind::from_word(kind.name().as_bytes()), Some(kind));
        }
        assert_eq!(Kind::from_word(b"plastik"), None);
        assert_eq!(Kind::from_word(b"BSDF "), None);
    }

    #[test]
    fn inside_out_twice_is_the_same() {
        for &kind in Kind::ALL {
            assert_eq!(kind.inside_out().inside_out(), kind);
        }
    }
}
