"""Sensors, calibration, retroreflectors, arrays with units, types and documentation."""

import importlib.util
import pathlib
import subprocess
import sys

import numpy as np
import pytest
import radsight
from radsight import retro

GRIPPS = pathlib.Path(__file__).parents[3] / "radiance-scenes" / "gripps"
PACKAGE = pathlib.Path(radsight.__file__).parent
WHITE = "void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2"
VIEW = "-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40"


def test_a_calibration_finds_the_sensors_numbers():
    sensor = radsight.Capture(GRIPPS / "fig10.toml").sensor
    exposure = np.linspace(0, 1.5e-5, 80)  # J/m², up to nearly saturation
    fit = radsight.calibrate(exposure, sensor.grey(exposure).astype(float), unit="J/m2")
    low, high = fit.gamma_interval
    assert low <= 0.85 <= high and fit.unit.lower().startswith("j")
    with pytest.raises(radsight.RadsightError, match="unit"):
        radsight.calibrate(exposure, exposure, unit="furlong")


def test_retroreflectors_are_fitted_to_their_own_values():
    # The number of glass beads is about R_A at 0.5° of observation and normal incidence.
    angles = np.array([0.5, 0.2]), np.array([0.0, 5.0])
    half = retro.coefficient("glass_bead", [100.0], *angles)
    np.testing.assert_allclose(half[0], 100.0, rtol=0.1)
    np.testing.assert_array_equal(half, retro.coefficient("glass_bead", [100.0], *angles, word="sheet"))
    assert half[1] > 3 * half[0] and (half != retro.coefficient("glass_bead", [100.0], *angles, word="paint")).any()
    assert retro.models()["glass_bead"][0] == "r_half"
    observation = np.repeat([0.1, 0.2, 0.33, 0.5, 1.0], 3)
    entrance = np.tile([5.0, 15.0, 30.0], 5)
    values = retro.coefficient("gauss_reciprocal", [0.4, 0.005], observation, entrance)
    found = retro.fit("gauss_reciprocal", observation, entrance, values)
    assert found["rms"] < 1e-4
    np.testing.assert_allclose([found["rho_s"], found["alpha"]], [0.4, 0.005], rtol=1e-3)
    with pytest.raises(radsight.RadsightError, match="no such model"):
        retro.coefficient("no such model", [], observation, entrance)
    with pytest.raises(radsight.RadsightError, match="entrance_deg has shape"):
        retro.coefficient("glass_bead", [100.0], observation, entrance[:3])


def test_exposures_show_themselves_in_false_colour_with_a_scale():
    image = radsight.capture(GRIPPS / "fig10.toml", GRIPPS / "sheet-retro.rad", samples=1)
    png = image._repr_png_()
    width, height = (int.from_bytes(png[place : place + 4], "big") for place in (16, 20))
    rows, columns = image.exposure_j_per_m2.shape
    assert png.startswith(b"\x89PNG") and width > columns and height >= rows
    scene = radsight.Scene.from_text(WHITE)
    assert radsight.render(scene, VIEW, 16, 16, samples=1).false_color_png().startswith(b"\x89PNG")


def test_arrays_have_units():
    pytest.importorskip("xarray")
    pytest.importorskip("pandas")
    from radsight.arrays import to_dataset, to_frame

    scene = radsight.Scene.from_text(WHITE)
    dataset = to_dataset(radsight.render(scene, VIEW, 8, 8, error=0.1))
    assert dataset.radiance.attrs["units"] == "W/(sr m2)" and dataset.radiance.sel(band="green").shape == (8, 8)
    exposed = to_dataset(radsight.capture(GRIPPS / "fig10.toml", GRIPPS / "sheet-retro.rad", samples=1))
    assert exposed.exposure.attrs["units"] == "J/m2" and exposed.grey.dtype == np.uint16
    traced = radsight.Renderer(scene).trace(np.array([[0, 0, 0, 0, 1, 0], [0, 0, 0, 0, -1, 0.0]]))
    frame = to_frame(traced)
    assert list(frame["distance"]) == [7.0, np.inf] and frame["y"][0] == 7.0 and frame["radiance_red_w_per_sr_m2"][0] == 1
    of_irradiance = to_frame(radsight.Renderer(scene, quantity="irradiance").trace(np.array([[0, 0, 0, 0, 1, 0.0]])))
    assert "irradiance_red_w_per_m2" in of_irradiance


def test_what_is_asked_of_rays_comes_as_arrays():
    scene = radsight.Scene.from_text(WHITE)
    heard: list[float] = []
    asked = radsight.trace(scene, np.array([[0, 0, 0, 0, 1, 0.0]]), ["distance", "normal"], progress=heard.append)
    assert set(asked) == {"distance", "normal"} and asked["normal"].shape == (1, 3)
    assert heard[-1] == 1.0
    rays = np.array([[0, 6.9, 0, 0, 1, 0.0]])
    irradiance = radsight.trace(scene, rays, quantity="irradiance", ambient_bounces=1, ambient_accuracy=0.0)
    np.testing.assert_allclose(irradiance["irradiance_w_per_m2"], np.pi, rtol=0.2)
    with pytest.raises(radsight.RadsightError, match="ask has 'radiance_w_per_sr_m2', expected irradiance_w_per_m2"):
        radsight.trace(scene, rays, ["radiance_w_per_sr_m2"], quantity="surface_irradiance")
    traced = radsight.Renderer(scene, quantity="irradiance").trace(rays)
    with pytest.raises(AttributeError, match="irradiance_w_per_m2, not radiance_w_per_sr_m2"):
        traced.radiance_w_per_sr_m2
    with pytest.raises(AttributeError, match="radiance_w_per_sr_m2, not irradiance_w_per_m2"):
        radsight.Renderer(scene).trace(rays).irradiance_w_per_m2


