//! The function files of real Radiance, ours against theirs.
