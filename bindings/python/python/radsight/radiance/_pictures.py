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
    """Filter and expose a picture: ``pfilt``.

    Parameters
    ----------
    image : path-like or bytes
        A Radiance picture.
    xres : str, optional
        Columns, or a factor such as ``/2``.
    yres : str, optional
        Rows, or a factor.
    pixel_aspect : float
        Aspect of the pixels; 0 keeps it.
    pa_correct : bool
        Whether square pixels are made (``-c``).
    exposure : float, optional
        A factor, or stops with a sign; 0 for automatic exposure.
    lamp : str, optional
        Lamp type whose colour becomes white.
    lampdat : str, optional
        File of lamp types.
    one_pass : bool
        Whether the picture is filtered in one pass (``-1``).
    gaussian_filter_radius : float, optional
        Radius of a Gaussian filter, output pixels.
    limitfrac : float, optional
        Share of a pixel's value that one input pixel may have.
    hot_threshold : float
        Value of a star, W/(sr·m²).
    star_points : int
        Points of a star; 0 for none.
    star_spread : float
        Spread of a star.
    average_hot : bool
        Whether bright pixels are averaged like others.

    Returns
    -------
    bytes
        The picture.
    """
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
    """Print the values of a picture: ``pvalue``.

    Parameters
    ----------
    pic : path-like or bytes
        A Radiance picture.
    unique : bool
        Whether repeated values are left out.
    original : bool
        Whether the exposure is undone.
    header : bool
        Whether the output has an information header.
    resstr : bool
        Whether the size is printed.
    skip : int
        Bytes to skip in raw data.
    exposure : int
        Stops.
    gamma : float
        Gamma of the integer values.
    dataonly : bool
        Whether positions are left out.
    outform : str
        Format of the values: ``f``, ``d``, ``b``, …; text if empty.
    reverse_rgb : bool
        Whether the order is blue, green, red.
    interleaving : bool
        Whether the bands of a pixel stand together.
    brightness : bool
        Whether only brightness is printed.
    outprimary : str, optional
        Primaries, such as ``XYZ``.

    Returns
    -------
    bytes
        A value for each pixel.
    """
    word, stdin = source_of(pic)
    words = switches({"-u": unique, "-o": original, "-h": not header, "-H": not resstr, "-d": dataonly})
    words += [*option("-s", skip or None), *option("-e", exposure or None)]
    words += option("-g", None if gamma == 1.0 else gamma)
    words += attached("-d", outform)
    words += switches({"-R": reverse_rgb, "-n": not interleaving, "-b": brightness})
    words += attached("-p", outprimary)
    return run("pvalue", *words, *word, stdin=stdin)


def pvaluer(
    pic: Source,
    xres: None | int = None,
    yres: None | int = None,
    inform: str = "a",
    resstr: bool = True,
    dataonly: bool = False,
    header: bool = True,
    primaries: None | list[float] = None,
    pxyz: bool = False,
) -> bytes:
    """Make a picture of values: ``pvalue -r``.

    Parameters
    ----------
    pic : path-like or bytes
        Values, as `pvalue` prints them.
    xres : int, optional
        Columns, where the values have no size; below zero from the right.
    yres : int, optional
        Rows, where the values have no size; below zero from the bottom.
    inform : str
        Format of the values: ``a`` text, ``f`` floats, ``d`` doubles, ``b`` bytes.
    resstr : bool
        Whether the values have a size.
    dataonly : bool
        Whether they are without positions.
    header : bool
        Whether they have a header.
    primaries : list of float, optional
        Eight chromaticities.
    pxyz : bool
        Whether the picture is in XYZ.

    Returns
    -------
    bytes
        The picture.
    """
    word, stdin = source_of(pic)
    words = ["-r", *switches({"-h": not header, "-H": not resstr, "-d": dataonly})]
    words += [] if inform == "a" else [f"-d{inform}"]
    words += [*_signed("y", yres, "-+"), *_signed("x", xres, "+-")]
    words += [*vector("-p", primaries), *switches({"-pXYZ": pxyz})]
    return run("pvalue", *words, *word, stdin=stdin)


