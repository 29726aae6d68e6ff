//! Loads BRDF plugins and checks them.
