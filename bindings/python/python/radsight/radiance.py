"""Radiance's programs as functions on bytes, with the signatures of `pyradiance`: change the import and keep the code.

>>> from radsight import radiance
>>> scene = b"void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2"
>>> radiance.getbbox(scene)
[-2.0, 2.0, 7.0, 11.0, -2.0, 2.0]

A program that fails raises `RuntimeError` with its messages, as there. `run` runs any program of ``radsight``, those without a function as
well.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ._program import run as _run

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = [
    "Rcontrib",
    "Xform",
    "cnt",
    "dctimestep",
    "falsecolor",
    "genbox",
    "gendaylit",
    "gensky",
    "get_header",
    "get_image_dimensions",
    "getbbox",
    "getinfo",
    "oconv",
    "pcond",
    "pfilt",
    "pvalue",
    "rcalc",
    "rfluxmtx",
    "rmtxop",
    "rpict",
    "rtrace",
    "run",
    "total",
    "vwrays",
]

PathLike = str | Path
Source = str | Path | bytes


def run(program: str, *words: Any, stdin: bytes | None = None) -> bytes:
    """What a program writes to standard output.

    Parameters
    ----------
    program : str
        Its name, such as ``"pcomb"``.
    *words
        Its command line.
    stdin : bytes, optional

    Returns
    -------
    bytes

    Raises
    ------
    RuntimeError
        With its messages, if it fails.
    """
    return _run([program, *map(str, words)], stdin)


def _option(letter: str, *values: Any) -> list[str]:
    """An option with its values; nothing where one of them is not given."""
    return [] if any(value is None for value in values) else [letter, *map(str, values)]


def _switches(switches: dict[str, bool]) -> list[str]:
    return [letter for letter, is_on in switches.items() if is_on]


def _source(source: Source, name_of_stdin: str | None = None) -> tuple[list[str], bytes | None]:
    """The word for an input and what goes to standard input."""
    if isinstance(source, bytes):
        return ([] if name_of_stdin is None else [name_of_stdin]), source
    if isinstance(source, str | Path):
        return [str(source)], None
    raise TypeError(f"expected a path or bytes, not {type(source).__name__}")


@contextmanager
def _as_file(source: Source) -> Iterator[str]:
    """A path of what is given, for programs that read a file twice."""
    if not isinstance(source, bytes):
        yield str(source)
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "input"
        path.write_bytes(source)
        yield str(path)


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
    words = [*_option("-i", octree), *_switches({"-w": not warning, "-f": frozen})]
    words += ["-"] if stdin is not None else []
    return run("oconv", *words, *paths, stdin=stdin)


def getbbox(*inputs: Source, header: bool = False, warning: bool = True) -> list[float]:
    """The box around scenes, files or text: [xmin, xmax, ymin, ymax, zmin, zmax]."""
    if not inputs:
        raise ValueError("expected at least one input")
    texts = [source for source in inputs if isinstance(source, bytes)]
    words = _switches({"-h": not header, "-w": not warning})
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
        *_switches({"-h": not header, "-I": irradiance, "-i": irradiance_lambertian and not irradiance}),
        f"-f{inform}{outform}",
        *([f"-o{outspec}"] if outspec else []),
        *limit,
        *_switches({"-u+": uncorrelated}),
        *_option("-x", xres),
        *_option("-y", yres),
        *_option("-n", nproc or None),
        *(params or []),
        str(octree),
    ]
    return _run(words, rays, keep_stderr=report)


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
    words = [*view, *_option("-t", report or None), *_option("-e", report_file)]
    words += [*_option("-x", xres), *_option("-y", yres), *(params or [])]
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
        self._words += [*_option("-y", yres), *_option("-t", report or None)]

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
        self._words += [*_option("-f", calfile), *_option("-e", expression), *_option("-b", binv)]
        self._words += [*_option("-bn", nbins), *_option("-p", param), *_option("-o", output)]
        self._words += [*_option("-x", xres), *_option("-y", yres)]
        self._words += [*_option("-m", modifier), *_option("-M", modifier_path)]
        return self

    def __call__(self) -> bytes:
        return run("rcontrib", *self._words, self._octree, stdin=self._rays)


def rfluxmtx(
    receiver: PathLike,
    surface: None | PathLike = None,
    rays: None | bytes = None,
    params: None | Sequence[str] = None,
    octree: None | PathLike = None,
    scene: None | Sequence[PathLike] = None,
) -> bytes:
    """Flux transfer matrices: ``rfluxmtx``.

    Parameters
    ----------
    receiver : path-like
    surface : path-like, optional
        The sender; without it ``rays``.
    rays : bytes, optional
    params : sequence of str, optional
    octree : path-like, optional
    scene : sequence of path-like, optional
    """
    sender = "-" if surface is None else str(surface)
    words = [*(params or []), sender, receiver, *_option("-i", octree), *(scene or [])]
    return run("rfluxmtx", *words, stdin=rays)


def rmtxop(
    inp: Source,
    outform: Literal["a", "f", "d", "c"] = "a",
    transpose: bool = False,
    scale: None | float = None,
    transform: None | str | Sequence[float] = None,
    reflectance: None | str = None,
) -> bytes:
    """Change a matrix: ``rmtxop``."""
    word, stdin = _source(inp, "-")
    words = [*_switches({"-t": transpose}), f"-f{outform}", *_option("-s", scale)]
    if transform is not None:
        words += ["-c", *([transform] if isinstance(transform, str) else map(str, transform))]
    words += [f"-r{reflectance[0]}"] if reflectance else []
    return run("rmtxop", *words, *word, stdin=stdin)


def dctimestep(
    *mtx: Source,
    nstep: None | int = None,
    header: bool = True,
    xres: None | int = None,
    yres: None | int = None,
    inform: None | str = None,
    outform: None | str = None,
    ospec: None | str = None,
) -> None | bytes:
    """Products of daylight matrices: ``dctimestep``. The last may be bytes. ``None`` where ``ospec`` names files."""
    if not 1 <= len(mtx) <= 4:
        raise ValueError(f"{len(mtx)} matrices, expected 1 to 4")
    if any(isinstance(matrix, bytes) for matrix in mtx[:-1]):
        raise ValueError("only the last matrix may be bytes")
    last, stdin = _source(mtx[-1])
    words = [*_option("-n", nstep), *_switches({"-h": not header}), *_option("-x", xres), *_option("-y", yres)]
    words += [f"-i{inform}"] if inform else []
    words += [f"-o{outform}"] if outform else []
    said = run("dctimestep", *words, *_option("-o", ospec), *mtx[:-1], *last, stdin=stdin)
    return None if ospec else said


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
    words = _switches({"-i": pixpos is not None, "-u": unbuf})
    words += [] if outform == "a" else [f"-f{outform}"]
    words += [*_option("-c", ray_count), *_option("-pj", pixel_jitter), *_option("-pd", pixel_diameter)]
    words += [*_option("-pa", pixel_aspect), *_option("-x", xres), *_option("-y", yres), *_switches({"-d": dimensions})]
    of = list(view) if view is not None else [str(pic), *([] if zbuf is None else [str(zbuf)])]
    return run("vwrays", *words, *of, stdin=pixpos)


def pfilt(
    image: Source,
    xres: None | str = None,
    yres: None | str = None,
    pixel_aspect: float = 0,
    pa_correct: bool = False,
    exposure: None | float = 0,
    lamp: None | str = None,
    lampdat: None | str = None,
    one_pass: bool = False,
    gaussian_filter_radius: None | float = None,
    limitfrac: None | float = None,
    hot_threshold: float = 100,
    star_points: int = 0,
    star_spread: float = 0.0001,
    average_hot: bool = False,
) -> bytes:
    """Filter a picture: ``pfilt``."""
    word, stdin = _source(image)
    valued = {
        "-x": xres,
        "-y": yres,
        "-p": pixel_aspect,
        "-e": exposure,
        "-t": lamp,
        "-f": lampdat,
        "-r": gaussian_filter_radius,
        "-m": limitfrac,
        "-h": None if hot_threshold == 100 else hot_threshold,
        "-n": star_points,
        "-s": None if star_spread == 0.0001 else star_spread,
    }
    words = [text for letter, value in valued.items() for text in _option(letter, value or None)]
    words += _switches({"-c": pa_correct, "-1": one_pass, "-a": average_hot})
    return run("pfilt", *words, *word, stdin=stdin)


def pvalue(
    pic: Source,
    unique: bool = False,
    original: bool = False,
    header: bool = True,
    resstr: bool = True,
    skip: int = 0,
    exposure: int = 0,
    gamma: float = 1.0,
    dataonly: bool = False,
    outform: str = "",
    reverse_rgb: bool = False,
    interleaving: bool = True,
    brightness: bool = False,
    outprimary: None | str = None,
) -> bytes:
    """The values of a picture: ``pvalue``."""
    word, stdin = _source(pic)
    words = _switches({"-u": unique, "-o": original, "-h": not header, "-H": not resstr, "-d": dataonly})
    words += [*_option("-s", skip or None), *_option("-e", exposure or None)]
    words += _option("-g", None if gamma == 1.0 else gamma)
    words += [f"-d{outform}"] if outform else []
    words += _switches({"-R": reverse_rgb, "-n": not interleaving, "-b": brightness})
    words += [f"-p{outprimary}"] if outprimary else []
    return run("pvalue", *words, *word, stdin=stdin)


def pcond(
    hdr: Source,
    human: bool = False,
    acuity: bool = False,
    veiling: bool = False,
    sense: bool = False,
    closs: bool = False,
    center_weighted: bool = False,
    linear: bool = False,
    fixfrac: float = 0.0,
    fixpoints: None | list[tuple[float, ...]] = None,
    histo: str = "",
    expval: str = "",
    ldmax: float = 100.0,
    lddyn: float = 100.0,
    primaries: None | list[float] = None,
    macbeth: str = "",
    mapfile: str = "",
) -> bytes:
    """Condition a picture for a display: ``pcond``."""
    if fixfrac > 0 and fixpoints is None:
        raise ValueError("fixfrac is given without fixpoints")
    vision = {"-h": True} if human else {"-a": acuity, "-v": veiling, "-s": sense, "-c": closs}
    words = _switches({**vision, "-l": linear, "-w": center_weighted})
    stdin = None
    if fixfrac > 0 and fixpoints is not None:
        words += _option("-i", fixfrac)
        stdin = "\n".join(" ".join(map(str, point)) for point in fixpoints).encode()
    elif histo:
        words.append("-I")
        stdin = histo.encode()
    words += [*_option("-e", expval or None), *_option("-u", None if ldmax == 100.0 else ldmax)]
    words += _option("-d", None if lddyn == 100.0 else lddyn)
    words += ["-p", *map(str, primaries)] if primaries is not None else _option("-f", macbeth or None)
    words += _option("-x", mapfile or None)
    with _as_file(hdr) as path:
        return run("pcond", *words, path, stdin=stdin)


def falsecolor(
    inp: Source,
    pic_overlay: None | str = None,
    contour: None | str = None,
    extrema: bool = False,
    scale: None | str = None,
    digits: None | int = None,
    label: None | str = None,
    ndivs: None | int = None,
    lwidth: None | int = None,
    lheight: None | int = None,
    decades: None | int = None,
    multiplier: None | float = None,
    palette: None | str = None,
    redv: None | str = None,
    grnv: None | str = None,
    bluv: None | str = None,
) -> bytes:
    """A picture in false colour: ``falsecolor``."""
    if contour and contour not in ("b", "l", "p"):
        raise ValueError(f"contour is {contour!r}, expected 'b', 'l' or 'p'")
    word, stdin = _source(inp)
    valued = {
        "-p": pic_overlay,
        "-s": scale,
        "-d": digits,
        "-l": label,
        "-n": ndivs,
        "-lw": lwidth,
        "-lh": lheight,
        "-log": decades,
        "-m": multiplier,
        "-pal": palette,
        "-r": redv,
        "-g": grnv,
        "-b": bluv,
    }
    words = [text for letter, value in valued.items() for text in _option(letter, value)]
    words += [f"-c{contour}"] if contour else []
    words += _switches({"-e": extrema})
    return run("falsecolor", *(["-i", *word] if word else []), *words, stdin=stdin)


def getinfo(
    *inputs: Source,
    dimension_only: bool = False,
    dimension: bool = False,
    strip_header: bool = False,
    replace: str = "",
    append: str = "",
    command: str = "",
) -> bytes:
    """Headers of files: ``getinfo``."""
    words = next(
        (
            words
            for is_asked, words in (
                (dimension_only, ["-d"]),
                (dimension, ["+d"]),
                (replace, ["-r", replace]),
                (append, ["-a", append]),
            )
            if is_asked
        ),
        [],
    )
    words = [*words, *_option("-c", command or None)]
    if len(inputs) == 1 and (strip_header or isinstance(inputs[0], bytes)):
        source = inputs[0]
        data = source if isinstance(source, bytes) else Path(source).read_bytes()
        return run("getinfo", *words, *_switches({"-": strip_header}), stdin=data)
    if strip_header:
        raise ValueError(f"{len(inputs)} inputs, expected one where its header is stripped")
    if any(isinstance(source, bytes) for source in inputs):
        raise TypeError("bytes beside other inputs")
    return run("getinfo", *words, *inputs)


def get_header(inp: Source, dimension: bool = False) -> bytes:
    """The header of a picture, matrix or octree."""
    word, stdin = _source(inp)
    return run("getinfo", *_switches({"-d": dimension}), *word, stdin=stdin)


def get_image_dimensions(image: Source) -> tuple[int, int]:
    """Columns and rows of a picture."""
    data = image if isinstance(image, bytes) else Path(image).read_bytes()
    said = getinfo(data, dimension_only=True).split()
    if len(said) < 4:
        raise ValueError(f"no size of a picture: {said!r}")
    return int(said[3]), int(said[1])


def _when(
    dt: None | datetime, place: dict[str, Any], altitude: None | float, azimuth: None | float, *, seconds: bool
) -> list[str]:
    """Date and place of a sky, or where its sun is."""
    if dt is not None:
        hour = dt.hour + dt.minute / 60 + (dt.second / 3600 if seconds else 0)
        words = [text for letter, value in place.items() for text in _option(letter, value)]
        return [str(dt.month), str(dt.day), str(hour), *words]
    if altitude is None or azimuth is None:
        raise ValueError("expected a date, or altitude and azimuth")
    return ["-ang", str(altitude), str(azimuth)]


def gensky(
    dt: None | datetime = None,
    latitude: None | float = None,
    longitude: None | float = None,
    timezone: None | int = None,
    altitude: None | float = None,
    azimuth: None | float = None,
    year: None | int = None,
    sunny_with_sun: bool = False,
    sunny_without_sun: bool = False,
    cloudy: bool = False,
    intermediate_with_sun: bool = False,
    intermediate_without_sun: bool = False,
    uniform: bool = False,
    ground_reflectance: None | float = None,
    zenith_brightness: None | float = None,
    horizontal_brightness: None | float = None,
    solar_radiance: None | float = None,
    horizontal_direct_irradiance: None | float = None,
    turbidity: None | float = None,
) -> bytes:
    """A CIE sky: ``gensky``."""
    place = {"-a": latitude, "-o": longitude, "-m": timezone, "-y": year}
    kinds = {
        "+s": sunny_with_sun,
        "-s": sunny_without_sun,
        "-c": cloudy,
        "+i": intermediate_with_sun,
        "-i": intermediate_without_sun,
        "-u": uniform,
    }
    words = [*_when(dt, place, altitude, azimuth, seconds=False), *_switches(kinds)[:1]]
    words += _option("-g", ground_reflectance)
    words += _option("-b", zenith_brightness) or _option("-B", horizontal_brightness)
    words += _option("-r", solar_radiance) or _option("-R", horizontal_direct_irradiance)
    return run("gensky", *words, *_option("-t", turbidity))


def gendaylit(
    dt: None | datetime = None,
    latitude: None | float = None,
    longitude: None | float = None,
    timezone: None | int = None,
    altitude: None | float = None,
    azimuth: None | float = None,
    year: None | int = None,
    dirnorm: None | float = None,
    diffhor: None | float = None,
    dirhor: None | float = None,
    dirnorm_illum: None | float = None,
    diffhor_illum: None | float = None,
    solar: bool = False,
    sky_only: bool = False,
    silent: bool = False,
    grefl: None | float = None,
    interval: None | int = None,
) -> bytes:
    """A Perez sky: ``gendaylit``."""
    place = {"-a": latitude, "-o": longitude, "-m": timezone, "-y": year}
    words = _when(dt, place, altitude, azimuth, seconds=True)
    words += (
        _option("-W", dirnorm, diffhor)
        or _option("-G", dirhor, diffhor)
        or _option("-L", dirnorm_illum, diffhor_illum)
    )
    words += [*(["-O", "1"] if solar else []), *_switches({"-s": sky_only, "-w": silent})]
    return run("gendaylit", *words, *_option("-g", grefl), *_option("-i", interval))


def genbox(
    mat: str,
    name: str,
    xsiz: float,
    ysiz: float,
    zsiz: float,
    inward: bool = False,
    beveled: None | float = None,
    rounded: None | float = None,
    nsegs: None | int = None,
    smoothing: bool = False,
    waveout: bool = False,
) -> bytes:
    """A box: ``genbox``."""
    words = [*_switches({"-i": inward}), *_option("-b", beveled), *_option("-r", rounded), *_option("-n", nsegs)]
    return run("genbox", mat, name, xsiz, ysiz, zsiz, *words, *_switches({"-s": smoothing, "-o": waveout}))


class Xform:
    """Move scene text: ``xform``. Transformations are added in their order; then call it.

    Parameters
    ----------
    inp : path-like or bytes
    expand_cmd : bool
        Whether commands are expanded.
    invert : bool
        Whether surfaces are turned around.
    iprefix : str, optional
        Before all names.
    modifier : str, optional
        Of all surfaces.
    """

    def __init__(
        self,
        inp: Source,
        expand_cmd: bool = True,
        invert: bool = False,
        iprefix: None | str = None,
        modifier: None | str = None,
    ) -> None:
        self._source = inp
        self._words = [*_switches({"-c": not expand_cmd}), *_option("-n", iprefix), *_option("-m", modifier)]
        self._words += _switches({"-I": invert})

    def _add(self, *words: Any) -> Xform:
        self._words += map(str, words)
        return self

    def translate(self, x: float, y: float, z: float) -> Xform:
        """Move."""
        return self._add("-t", x, y, z)

    def rotatex(self, deg: float) -> Xform:
        """Turn about the x axis."""
        return self._add("-rx", deg)

    def rotatey(self, deg: float) -> Xform:
        """Turn about the y axis."""
        return self._add("-ry", deg)

    def rotatez(self, deg: float) -> Xform:
        """Turn about the z axis."""
        return self._add("-rz", deg)

    def scale(self, ratio: float) -> Xform:
        """Scale about the origin."""
        return self._add("-s", ratio)

    def mirrorx(self) -> Xform:
        """Mirror at the yz plane."""
        return self._add("-mx")

    def mirrory(self) -> Xform:
        """Mirror at the xz plane."""
        return self._add("-my")

    def mirrorz(self) -> Xform:
        """Mirror at the xy plane."""
        return self._add("-mz")

    def array(self, number: int) -> Xform:
        """Repeat what follows, each time once more."""
        return self._add("-a", number)

    def iterate(self, number: int) -> Xform:
        """Do what follows so often."""
        return self._add("-i", number)

    def __call__(self) -> bytes:
        word, stdin = _source(self._source)
        return run("xform", *self._words, *word, stdin=stdin)


def cnt(*dims: int, shuffled: bool = False) -> bytes:
    """Count: ``cnt``."""
    return run("cnt", *_switches({"-s": shuffled}), *dims)


def total(
    inp: None | Source,
    mean: bool = False,
    sumpower: int = 0,
    multiply: bool = False,
    find_max: bool = False,
    find_min: bool = False,
    inform: None | str = None,
    incount: int = 1,
    outform: None | str = None,
    substep: None | int = None,
    substep_reset: bool = True,
    inlimit: None | int = None,
    outlimit: None | int = None,
    sep: None | str = None,
) -> bytes:
    """Sums of columns: ``total``."""
    word, stdin = _source(inp if inp is not None else b"")
    words = _switches({"-m": mean, "-p": multiply, "-u": find_max, "-l": find_min})
    words += [f"-s{sumpower}"] if sumpower else []
    words += [f"-i{inform}{incount if incount > 1 else ''}"] if inform else []
    words += [f"-o{outform}"] if outform else []
    words += [f"-{substep}{'' if substep_reset else 'r'}"] if substep else []
    words += [*_option("-in", inlimit), *_option("-on", outlimit)]
    words += [f"-t{sep}"] if sep else []
    return run("total", *words, *word, stdin=stdin)


def rcalc(
    inp: Source,
    sep: None | str = None,
    inform: None | str = None,
    incount: int = 1,
    outform: None | str = None,
    passive: bool = False,
    pass_negative: bool = False,
    inlimit: None | int = None,
    outlimit: None | int = None,
    source: None | str = None,
    expr: None | str = None,
    assign: None | str = None,
    exact_only: bool = False,
    ignore_newlines: bool = False,
    silent: bool = False,
) -> bytes:
    """Calculate with columns: ``rcalc``."""
    word, stdin = _source(inp)
    words = [f"-t{sep}"] if sep else []
    words += [f"-i{inform}{incount if incount > 1 else ''}"] if inform else []
    words += [f"-o{outform}"] if outform else []
    words += _switches({"-p": passive, "-P": pass_negative and not passive})
    words += [*_option("-in", inlimit), *_option("-on", outlimit), *_option("-f", source)]
    words += [*_option("-e", expr), *_option("-s", assign)]
    words += _switches({"-b": exact_only, "-l": ignore_newlines, "-w": silent})
    return run("rcalc", *words, *word, stdin=stdin)
