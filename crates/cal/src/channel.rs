//! The channels of a ray, by which functions read its variables.
//!
//! Channels 1 to 27 are Radiance's. The higher ones are radsight's, for variables that Radiance's
//! materials set by name; a host that does not provide them checks
//! [`Program::channels_used`](crate::Program::channels_used).
//!
//! All vectors are in the modifier's frame; lengths are in its units. D, N, I, J and K are unit
//! vectors.

/// `Dx`: ray direction; `Dy` and `Dz` follow.
pub const DX: u32 = 1;
/// `Nx`: surface normal; `Ny` and `Nz` follow.
pub const NX: u32 = 4;
/// `Px`: intersection point; `Py` and `Pz` follow.
pub const PX: u32 = 7;
/// `T`: distance from the start of the path.
pub const T: u32 = 10;
/// `Rdot`: cosine between the reversed ray and the normal, −1…1.
pub const RDOT: u32 = 11;
/// `S`: scale of the world in the modifier's frame.
pub const S: u32 = 12;
/// `Tx`: origin of the world; `Ty` and `Tz` follow.
pub const TX: u32 = 13;
/// `Ix`: first axis of the world; `Iy` and `Iz` follow.
pub const IX: u32 = 16;
/// `Jx`: second axis of the world; `Jy` and `Jz` follow.
pub const JX: u32 = 19;
/// `Kx`: third axis of the world; `Ky` and `Kz` follow.
pub const KX: u32 = 22;
/// `Ts`: length of the ray, for shadow rays from the surface.
pub const TS: u32 = 25;
/// `Lu`: first local coordinate of a mesh; `Lv` follows.
pub const LU: u32 = 26;
/// `NxP`: perturbed normal, in function materials; `NyP` and `NzP` follow.
pub const NXP: u32 = 28;
/// `RdotP`: perturbed cosine, in function materials.
pub const RDOTP: u32 = 31;
/// `CrP`: perturbed material colour, in function materials; `CgP` and `CbP` follow.
pub const CRP: u32 = 32;
/// `DxA`: direction to the light source, in prisms; `DyA` and `DzA` follow.
pub const DXA: u32 = 35;
/// Highest channel of a ray.
pub const HIGHEST: u32 = 37;
