"""Programs and their command lines."""

from __future__ import annotations

import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from .._program import run as run_program

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

PathLike = str | Path
Source = str | Path | bytes
Format = Literal["a", "f", "d", "c"]


def run(program: str, *words: Any, stdin: bytes | None = None) -> bytes:
    """Run a program.

    Parameters
    ----------
    program : str
        Its name, such as ``"pcomb"``.
    *words
        Its command line.
    stdin : bytes, optional
        What it reads from standard input.

    Returns
    -------
    bytes
        Its standard output.

    Raises
    ------
    RuntimeError
        With its messages, if it fails.
    """
    return run_program([program, *map(str, words)], stdin)


def option(letter: str, *values: Any) -> list[str]:
    """An option with its values; nothing where one of them is not given."""
    return [] if any(value is None for value in values) else [letter, *map(str, values)]


def attached(letter: str, value: Any) -> list[str]:
    """An option with its value in the same word; nothing for an empty one."""
    return [f"{letter}{value}"] if value else []


def vector(letter: str, values: Any) -> list[str]:
    """An option with a text, a number, or several numbers; nothing where it is not given."""
    if values is None or isinstance(values, str | int | float):
        return option(letter, values)
    return [letter, *map(str, values)]


def repeated(letter: str, values: None | str | Sequence[str]) -> list[str]:
    """An option for one text, or once for each of several."""
    return [word for value in ([values] if isinstance(values, str) else values or []) for word in (letter, value)]


def switches(switches: dict[str, bool]) -> list[str]:
    return [letter for letter, is_on in switches.items() if is_on]


def source_of(source: Source, name_of_stdin: str | None = None) -> tuple[list[str], bytes | None]:
    """The word for an input and what goes to standard input."""
    if isinstance(source, bytes):
        return ([] if name_of_stdin is None else [name_of_stdin]), source
    if isinstance(source, str | Path):
        return [str(source)], None
    raise TypeError(f"expected a path or bytes, not {type(source).__name__}")


@contextmanager
def as_file(source: Source) -> Iterator[str]:
    """A path of what is given, for programs that read a file twice."""
    if not isinstance(source, bytes):
        yield str(source)
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "input"
        path.write_bytes(source)
        yield str(path)


def one_source(words: list[str], stdin: None | bytes, source: Source) -> None | bytes:
    """Adds the word for one of several inputs, of which one may be bytes. Gives what goes to standard input."""
    word, data = source_of(source, "-")
    if data is not None and stdin is not None:
        raise ValueError("two inputs are bytes, expected at most one")
    words += word
    return stdin if data is None else data
