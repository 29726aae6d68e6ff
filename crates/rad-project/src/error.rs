//! Errors of `.rif` files.

/// Why no pictures can be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ProjectError {
    /// An unknown variable.
    #[error("{place}: unknown variable \"{name}\"")]
    UnknownVariable {
        /// File and line, or the command line.
        place: String,
        /// The name as typed.
        name: String,
    },
    /// An invalid value of a variable.
    #[error("variable {variable} is \"{value}\", expected {expected}")]
    Value {
        /// Full name of the variable.
        variable: &'static str,
        /// The value as typed.
        value: String,
        /// The valid values.
        expected: &'static str,
    },
    /// No variable names the scene.
    #[error("no scene is named, expected a variable OCTREE, scene or illum")]
    NoScene,
    /// A file named by a variable does not exist.
    #[error("file \"{0}\" does not exist")]
    NoFile(String),
    /// The scene has no bounding cube from which a quality could be derived.
    #[error("the size of the scene is unknown, expected a scene with local surfaces or a variable ZONE")]
    NoCube,
}
