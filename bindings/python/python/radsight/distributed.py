"""Work on many machines, with `dask.distributed`: ``pip install radsight[distributed]``.

Scheduling, retries, spilling and the dashboard are Dask's. A scene is sent to the scheduler once, and from worker to worker; jobs are a
few hundred bytes. A pixel or ray depends on scene, options, samples and seed alone, so the results are the same bits for any number of
workers, whatever happens to them: Dask runs the jobs of a lost worker again, and only these.

Irradiance caches are not shared between workers: light between diffuse surfaces is followed path by path (``ambient_accuracy=0``).

>>> import dask.distributed, radsight                                                      # doctest: +SKIP
>>> client = dask.distributed.Client("scheduler:8786")                                     # doctest: +SKIP
>>> scene = radsight.Scene.load("office.rad")                                              # doctest: +SKIP
>>> picture = radsight.distributed.render(client, scene, "-vf office.vf", 640, 480, error=0.02)  # doctest: +SKIP
"""

from __future__ import annotations

import hashlib
import pickle
import threading
from collections import OrderedDict
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from dask.distributed import Client, Future, as_completed

from ._radsight import Capture, JobResult, MergedJob, RadsightError, RenderJob, Renderer, Scene, View

__all__ = ["capture", "capture_series", "contributions", "render", "trace"]



#: Samples of every pixel before it is decided how many an asked error needs.
_FIRST_SAMPLES = 16

#: No pixel gets more.
_MOST_SAMPLES = 65536

#: Jobs for each thread of the workers: enough that the last ones end at about the same time.
_JOBS_A_THREAD = 4

#: Scenes that a worker keeps compiled.
_MOST_RENDERERS = 4

Partial = Callable[[MergedJob], object]


def render(
    client: Client,
    scene: Scene,
    view: View | str,
    columns: int,
    rows: int,
    *,
    samples: int | None = None,
    error: float | None = None,
    seed: int = 0,
    ambient_bounces: int = 0,
    jobs: int | None = None,
    partial: Partial | None = None,
) -> MergedJob:
    """Render a view.

    Parameters
    ----------
    client : dask.distributed.Client
    scene : Scene
    view : View or str
    columns, rows : int
        The picture is within this size, in the view's own proportions.
    samples : int, optional
        Rays through every pixel.
    error : float, optional
        Relative error instead, such as 0.02: all pixels get as many rays as this needs, at most 65536.
    seed, ambient_bounces : int
    jobs : int, optional
        Into how many jobs the picture is split; four a thread of the workers if not given. The result does not depend on it.
    partial : callable, optional
        Called with the picture so far and its error whenever a job has ended.

    Returns
    -------
    MergedJob
        To the bit what one process gives for as many samples.
    """
    view = View(view) if isinstance(view, str) else view
    job = RenderJob(
        samples=_samples(samples, error),
        view=view,
        columns=columns,
        rows=rows,
        seed=seed,
        ambient_bounces=ambient_bounces,
    )
    with _Shared(client, scene) as shared:

        def run(job: RenderJob) -> MergedJob:
            parts = job.split(_jobs(client, jobs))
            return _merged(client, [client.submit(_run_job, shared, part, pure=False) for part in parts], partial)

        return _to_error(run, job, error)


def capture(
    client: Client,
    camera: Capture,
    scene: Scene,
    *,
    samples: int | None = None,
    error: float | None = None,
    seed: int = 0,
    ambient_bounces: int = 0,
    jobs: int | None = None,
    partial: Partial | None = None,
) -> MergedJob:
    """Expose a camera to a scene, with its light ring.

    Parameters
    ----------
    client : dask.distributed.Client
    camera : Capture
        Its camera file counts, not its ``error`` or ``samples``.
    scene : Scene
    samples, error, seed, ambient_bounces, jobs, partial
        As for `render`; the error is the rms over the pixels as a share of the mean exposure.

    Returns
    -------
    MergedJob
        ``values`` are exposures, J/m²: (rows, columns, 1).
    """
    job = RenderJob(samples=_samples(samples, error), camera="camera", seed=seed, ambient_bounces=ambient_bounces)
    with _Shared(client, (camera, camera.with_ring(scene))) as shared:

        def run(job: RenderJob) -> MergedJob:
            parts = job.split(_jobs(client, jobs), camera.size[1])
            return _merged(client, [client.submit(_expose_job, shared, part, pure=False) for part in parts], partial)

        return _to_error(run, job, error)


