"""Radiance's programs as functions on bytes, with the signatures of `pyradiance`.

Change the import and keep the code: ``from radsight import radiance as pr`` in the place of ``import pyradiance as pr``.

>>> from radsight import radiance
>>> scene = b"void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2"
>>> radiance.getbbox(scene)
[-2.0, 2.0, 7.0, 11.0, -2.0, 2.0]

A program that fails raises `RuntimeError` with its messages, as there. `run` runs any program of ``radsight``, those
without a function as well. ``docs/python.md`` lists what of `pyradiance` is left out, and why.
"""

from ._command import run
from ._files import write
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
    pvaluer,
    ra_ppm,
    ra_rgbe,
    ra_tiff,
    ra_xyze,
)
from ._primitives import Primitive, Scene, parse_primitive, render
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
from ._views import (
    RayParams,
    View,
    create_default_view,
    get_default_ray_params,
    get_ray_params_args,
    get_view_args,
    parse_view,
    viewfile,
)

__all__ = [
    "Pcomb",
    "Primitive",
    "RayParams",
    "Rcomb",
    "Rcontrib",
    "Rmtxop",
    "Scene",
    "View",
    "Xform",
    "cnt",
    "create_default_view",
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
    "get_default_ray_params",
    "get_header",
    "get_image_dimensions",
    "get_ray_params_args",
    "get_view_args",
    "getbbox",
    "getinfo",
    "ies2rad",
    "mgf2rad",
    "mkillum",
    "obj2mesh",
    "obj2rad",
    "oconv",
    "parse_primitive",
    "parse_view",
    "pcompos",
    "pcond",
    "pextrem",
    "pfilt",
    "pkgbsdf",
    "pvalue",
    "pvaluer",
    "ra_ppm",
    "ra_rgbe",
    "ra_tiff",
    "ra_xyze",
    "rcalc",
    "rcollate",
    "render",
    "rfluxmtx",
    "rlam",
    "rmtxop",
    "rpict",
    "rtrace",
    "run",
    "total",
    "viewfile",
    "vwrays",
    "write",
]
