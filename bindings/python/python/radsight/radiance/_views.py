"""Views, and options of rays."""

from __future__ import annotations

import re
from dataclasses import Field, dataclass, field, fields
from pathlib import Path
from typing import Any

from .._radsight import View as _CheckedView

_Vector = tuple[float, float, float]


@dataclass
class View:
    """A view.

    Parameters
    ----------
    type : str
        ``v`` perspective, ``l`` parallel, ``c`` cylindrical panorama; fisheyes: ``h`` hemispherical, ``a`` angular,
        ``s`` planispherical.
    vp, vdir, vu : (float, float, float)
        Position (scene units), direction and up direction.
    horiz, vert : float
        Size: degrees, or scene units of a parallel view.
    vfore, vaft : float
        Distances of the clipping planes, scene units; 0 for none.
    hoff, voff : float
        Shift and lift, as shares of the size.
    """

    type: str = "v"
    vp: _Vector = (0.0, 0.0, 0.0)
    vdir: _Vector = (0.0, 1.0, 0.0)
    vu: _Vector = (0.0, 0.0, 1.0)
    horiz: float = 45.0
    vert: float = 45.0
    vfore: float = 0.0
    vaft: float = 0.0
    hoff: float = 0.0
    voff: float = 0.0


#: Options and the attributes that they set, in the order in which they are written.
_VIEW_OPTIONS = {
    "-vp": "vp",
    "-vd": "vdir",
    "-vu": "vu",
    "-vh": "horiz",
    "-vv": "vert",
    "-vs": "hoff",
    "-vl": "voff",
    "-vo": "vfore",
    "-va": "vaft",
}


def create_default_view() -> View:
    """Make the view that Radiance's programs have without options.

    Returns
    -------
    View
        Perspective, from the origin along +y, 45° wide and high.
    """
    return View()


def parse_view(arg: str) -> View:
    """Read options of a view.

    Parameters
    ----------
    arg : str
        Such as ``-vp 0 0 1.7 -vd 0 1 0 -vh 60``.

    Returns
    -------
    View
        What is not said is as in `create_default_view`.

    Raises
    ------
    RadsightError
        If an option is wrong.

    Examples
    --------
    >>> parse_view("-vta -vp 1 2 3 -vh 170").vp
    (1.0, 2.0, 3.0)
    """
    _CheckedView(arg)
    view = View()
    _read_options(view, arg)
    return view


def viewfile(arg: str) -> View:
    """Read a view file, or the view in a picture's header.

    Parameters
    ----------
    arg : str
        File of the view.

    Returns
    -------
    View
        What its lines of views say, the last one last.

    Raises
    ------
    ValueError
        If no line is a view.
    """
    header = Path(arg).read_bytes().split(b"\n\n", 1)[0].decode(errors="replace")
    lines = [line for line in header.splitlines() if re.match(r"\s*(VIEW=|rvu\b|rview\b|rpict\b|-v)", line)]
    if not lines:
        raise ValueError(f"{arg} has no view")
    view = View()
    for line in lines:
        _read_options(view, line)
    return view


def get_view_args(arg: View) -> list[str]:
    """Tell the options of a view.

    Parameters
    ----------
    arg : View
        The view.

    Returns
    -------
    list of str
        Words for ``rpict`` and `vwrays`.

    Examples
    --------
    >>> get_view_args(create_default_view())[:4]
    ['-vtv', '-vp', '0.000000', '0.000000']
    """
    words = [f"-vt{arg.type}"]
    for option, name in _VIEW_OPTIONS.items():
        words += [option, *_decimals(getattr(arg, name))]
    return words


def _read_options(view: View, text: str) -> None:
    """Sets what the options say."""
    words = iter(re.sub(r"^\s*VIEW=", "", text).split())
    for word in words:
        if word.startswith("-vt") and len(word) == 4:
            view.type = word[3]
        elif word in _VIEW_OPTIONS:
            name = _VIEW_OPTIONS[word]
            is_vector = isinstance(getattr(view, name), tuple)
            setattr(view, name, tuple(float(next(words)) for _ in range(3)) if is_vector else float(next(words)))