def capture_series(
    client: Client,
    captures: Sequence[tuple[Capture, Scene]],
) -> dict[str, npt.NDArray[Any]]:
    """Expose many cameras, or one to many scenes: a job each.

    Parameters
    ----------
    client : dask.distributed.Client
    captures : sequence of (Capture, Scene)
        Of cameras of one size; each with its own error or samples.

    Returns
    -------
    dict of str to array
        ``exposure_j_per_m2``, (n, rows, columns), and ``grey`` where all cameras have a sensor.
    """
    # One object that several captures have in common travels once.
    with _SharedMany(client) as many:
        futures = [
            client.submit(_expose_whole, many.share(camera), many.share(scene), pure=False)
            for camera, scene in captures
        ]
        results = client.gather(futures)
    exposures = np.stack([exposure for exposure, _ in results])
    series: dict[str, npt.NDArray[Any]] = {"exposure_j_per_m2": exposures}
    greys = [grey for _, grey in results if grey is not None]
    if len(greys) == len(results):
        series["grey"] = np.stack(greys)
    return series


def trace(
    client: Client,
    scene: Scene,
    rays: npt.NDArray[np.float64],
    ask: Sequence[str] = ("radiance_w_per_sr_m2",),
    *,
    rays_a_job: int = 1 << 16,
    **options: Any,
) -> dict[str, npt.NDArray[np.float64]]:
    """Answer rays.

    Parameters
    ----------
    client : dask.distributed.Client
    scene : Scene
    rays : (n, 6) array of float
        Origin (scene units) and direction of each.
    ask : sequence of str
        As for `radsight.trace`.
    rays_a_job : int
    **options
        As for `Renderer`.

    Returns
    -------
    dict of str to array
        To the bit what `radsight.trace` gives.
    """
    options = _uncached(options)
    with _Shared(client, scene) as shared:
        futures = [
            client.submit(_trace_job, shared, options, rays[first : first + rays_a_job], first, tuple(ask), pure=False)
            for first in range(0, len(rays), rays_a_job)
        ]
        parts = client.gather(futures)
    return {name: np.concatenate([part[name] for part in parts]) for name in ask}


def contributions(
    client: Client,
    scene: Scene,
    rays: npt.NDArray[np.float64],
    modifiers: Sequence[str],
    *,
    rays_a_job: int = 1 << 12,
    **options: Any,
) -> npt.NDArray[np.float64]:
    """What each ray owes to modifiers of these names, such as the patches of a sky for annual daylight.

    Parameters
    ----------
    client : dask.distributed.Client
    scene : Scene
    rays : (n, 6) array of float
    modifiers : sequence of str
    rays_a_job : int
    **options
        As for `Renderer`.

    Returns
    -------
    (n, m, 3) array of float
        To the bit what `radsight.contributions` gives.
    """
    options = _uncached(options)
    with _Shared(client, scene) as shared:
        futures = [
            client.submit(
                _contributions_job,
                shared,
                options,
                rays[first : first + rays_a_job],
                first,
                list(modifiers),
                pure=False,
            )
            for first in range(0, len(rays), rays_a_job)
        ]
        return np.concatenate(client.gather(futures))


class _SharedMany:
    """Objects that many jobs need, each on the cluster once. A lost worker's copies are made again from the scheduler's."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._futures: dict[int, Future] = {}

    def __enter__(self) -> _SharedMany:
        return self

    def share(self, thing: object) -> Future:
        if id(thing) not in self._futures:
            data = pickle_of(thing)
            self._futures[id(thing)] = self._client.submit(_unpacked, data, pure=False)
        return self._futures[id(thing)]

    def __exit__(self, *_: object) -> None:
        for future in self._futures.values():
            future.release()


class _Shared:
    """The same for one object."""

    def __init__(self, client: Client, thing: object) -> None:
        self._many, self._thing = _SharedMany(client), thing

    def __enter__(self) -> Future:
        return self._many.share(self._thing)

    def __exit__(self, *_: object) -> None:
        self._many.__exit__()


def pickle_of(thing: object) -> bytes:
    """Pickled with `cloudpickle`, which takes materials of a notebook's own classes too."""
    from distributed.protocol.pickle import dumps

    return bytes(dumps(thing))


