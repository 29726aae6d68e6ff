"""Docstrings of all public objects: numpydoc's form, and examples that run."""

import doctest
import importlib
import importlib.util
import inspect
import pathlib
import pkgutil
import re
import subprocess
import sys
import types

import pytest
import radsight
from radsight import _program

validate = pytest.importorskip("numpydoc.validate")

# Not every object needs an example, a reference to another one, or more than a line, in which quotes may end; a summary may be a
# noun, as that of a property.
NOT_NEEDED = {"EX01", "SA01", "ES01", "GL02", "GL03", "SS05"}
MODULES = ["radsight", "radsight.retro", "radsight.arrays", "radsight.distributed", "radsight.radiance"]
DOCTESTS = ["radsight._radsight", *(module.name for module in pkgutil.walk_packages(radsight.__path__, "radsight."))]


def members(of):
    """Methods and properties of a class that are its own."""
    for name in dir(of):
        owners = [base for base in of.__mro__ if base.__module__.split(".")[0] == "radsight" and name in vars(base)]
        # Fields of data classes are parameters.
        is_field = name in getattr(of, "__dataclass_fields__", {})
        if not name.startswith("_") and owners and not is_field:
            yield name


def public_objects():
    for module_name in MODULES:
        if module_name == "radsight.distributed":
            pytest.importorskip("dask.distributed")
        module = importlib.import_module(module_name)
        for name in module.__all__:
            thing = getattr(module, name)
            if not callable(thing):
                continue
            yield f"{module_name}.{name}", thing
            if inspect.isclass(thing):
                yield from ((f"{module_name}.{name}.{member}", None) for member in members(thing))


def test_docstrings_have_numpydocs_form():
    found, checked = [], 0
    for name, thing in public_objects():
        not_needed = set(NOT_NEEDED)
        if inspect.isclass(thing) and getattr(thing, "_is_protocol", False):
            # Nobody makes one.
            not_needed |= {"PR01"}
        errors = validate.validate(name)["errors"]
        found += [f"{name}: {code} {text}" for code, text in errors if code not in not_needed]
        checked += 1
    assert found == [], "\n".join(found)
    assert checked > 200, checked


def test_the_check_finds_what_is_missing(example_module):
    errors = {code for code, _ in validate.validate("bindings_example.nothing_said")["errors"]}
    assert {"PR01", "RT01"} <= errors


@pytest.fixture
def example_module(monkeypatch):
    """A module with a function that says neither its parameter nor what it returns."""
    module = types.ModuleType("bindings_example")

    def nothing_said(length):
        """Do something."""
        return 2 * length

    nothing_said.__module__ = "bindings_example"
    module.nothing_said = nothing_said
    monkeypatch.setitem(sys.modules, "bindings_example", module)


def has_program():
    try:
        return bool(_program.path())
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("name", DOCTESTS)
def test_examples_run(name):
    if name == "radsight.distributed":
        pytest.importorskip("dask.distributed")
    if name == "radsight.radiance" and not has_program():
        pytest.skip("there is no program")
    failed, _ = doctest.testmod(importlib.import_module(name), optionflags=doctest.NORMALIZE_WHITESPACE)
    assert failed == 0


def test_there_are_examples():
    finder = doctest.DocTestFinder(exclude_empty=True)
    modules = [importlib.import_module(name) for name in DOCTESTS if not name.endswith(".distributed")]
    tests = [test for module in modules for test in finder.find(module) if test.examples]
    assert len(tests) > 14, len(tests)


GUIDE = pathlib.Path(__file__).parents[3] / "docs" / "python.md"

ROOM = """void plastic wall 0 0 5 .5 .5 .5 0 0
void light lamp 0 0 3 10 10 10
void glow sky 0 0 4 1 1 1 0
wall sphere ball 0 0 4 2 5 1.6 1
wall sphere washer_ball 0 0 4 0 0 0 .02
lamp sphere bulb 0 0 4 2 1 5 .3
sky source up 0 0 4 0 0 1 180
"""

CAMERA = """[camera]
position_m = [0, 0, 0.5]
direction = [0, 0, -1]
up = [0, 1, 0]
pixels = [12, 10]
pixel_pitch_um = [400, 400]
focal_distance_mm = 6.75
pinhole_diameter_mm = 0.1
exposure_ms = 10
wavelength_nm = 550

[sensor]
response = "emva1288"
quantum_efficiency = 0.6
gain_dn_per_e = 0.25
dark_offset_dn = 20
full_well_e = 10000
read_noise_e = 5
bits = 12
"""

POSES = """name,move washer_*,camera.exposure_ms
a,-t .01 0 0,
b,-t -.03 0 0,5
"""


def snippets():
    return re.findall(r"^```python\n(.*?)^```", GUIDE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def test_the_snippets_of_the_guide_run(tmp_path, monkeypatch):
    for package in ("xarray", "pandas"):
        pytest.importorskip(package)
    for name, text in {"office.rad": ROOM, "fig14.toml": CAMERA, "poses.csv": POSES}.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    names = {"view": "-vp 2 1 1.6 -vd 0 1 0 -vh 60 -vv 40"}
    has_bar = importlib.util.find_spec("tqdm") is not None
    for snippet in snippets():
        if has_bar or "import tqdm" not in snippet:
            exec(snippet.replace("640, 480", "32, 24"), names)
    assert len(snippets()) > 4


def test_modules_with_optional_packages_are_imported_at_first_use():
    program = "import sys, radsight; assert 'radsight.arrays' not in sys.modules; print(radsight.arrays.to_frame.__name__)"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == "to_frame\n"
    with pytest.raises(AttributeError, match="nothing"):
        radsight.nothing
