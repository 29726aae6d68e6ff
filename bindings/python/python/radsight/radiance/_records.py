"""Headers, and numbers in columns."""

from __future__ import annotations

from pathlib import Path

from ._command import Source, attached, one_source, option, run, source_of, switches


def getinfo(
    *inputs: Source,
    dimension_only: bool = False,
    dimension: bool = False,
    strip_header: bool = False,
    replace: str = "",
    append: str = "",
    command: str = "",
) -> bytes:
    """Read or change headers: ``getinfo``.

    Parameters
    ----------
    *inputs : path-like or bytes
        Files, or the bytes of one.
    dimension_only : bool
        Whether to output only the sizes of pictures.
    dimension : bool
        Whether sizes follow the headers.
    strip_header : bool
        Whether the header is left out and the rest kept.
    replace : str
        Lines to put in the place of those with the same variable.
    append : str
        Lines to add.
    command : str
        A command that changes the header.

    Returns
    -------
    bytes
        Headers, or the file with its new header.

    Raises
    ------
    ValueError
        If several inputs are to lose their headers.
    """
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
    words = [*words, *option("-c", command or None)]
    if len(inputs) == 1 and (strip_header or isinstance(inputs[0], bytes)):
        source = inputs[0]
        data = source if isinstance(source, bytes) else Path(source).read_bytes()
        return run("getinfo", *words, *switches({"-": strip_header}), stdin=data)
    if strip_header:
        raise ValueError(f"{len(inputs)} inputs, expected one where its header is stripped")
    if any(isinstance(source, bytes) for source in inputs):
        raise TypeError("bytes beside other inputs")
    return run("getinfo", *words, *inputs)


def get_header(inp: Source, dimension: bool = False) -> bytes:
    """Read the header of a picture, matrix or octree.

    Parameters
    ----------
    inp : path-like or bytes
        The file.
    dimension : bool
        Whether to output only the size.

    Returns
    -------
    bytes
        The header.
    """
    word, stdin = source_of(inp)
    return run("getinfo", *switches({"-d": dimension}), *word, stdin=stdin)


def cnt(*dims: int, shuffled: bool = False) -> bytes:
    """Count: ``cnt``.

    Parameters
    ----------
    *dims : int
        How far each column counts.
    shuffled : bool
        Whether the order is random.

    Returns
    -------
    bytes
        A line for each combination.
    """
    return run("cnt", *switches({"-s": shuffled}), *dims)


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
    """Sum columns: ``total``.

    Parameters
    ----------
    inp : path-like or bytes, optional
        Numbers in columns.
    mean : bool
        Whether means are taken instead of sums.
    sumpower : int
        Exponent of a power sum.
    multiply : bool
        Whether products are taken.
    find_max : bool
        Whether largest values are taken.
    find_min : bool
        Whether smallest values are taken.
    inform : str, optional
        Format of the input: ``f`` or ``d``; text if not given.
    incount : int
        Columns of a binary record.
    outform : str, optional
        Format of the output.
    substep : int, optional
        Records for each subtotal.
    substep_reset : bool
        Whether a subtotal starts anew.
    inlimit : int, optional
        Number of records read at most.
    outlimit : int, optional
        Number of results written at most.
    sep : str, optional
        The character between columns.

    Returns
    -------
    bytes
        A number for each column.
    """
    word, stdin = source_of(inp if inp is not None else b"")
    words = switches({"-m": mean, "-p": multiply, "-u": find_max, "-l": find_min})
    words += [*attached("-s", sumpower), *_formats(inform, incount, outform)]
    words += [f"-{substep}{'' if substep_reset else 'r'}"] if substep else []
    words += [*option("-in", inlimit), *option("-on", outlimit)]
    words += attached("-t", sep)
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
    """Calculate with columns: ``rcalc``.

    Parameters
    ----------
    inp : path-like or bytes
        Records.
    sep : str, optional
        The character between columns.
    inform : str, optional
        Format of the input: ``f`` or ``d``; text if not given.
    incount : int
        Columns of a binary record.
    outform : str, optional
        Format of the output.
    passive : bool
        Whether records pass unchanged where a condition holds (``-p``).
    pass_negative : bool
        Whether they pass where it does not (``-P``).
    inlimit : int, optional
        Number of records read at most.
    outlimit : int, optional
        Number of records written at most.
    source : str, optional
        File of definitions (``-f``).
    expr : str, optional
        Definitions such as ``$1=$1+$2`` (``-e``).
    assign : str, optional
        Strings assigned (``-s``).
    exact_only : bool
        Whether blanks in formats must match (``-b``).
    ignore_newlines : bool
        Whether line ends count as blanks (``-l``).
    silent : bool
        Whether warnings are left out (``-w``).

    Returns
    -------
    bytes
        Records.
    """
    word, stdin = source_of(inp)
    words = [*attached("-t", sep), *_formats(inform, incount, outform)]
    words += switches({"-p": passive, "-P": pass_negative and not passive})
    words += [*option("-in", inlimit), *option("-on", outlimit), *option("-f", source)]
    words += [*option("-e", expr), *option("-s", assign)]
    words += switches({"-b": exact_only, "-l": ignore_newlines, "-w": silent})
    return run("rcalc", *words, *word, stdin=stdin)


def rlam(*inputs: Source) -> bytes:
    """Join records of several inputs side by side: ``rlam``.

    Parameters
    ----------
    *inputs : path-like or bytes
        Files, of which one may be bytes.

    Returns
    -------
    bytes
        Records.
    """
    words: list[str] = []
    stdin = None
    for source in inputs:
        stdin = one_source(words, stdin, source)
    return run("rlam", *words, stdin=stdin)


def _formats(inform: None | str, incount: int, outform: None | str) -> list[str]:
    """The formats of records that are read and written."""
    count = incount if incount > 1 else ""
    return [*attached("-i", inform and f"{inform}{count}"), *attached("-o", outform)]