def _signed(letter: str, count: None | int, signs: str) -> list[str]:
    """The option of a size, whose sign is that of the scan direction."""
    return [f"{signs[count < 0]}{letter}", str(abs(count))] if count else []


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
    """Condition a picture for a display: ``pcond``.

    Parameters
    ----------
    hdr : path-like or bytes
        A Radiance picture.
    human : bool
        Whether the eye's response is imitated (``-h``).
    acuity : bool
        Whether acuity is lowered in the dark.
    veiling : bool
        Whether glare veils.
    sense : bool
        Whether contrast is as seen.
    closs : bool
        Whether colours fade in the dark.
    center_weighted : bool
        Whether the centre counts more.
    linear : bool
        Whether the response is linear.
    fixfrac : float
        Share of fixation points in the adaptation.
    fixpoints : list of (float, float), optional
        Fixation points: column and row.
    histo : str
        A histogram instead.
    expval : str
        Exposure: a factor, or stops with a sign.
    ldmax : float
        Luminance of the display, cd/m².
    lddyn : float
        Dynamic range of the display.
    primaries : list of float, optional
        Eight chromaticities of the display.
    macbeth : str
        Calibration file of ``macbethcal``.
    mapfile : str
        File for the mapping of luminances.

    Returns
    -------
    bytes
        The picture.

    Raises
    ------
    ValueError
        With ``fixfrac`` and no points.
    """
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
    """Show a picture in false colour: ``falsecolor``.

    Parameters
    ----------
    inp : path-like or bytes
        A Radiance picture.
    pic_overlay : str, optional
        Picture below contour lines.
    contour : str, optional
        ``l`` for lines, ``b`` for bands, ``p`` for posters.
    extrema : bool
        Whether the extremes are printed in the picture.
    scale : str, optional
        Largest value of the scale, or ``auto``.
    digits : int, optional
        Digits of the numbers.
    label : str, optional
        Unit above the scale.
    ndivs : int, optional
        Steps of the scale.
    lwidth : int, optional
        Width of the scale, pixels.
    lheight : int, optional
        Height of the scale, pixels.
    decades : int, optional
        Decades of a logarithmic scale.
    multiplier : float, optional
        Factor of the values, 179 if not given.
    palette : str, optional
        Palette, such as ``spec``, ``hot`` or ``eco``.
    redv : str, optional
        Expression of red.
    grnv : str, optional
        Expression of green.
    bluv : str, optional
        Expression of blue.

    Returns
    -------
    bytes
        The picture.

    Raises
    ------
    ValueError
        If ``contour`` is none of these.
    """
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
    """Read the size of a picture.

    Parameters
    ----------
    image : path-like or bytes
        A Radiance picture.

    Returns
    -------
    (int, int)
        Columns and rows.

    Raises
    ------
    ValueError
        If it has none.
    """
    data = image if isinstance(image, bytes) else Path(image).read_bytes()
    said = getinfo(data, dimension_only=True).split()
    if len(said) < 4:
        raise ValueError(f"no size of a picture: {said!r}")
    return int(said[3]), int(said[1])


