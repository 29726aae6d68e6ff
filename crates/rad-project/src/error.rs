//! What can be wrong with a `.rif` file.

/// Why no pictures can be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RifError {
    /// A name that is no variable.
    #[error("{place}: unknown variable \"{name}\"")]
    UnknownVariable {
        /// File and line, or the command line.
        place: String,
        /// As typed.
        name: String,
    },
    /// A value that its variable cannot have.
    #[error("variable {variable} is \"{value}\", expected {expected}")]
    Value {
        /// Its full name.
        variable: &'static str,
        /// As typed.
        value: String,
        /// What it can be.
        expected: &'static str,
    },
    /// Nothing says of what to make pictures.
    #[error("there is no octree, expected a variable OCTREE, scene or illum")]
    NoScene,
    /// A file that the variables name.
    #[error("file \"{0}\" does not exist")]
    NoFile(String),
    /// The scene has no size that a quality could be told from.
    #[error("the size of the scene cannot be told")]
    NoCube,
}
