"""Octrees, rays and rendered pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from .._program import run as run_program
from ._command import PathLike, Source, attached, option, run, switches


def oconv(
    *paths: PathLike,
    warning: bool = True,
    stdin: None | bytes = None,
    frozen: bool = False,
    octree: None | PathLike = None,
) -> bytes:
    """Compile scenes to an octree.

    Parameters
    ----------
    *paths : path-like
    warning : bool
        Whether warnings are printed.
    stdin : bytes, optional
        Further scene text.
    frozen : bool
        Whether the octree holds the scene, so that its files are not needed any more.
    octree : path-like, optional
        An octree to which the scenes are added.
    """
    words = [*option("-i", octree), *switches({"-w": not warning, "-f": frozen})]
    words += ["-"] if stdin is not None else []
    return run("oconv", *words, *paths, stdin=stdin)


def getbbox(*inputs: Source, header: bool = False, warning: bool = True) -> list[float]:
    """The box around scenes, files or text: [xmin, xmax, ymin, ymax, zmin, zmax]."""
    if not inputs:
        raise ValueError("expected at least one input")
    texts = [source for source in inputs if isinstance(source, bytes)]
    words = switches({"-h": not header, "-w": not warning})
    words += ["-"] if texts else []
    words += [str(source) for source in inputs if not isinstance(source, bytes)]
    said = run("getbbox", *words, stdin=b"\n".join(texts) if texts else None)
    return [float(number) for number in said.split()[-6:]]


def rtrace(
    rays: bytes,
    octree: PathLike,
    header: bool = True,
    inform: str = "a",
    outform: str = "a",
    irradiance: bool = False,
    irradiance_lambertian: bool = False,
    outspec: None | str = None,
    trace_exclude: str = "",
    trace_include: str = "",
    trace_exclude_file: None | PathLike = None,
    trace_include_file: None | PathLike = None,
    uncorrelated: bool = False,
    xres: None | int = None,
    yres: None | int = None,
    nproc: None | int = None,
    params: None | Sequence[str] = None,
    report: bool = False,
    version: bool = False,
) -> bytes:
    """Answer rays: ``rtrace``.

    Parameters
    ----------
    rays : bytes
        Origins and directions in the format ``inform``.
    octree : path-like
    header : bool
        Whether the answers have a header.
    inform, outform : str
        ``a`` text, ``f`` floats, ``d`` doubles.
    irradiance, irradiance_lambertian : bool
        ``-I`` and ``-i``.
    outspec : str, optional
        ``-o``.
    trace_exclude, trace_include : str
        A material (``-te``, ``-ti``); or a file of materials (``trace_exclude_file``, ``trace_include_file``).
    uncorrelated : bool
        ``-u+``.
    xres, yres, nproc : int, optional
    params : sequence of str, optional
        Further options.
    report : bool
        Whether messages go to standard error as they come.
    version : bool
        Only tell the version.
    """
    if version:
        return run("rtrace", "-version")
    if not isinstance(rays, bytes):
        raise TypeError("rays are not bytes")
    limits = [
        ("-te", trace_exclude),
        ("-ti", trace_include),
        ("-tE", trace_exclude_file),
        ("-tI", trace_include_file),
    ]
    limit = next(([letter, str(value)] for letter, value in limits if value), [])
    words = [
        "rtrace",
        *switches({"-h": not header, "-I": irradiance, "-i": irradiance_lambertian and not irradiance}),
        f"-f{inform}{outform}",
        *attached("-o", outspec),
        *limit,
        *switches({"-u+": uncorrelated}),
        *option("-x", xres),
        *option("-y", yres),
        *option("-n", nproc or None),
        *(params or []),
        str(octree),
    ]
    return run_program(words, rays, keep_stderr=report)


def rpict(
    view: Sequence[str],
    octree: PathLike,
    xres: None | int = None,
    yres: None | int = None,
    report: float = 0,
    report_file: None | Path = None,
    params: None | Sequence[str] = None,
) -> bytes:
    """Render a picture: ``rpict``.

    Parameters
    ----------
    view : sequence of str
        Options of the view.
    octree : path-like
    xres, yres : int, optional
    report : float
        Seconds between reports of progress.
    report_file : path-like, optional
        Where these go.
    params : sequence of str, optional
        Further options; ``--error`` and its number ask for an error.
    """
    words = [*view, *option("-t", report or None), *option("-e", report_file)]
    words += [*option("-x", xres), *option("-y", yres), *(params or [])]
    return run("rpict", *words, octree)


class Rcontrib:
    """Contributions of modifiers to rays: ``rcontrib``. `add_modifier`, then call it.

    Parameters
    ----------
    inp : bytes
        Rays.
    octree : path-like
    nproc : int
    yres : int, optional
    inform, outform : str, optional
    report : int
    params : sequence of str, optional
    """

    def __init__(
        self,
        inp: bytes,
        octree: PathLike,
        nproc: int = 1,
        yres: None | int = None,
        inform: None | str = None,
        outform: None | str = None,
        report: int = 0,
        params: None | Sequence[str] = None,
    ) -> None:
        self._rays, self._octree = inp, octree
        self._words = ["-n", str(nproc), *(params or [])]
        if inform is not None and outform is not None:
            self._words.append(f"-f{inform}{outform}")
        self._words += [*option("-y", yres), *option("-t", report or None)]

    def add_modifier(
        self,
        modifier: None | str = None,
        modifier_path: None | str = None,
        calfile: None | str = None,
        expression: None | str = None,
        nbins: None | int | str = None,
        binv: None | int | str = None,
        param: None | str = None,
        xres: None | int = None,
        yres: None | int = None,
        output: None | str = None,
    ) -> Rcontrib:
        """Track a modifier, or all of a file."""
        self._words += [*option("-f", calfile), *option("-e", expression), *option("-b", binv)]
        self._words += [*option("-bn", nbins), *option("-p", param), *option("-o", output)]
        self._words += [*option("-x", xres), *option("-y", yres)]
        self._words += [*option("-m", modifier), *option("-M", modifier_path)]
        return self

    def __call__(self) -> bytes:
        return run("rcontrib", *self._words, self._octree, stdin=self._rays)


def vwrays(
    pixpos: None | bytes = None,
    unbuf: bool = False,
    outform: Literal["a", "f", "d", "c"] = "a",
    ray_count: int = 1,
    pixel_jitter: float = 0,
    pixel_diameter: float = 0,
    pixel_aspect: float = 1,
    xres: int = 512,
    yres: int = 512,
    dimensions: bool = False,
    view: None | Sequence[str] = None,
    pic: None | Path = None,
    zbuf: None | Path = None,
) -> bytes:
    """Rays of a view or a picture: ``vwrays``."""
    if view is None and pic is None:
        raise ValueError("expected a view or a picture")
    words = switches({"-i": pixpos is not None, "-u": unbuf})
    words += [] if outform == "a" else [f"-f{outform}"]
    words += [*option("-c", ray_count), *option("-pj", pixel_jitter), *option("-pd", pixel_diameter)]
    words += [*option("-pa", pixel_aspect), *option("-x", xres), *option("-y", yres), *switches({"-d": dimensions})]
    of = list(view) if view is not None else [str(pic), *([] if zbuf is None else [str(zbuf)])]
    return run("vwrays", *words, *of, stdin=pixpos)


def mkillum(inp: bytes, octree: PathLike, nproc: int = 1, params: None | Sequence[str] = None) -> bytes:
    """Windows and other surfaces as light sources: ``mkillum``."""
    return run("mkillum", *option("-n", nproc or None), *(params or []), octree, stdin=inp)
