//! Real Radiance, for test files that stand in this folder by themselves.

pub(crate) use radsight_test_support::Radiance;
