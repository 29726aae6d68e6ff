"""Builds the wheel: the program first, which goes into it as a script, and then maturin's part.

What `pip install ./bindings/python` calls (PEP 517). Needs a Rust toolchain and nothing else.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import maturin
from maturin import (  # noqa: F401  (pip asks for these)
    build_sdist,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

_HERE = Path(__file__).parent
_SCRIPTS = _HERE / "wheel-data" / "scripts"
# maturin wants the folder before anything is in it.
_SCRIPTS.mkdir(parents=True, exist_ok=True)


def build_wheel(wheel_directory: str, config_settings: Any = None, metadata_directory: str | None = None) -> str:
    _build_program()
    return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory: str, config_settings: Any = None, metadata_directory: str | None = None) -> str:
    _build_program()
    return maturin.build_editable(wheel_directory, config_settings, metadata_directory)


def _build_program() -> None:
    """Puts the program where maturin takes scripts from."""
    command = ["cargo", "build", "--release", "--bin", "radsight", "--message-format", "json-render-diagnostics"]
    # In the program's own workspace, with its own lock file: `cargo build --release` has done it already, maybe.
    built = subprocess.run(command, cwd=_HERE.parents[1], stdout=subprocess.PIPE, check=True)
    messages = (json.loads(line) for line in built.stdout.splitlines() if line.startswith(b"{"))
    programs = [message["executable"] for message in messages if message.get("executable")]
    shutil.rmtree(_SCRIPTS, ignore_errors=True)
    _SCRIPTS.mkdir()
    program = _SCRIPTS / Path(programs[-1]).name
    shutil.copy2(programs[-1], program)
    strip = shutil.which("strip") if os.name == "posix" else None
    if strip is not None:
        subprocess.run([strip, str(program)], check=True)
