"""Scripts of `examples/python`, where the packages that they need are installed."""

import importlib
import os
import pathlib
import sys

import pytest


def test_the_nine_points_of_bifacial_radiance_have_its_irradiances(monkeypatch):
    pytest.importorskip("bifacial_radiance")
    pytest.importorskip("pyradiance")
    monkeypatch.setattr(sys, "path", [str(pathlib.Path(__file__).parents[3] / "examples" / "python"), *sys.path])
    for name in ("PATH", "RAYPATH"):
        monkeypatch.setenv(name, os.environ.get(name, ""))
    example = importlib.import_module("bifacial_nine_points")
    example.radiance_on_path()
    assert example.compare("low") < 0.05
