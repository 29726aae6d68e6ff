"""Arrays that come out are views of what holds them; arrays that go in are read in place, or converted once."""

import gc
import tracemalloc

import numpy as np
import pytest
import radsight
from radsight import retro

TABLE = """void light lamp 0 0 3 100 100 100
void plastic grey 0 0 5 .5 .4 .3 0 0
lamp ring bulb 0 0 8 0 0 4 0 0 -1 0 .05
grey ring table 0 0 8 0 0 0 0 0 1 0 6
"""
VIEW = radsight.View("-vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 45")
CAMERA = """[camera]
position_m = [0, 0, 3]
direction = [0, 0, -1]
up = [0, 1, 0]
focal_distance_mm = 20
pinhole_diameter_mm = 0.5
pixel_pitch_um = [100, 100]
pixels = [48, 36]
exposure_ms = 10

[sensor]
response = "power-law"
bits = 8
exposure_unit = "uJ/cm2"
k = 3.0
gamma = 0.85
grey_background = 12
grey_max = 255
"""


@pytest.fixture(scope="module")
def scene():
    return radsight.Scene.from_text(TABLE)


@pytest.fixture(scope="module")
def rays():
    return np.array([[x, 0.2, 1, 0.1, 0, -1] for x in np.linspace(-3, 3, 200)])


@pytest.fixture(scope="module")
def holders(scene):
    """Objects with arrays, and the arrays' names."""
    camera = radsight.Capture.from_text(CAMERA, error=0.05)
    job = radsight.RenderJob(samples=2, view=VIEW, columns=40, rows=30)
    return {
        "image": (radsight.render(scene, VIEW, 48, 36, error=0.1), ["radiance_w_per_sr_m2", "relative_error", "samples"]),
        "capture": (camera.expose(scene), ["exposure_j_per_m2", "standard_error_j_per_m2", "grey"]),
        "job": (radsight.MergedJob([radsight.Renderer(scene).run_job(job)]), ["values", "standard_errors"]),
    }


@pytest.mark.parametrize("kind", ["image", "capture", "job"])
def test_arrays_of_pictures_are_read_only_views_that_keep_them_alive(holders, kind):
    holder, names = holders[kind]
    for name in names:
        first, second = getattr(holder, name), getattr(holder, name)
        assert first.ctypes.data == second.ctypes.data and np.shares_memory(first, second), name
        assert first.base is holder and first.flags.c_contiguous and not first.flags.owndata, name
        with pytest.raises(ValueError, match="read-only"):
            first[...] = 0
        with pytest.raises(ValueError, match="WRITEABLE"):
            first.flags.writeable = True
        first.copy()[...] = 0


def test_arrays_outlive_the_name_of_their_picture(scene):
    radiance = radsight.render(scene, VIEW, 64, 48, samples=4).radiance_w_per_sr_m2
    again = radsight.render(scene, VIEW, 64, 48, samples=4)
    gc.collect()
    others = [np.full(radiance.shape, 7, np.float32) for _ in range(100)]
    np.testing.assert_array_equal(radiance, again.radiance_w_per_sr_m2)
    assert len(others) == 100


def test_reading_arrays_takes_no_memory(holders):
    tracemalloc.start()
    try:
        for holder, names in holders.values():
            kept = [getattr(holder, name) for name in names for _ in range(20)]
            held, _ = tracemalloc.get_traced_memory()
            # 20 copies of the smallest array would be 30 kB and more for each name.
            assert held < 20_000, (holder, held)
            del kept
    finally:
        tracemalloc.stop()


def test_answers_of_rays_are_views_of_one_array(scene, rays):
    traced = radsight.Renderer(scene).trace(rays)
    names = ["radiance_w_per_sr_m2", "distance", "point", "normal"]
    bases = {id(getattr(traced, name).base) for name in names}
    assert len(bases) == 1
    assert np.shares_memory(traced.point, traced.point) and traced.distance.shape == (200,)


