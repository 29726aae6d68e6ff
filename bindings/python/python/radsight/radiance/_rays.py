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
    """Compile scenes to an octree: ``oconv``.

    Parameters
    ----------
    *paths : path-like
        Scene files.
    warning : bool
        Whether warnings are printed.
    stdin : bytes, optional
        Further scene text.
    frozen : bool
        Whether the octree holds the scene, so that its files are not needed any more.
    octree : path-like, optional
        An octree to which the scenes are added.

    Returns
    -------
    bytes
        The octree.
    """
    words = [*option("-i", octree), *switches({"-w": not warning, "-f": frozen})]
    words += ["-"] if stdin is not None else []
    return run("oconv", *words, *paths, stdin=stdin)


def getbbox(*inputs: Source, header: bool = False, warning: bool = True) -> list[float]:
    """Find the box around scenes: ``getbbox``.

    Parameters
    ----------
    *inputs : path-like or bytes
        Scene files, or scene text.
    header : bool
        Whether the program prints a header; the result is the same.
    warning : bool
        Whether warnings are printed.

    Returns
    -------
    list of float
        Limits xmin, xmax, ymin, ymax, zmin, zmax, in scene units.

    Raises
    ------
    ValueError
        If there is no input.
    """
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
    """Trace rays: ``rtrace``.

    Parameters
    ----------
    rays : bytes
        Origins and directions in the format ``inform``.
    octree : path-like
        File of the octree.
    header : bool
        Whether the answers have a header.
    inform : str
        Format of the rays: ``a`` text, ``f`` floats, ``d`` doubles.
    outform : str
        Format of the answers: the same, or ``c`` for a picture.
    irradiance : bool
        Whether rays ask for irradiance at their origin (``-I``).
    irradiance_lambertian : bool
        Whether rays ask for irradiance of the first surface (``-i``).
    outspec : str, optional
        What is answered (``-o``), such as ``v`` for radiance; W/(sr·m²), W/m² for irradiance.
    trace_exclude : str
        A modifier that is not traced (``-te``).
    trace_include : str
        A modifier that alone is traced (``-ti``).
    trace_exclude_file : path-like, optional
        A file of such modifiers (``-tE``).
    trace_include_file : path-like, optional
        A file of such modifiers (``-tI``).
    uncorrelated : bool
        Whether samples are independent (``-u+``).
    xres : int, optional
        Columns of the picture that the rays are.
    yres : int, optional
        Rows of it.
    nproc : int, optional
        Number of processes.
    params : sequence of str, optional
        Further options, word by word.
    report : bool
        Whether messages go to standard error as they come.
    version : bool
        Whether to output only the version.

    Returns
    -------
    bytes
        A record for each ray.

    Raises
    ------
    TypeError
        If the rays are not bytes.
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
        File of the octree.
    xres : int, optional
        Columns at most.
    yres : int, optional
        Rows at most.
    report : float
        Seconds between reports of progress.
    report_file : path-like, optional
        File of these reports.
    params : sequence of str, optional
        Further options; ``--error`` and its number ask for an error.

    Returns
    -------
    bytes
        The picture; its values are W/(sr·m²).
    """
    words = [*view, *option("-t", report or None), *option("-e", report_file)]
    words += [*option("-x", xres), *option("-y", yres), *(params or [])]
    return run("rpict", *words, octree)


class Rcontrib:
    """Ask for contributions of modifiers to rays: ``rcontrib``.

        Add modifiers with `add_modifier`, then call it for the bytes that the program writes.

    Parameters
    ----------
    inp : bytes
        Rays in the format ``inform``.
    octree : path-like
        File of the octree.
    nproc : int
        Number of processes.
    yres : int, optional
        Rows of the answers.
    inform : str, optional
        Format of the rays: ``a``, ``f`` or ``d``.
    outform : str, optional
        Format of the answers: the same, or ``c``.
    report : int
        Seconds between reports of progress.
    params : sequence of str, optional
        Further options, word by word.
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
        """Track a modifier, or all modifiers of a file.

        Parameters
        ----------
        modifier : str, optional
            Name of the modifier.
        modifier_path : str, optional
            File of names, one a line.
        calfile : str, optional
            File of functions for the bins (``-f``).
        expression : str, optional
            Definitions for them (``-e``).
        nbins : int or str, optional
            Number of bins, or an expression of it (``-bn``).
        binv : int or str, optional
            Expression of a contribution's bin (``-b``).
        param : str, optional
            Variables of the bins (``-p``).
        xres : int, optional
            Columns of the answers.
        yres : int, optional
            Rows of them.
        output : str, optional
            File of the answers instead of standard output (``-o``).

        Returns
        -------
        Rcontrib
            This object, for the next call.
        """
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
    """Make the rays of a view or a picture: ``vwrays``.

    Parameters
    ----------
    pixpos : bytes, optional
        Positions of pixels, for rays through these alone.
    unbuf : bool
        Whether each ray is written at once.
    outform : {"a", "f", "d", "c"}
        Format of the rays: ``a``, ``f`` or ``d``.
    ray_count : int
        Rays for each pixel.
    pixel_jitter : float
        Random shift within a pixel, 0 to 1.
    pixel_diameter : float
        Diameter of the lens, scene units.
    pixel_aspect : float
        Height of a pixel as a multiple of its width.
    xres : int
        Columns at most.
    yres : int
        Rows at most.
    dimensions : bool
        Whether to output only the size, as options of ``rtrace``.
    view : sequence of str, optional
        Options of the view.
    pic : path-like, optional
        A picture that has a view, instead.
    zbuf : path-like, optional
        Distances of its surfaces, from which the rays start.

    Returns
    -------
    bytes
        Origin and direction of each ray, or the size.

    Raises
    ------
    ValueError
        Without a view and a picture.
    """
    if view is None and pic is None:
        raise ValueError("expected a view or a picture")
    words = switches({"-i": pixpos is not None, "-u": unbuf})
    words += [] if outform == "a" else [f"-f{outform}"]
    words += [*option("-c", ray_count), *option("-pj", pixel_jitter), *option("-pd", pixel_diameter)]
    words += [*option("-pa", pixel_aspect), *option("-x", xres), *option("-y", yres), *switches({"-d": dimensions})]
    of = list(view) if view is not None else [str(pic), *([] if zbuf is None else [str(zbuf)])]
    return run("vwrays", *words, *of, stdin=pixpos)


def mkillum(inp: bytes, octree: PathLike, nproc: int = 1, params: None | Sequence[str] = None) -> bytes:
    """Turn windows and other surfaces into light sources: ``mkillum``.

    Parameters
    ----------
    inp : bytes
        Scene text with the surfaces.
    octree : path-like
        File of the octree in which they shine.
    nproc : int
        Number of processes.
    params : sequence of str, optional
        Further options, word by word.

    Returns
    -------
    bytes
        Scene text with ``illum`` surfaces.
    """
    return run("mkillum", *option("-n", nproc or None), *(params or []), octree, stdin=inp)
