"""The bindings: values, errors, threads and equality with the program."""

import os
import pathlib
import pickle
import subprocess

import numpy as np
import pytest
import radsight

ROOT = pathlib.Path(__file__).parents[3]
GRIPPS = ROOT / "radiance-scenes" / "gripps"
TABLE = """void light lamp 0 0 3 100 100 100
void plastic grey 0 0 5 .5 .4 .3 0 0
lamp ring bulb 0 0 8 0 0 4 0 0 -1 0 .05
grey ring table 0 0 8 0 0 0 0 0 1 0 6
"""


def test_radiance_follows_the_inverse_square_law():
    scene = radsight.Scene.from_text(TABLE)
    traced = radsight.Renderer(scene).trace(np.array([[0, 0, 1, 0, 0, -1.0]]))
    expected = np.array([0.5, 0.4, 0.3]) * 100 * 0.05**2 / 16
    np.testing.assert_allclose(traced.radiance_w_per_sr_m2[0], expected, rtol=1e-3)
    np.testing.assert_allclose(traced.point[0], [0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(np.abs(traced.normal[0]), [0, 0, 1])


def test_contributions_add_up():
    scene = radsight.Scene.from_text(TABLE)
    rays = np.array([[0.5, 0, 1, 0, 0, -1.0], [1, 1, 1, 0, 0, -1.0]])
    renderer = radsight.Renderer(scene)
    parts = renderer.contributions(rays, ["lamp", "nobody"])
    assert parts.shape == (2, 2, 3)
    np.testing.assert_allclose(parts.sum(axis=1), renderer.trace(rays).radiance_w_per_sr_m2, rtol=0.02)


def test_mistakes_have_line_and_caret():
    with pytest.raises(radsight.SceneError, match=r"<text>:1:1: error: undefined modifier \"chrome\"") as raised:
        radsight.Scene.from_text("chrome sphere ball 0 0 4 0 0 0 1")
    assert "^" in str(raised.value)
    file, line, column, message = raised.value.mistakes[0]
    assert (file, line, column) == ("<text>", 1, 1) and "chrome" in message
    with pytest.raises(radsight.RadsightError):
        radsight.View("-vp 1 2")
    with pytest.raises(radsight.RadsightError, match=r"rays has shape \(2, 5\), expected \(n, 6\)"):
        radsight.Renderer(radsight.Scene.from_text(TABLE)).trace(np.zeros((2, 5)))
    with pytest.raises(radsight.RadsightError, match="ray 1"):
        radsight.Renderer(radsight.Scene.from_text(TABLE)).trace(np.array([[0, 0, 1, 0, 0, -1.0], [0] * 6]))


@pytest.mark.parametrize("number", [-3, 2**70])
def test_numbers_that_do_not_fit_are_named_with_their_range(number):
    scene = radsight.Scene.from_text(TABLE)
    view = radsight.View("-vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 45")
    renderer = radsight.Renderer(scene)
    job = radsight.RenderJob(samples=1, view=view, columns=8, rows=8)
    calls = {
        "columns": lambda: renderer.render(view, number, 8),
        "rows": lambda: renderer.render(view, 8, number),
        "samples": lambda: radsight.Renderer(scene, samples=number),
        "ambient_bounces": lambda: radsight.Renderer(scene, ambient_bounces=number),
        "seed": lambda: radsight.Renderer(scene, seed=number),
        "threads": lambda: radsight.Renderer(scene, threads=number),
        "first": lambda: renderer.trace([[0, 0, 1, 0, 0, -1]], first=number),
        "parts": lambda: job.split(number),
        "columns of size": lambda: job.split(2, (number, 1)),
    }
    for name, call in calls.items():
        with pytest.raises(ValueError, match=f"{name} is {number}, expected a whole number of 0 to [0-9]+"):
            call()
    with pytest.raises(TypeError, match="columns"):
        renderer.render(view, "many", 8)


def test_threads_change_nothing():
    scene = radsight.Scene.from_text(TABLE)
    view = radsight.View("-vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 45")
    images = [
        radsight.Renderer(scene, ambient_bounces=1, error=0.05, threads=threads).render(view, 48, 36)
        for threads in (1, 2)
    ]
    np.testing.assert_array_equal(images[0].radiance_w_per_sr_m2, images[1].radiance_w_per_sr_m2)
    assert images[0].error <= 0.05
    assert images[0]._repr_png_().startswith(b"\x89PNG")


def test_progress_can_stop_the_work():
    heard = []

    def stop(done):
        heard.append(done)
        raise KeyboardInterrupt

    view = radsight.View("-vp 0 -4 3 -vd 0 4 -3")
    with pytest.raises(KeyboardInterrupt):
        radsight.Renderer(radsight.Scene.from_text(TABLE)).render(view, 16, 400, progress=stop)
    assert len(heard) == 1


def test_captures_and_pictures_equal_the_programs(tmp_path):
    program = os.environ.get("RADSIGHT_PROGRAM")
    if not program:
        pytest.skip("RADSIGHT_PROGRAM names no program")
    camera, sheet = str(GRIPPS / "fig10.toml"), str(GRIPPS / "sheet-retro.rad")
    npy = tmp_path / "exposure.npy"
    subprocess.run([program, "capture", camera, sheet, "--samples", "2", "--exposure", npy], check=True)
    image = radsight.Capture(camera, samples=2).expose(sheet)
    exposure = np.load(npy).reshape(image.exposure_j_per_m2.shape)
    np.testing.assert_array_equal(image.exposure_j_per_m2.astype(np.float32), exposure)
    assert image.grey.dtype == np.uint16


def test_rays_equal_the_programs(tmp_path):
    program = os.environ.get("RADSIGHT_PROGRAM")
    if not program:
        pytest.skip("RADSIGHT_PROGRAM names no program")
    (tmp_path / "table.rad").write_text(TABLE)
    rays = np.array([[x, y, 1, 0.2, 0.1, -1] for x in np.linspace(-3, 3, 40) for y in np.linspace(-2, 2, 25)])
    cached = ["-ab", "1", "-aa", ".2", "-ad", "512", "-as", "128"]
    for options, words in (({}, []), ({"quantity": "irradiance"}, ["-I"]), ({"ambient_bounces": 1}, cached)):
        command = [program, "rtrace", "-h", "-fdd", *words, str(tmp_path / "table.rad")]
        run = subprocess.run(command, input=rays.tobytes(), capture_output=True, check=True)
        (own,) = radsight.trace(radsight.Scene.load(tmp_path / "table.rad"), rays, **options).values()
        np.testing.assert_array_equal(own, np.frombuffer(run.stdout).reshape(-1, 3))


def test_pages_hold_values_error_and_time():
    scene = radsight.Scene.from_text(TABLE)
    view = radsight.View("-vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 45")
    image = radsight.Renderer(scene, error=0.05).render(view, 48, 36)
    relative = image.relative_error
    assert relative.shape == image.samples.shape == image.radiance_w_per_sr_m2.shape[:2]
    np.testing.assert_allclose(np.sqrt(np.mean(relative.astype(float) ** 2)), image.error, rtol=1e-4)
    page = image.report_html(title="<script>")
    assert page.startswith("<!DOCTYPE html>") and "<h1>&lt;script&gt;</h1>" in page
    for said in ("luminance", "relative standard error", "rays per pixel", "rendering", "Skipped"):
        assert said in page
    preview = radsight.Renderer(scene).render(view, 48, 36)
    assert preview.relative_error is None and preview.samples is None
    assert "The input has no error map" in preview.report_html()


def test_pages_of_captures_have_grey_values():
    captured = radsight.Capture(str(GRIPPS / "fig10.toml"), error=0.1).expose(str(GRIPPS / "sheet-retro.rad"))
    error = captured.standard_error_j_per_m2
    assert error.shape == captured.exposure_j_per_m2.shape
    of_map = np.sqrt(np.mean(error**2)) / captured.exposure_j_per_m2.mean()
    np.testing.assert_allclose(of_map, captured.estimated_error, rtol=1e-9)
    page = captured.report_html()
    for said in ("J/m²", "sensor&#39;s grey value", "standard error", "scene read and exposed"):
        assert said in page


def test_no_memory_is_lost_over_many_calls():
    resource = pytest.importorskip("resource")
    renderer = radsight.Renderer(radsight.Scene.from_text(TABLE), threads=1)
    rays = np.tile(np.array([[0, 0, 1, 0, 0, -1.0]]), (1000, 1))
    view = radsight.View("-vp 0 -4 3 -vd 0 4 -3")

    def work():
        renderer.trace(rays).radiance_w_per_sr_m2.sum()
        renderer.render(view, 8, 8)._repr_png_()

    for _ in range(100):
        work()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(1000):
        work()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 8 * 1024


def test_mistakes_can_be_pickled():
    with pytest.raises(radsight.SceneError) as raised:
        radsight.Scene.from_text("chrome sphere ball 0 0 4 0 0 0 1")
    again = pickle.loads(pickle.dumps(raised.value))
    assert type(again) is radsight.SceneError and str(again) == str(raised.value)
    assert again.mistakes == raised.value.mistakes
