"""Pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from ._command import (
    PathLike,
    Source,
    as_file,
    attached,
    one_source,
    option,
    repeated,
    run,
    source_of,
    switches,
    vector,
)
from ._records import getinfo


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
    word, stdin = source_of(image)
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
    words = [text for letter, value in valued.items() for text in option(letter, value or None)]
    words += switches({"-c": pa_correct, "-1": one_pass, "-a": average_hot})
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
    word, stdin = source_of(pic)
    words = switches({"-u": unique, "-o": original, "-h": not header, "-H": not resstr, "-d": dataonly})
    words += [*option("-s", skip or None), *option("-e", exposure or None)]
    words += option("-g", None if gamma == 1.0 else gamma)
    words += attached("-d", outform)
    words += switches({"-R": reverse_rgb, "-n": not interleaving, "-b": brightness})
    words += attached("-p", outprimary)
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
    words = switches({**vision, "-l": linear, "-w": center_weighted})
    stdin = None
    if fixfrac > 0 and fixpoints is not None:
        words += option("-i", fixfrac)
        stdin = "\n".join(" ".join(map(str, point)) for point in fixpoints).encode()
    elif histo:
        words.append("-I")
        stdin = histo.encode()
    words += [*option("-e", expval or None), *option("-u", None if ldmax == 100.0 else ldmax)]
    words += option("-d", None if lddyn == 100.0 else lddyn)
    words += vector("-p", primaries) or option("-f", macbeth or None)
    words += option("-x", mapfile or None)
    with as_file(hdr) as path:
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
    word, stdin = source_of(inp)
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
    words = [text for letter, value in valued.items() for text in option(letter, value)]
    words += [*attached("-c", contour), *switches({"-e": extrema})]
    return run("falsecolor", *(["-i", *word] if word else []), *words, stdin=stdin)


def get_image_dimensions(image: Source) -> tuple[int, int]:
    """Columns and rows of a picture."""
    data = image if isinstance(image, bytes) else Path(image).read_bytes()
    said = getinfo(data, dimension_only=True).split()
    if len(said) < 4:
        raise ValueError(f"no size of a picture: {said!r}")
    return int(said[3]), int(said[1])


class Pcomb:
    """Combine pictures: ``pcomb``. Add them with `add`, then call it.

    Parameters
    ----------
    xres, yres : int, optional
        The size, where expressions alone make the picture.
    inform : str
        Only ``a``: the format is in the input's header.
    fout : bool
        Whether the result is in floats.
    header : bool
        Whether the headers of the inputs are kept.
    expression, source : str or sequence of str, optional
        Expressions, and files of functions.
    """

    def __init__(
        self,
        xres: None | int = None,
        yres: None | int = None,
        inform: str = "a",
        fout: bool = True,
        header: bool = True,
        expression: None | str | Sequence[str] = None,
        source: None | str | Sequence[str] = None,
    ) -> None:
        if inform != "a":
            raise ValueError(f"inform is {inform!r}, expected 'a': the input's header has the format")
        self._words = [*option("-x", xres), *option("-y", yres), *switches({"-ff": fout, "-h": not header})]
        self._words += [*repeated("-e", expression), *repeated("-f", source)]
        self._is_ready = xres is not None and yres is not None
        self._stdin: None | bytes = None

    def add(self, image: Source, original: bool = False, scaler: float = 1.0) -> Pcomb:
        """Add a picture with its factor."""
        self._words += [*switches({"-o": original}), "-s", str(scaler)]
        self._stdin = one_source(self._words, self._stdin, image)
        self._is_ready = True
        return self

    def __call__(self) -> bytes:
        if not self._is_ready:
            raise ValueError("expected a picture, or xres and yres")
        return run("pcomb", *self._words, stdin=self._stdin)


def pcompos(
    inputs: Sequence[Source],
    pos: None | Sequence[Sequence[float]] = None,
    xres: None | int = None,
    yres: None | int = None,
    spacing: int = 0,
    background: None | tuple[float, float, float] = None,
    anchors: None | Sequence[str] = None,
    header: bool = True,
    lower_threashold: None | float = None,
    upper_threshold: None | float = None,
    label: None | str = None,
    label_height: None | int = None,
    ncols: None | int = None,
    anchor_point: None | Sequence[str] = None,
) -> bytes:
    """Put pictures side by side: ``pcompos``, at positions or in so many columns."""
    words = []
    if ncols is not None:
        words += ["-a", str(ncols), *option("-s", spacing or None), *vector("-o", anchor_point)]
    elif pos is None or len(pos) != len(inputs):
        raise ValueError("expected ncols, or a position for each picture")
    words += [*option("-x", xres), *option("-y", yres), *vector("-b", background)]
    words += [*option("-t", lower_threashold), *option("+t", upper_threshold)]
    if label is not None:
        words += [*(["-l", label] if label else ["-la"]), *option("-lh", label_height)]
    words += switches({"-h": not header})
    stdin = None
    for place, picture in enumerate(inputs):
        if ncols is None and anchors is not None and anchors[place] is not None:
            words.append(f"={anchors[place]}")
        stdin = one_source(words, stdin, picture)
        words += [] if ncols is not None or pos is None else map(str, pos[place])
    return run("pcompos", *words, stdin=stdin)


class xyRGB(NamedTuple):  # noqa: N801 (pyradiance's name)
    """A pixel and its value."""

    x: int
    y: int
    R: float
    G: float
    B: float


def pextrem(pic: Source, original: bool = False, original_xyze: bool = False) -> tuple[xyRGB, xyRGB]:
    """The darkest and the brightest pixel: ``pextrem``."""
    word, stdin = source_of(pic)
    said = run("pextrem", *switches({"-o": original, "-O": original_xyze and not original}), *word, stdin=stdin)
    lines = [line.split() for line in said.decode().splitlines()]
    if [len(line) for line in lines] != [5, 5]:
        raise ValueError(f"no two pixels: {said!r}")
    least, most = (xyRGB(int(x), int(y), float(r), float(g), float(b)) for x, y, r, g, b in lines)
    return least, most


def ra_ppm(
    inp: Source,
    gamma: float = 2.2,
    greyscale: bool = False,
    reverse: bool = False,
    exposure: int = 0,
    ascii: bool = False,
    outscale: int = 255,
) -> bytes:
    """A picture to or (``reverse``) from a portable pixmap: ``ra_ppm``."""
    word, stdin = source_of(inp)
    words = [*switches({"-r": reverse}), *option("-g", gamma or None), *switches({"-b": greyscale})]
    words += [*option("-e", _stops(exposure)), *switches({"-a": ascii})]
    return run("ra_ppm", *words, *option("-s", None if outscale == 255 else outscale), *word, stdin=stdin)


def ra_rgbe(
    inp: Source,
    outspec: None | PathLike = None,
    rle: bool = False,
    exposure: None | int = None,
    force: bool = False,
    frameno: None | int = None,
) -> None | bytes:
    """A picture in another encoding: ``ra_rgbe``. ``None`` where ``outspec`` names a file."""
    word, stdin = source_of(inp, "-")
    words = [*switches({"-r": rle}), *option("-e", _stops(exposure or 0))]
    words += [*switches({"-f": force}), *option("-n", frameno)]
    said = run("ra_rgbe", *words, *word, *_file(outspec), stdin=stdin)
    return said if outspec is None else None


def ra_tiff(
    inp: Source,
    out: None | str = None,
    gamma: float = 2.2,
    greyscale: bool = False,
    lzw: bool = False,
    sgilog: bool = False,
    sgilog24: bool = False,
    ieee32: bool = False,
    primary: bool = False,
    exposure: int = 0,
    reverse: bool = False,
    xyze: bool = False,
) -> None | bytes:
    """A picture to or (``reverse``) from TIFF: ``ra_tiff``. ``None`` where ``out`` names a file."""
    if reverse and isinstance(inp, bytes):
        raise ValueError("a TIFF is bytes, expected a file")
    if not reverse and out is None:
        raise ValueError("expected out: a TIFF is written to a file")
    if reverse:
        words = ["-r", *(["-e"] if xyze else option("-e", _stops(exposure))), *option("-g", gamma or None)]
    else:
        kinds = {"-z": lzw, "-L": sgilog, "-l": sgilog24, "-f": ieee32, "-w": primary}
        words = [*switches(kinds)[:1], *switches({"-b": greyscale})]
        words += [*option("-g", gamma or None), *option("-e", _stops(exposure))]
    word, stdin = source_of(inp, "-")
    said = run("ra_tiff", *words, *word, *_file(out), stdin=stdin)
    return said if out is None else None


def ra_xyze(
    inp: Source,
    out: None | PathLike = None,
    rgbe: bool = False,
    exposure: None | str = None,
    original: bool = False,
    rle: bool = False,
    flat: bool = False,
    primaries: None | Sequence[float] = None,
) -> None | bytes:
    """A picture to XYZE, or with ``rgbe`` from it: ``ra_xyze``. ``None`` where ``out`` names a file."""
    word, stdin = source_of(inp)
    if stdin is not None and out is not None:
        word = ["-"]
    words = [*switches({"-r": rgbe}), *option("-e", exposure)]
    words += switches({"-o": original, "-c": rle, "-u": flat and not rle})
    words += vector("-p", primaries)
    said = run("ra_xyze", *words, *word, *_file(out), stdin=stdin)
    return said if out is None else None


def _stops(exposure: int) -> None | str:
    """Stops with their sign."""
    return f"{exposure:+d}" if exposure else None


def _file(name: None | PathLike) -> list[str]:
    return [] if name is None else [str(name)]
