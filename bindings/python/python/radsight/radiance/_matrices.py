"""Matrices of flux and daylight."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from ._command import (
    Format,
    PathLike,
    Source,
    attached,
    one_source,
    option,
    repeated,
    run,
    source_of,
    switches,
    vector,
)


def rfluxmtx(
    receiver: PathLike,
    surface: None | PathLike = None,
    rays: None | bytes = None,
    params: None | Sequence[str] = None,
    octree: None | PathLike = None,
    scene: None | Sequence[PathLike] = None,
) -> bytes:
    """Compute flux transfer matrices: ``rfluxmtx``.

    Parameters
    ----------
    receiver : path-like
        Scene file of the receivers.
    surface : path-like, optional
        Scene file of the sender; without it ``rays``.
    rays : bytes, optional
        Origins and directions.
    params : sequence of str, optional
        Further options, word by word.
    octree : path-like, optional
        An octree of the scene.
    scene : sequence of path-like, optional
        Scene files.

    Returns
    -------
    bytes
        The matrix, or nothing where the receivers name files.
    """
    sender = "-" if surface is None else str(surface)
    words = [*(params or []), sender, receiver, *option("-i", octree), *(scene or [])]
    return run("rfluxmtx", *words, stdin=rays)


def rmtxop(
    inp: Source,
    outform: Literal["a", "f", "d", "c"] = "a",
    transpose: bool = False,
    scale: None | float = None,
    transform: None | str | Sequence[float] = None,
    reflectance: None | str = None,
) -> bytes:
    """Change a matrix: ``rmtxop``.

    Parameters
    ----------
    inp : path-like or bytes
        The matrix, in Radiance's format.
    outform : {"a", "f", "d", "c"}
        ``a`` text, ``f`` floats, ``d`` doubles, ``c`` a picture.
    transpose : bool
        Whether rows become columns.
    scale : float, optional
        A factor.
    transform : str or sequence of float, optional
        Factors of the components (``-c``), a row after the other, or a name such as ``XYZ``.
    reflectance : str, optional
        Side of a BSDF file: ``front`` or ``back``.

    Returns
    -------
    bytes
        The matrix.
    """
    word, stdin = source_of(inp, "-")
    words = [*switches({"-t": transpose}), f"-f{outform}", *option("-s", scale), *vector("-c", transform)]
    words += attached("-r", (reflectance or "")[:1])
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
    """Multiply daylight matrices: ``dctimestep``.

    Parameters
    ----------
    *mtx : path-like or bytes
        Files of 1 to 4 matrices; the last may be bytes.
    nstep : int, optional
        Number of time steps.
    header : bool
        Whether the output has an information header.
    xres : int, optional
        Columns.
    yres : int, optional
        Rows.
    inform : str, optional
        Format of a sky without a header: ``a``, ``f`` or ``d``.
    outform : str, optional
        ``a``, ``f``, ``d`` or ``c``.
    ospec : str, optional
        Files of the results, with a place for a number.

    Returns
    -------
    bytes or None
        The product; ``None`` where ``ospec`` names files.

    Raises
    ------
    ValueError
        With no matrix or more than four, or if another than the last is bytes.
    """
    if not 1 <= len(mtx) <= 4:
        raise ValueError(f"{len(mtx)} matrices, expected 1 to 4")
    if any(isinstance(matrix, bytes) for matrix in mtx[:-1]):
        raise ValueError("only the last matrix may be bytes")
    last, stdin = source_of(mtx[-1])
    words = [*option("-n", nstep), *switches({"-h": not header}), *option("-x", xres), *option("-y", yres)]
    words += [*attached("-i", inform), *attached("-o", outform)]
    said = run("dctimestep", *words, *option("-o", ospec), *mtx[:-1], *last, stdin=stdin)
    return None if ospec else said


class Rmtxop:
    """Combine matrices: ``rmtxop``.

        Add them with `add_input`, then call it for the bytes of the result.

    Parameters
    ----------
    outform : {"a", "f", "d", "c"}
        ``a`` text, ``f`` floats, ``d`` doubles, ``c`` a picture.
    color : str, optional
        Must be ``None``, as ``rmtxop`` has no such option: see ``transform`` of `add_input`.
    """

    def __init__(self, outform: Format = "a", color: None | str = None) -> None:
        _check_no_color(color)
        self._words, self._inputs = [f"-f{outform}"], 0
        self._stdin: None | bytes = None

    def add_input(
        self,
        input_data: Source,
        op: Literal["*", "/", "+", "."] = ".",
        scale: None | float | Sequence[float] = None,
        transform: None | str | Sequence[float] = None,
        transpose: bool = False,
        refl_side: None | str = None,
        color: None | str = None,
    ) -> Rmtxop:
        """Add a matrix, and say by which operation it joins those before.

        Parameters
        ----------
        input_data : path-like or bytes
            The matrix, in Radiance's format.
        op : {"*", "/", "+", "."}
            Of the first matrix it does not count.
        scale : float or sequence of float, optional
            A factor, or one for each component.
        transform : str or sequence of float, optional
            Factors of the components (``-c``), a row after the other, or a name such as ``XYZ``.
        transpose : bool
            Whether rows become columns.
        refl_side : str, optional
            Side of a BSDF file: ``front`` or ``back``.
        color : str, optional
            Must be ``None``.

        Returns
        -------
        Rmtxop
            This object, for the next call.

        Raises
        ------
        ValueError
            If a second matrix is bytes.
        """
        _check_no_color(color)
        self._words += [op] if self._inputs else []
        self._words += [*vector("-s", scale), *attached("-r", (refl_side or "")[:1])]
        self._words += [*switches({"-t": transpose}), *vector("-c", transform)]
        self._stdin = one_source(self._words, self._stdin, input_data)
        self._inputs += 1
        return self

    def __call__(self) -> bytes:
        return run("rmtxop", *self._words, stdin=self._stdin)


def _check_no_color(color: None | str) -> None:
    if color is not None:
        raise ValueError("rmtxop has no option -C; expected transform")


class Rcomb:
    """Combine matrices row by row: ``rcomb``.

        Add them with `add_input`, then call it for the bytes of the result.

    Parameters
    ----------
    transform : str, optional
        Of the first input's components (``-c``).
    transform_all : str, optional
        Of all inputs' components (``-C``).
    source : str, optional
        A file of functions (``-f``).
    expression : str, optional
        Definitions of the result ``co`` (``-e``).
    concat : sequence of str, optional
        Matrices that the result is multiplied with (``-m``).
    outform : {"a", "f", "d", "c"}, optional
        ``a``, ``f``, ``d`` or ``c``.
    header : bool
        Whether the output has an information header.
    silent : bool
        Whether warnings are left out.
    """

    def __init__(
        self,
        transform: None | str = None,
        transform_all: None | str = None,
        source: None | str = None,
        expression: None | str = None,
        concat: None | Sequence[str] = None,
        outform: None | Format = None,
        header: bool = True,
        silent: bool = False,
    ) -> None:
        words = [*switches({"-h": not header, "-w": silent}), *option("-e", expression)]
        words += [*repeated("-m", concat), *option("-C", transform_all), *option("-f", source)]
        self._words = [*words, *attached("-f", outform), *option("-c", transform)]
        self._stdin: None | bytes = None

    def add_input(
        self, input: Source, transform: None | str = None, scale: None | Sequence[float] = None
    ) -> Rcomb:
        """Add a matrix.

        Parameters
        ----------
        input : path-like or bytes
            The matrix, in Radiance's format.
        transform : str, optional
            Of its components (``-c``).
        scale : sequence of float, optional
            Factors of its components.

        Returns
        -------
        Rcomb
            This object, for the next call.

        Raises
        ------
        ValueError
            If a second matrix is bytes.
        """
        self._words += [*option("-c", transform), *vector("-s", scale)]
        self._stdin = one_source(self._words, self._stdin, input)
        return self

    def __call__(self) -> bytes:
        return run("rcomb", *self._words, stdin=self._stdin)


def rcollate(
    inp: Source,
    header: bool = True,
    warn: bool = True,
    inform: Format = "a",
    ncomp: int = 3,
    nrows: None | int = None,
    ncols: None | int = None,
    orows: None | int = None,
    ocols: None | int = None,
    transpose: bool = False,
) -> bytes:
    """Reorder a matrix: ``rcollate``.

    Parameters
    ----------
    inp : path-like or bytes
        The matrix, in Radiance's format.
    header : bool
        Whether input and output have headers.
    warn : bool
        Whether warnings are printed.
    inform : {"a", "f", "d", "c"}
        Format of the elements: ``a``, ``f`` or ``d``.
    ncomp : int
        Components of an element.
    nrows : int, optional
        Rows of the input.
    ncols : int, optional
        Columns of it.
    orows : int, optional
        Rows of the output.
    ocols : int, optional
        Columns of it.
    transpose : bool
        Whether rows become columns.

    Returns
    -------
    bytes
        The matrix.
    """
    words = switches({"-h": not header, "-w": not warn})
    words += [] if (inform, ncomp) == ("a", 3) else [f"-f{inform}{'' if ncomp == 1 else ncomp}"]
    words += [*switches({"-t": transpose}), *option("-ir", nrows), *option("-ic", ncols)]
    words += [*option("-or", orows), *option("-oc", ocols)]
    word, stdin = source_of(inp, "-")
    return run("rcollate", *words, *word, stdin=stdin)