class Pcomb:
    """Combine pictures: ``pcomb``.

        Add them with `add`, then call it for the bytes of the result.

    Parameters
    ----------
    xres : int, optional
        Columns, where expressions alone make the picture.
    yres : int, optional
        Rows.
    inform : str
        Only ``a``: the format is in the input's header.
    fout : bool
        Whether the result is in floats.
    header : bool
        Whether the headers of the inputs are kept.
    expression : str or sequence of str, optional
        Definitions of ``ro``, ``go``, ``bo`` (``-e``).
    source : str or sequence of str, optional
        Files of functions (``-f``).
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
        """Add a picture with its factor.

        Parameters
        ----------
        image : path-like or bytes
            A Radiance picture.
        original : bool
            Whether its exposure is undone.
        scaler : float
            The factor.

        Returns
        -------
        Pcomb
            This object, for the next call.

        Raises
        ------
        ValueError
            If a second picture is bytes.
        """
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
    """Put pictures side by side: ``pcompos``.

    Parameters
    ----------
    inputs : sequence of path-like or bytes
        Pictures, of which one may be bytes.
    pos : sequence of sequence of float, optional
        Column and row of the lower left corner of each.
    xres : int, optional
        Columns.
    yres : int, optional
        Rows.
    spacing : int
        Pixels between columns.
    background : (float, float, float), optional
        Red, green and blue between pictures.
    anchors : sequence of str, optional
        Which point of each picture stands at its position, such as ``+-``.
    header : bool
        Whether the output has an information header.
    lower_threashold : float, optional
        Values below are transparent.
    upper_threshold : float, optional
        Values above are transparent.
    label : str, optional
        Label of the pictures; their names if empty.
    label_height : int, optional
        Height of labels, pixels.
    ncols : int, optional
        Number of columns, instead of positions.
    anchor_point : sequence of str, optional
        Where the pictures of a row stand.

    Returns
    -------
    bytes
        The picture.

    Raises
    ------
    ValueError
        Without ``ncols`` and a position for each picture.
    """
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
    """Find the darkest and the brightest pixel: ``pextrem``.

    Parameters
    ----------
    pic : path-like or bytes
        A Radiance picture.
    original : bool
        Whether the exposure is undone.
    original_xyze : bool
        The same, in XYZ.

    Returns
    -------
    (xyRGB, xyRGB)
        Column, row and the values of both.
    """
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
    """Convert a picture to or from a portable pixmap: ``ra_ppm``.

    Parameters
    ----------
    inp : path-like or bytes
        A picture; a pixmap with ``reverse``.
    gamma : float
        Gamma of the integer values.
    greyscale : bool
        Whether the result is grey.
    reverse : bool
        Whether the conversion goes the other way.
    exposure : int
        Stops.
    ascii : bool
        Whether the pixmap is text.
    outscale : int
        Largest integer value.

    Returns
    -------
    bytes
        The pixmap or picture.
    """
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
    """Convert a picture to another encoding: ``ra_rgbe``.

    Parameters
    ----------
    inp : path-like or bytes
        A Radiance picture.
    outspec : path-like, optional
        File of the result.
    rle : bool
        Whether run lengths are encoded.
    exposure : int, optional
        Stops.
    force : bool
        Whether an existing file is replaced.
    frameno : int, optional
        Which of several pictures.

    Returns
    -------
    bytes or None
        The picture; ``None`` where ``outspec`` names a file.
    """
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
    """Convert a picture to or from TIFF: ``ra_tiff``.

    Parameters
    ----------
    inp : path-like or bytes
        A picture; a TIFF file with ``reverse``.
    out : str, optional
        File of the result; a TIFF needs one.
    gamma : float
        Gamma of the integer values.
    greyscale : bool
        Whether the result is grey.
    lzw : bool
        Whether LZW compresses.
    sgilog : bool
        Whether LogLuv of 32 bits is written.
    sgilog24 : bool
        The same with 24 bits.
    ieee32 : bool
        Whether floats are written.
    primary : bool
        Whether 16-bit integers of the primaries are written.
    exposure : int
        Stops.
    reverse : bool
        Whether the conversion goes the other way.
    xyze : bool
        Whether a picture from TIFF is in XYZ.

    Returns
    -------
    bytes or None
        The picture; ``None`` where ``out`` names a file.

    Raises
    ------
    ValueError
        If a TIFF is bytes, or has no file.
    """
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
    """Convert a picture to XYZE, or with ``rgbe`` from it: ``ra_xyze``.

    Parameters
    ----------
    inp : path-like or bytes
        A Radiance picture.
    out : path-like, optional
        File of the result.
    rgbe : bool
        Whether the result is RGBE.
    exposure : str, optional
        A factor, or stops with a sign.
    original : bool
        Whether the exposure is undone.
    rle : bool
        Whether run lengths are encoded.
    flat : bool
        Whether the encoding is flat.
    primaries : sequence of float, optional
        Eight chromaticities.

    Returns
    -------
    bytes or None
        The picture; ``None`` where ``out`` names a file.
    """
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
