"""Work on several processes with Dask: whole bits, lost workers, partial results."""

import os
import signal
import threading

import numpy as np
import pytest
import radsight

dask_distributed = pytest.importorskip("dask.distributed")
from radsight import distributed  # noqa: E402

TEXT = """void light lamp 0 0 3 100 100 100
void plastic grey 0 0 5 .5 .4 .3 0 0
lamp ring bulb 0 0 8 0 0 4 0 0 -1 0 .5
grey ring table 0 0 8 0 0 0 0 0 1 0 6
grey sphere ball 0 0 4 .5 .5 .4 .4
"""
VIEW = radsight.View("-vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 45")
CAMERA = """[camera]
position_m = [0, 0, 3]
direction = [0, 0, -1]
up = [0, 1, 0]
focal_distance_mm = 20
pinhole_diameter_mm = 0.5
pinhole_model = "finite"
pixel_pitch_um = [200, 200]
pixels = [24, 18]
exposure_ms = 10
"""


@pytest.fixture
def scene():
    return radsight.Scene.from_text(TEXT)


@pytest.fixture
def cluster():
    """Starts a cluster of so many processes."""
    started = []

    def start(workers):
        cluster = dask_distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
        )
        client = dask_distributed.Client(cluster)
        started.append((client, cluster))
        return client

    yield start
    for client, cluster in started:
        client.close()
        cluster.close()


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_any_number_of_workers_gives_the_same_bits(cluster, scene, workers):
    client = cluster(workers)
    merged = distributed.render(client, scene, VIEW, 40, 30, samples=4, ambient_bounces=1)
    options = {"ambient_bounces": 1, "ambient_accuracy": 0.0}
    whole = radsight.render(scene, VIEW, 40, 30, samples=4, **options)
    np.testing.assert_array_equal(merged.values, whole.radiance_w_per_sr_m2)
    rays = np.array([[x, 0, 1, 0, 0, -1.0] for x in np.linspace(-2, 2, 100)])
    traced = distributed.trace(client, scene, rays, ["radiance_w_per_sr_m2", "distance"], rays_a_job=17, **options)
    alone = radsight.trace(scene, rays, ["radiance_w_per_sr_m2", "distance"], **options)
    for name, values in alone.items():
        np.testing.assert_array_equal(traced[name], values)
    contributions = distributed.contributions(client, scene, rays, ["lamp"], rays_a_job=17)
    np.testing.assert_array_equal(contributions, radsight.contributions(scene, rays, ["lamp"]))


def test_captures_and_series_are_those_of_one_process(cluster, scene):
    client = cluster(2)
    camera = radsight.Capture.from_text(CAMERA, samples=4)
    merged = distributed.capture(client, camera, scene, samples=4)
    whole = camera.expose(scene)
    np.testing.assert_array_equal(merged.values[..., 0], whole.exposure_j_per_m2.astype(np.float32))
    brighter = radsight.Scene.from_text(TEXT.replace("100 100 100", "200 200 200"))
    series = distributed.capture_series(client, [(camera, scene), (camera, brighter), (camera, scene)])
    np.testing.assert_array_equal(series["exposure_j_per_m2"][0], whole.exposure_j_per_m2)
    np.testing.assert_array_equal(series["exposure_j_per_m2"][0], series["exposure_j_per_m2"][2])
    np.testing.assert_allclose(series["exposure_j_per_m2"][1], 2 * whole.exposure_j_per_m2, rtol=0.1)


def test_a_worker_that_is_killed_costs_no_bit(cluster, scene):
    client = cluster(2)
    heard = []
    victim = next(iter(client.run(os.getpid).values()))
    killed = threading.Event()

    def partial(picture):
        heard.append((len(picture.missing), picture.relative_error))
        if not killed.is_set():
            killed.set()
            os.kill(victim, signal.SIGKILL)

    merged = distributed.render(client, scene, VIEW, 64, 48, samples=64, jobs=24, partial=partial)
    whole = radsight.render(scene, VIEW, 64, 48, samples=64)
    np.testing.assert_array_equal(merged.values, whole.radiance_w_per_sr_m2)
    assert killed.is_set() and len(heard) == 24
    # The first rows to come may be black, which has no relative error.
    assert heard[-1][0] == 0 and heard[-1][1] > 0


def test_an_asked_error_is_reached_with_the_same_samples_everywhere(cluster, scene):
    client = cluster(2)
    pictures = [distributed.render(client, scene, VIEW, 32, 24, error=0.01, jobs=jobs) for jobs in (1, 5)]
    assert pictures[0].relative_error <= 0.01
    assert pictures[0].job.samples > 16
    np.testing.assert_array_equal(pictures[0].values, pictures[1].values)


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_an_irradiance_cache_is_made_once_for_any_number_of_workers(cluster, workers):
    client = cluster(workers)
    scene = radsight.Scene.from_text(TEXT + "grey ring ceiling 0 0 8 0 0 5 0 0 -1 0 6\n")
    options = {"ambient_bounces": 2, "ambient_accuracy": 0.2, "ambient_divisions": 64, "ambient_super_samples": 0}
    merged = distributed.render(client, scene, VIEW, 40, 30, samples=2, **options)
    whole = radsight.render(scene, VIEW, 40, 30, samples=2, **options)
    np.testing.assert_array_equal(merged.values, whole.radiance_w_per_sr_m2)
    rays = np.array([[x, 0, 1, 0, 0, -1.0] for x in np.linspace(-2, 2, 100)])
    traced = distributed.trace(client, scene, rays, rays_a_job=17, **options)
    alone = radsight.trace(scene, rays, **options)
    np.testing.assert_array_equal(traced["radiance_w_per_sr_m2"], alone["radiance_w_per_sr_m2"])


def test_what_cannot_be_shared_out_is_refused(scene):
    with pytest.raises(radsight.RadsightError, match="threads"):
        distributed.trace(None, scene, np.zeros((1, 6)), threads=2)
    with pytest.raises(radsight.RadsightError, match="samples or error"):
        distributed.render(None, scene, VIEW, 8, 8)
    with pytest.raises(TypeError, match="sample"):
        distributed.render(None, scene, VIEW, 8, 8, sample=3)
    camera = radsight.Capture.from_text(CAMERA)
    with pytest.raises(radsight.RadsightError, match="ambient_accuracy"):
        distributed.capture(None, camera, scene, samples=2, ambient_bounces=1, ambient_accuracy=0.1)


def test_no_rays_have_no_answers_and_wrong_ones_are_refused_before_they_are_sent(cluster, scene):
    with pytest.raises(radsight.RadsightError, match=r"rays has shape \(6,\), expected \(n, 6\)"):
        distributed.trace(None, scene, np.zeros(6))
    with pytest.raises(radsight.RadsightError, match="rays_a_job is 0"):
        distributed.contributions(None, scene, np.zeros((1, 6)), ["lamp"], rays_a_job=0)
    with pytest.raises(radsight.RadsightError, match="ask has 'colour'"):
        distributed.trace(None, scene, np.zeros((1, 6)), ["colour"])
    client = cluster(1)
    none = np.empty((0, 6))
    assert distributed.trace(client, scene, none, ["point"])["point"].shape == (0, 3)
    assert distributed.contributions(client, scene, none, ["lamp"]).shape == (0, 1, 3)
    # What a worker raises is the exception that one process raises.
    with pytest.raises(radsight.RadsightError, match="ray 0 has no direction"):
        distributed.trace(client, scene, np.zeros((1, 6)))
