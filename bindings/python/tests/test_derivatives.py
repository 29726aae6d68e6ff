"""Derivatives of captures: analytic cases, units and shapes, mistakes, the Fisher information."""

import numpy as np
import pytest
import radsight

CAMERA = """[camera]
position_m = [0, 0, 0.5]
direction = [0, 0, -1]
up = [0, 1, 0]
pixels = [12, 10]
pixel_pitch_um = [200, 200]
focal_distance_mm = 6.75
pinhole_diameter_mm = 0.1
exposure_ms = 10
"""
SENSOR = """
[sensor]
response = "power-law"
k = 33844.0
gamma = 0.85
grey_background = 12
grey_max = 161
exposure_unit = "uJ/cm2"
bits = 8
"""
DISK = "void glow white 0 0 4 1 1 1 0 white ring disk 0 0 8 .01 0 0 0 0 1 0 .03"


@pytest.fixture
def scene():
    return radsight.Scene.from_text(DISK)


def camera(**settings):
    return radsight.Capture.from_text(CAMERA + SENSOR, error=0.01, **settings)


def test_shapes_units_and_errors(scene):
    heard: list[float] = []
    names = ["disk.x", "disk.rz", "exposure.time"]
    exposed = radsight.CaptureDerivatives(scene).expose(camera(), names, error=0.05, progress=heard.append)
    assert exposed.parameters == names and exposed.units == ["m", "degree", "s"] and heard[-1] == 1.0
    assert exposed.exposure_j_per_m2.shape == (10, 12)
    for array in (exposed.derivative_j_per_m2_per_unit, exposed.standard_error_j_per_m2_per_unit):
        assert array.shape == (3, 10, 12) and not array.flags.writeable and array.dtype == np.float64
    assert exposed.relative_error[0] <= 0.05 and all(step > 0 for step in exposed.step) and all(rays > 0 for rays in exposed.rays)
    # A turn of one degree about its own axis changes nothing.
    assert abs(exposed.derivative_j_per_m2_per_unit[1]).max() < 1e-3 * exposed.exposure_j_per_m2.max()


def test_exposure_is_proportional_to_its_time(scene):
    exposed = radsight.CaptureDerivatives(scene).expose(camera(), ["exposure.time"], error=0.01)
    by_time, error = exposed.derivative_j_per_m2_per_unit[0], exposed.standard_error_j_per_m2_per_unit[0]
    expected = exposed.exposure_j_per_m2 / 0.01
    assert (abs(by_time - expected) < 4 * error + 0.03 * expected.max()).all()
    assert abs(by_time.sum() / expected.sum() - 1) < 0.01


def test_a_disk_moves_as_its_pictures_do(scene):
    step = 0.002
    exposed = radsight.CaptureDerivatives(scene).expose(camera(), ["disk.y"], error=0.01)
    sides = [
        camera().expose(radsight.Scene.from_text(DISK.replace(".01 0 0 0 0 1", f".01 {y} 0 0 0 1"))).exposure_j_per_m2 for y in (-step, step)
    ]
    difference = (sides[1] - sides[0]) / (2 * step)
    by_y = exposed.derivative_j_per_m2_per_unit[0]
    assert np.sqrt(((by_y - difference) ** 2).mean() / (difference**2).mean()) < 0.1
    assert abs((by_y * difference).sum() / (difference**2).sum() - 1) < 0.03


def test_fisher_information_is_that_of_the_formula(scene):
    derivatives = radsight.CaptureDerivatives(scene)
    exposed = derivatives.expose(camera(), ["disk.x", "disk.y"], error=0.02)
    fisher = exposed.fisher_information()
    assert fisher.parameters == ["disk.x", "disk.y"] and fisher.units == ["m", "m"]
    assert fisher.matrix.shape == (2, 2) and np.allclose(fisher.matrix, fisher.matrix.T)
    np.testing.assert_allclose(fisher.deviations_alone, np.diag(fisher.matrix) ** -0.5)
    np.testing.assert_allclose(fisher.deviations_together, np.sqrt(np.diag(np.linalg.inv(fisher.matrix))))
    # dG/dE of G = K E^gamma + G0, with E in uJ/cm2; rounding to grey levels has the variance 1/12.
    exposure = 100 * exposed.exposure_j_per_m2
    lit = exposure > 0
    slope = np.zeros_like(exposure)
    slope[lit] = 100 * 33844.0 * 0.85 * exposure[lit] ** (0.85 - 1)
    by_x, by_y = exposed.derivative_j_per_m2_per_unit
    error = exposed.standard_error_j_per_m2_per_unit[0]
    np.testing.assert_allclose(fisher.matrix[0, 0], 12 * (slope**2 * (by_x**2 - error**2)).sum(), rtol=1e-6)
    np.testing.assert_allclose(fisher.matrix[0, 1], 12 * (slope**2 * by_x * by_y).sum(), rtol=1e-6)


def test_a_dark_picture_tells_nothing():
    dark = radsight.Scene.from_text(DISK.replace("4 1 1 1 0", "4 0 0 0 0"))
    fisher = radsight.CaptureDerivatives(dark).expose(camera(), ["disk.x"], error=0.05).fisher_information()
    assert np.isinf(fisher.deviations_alone[0]) and fisher.deviations_together is None


def test_mistakes_name_what_was_expected(scene):
    for names, expected in (([], "at least 1"), (["disk.x", "disk.x"], "given twice")):
        with pytest.raises(radsight.RadsightError, match=expected):
            radsight.CaptureDerivatives(scene).expose(camera(), names)
    with pytest.raises(radsight.RadsightError, match="both error and samples are given"):
        camera(samples=3)
    with pytest.raises(radsight.RadsightError, match="threads is 0, expected at least 1"):
        camera(threads=0)
    with pytest.raises(radsight.RadsightError, match='^key "foo": expected a table and a key'):
        camera().with_keys({"foo": "1"})
    derivatives = radsight.CaptureDerivatives(scene)
    with pytest.raises(radsight.RadsightError, match='did you mean "distance"'):
        derivatives.expose(camera(), ["distanse"])
    with pytest.raises(radsight.RadsightError, match="washer"):
        derivatives.expose(camera(), ["washer.x"])
    with pytest.raises(radsight.RadsightError, match="above 0"):
        derivatives.expose(camera(), ["disk.x"], error=0.0)
    without = radsight.Capture.from_text(CAMERA, error=0.05)
    with pytest.raises(radsight.RadsightError, match="sensor"):
        derivatives.expose(without, ["disk.x"], error=0.2).fisher_information()