class _Sent:
    """What a worker has got, with a key for what it makes of it. Goes from worker to worker as the bytes that it came as."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.key = hashlib.sha256(data).hexdigest()
        self._thing: Any = None

    @property
    def thing(self) -> Any:
        if self._thing is None:
            self._thing = pickle.loads(self.data)
        return self._thing

    def __reduce__(self) -> tuple[type[_Sent], tuple[bytes]]:
        return _Sent, (self.data,)

    def __sizeof__(self) -> int:
        return len(self.data)


def _unpacked(data: bytes) -> _Sent:
    return _Sent(data)


class _Renderers(threading.local):
    """Scenes that a thread of a worker has compiled, the last used last."""

    def __init__(self) -> None:
        self.made: OrderedDict[str, Renderer] = OrderedDict()

    def of(self, sent: _Sent, options: dict[str, Any]) -> Renderer:
        key = f"{sent.key} {sorted(options.items())}"
        if key not in self.made:
            # A thread of the worker is one processor for Dask.
            scene = sent.thing[1] if isinstance(sent.thing, tuple) else sent.thing
            self.made[key] = Renderer(scene, threads=1, **options)
            while len(self.made) > _MOST_RENDERERS:
                self.made.popitem(last=False)
        self.made.move_to_end(key)
        return self.made[key]


_renderers = _Renderers()


def _run_job(sent: _Sent, job: RenderJob) -> JobResult:
    return _renderers.of(sent, {}).run_job(job)


def _expose_job(sent: _Sent, job: RenderJob) -> JobResult:
    camera, _ = sent.thing
    return _renderers.of(sent, {}).run_job(job, camera=camera)


def _expose_whole(camera: _Sent, scene: _Sent) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.uint16] | None]:
    image = camera.thing.with_threads(1).expose(scene.thing)
    return image.exposure_j_per_m2, image.grey if image.has_sensor else None


def _trace_job(
    sent: _Sent, options: dict[str, Any], rays: npt.NDArray[np.float64], first: int, ask: tuple[str, ...]
) -> dict[str, npt.NDArray[np.float64]]:
    traced = _renderers.of(sent, options).trace(np.ascontiguousarray(rays), first=first)
    return {name: getattr(traced, name) for name in ask}


def _contributions_job(
    sent: _Sent, options: dict[str, Any], rays: npt.NDArray[np.float64], first: int, modifiers: list[str]
) -> npt.NDArray[np.float64]:
    return _renderers.of(sent, options).contributions(np.ascontiguousarray(rays), modifiers, first=first)


def _merged(client: Client, futures: list[Future], partial: Partial | None) -> MergedJob:
    parts: list[JobResult] = []
    try:
        for _, part in as_completed(futures, with_results=True):
            parts.append(part)
            if partial is not None:
                partial(MergedJob(parts))
    except BaseException:
        # Ctrl-C, too: nobody waits for the others any more.
        client.cancel(futures)
        raise
    return MergedJob(parts)


def _to_error(run: Callable[[RenderJob], MergedJob], job: RenderJob, error: float | None) -> MergedJob:
    """Runs a job with ever more samples until its error is the asked one. How many is decided by pixels alone."""
    merged = run(job)
    while error is not None and job.samples < _MOST_SAMPLES:
        reached = merged.relative_error
        if reached is None or reached <= error:
            break
        # The error of independent samples falls with the square root; more than that at once would be a guess.
        doublings = int(np.ceil(np.clip(2 * np.log2(reached / error), 1, 6)))
        job = job.with_samples(min(job.samples << doublings, _MOST_SAMPLES))
        merged = run(job)
    return merged


def _samples(samples: int | None, error: float | None) -> int:
    if (samples is None) == (error is None):
        raise RadsightError("expected either samples or error")
    if error is not None and not (error > 0 and np.isfinite(error)):
        raise RadsightError(f"error is {error}, expected a relative error above 0, such as 0.02")
    return _FIRST_SAMPLES if samples is None else samples


def _jobs(client: Client, asked: int | None) -> int:
    return asked if asked is not None else max(1, _JOBS_A_THREAD * sum(client.nthreads().values()))


def _uncached(options: dict[str, Any]) -> dict[str, Any]:
    """Options with which a ray's answer does not depend on other rays."""
    if options.get("ambient_bounces", 0) > 0 and options.get("ambient_accuracy", 0) != 0:
        raise RadsightError(
            "ambient_accuracy is not 0: each worker would fill an irradiance cache of its own, with other values; "
            "expected 0 with ambient_bounces"
        )
    if "threads" in options:
        raise RadsightError("threads are the workers', expected none")
    return {**options, "ambient_accuracy": 0.0}
