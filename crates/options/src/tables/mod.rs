//! The tables: one file per kind of program.

mod calculators;
mod converters;
mod generators;
mod matrices;
mod pictures;
mod rendering;
mod scenes;
mod skies;
mod tracing;

use crate::program::Program;

/// All programs, sorted by name.
pub(crate) static PROGRAMS: &[&Program] = &[
    &calculators::CNT,
    &matrices::DCTIMESTEP,
    &skies::EPW2WEA,
    &calculators::EV,
    &pictures::FALSECOLOR,
    &generators::GENBEADS,
    &generators::GENBLINDS,
    &generators::GENBOX,
    &generators::GENCLOCK,
    &skies::GENDAYLIT,
    &skies::GENDAYMTX,
    &generators::GENPRISM,
    &generators::GENREV,
    &skies::GENSKY,
    &skies::GENSKYVEC,
    &generators::GENSURF,
    &generators::GENWORM,
    &scenes::GETBBOX,
    &pictures::GETINFO,
    &calculators::HISTO,
    &scenes::IES2RAD,
    &scenes::MGF2RAD,
    &tracing::MKILLUM,
    &scenes::MKSOURCE,
    &scenes::OBJ2MESH,
    &scenes::OBJ2RAD,
    &scenes::OCONV,
    &pictures::PCOMB,
    &pictures::PCOMPOS,
    &pictures::PCOND,
    &pictures::PEXTREM,
    &pictures::PFILT,
    &pictures::PFLIP,
    &pictures::PINTERP,
    &scenes::PKGBSDF,
    &pictures::PROTATE,
    &pictures::PSIGN,
    &pictures::PVALUE,
    &converters::RA_BMP,
    &converters::RA_PNG,
    &converters::RA_PPM,
    &converters::RA_RGBE,
    &converters::RA_TIFF,
    &converters::RA_XYZE,
    &scenes::RAD,
    &calculators::RCALC,
    &calculators::RCOLLATE,
    &matrices::RCOMB,
    &tracing::RCONTRIB,
    &scenes::REPLMARKS,
    &tracing::RFLUXMTX,
    &calculators::RLAM,
    &matrices::RMTXOP,
    &tracing::RPICT,
    &calculators::RSPLIT,
    &tracing::RTRACE,
    &calculators::TABFUNC,
    &calculators::TOTAL,
    &tracing::VWRAYS,
    &scenes::XFORM,
];
