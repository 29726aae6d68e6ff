"""Radiance's programs as functions on bytes, with the signatures of `pyradiance`: change the import and keep the code.

>>> from radsight import radiance
>>> scene = b"void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2"
>>> radiance.getbbox(scene)
[-2.0, 2.0, 7.0, 11.0, -2.0, 2.0]

A program that fails raises `RuntimeError` with its messages, as there. `run` runs any program of ``radsight``, those without a function as
well.
"""

from ._command import run
from ._matrices import (
    Rcomb,
    Rmtxop,
    dctimestep,
    rcollate,
    rfluxmtx,
    rmtxop,
)
from ._pictures import (
    Pcomb,
    falsecolor,
    get_image_dimensions,
    pcompos,
    pcond,
    pextrem,
    pfilt,
    pvalue,
    ra_ppm,
    ra_rgbe,
    ra_tiff,
    ra_xyze,
)
from ._rays import (
    Rcontrib,
    getbbox,
    mkillum,
    oconv,
    rpict,
    rtrace,
    vwrays,
)
from ._records import (
    cnt,
    get_header,
    getinfo,
    rcalc,
    rlam,
    total,
)
from ._scenes import (
    Xform,
    genblinds,
    genbox,
    gendaylit,
    gendaymtx,
    genprism,
    genrev,
    gensky,
    gensurf,
    ies2rad,
    mgf2rad,
    obj2mesh,
    obj2rad,
    pkgbsdf,
)

__all__ = [
    "Pcomb",
    "Rcomb",
    "Rcontrib",
    "Rmtxop",
    "Xform",
    "cnt",
    "dctimestep",
    "falsecolor",
    "genblinds",
    "genbox",
    "gendaylit",
    "gendaymtx",
    "genprism",
    "genrev",
    "gensky",
    "gensurf",
    "get_header",
    "get_image_dimensions",
    "getbbox",
    "getinfo",
    "ies2rad",
    "mgf2rad",
    "mkillum",
    "obj2mesh",
    "obj2rad",
    "oconv",
    "pcompos",
    "pcond",
    "pextrem",
    "pfilt",
    "pkgbsdf",
    "pvalue",
    "ra_ppm",
    "ra_rgbe",
    "ra_tiff",
    "ra_xyze",
    "rcalc",
    "rcollate",
    "rfluxmtx",
    "rlam",
    "rmtxop",
    "rpict",
    "rtrace",
    "run",
    "total",
    "vwrays",
]
