"""Files that are written."""

from __future__ import annotations

from pathlib import Path


def write(file_path: str | Path, data: str | bytes, overwrite: bool = True, mode: str = "wb") -> str:
    """Write a file.

    Parameters
    ----------
    file_path : str or path-like
        Name of the file.
    data : str or bytes
        Its content; text needs ``mode="w"``.
    overwrite : bool
        Whether an existing file is replaced.
    mode : str
        As for `open`.

    Returns
    -------
    str
        Name of the file.

    Raises
    ------
    FileExistsError
        If it exists and is not to be replaced.
    """
    if not overwrite and Path(file_path).exists():
        raise FileExistsError(f"{file_path} exists, and overwrite is False")
    with open(file_path, mode) as file:
        file.write(data)
    return str(file_path)