@pytest.mark.parametrize("checker", ["mypy", "pyright"])
def test_types_are_right(checker, tmp_path):
    if importlib.util.find_spec(checker) is None:
        pytest.skip(f"{checker} is not installed")
    if subprocess.run([sys.executable, "-m", checker, "--version"], capture_output=True).returncode != 0:
        pytest.skip(f"{checker} cannot run here: pyright fetches a program at its first run")
    user = tmp_path / "user.py"
    user.write_text(
        "import numpy as np\nimport radsight\n"
        f"scene = radsight.Scene.from_text({WHITE!r})\n"
        f"image: radsight.Image = radsight.render(scene, radsight.View({VIEW!r}), 8, 8, samples=1)\n"
        "total: np.floating = image.radiance_w_per_sr_m2.sum()\n"
        "job = radsight.RenderJob(samples=4, camera='fig14.toml')\n"
        "parts: list[radsight.RenderJob] = job.split(4, (192, 165))\n"
    )
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import radsight\nradsight.Scene.from_text(5)\n")
    words = {"mypy": ["--strict", "--ignore-missing-imports"], "pyright": ["--pythonpath", sys.executable]}[checker]
    run = [sys.executable, "-m", checker, *words]
    good = subprocess.run([*run, str(user)], cwd=tmp_path, capture_output=True, text=True)
    assert good.returncode == 0, good.stdout + good.stderr
    bad = subprocess.run([*run, str(wrong)], cwd=tmp_path, capture_output=True, text=True)
    assert bad.returncode == 1 and "from_text" in bad.stdout, bad.stdout + bad.stderr


def test_the_package_itself_has_types():
    pytest.importorskip("mypy")
    pyright = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable]
    if subprocess.run([*pyright, "--version"], capture_output=True).returncode == 0:
        done = subprocess.run([*pyright, str(PACKAGE)], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout
    # Most of Dask has no types.
    dask = ["--ignore-missing-imports", "--allow-untyped-calls", "--allow-any-generics"]
    run = [sys.executable, "-m", "mypy", "--strict", *dask, "-p", "radsight"]
    done = subprocess.run(run, capture_output=True, text=True, cwd=PACKAGE.parent.parent)
    assert done.returncode == 0, done.stdout


def test_the_types_tell_what_the_package_has(tmp_path):
    pytest.importorskip("mypy")
    allowed = tmp_path / "allowed"
    # Imported for types alone; and a type of letters, which is not one at run time.
    allowed.write_text("radsight\\.(_shortcuts|arrays)\\.(pandas|xarray)\nradsight\\.radiance\\.\\w+\\.Format\n")
    configuration = pathlib.Path(__file__).parents[1] / "pyproject.toml"
    run = [sys.executable, "-m", "mypy.stubtest", "radsight", "--ignore-disjoint-bases", "--ignore-unused-allowlist"]
    run += ["--allowlist", str(allowed), "--mypy-config-file", str(configuration)]
    done = subprocess.run(run, capture_output=True, text=True, cwd=PACKAGE.parent.parent)
    assert done.returncode == 0, done.stdout + done.stderr


def test_public_objects_are_documented_with_examples_that_run():
    import doctest

    for name in radsight.__all__:
        thing = getattr(radsight, name)
        if callable(thing):
            assert thing.__doc__, name
    names = ["radsight", "radsight.own", "radsight.retro", "radsight._shortcuts", "radsight._radsight"]
    tried = 0
    for name in names:
        module = importlib.import_module(name)
        failed, of_module = doctest.testmod(module, optionflags=doctest.NORMALIZE_WHITESPACE)
        assert failed == 0, name
        tried += of_module
    assert tried > 12, tried


@pytest.mark.parametrize("checker", ["mypy", "pyright"])
def test_types_of_the_examples_are_right(checker):
    pytest.importorskip(checker)
    for package in ("matplotlib", "cv2", "skimage"):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{package} is not installed")
    if subprocess.run([sys.executable, "-m", checker, "--version"], capture_output=True).returncode != 0:
        pytest.skip(f"{checker} cannot run here: pyright fetches a program at its first run")
    folder = pathlib.Path(__file__).parents[3] / "examples"
    words = {
        # Not all packages of others have types, and a notebook's cells may repeat imports.
        "mypy": ["--strict", "--ignore-missing-imports", "--allow-untyped-calls"],
        "pyright": ["--pythonpath", sys.executable],
    }[checker]
    examples = sorted([*folder.glob("notebooks/*.py"), *folder.glob("python/*.py")])
    assert len(examples) >= 6
    done = subprocess.run([sys.executable, "-m", checker, *words, *examples], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
