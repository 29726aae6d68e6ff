//! Views: the projection of a picture, and the ray of each point of the image plane.
//!
//! [`ViewOptions`] is a view as typed; a [`View`] was checked and generates rays. Options mean the
//! same as in Radiance (`rpict -vt… -vp … -vd …`).

mod geometry;
mod options;
mod text;

pub use geometry::{View, ViewLocation, ViewRay};
pub use options::{ViewKind, ViewOptions};

/// Why a view is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// No such view type.
    #[error("unknown view type \"{0}\", expected one of v l c h a s")]
    UnknownKind(char),
    /// A number is not finite.
    #[error("{option} is {value}, expected finite numbers")]
    NotFinite {
        /// The option, such as `-vp`.
        option: &'static str,
        /// The value.
        value: String,
    },
    /// The direction is the zero vector.
    #[error("the view direction (-vd) is zero")]
    ZeroDirection,
    /// The up vector is the zero vector.
    #[error("the view up vector (-vu) is zero")]
    ZeroUp,
    /// Up and direction are parallel.
    #[error("the view up vector (-vu) is parallel to the view direction (-vd)")]
    UpParallel,
    /// The size does not fit the view type.
    #[error("{option} is {value}, expected {expected}")]
    Size {
        /// `-vh` or `-vv`.
        option: &'static str,
        /// The value.
        value: String,
        /// The range that the view type allows.
        expected: &'static str,
    },
    /// The clipping planes are behind the eye or in the wrong order.
    #[error("clipping planes -vo {fore} -va {aft}, expected 0 <= fore, and aft = 0 or aft > fore")]
    Clipping {
        /// The value.
        fore: String,
        /// The value.
        aft: String,
    },
    /// A crop without area, or one that leaves the hemisphere.
    #[error("the crop is empty or leaves the hemisphere")]
    Crop,
    /// A line holds a zero byte, at which Radiance stops reading it.
    #[error("a zero byte is in the line of the view, expected text")]
    ZeroByte,
    /// The file has no line with a view.
    #[error("there is no view in the file, expected a line such as VIEW= -vtv -vp 0 0 0 -vd 0 1 0")]
    Missing,
}
