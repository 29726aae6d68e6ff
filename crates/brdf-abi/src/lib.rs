//! The C interface of BRDF plugins.
