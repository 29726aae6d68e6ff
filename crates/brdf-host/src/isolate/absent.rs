//! Isolation on systems that do not support it.

use super::wire::Description;
use super::{Isolation, Question};
use crate::functions::RawSample;
use crate::guard::Breadcrumb;
use crate::library::{Message, User};
use crate::table::Arguments;
use crate::{Error, Label};
use glam::DVec3;
use radsight_brdf_abi::{Band, Status};
use std::path::Path;

/// A worker that cannot exist.
pub(crate) enum Worker {}

impl Worker {
    pub(crate) fn start(
        _: &Isolation,
        _: &Path,
        library: &str,
        _: Option<User<'_>>,
        _: Breadcrumb,
    ) -> Result<(Worker, Description), Error> {
        let reason = "plugins can be isolated on Linux only".to_owned();
        Err(Error::CannotIsolate { library: library.to_owned(), reason })
    }

    pub(crate) fn create(
        &self,
        _: u32,
        _: &Arguments,
        _: &[Band],
        _: &Label,
        _: Breadcrumb,
    ) -> Result<(u32, u32), Error> {
        match *self {}
    }

    pub(crate) fn destroy(&self, _: u32, _: Breadcrumb) {
        match *self {}
    }

    pub(crate) fn self_check(&self, _: u32, _: Breadcrumb) -> Vec<String> {
        match *self {}
    }

    pub(crate) fn manual(&self) -> Option<String> {
        match *self {}
    }

    pub(crate) fn take_messages(&self) -> Vec<Message> {
        match *self {}
    }

    pub(crate) fn eval(&self, _: u32, _: Breadcrumb, _: Question<'_>, _: &mut [f64], _: &mut [f64]) -> Status {
        match *self {}
    }

    pub(crate) fn sample(&self, _: u32, _: Breadcrumb, _: DVec3, _: [f64; 3], _: &mut [f64]) -> (Status, RawSample) {
        match *self {}
    }
}

/// Entry point of a worker process.
///
/// # Errors
/// Always.
pub fn child_main() -> std::io::Result<()> {
    Err(std::io::Error::other("plugins can be isolated on Linux only"))
}