def test_rays_of_doubles_are_read_in_place(scene, rays):
    many = np.tile(rays, (200, 1))
    renderer = radsight.Renderer(scene)
    renderer.trace(many[:1])
    tracemalloc.start()
    try:
        for given in (many, np.asfortranarray(many), many[::2], many[:, :]):
            tracemalloc.reset_peak()
            before, _ = tracemalloc.get_traced_memory()
            renderer.trace(given)
            _, most = tracemalloc.get_traced_memory()
            assert most - before < given.nbytes / 100
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "convert",
    [
        lambda rays: rays.astype(np.float32).astype(float),
        np.asfortranarray,
        lambda rays: np.repeat(rays, 2, axis=0)[::2],
        lambda rays: np.hstack([rays, rays])[:, :6],
        lambda rays: rays[::-1][::-1],
        lambda rays: rays.astype(">f8"),
        lambda rays: rays.tolist(),
        lambda rays: np.frombuffer(b"\0" + rays.tobytes(), np.uint8)[1:].view(np.float64).reshape(rays.shape),
    ],
    ids=["float32", "Fortran", "rows", "columns", "backward", "big-endian", "list", "unaligned"],
)
def test_rays_of_other_layouts_are_the_same_rays(scene, rays, convert):
    rays = rays.astype(np.float32).astype(float)
    renderer = radsight.Renderer(scene)
    traced, expected = renderer.trace(convert(rays)), renderer.trace(rays)
    np.testing.assert_array_equal(traced.radiance_w_per_sr_m2, expected.radiance_w_per_sr_m2)
    np.testing.assert_array_equal(renderer.trace(rays.astype(np.float32)).point, expected.point)


def test_no_rays_have_no_answers(scene):
    none = np.empty((0, 6))
    traced = radsight.Renderer(scene).trace(none)
    assert len(traced) == 0 and traced.radiance_w_per_sr_m2.shape == (0, 3) and traced.distance.shape == (0,)
    assert radsight.contributions(scene, none, ["lamp"]).shape == (0, 1, 3)


@pytest.mark.parametrize(
    ("given", "error", "said"),
    [
        (np.zeros(6), ValueError, r"rays has shape \(6,\), expected \(n, 6\)"),
        (np.zeros((2, 5)), ValueError, r"rays has shape \(2, 5\), expected \(n, 6\)"),
        (np.zeros((2, 3, 6)), ValueError, r"rays has shape \(2, 3, 6\), expected \(n, 6\)"),
        (np.zeros((2, 6), complex), TypeError, r"rays is an array of complex128, expected an array of numbers of shape \(n, 6\)"),
        (np.full((2, 6), "1"), TypeError, "rays is an array of <U1"),
        ([[1, 2], [3]], TypeError, "rays is list"),
        ("rays.txt", TypeError, "rays is str"),
        (None, TypeError, "rays is NoneType"),
        (np.zeros((2, 6)), ValueError, "ray 0 has no direction"),
    ],
)
def test_wrong_rays_are_named_with_what_was_expected(scene, given, error, said):
    renderer = radsight.Renderer(scene)
    with pytest.raises(error, match=said):
        renderer.trace(given)
    with pytest.raises(error, match=said):
        renderer.contributions(given, ["lamp"])
    if given is not None:
        with pytest.raises(error, match=said):
            renderer.fill_irradiance_cache(given)


def test_other_arguments_are_named_too(holders):
    sensor = radsight.Capture.from_text(CAMERA).sensor
    exposure = holders["capture"][0].exposure_j_per_m2
    np.testing.assert_array_equal(sensor.grey(exposure.T[::-1]), sensor.grey(np.ascontiguousarray(exposure.T[::-1])))
    assert sensor.grey(exposure.astype(np.float32)).shape == exposure.shape and sensor.grey(1e-5).shape == ()
    with pytest.raises(TypeError, match="exposure_j_per_m2 is str"):
        sensor.grey("bright")
    for wrong in (np.nan, np.inf, -1.0):
        with pytest.raises(radsight.RadsightError, match="expected finite values of at least 0"):
            sensor.grey([1e-6, wrong])
    with pytest.raises(ValueError, match=r"grey has shape \(3,\), expected \(4,\), that of exposure"):
        radsight.calibrate(np.ones(4), np.ones(3))
    with pytest.raises(ValueError, match=r"entrance_deg has shape \(1, 2\), expected \(2,\)"):
        retro.coefficient("glass_bead", [100.0], [0.5, 0.2], [[0, 5]])
    assert retro.coefficient("glass_bead", [100.0], [0.5, 0.2], [0, 5]).shape == (2,)
    with pytest.raises(ValueError, match="ask has 'd', expected radiance_w_per_sr_m2"):
        radsight.trace(radsight.Scene.from_text(TABLE), np.ones((1, 6)), "distance")
