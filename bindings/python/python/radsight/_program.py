"""The program that comes with the wheel."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from pathlib import Path

_NAME = "radsight.exe" if os.name == "nt" else "radsight"


def path() -> str:
    """Where the program is: where ``RADSIGHT_PROGRAM`` says, beside this Python's scripts, or on ``PATH``.

    Returns
    -------
    str

    Raises
    ------
    FileNotFoundError
        If it is in none of these places.
    """
    named = os.environ.get("RADSIGHT_PROGRAM")
    if named:
        return named
    schemes = [sysconfig.get_default_scheme(), sysconfig.get_preferred_scheme("user")]
    folders = [Path(sysconfig.get_path("scripts", scheme)) for scheme in schemes]
    # Beside the packages of `pip install --target`.
    folders.append(Path(__file__).parents[1] / "bin")
    for folder in folders:
        if (folder / _NAME).is_file():
            return str(folder / _NAME)
    found = shutil.which(_NAME)
    if found is None:
        raise FileNotFoundError(f"the program radsight is in none of {', '.join(map(str, folders))}, nor on PATH")
    return found


def run(words: Sequence[str], standard_input: bytes | None = None, *, keep_stderr: bool = False) -> bytes:
    """What the program writes to standard output.

    Raises
    ------
    RuntimeError
        With its messages, if it fails.
    """
    stderr = None if keep_stderr else subprocess.PIPE
    done = subprocess.run([path(), *words], input=standard_input, stdout=subprocess.PIPE, stderr=stderr, check=False)
    if done.returncode != 0:
        said = (done.stderr or b"").decode(errors="replace")
        raise RuntimeError(f"{words[0]} ended with exit code {done.returncode}: {said}")
    return done.stdout


def main() -> int:
    """Run the program with the words of this process."""
    return subprocess.run([path(), *sys.argv[1:]], check=False).returncode