@dataclass
class RayParams:
    """Options of rays, by the names that they have in Radiance's programs; ``as_`` is ``-as``.

    Parameters
    ----------
    u, bv : bool
        Independent samples, and visibility of backs.
    dt, dc, dj : float
        Threshold, certainty and jitter of light sources.
    dr, dp : int
        Depth and pretest density of virtual sources.
    dv : bool
        Visibility of light sources.
    ds : float
        Subdivision of light sources.
    st, ss : float
        Threshold and jitter of specular reflection.
    lr : int
        Number of reflections at most.
    lw : float
        Weight of a ray at least.
    i : bool
        Irradiance instead of radiance.
    av : (float, float, float)
        Ambient value, W/(sr·m²).
    aw : int
        Weight of the ambient value.
    aa : float
        Error of cached irradiance.
    ar, ad, as_, ab : int
        Resolution, divisions, super-samples and bounces of interreflection.
    ambincl : bool
        Whether ``amblist`` names the only materials with interreflection (``-ai``), or those without (``-ae``).
    amblist : list of str
        These materials.
    af : str
        File of cached irradiance.
    me, ma : (float, float, float)
        Extinction and albedo of mist.
    mg, ms : float
        Eccentricity and sampling distance of mist.
    """

    u: bool = True
    bv: bool = True
    dt: float = 0.03
    dc: float = 0.75
    dj: float = 0.0
    dr: int = 2
    dp: int = 512
    dv: bool = True
    ds: float = 0.2
    st: float = 0.15
    ss: float = 1.0
    lr: int = -10
    lw: float = 1e-4
    i: bool = False
    av: _Vector = (0.0, 0.0, 0.0)
    aw: int = 0
    aa: float = 0.1
    ar: int = 256
    ad: int = 1024
    as_: int = 512
    ab: int = 0
    ambincl: bool = False
    amblist: list[str] = field(default_factory=list)
    af: str = ""
    me: _Vector = (0.0, 0.0, 0.0)
    ma: _Vector = (0.0, 0.0, 0.0)
    mg: float = 0.0
    ms: float = 0.0


def get_default_ray_params() -> RayParams:
    """Make the options of rays that pyradiance has by default.

    Returns
    -------
    RayParams
        To be changed.
    """
    return RayParams()


def get_ray_params_args(arg: RayParams) -> list[str]:
    """Tell the options of rays.

    Parameters
    ----------
    arg : RayParams
        The options.

    Returns
    -------
    list of str
        Words for ``rtrace`` and ``rpict``.

    Examples
    --------
    >>> params = get_default_ray_params()
    >>> params.ab = 3
    >>> args = get_ray_params_args(params)
    >>> args[args.index("-ab") + 1]
    '3'
    """
    return [word for of in fields(RayParams) for word in _ray_words(arg, of)]


def _ray_words(params: RayParams, of: Field[Any]) -> list[str]:
    name, value = of.name, getattr(params, of.name)
    match name, of.default:
        case ("ambincl", _):
            return []
        case ("amblist", _):
            option = "-ai" if params.ambincl else "-ae"
            return [word for material in value for word in (option, material)]
        case ("u" | "i", _):
            return [f"-{name}+"] if value else []
        case (_, bool()):
            return [f"-{name}" if value else f"-{name}-"]
        case ("af", _):
            return ["-af", value] if value else []
        case (_, int()):
            return [f"-{name.rstrip('_')}", str(int(value))]
        case _:
            return [f"-{name}", *_decimals(value)]


def _decimals(value: float | _Vector) -> list[str]:
    """A number, or each of several, with six digits."""
    values = value if isinstance(value, tuple | list) else [value]
    return [f"{number:.6f}" for number in values]
