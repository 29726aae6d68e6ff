"""Jobs: whole bits, files, and the program's."""

import os
import pathlib
import pickle
import subprocess

import numpy as np
import pytest
import radsight

GRIPPS = pathlib.Path(__file__).parents[3] / "radiance-scenes" / "gripps"
TABLE = """void light lamp 0 0 3 100 100 100
void plastic grey 0 0 5 .5 .4 .3 0 0
lamp ring bulb 0 0 8 0 0 4 0 0 -1 0 .05
grey ring table 0 0 8 0 0 0 0 0 1 0 6
"""
VIEW = radsight.View("-vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 45")


def test_parts_merge_to_the_picture():
    scene = radsight.Scene.from_text(TABLE)
    job = radsight.RenderJob(samples=4, view=VIEW, columns=40, rows=30, seed=5)
    parts = [radsight.Renderer(scene).run_job(pickle.loads(pickle.dumps(part))) for part in job.split(3)]
    merged = radsight.MergedJob([pickle.loads(pickle.dumps(part)) for part in parts[::-1]])
    whole = radsight.Renderer(scene, samples=4, seed=5).render(VIEW, 40, 30)
    np.testing.assert_array_equal(merged.values, whole.radiance_w_per_sr_m2)
    assert np.shares_memory(merged.radiance_w_per_sr_m2, merged.values)
    with pytest.raises(AttributeError, match="radiance_w_per_sr_m2, not exposure_j_per_m2"):
        merged.exposure_j_per_m2
    assert merged.missing == [] and merged.relative_error > 0
    assert merged.standard_errors.shape == merged.values.shape
    partial = radsight.MergedJob(parts[:2])
    assert partial.missing == [((0, 40), parts[2].job.rows)]
    assert np.isnan(partial.standard_errors[-1]).all() and partial.relative_error > 0
    assert merged._repr_png_().startswith(b"\x89PNG")


def test_captures_too():
    camera = radsight.Capture(GRIPPS / "fig10.toml", samples=2)
    scene = radsight.Scene.load(GRIPPS / "sheet-retro.rad")
    columns, rows = camera.size
    job = radsight.RenderJob(samples=2, camera="fig10.toml")
    renderer = radsight.Renderer(camera.with_ring(scene))
    parts = [renderer.run_job(part, camera=camera) for part in job.split_tiles(50, 60, camera.size)]
    merged = radsight.MergedJob(parts)
    whole = pickle.loads(pickle.dumps(camera)).expose(scene)
    np.testing.assert_array_equal(merged.values[..., 0], whole.exposure_j_per_m2.astype(np.float32))
    assert np.shares_memory(merged.exposure_j_per_m2, merged.values) and merged.exposure_j_per_m2.shape == (rows, columns)
    grey = camera.sensor.grey(merged.exposure_j_per_m2)
    np.testing.assert_array_equal(grey, whole.grey)
    assert grey.shape == (rows, columns) and camera.sensor.largest == 255


def test_ranges_of_rays_and_their_cache():
    scene = radsight.Scene.from_text(TABLE + "grey ring ceiling 0 0 8 0 0 5 0 0 -1 0 6\n")
    rays = np.array([[x, 0, 1, 0, 0, -1.0] for x in np.linspace(-2, 2, 100)])
    options = {"ambient_bounces": 1, "ambient_accuracy": 0.2, "ambient_divisions": 64, "ambient_super_samples": 0}
    job = radsight.RenderJob(samples=1, rays="points.txt", **options)
    with pytest.raises(radsight.RadsightError, match="irradiance_cache"):
        radsight.Renderer(scene).run_job(job, rays=rays)
    cache = radsight.Renderer(scene).fill_irradiance_cache(rays, job=job)
    renderer = radsight.Renderer(scene, irradiance_cache=cache)
    merged = radsight.MergedJob([renderer.run_job(part, rays=rays) for part in job.split_rays(30, 100)])
    whole = radsight.trace(scene, rays, **options)["radiance_w_per_sr_m2"]
    np.testing.assert_array_equal(merged.values[0], whole.astype(np.float32))
    job = radsight.RenderJob(samples=1, rays="points.txt", quantity="irradiance")
    merged = radsight.MergedJob([radsight.Renderer(scene).run_job(job, rays=rays)])
    alone = radsight.trace(scene, rays, quantity="irradiance", ambient_accuracy=0.0)["irradiance_w_per_m2"]
    np.testing.assert_array_equal(merged.irradiance_w_per_m2[0], alone.astype(np.float32))
    with pytest.raises(AttributeError, match="irradiance_w_per_m2, not radiance_w_per_sr_m2"):
        merged.radiance_w_per_sr_m2
    again = radsight.Renderer(scene, **options).fill_irradiance_cache(rays)
    half = radsight.Renderer(scene, irradiance_cache=again, **options).trace(rays[50:], first=50)
    np.testing.assert_array_equal(half.radiance_w_per_sr_m2, whole[50:])
    assert job.split(3, (100, 1))[1].rays == (33, 66) and "rays 33 to 65" in repr(job.split(3, (100, 1))[1])


def test_the_programs_parts_are_pythons(tmp_path):
    program = os.environ.get("RADSIGHT_PROGRAM")
    if not program:
        pytest.skip("RADSIGHT_PROGRAM names no program")
    (tmp_path / "table.rad").write_text(TABLE)
    job = radsight.RenderJob(samples=2, view=VIEW, columns=24, rows=18, scenes=[str(tmp_path / "table.rad")])
    (tmp_path / "job.json").write_text(job.to_json())
    words = [program, "job", "run", "job.json", "--part", "1/2", "-o", "part.mtx"]
    subprocess.run(words, cwd=tmp_path, check=True)
    theirs = radsight.JobResult.from_bytes((tmp_path / "part.mtx").read_bytes())
    own = radsight.Renderer(radsight.Scene.from_text(TABLE)).run_job(job.split(2)[1])
    first, end = theirs.job.rows
    merged = radsight.MergedJob([theirs])
    np.testing.assert_array_equal(merged.values[first:end], radsight.MergedJob([own]).values[first:end])


def test_mistakes_in_jobs_have_their_place():
    with pytest.raises(radsight.SceneError, match=r"job.json:2:\d+") as raised:
        radsight.RenderJob.from_json('{"format": 1,\n "samples": "many"}', "job.json")
    assert "^" in str(raised.value)
    with pytest.raises(radsight.RadsightError, match="samples is 0"):
        radsight.RenderJob(samples=0, view=VIEW, columns=8, rows=8)
    with pytest.raises(radsight.RadsightError, match="not part of this picture"):
        radsight.JobResult.from_bytes(b"nothing")
