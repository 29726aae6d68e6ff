"""Work on many machines, with `dask.distributed`: ``pip install radsight[distributed]``.

Scheduling, retries, spilling and the dashboard are Dask's. A scene is sent to the scheduler once, and from worker to worker; jobs are a
few hundred bytes. A pixel or ray depends on scene, options, samples and seed alone, so the results are the same bits for any number of
workers, whatever happens to them: Dask runs the jobs of a lost worker again, and only these.

With an ``ambient_accuracy`` the irradiance cache is made once, by one worker on all processors of its machine, and goes from worker to worker.

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
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import numpy.typing as npt
from dask.distributed import Client, Future, as_completed

from ._radsight import Capture, JobResult, MergedJob, RadsightError, RenderJob, Renderer, Scene, View
from ._shortcuts import answers

__all__ = ["Sampling", "capture", "capture_series", "contributions", "render", "trace"]


#: Samples of every pixel before the number for a requested error is estimated.
_FIRST_SAMPLES = 16

#: Maximum number of samples per pixel.
_MOST_SAMPLES = 65536

#: Jobs for each thread of the workers: enough that the last ones end at about the same time.
_JOBS_A_THREAD = 4

#: Scenes that a worker keeps compiled.
_MOST_RENDERERS = 4

Partial = Callable[[MergedJob], object]


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """How exactly `render` and `capture` work, and in how many jobs: their keyword arguments.

    Parameters
    ----------
    samples : int, optional
        Rays through every pixel.
    error : float, optional
        Relative error instead, such as 0.02: all pixels get as many rays as this needs, at most 65536. Of a capture it is the rms over the
        pixels as a share of the mean exposure. The bias of cached irradiance does not count.
    seed : int
        Chooses the sample sequence.
    ambient_bounces : int
        Number of diffuse interreflections.
    ambient_accuracy : float
        As for `RenderJob`: 0 follows light path by path, with more an irradiance cache is made first.
    ambient_divisions, ambient_super_samples : int, optional
        Rays of a cache point, and additional rays.
    jobs : int, optional
        Into about how many rectangles the picture is split; four a thread of the workers if not given. The result does not depend on it.
    partial : callable, optional
        Called with the picture so far and its error whenever a job has ended.
    """

    samples: int | None = None
    error: float | None = None
    seed: int = 0
    ambient_bounces: int = 0
    ambient_accuracy: float = 0.0
    ambient_divisions: int | None = None
    ambient_super_samples: int | None = None
    jobs: int | None = None
    partial: Partial | None = None

    def _job(self, **target: Any) -> RenderJob:
        """The whole job for a view or a camera."""
        if (self.samples is None) == (self.error is None):
            raise RadsightError("expected either samples or error")
        if self.error is not None and not (self.error > 0 and np.isfinite(self.error)):
            raise RadsightError(f"error is {self.error}, expected a relative error above 0, such as 0.02")
        return RenderJob(
            samples=_FIRST_SAMPLES if self.samples is None else self.samples,
            seed=self.seed,
            ambient_bounces=self.ambient_bounces,
            ambient_accuracy=self.ambient_accuracy,
            ambient_divisions=self.ambient_divisions,
            ambient_super_samples=self.ambient_super_samples,
            **target,
        )

    def _run(self, client: Client, shared: Future, job: RenderJob, size: tuple[int, int]) -> MergedJob:
        """Run the parts of a job, with more samples until its error is the requested one. Their number depends on the pixels only."""
        caches = self.ambient_bounces > 0 and self.ambient_accuracy > 0
        cache = client.submit(_fill_for_job, shared, job, pure=False) if caches else None
        while True:
            parts = job.split_tiles(*_tile(size, _jobs(client, self.jobs)), size)
            futures = [client.submit(_run_job, shared, cache, part, pure=False) for part in parts]
            merged = _merged(client, futures, self.partial)
            reached = merged.relative_error
            if self.error is None or reached is None or reached <= self.error or job.samples >= _MOST_SAMPLES:
                return merged
            # The error of independent samples falls with the square root; more than that at once would be a guess.
            doublings = int(np.ceil(np.clip(2 * np.log2(reached / self.error), 1, 6)))
            job = job.with_samples(min(job.samples << doublings, _MOST_SAMPLES))


def render(client: Client, scene: Scene, view: View | str, columns: int, rows: int, **sampling: Any) -> MergedJob:
    """Render a view.

    Parameters
    ----------
    client : dask.distributed.Client
        Connected to the scheduler.
    scene : Scene
        What is rendered; it goes to the cluster once.
    view : View or str
        A view, or Radiance's options of one.
    columns, rows : int
        The picture is within this size, in the view's own proportions.
    **sampling
        As for `Sampling`.

    Returns
    -------
    MergedJob
        To the bit what one process gives for as many samples.
    """
    how = Sampling(**sampling)
    job = how._job(view=View(view) if isinstance(view, str) else view, columns=columns, rows=rows)
    with _Shared(client, scene) as shared:
        return how._run(client, shared, job, job.picture_size)


def capture(client: Client, camera: Capture, scene: Scene, **sampling: Any) -> MergedJob:
    """Expose a camera to a scene, with its light ring.

    Parameters
    ----------
    client : dask.distributed.Client
        Connected to the scheduler.
    camera : Capture
        Its camera file counts, not its ``error`` or ``samples``.
    scene : Scene
        Without the camera's light ring.
    **sampling
        As for `Sampling`; light is followed path by path.

    Returns
    -------
    MergedJob
        ``values`` are exposures, J/m²: (rows, columns, 1).
    """
    how = Sampling(**sampling)
    job = how._job(camera="camera")
    with _Shared(client, (camera, camera.with_ring(scene))) as shared:
        return how._run(client, shared, job, camera.size)


def capture_series(
    client: Client,
    captures: Sequence[tuple[Capture, Scene]],
) -> dict[str, npt.NDArray[Any]]:
    """Expose many cameras, or one to many scenes: a job each.

    Parameters
    ----------
    client : dask.distributed.Client
        Connected to the scheduler.
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
        results = _gathered(client, futures)
    exposures = np.stack([exposure for exposure, _ in results])
    series: dict[str, npt.NDArray[Any]] = {"exposure_j_per_m2": exposures}
    greys = [grey for _, grey in results if grey is not None]
    if len(greys) == len(results):
        series["grey"] = np.stack(greys)
    return series


def trace(
    client: Client,
    scene: Scene,
    rays: npt.ArrayLike,
    ask: Sequence[str] | None = None,
    *,
    rays_a_job: int = 1 << 16,
    **options: Any,
) -> dict[str, npt.NDArray[np.float64]]:
    """Trace rays.

    Parameters
    ----------
    client : dask.distributed.Client
        Connected to the scheduler.
    scene : Scene
        The scene; it is sent to the cluster once.
    rays : (n, 6) array of float
        Origin (scene units) and direction of each.
    ask : sequence of str, optional
        As for `radsight.trace`.
    rays_a_job : int
        Number of rays in a job; the result does not depend on it.
    **options
        As for `Renderer`, with the same defaults. If they use an irradiance cache, one worker fills it for all rays.

    Returns
    -------
    dict of str to array
        The same bits as from `radsight.trace`.
    """
    names = answers(ask, options)
    _check_threads(options)
    checked = _checked(rays, rays_a_job)
    with _Shared(client, scene) as shared:
        caches = options.get("ambient_bounces", 0) > 0 and options.get("ambient_accuracy", 1) > 0
        cache = client.submit(_fill_for_rays, shared, options, checked, pure=False) if caches else None
        futures = [
            client.submit(
                _trace_job, shared, cache, options, checked[first : first + rays_a_job], first, tuple(names), pure=False
            )
            for first in _starts(checked, rays_a_job)
        ]
        parts = _gathered(client, futures)
    return {name: np.concatenate([part[name] for part in parts]) for name in names}


def contributions(
    client: Client,
    scene: Scene,
    rays: npt.ArrayLike,
    modifiers: Sequence[str],
    *,
    rays_a_job: int = 1 << 12,
    **options: Any,
) -> npt.NDArray[np.float64]:
    """Contributions of modifiers to each ray, such as those of sky patches for annual daylight.

    Parameters
    ----------
    client : dask.distributed.Client
        Connected to the scheduler.
    scene : Scene
        The scene; it is sent to the cluster once.
    rays : (n, 6) array of float
        Origin (scene units) and direction of each.
    modifiers : sequence of str
        Names of materials and lights.
    rays_a_job : int
        Number of rays in a job; the result does not depend on it.
    **options
        As for `Renderer`.

    Returns
    -------
    (n, m, 3) array of float
        W/(sr·m²) by ray, modifier and band: the same bits as from `radsight.contributions`.
    """
    _check_threads(options)
    checked = _checked(rays, rays_a_job)
    with _Shared(client, scene) as shared:
        futures = [
            client.submit(
                _contributions_job,
                shared,
                options,
                checked[first : first + rays_a_job],
                first,
                list(modifiers),
                pure=False,
            )
            for first in _starts(checked, rays_a_job)
        ]
        return np.concatenate(_gathered(client, futures))


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

    def of(self, sent: _Sent, cache: _Sent | None, options: dict[str, Any]) -> Renderer:
        key = f"{sent.key} {cache.key if cache else ''} {sorted(options.items())}"
        if key not in self.made:
            # A thread of the worker is one processor for Dask.
            data = cache.data if cache else None
            self.made[key] = Renderer(_scene(sent), threads=1, irradiance_cache=data, **options)
            while len(self.made) > _MOST_RENDERERS:
                self.made.popitem(last=False)
        self.made.move_to_end(key)
        return self.made[key]


_renderers = _Renderers()


def _scene(sent: _Sent) -> Scene:
    """The scene, alone or beside its camera."""
    scene: Scene = sent.thing[1] if isinstance(sent.thing, tuple) else sent.thing
    return scene


def _fill_for_job(sent: _Sent, job: RenderJob) -> _Sent | None:
    # The other workers wait for it, so it takes all processors of its machine.
    return _sent(Renderer(_scene(sent)).fill_irradiance_cache(job=job))


def _fill_for_rays(sent: _Sent, options: dict[str, Any], rays: npt.NDArray[np.float64]) -> _Sent | None:
    return _sent(Renderer(_scene(sent), **options).fill_irradiance_cache(np.ascontiguousarray(rays)))


def _sent(data: bytes | None) -> _Sent | None:
    return None if data is None else _Sent(data)


def _run_job(sent: _Sent, cache: _Sent | None, job: RenderJob) -> JobResult:
    camera = sent.thing[0] if isinstance(sent.thing, tuple) else None
    return _renderers.of(sent, cache, {}).run_job(job, camera=camera)


def _expose_whole(camera: _Sent, scene: _Sent) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.uint16] | None]:
    image = camera.thing.with_threads(1).expose(scene.thing)
    return image.exposure_j_per_m2, image.grey if image.has_sensor else None


def _trace_job(
    sent: _Sent,
    cache: _Sent | None,
    options: dict[str, Any],
    rays: npt.NDArray[np.float64],
    first: int,
    ask: tuple[str, ...],
) -> dict[str, npt.NDArray[np.float64]]:
    traced = _renderers.of(sent, cache, options).trace(np.ascontiguousarray(rays), first=first)
    return {name: getattr(traced, name) for name in ask}


def _contributions_job(
    sent: _Sent, options: dict[str, Any], rays: npt.NDArray[np.float64], first: int, modifiers: list[str]
) -> npt.NDArray[np.float64]:
    return _renderers.of(sent, None, options).contributions(np.ascontiguousarray(rays), modifiers, first=first)


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


def _gathered(client: Client, futures: list[Future]) -> list[Any]:
    """Results of a client that is not asynchronous."""
    return cast("list[Any]", client.gather(futures))


def _tile(size: tuple[int, int], jobs: int) -> tuple[int, int]:
    """Columns and rows of the rectangles, nearly squares, of which there are about so many in a picture."""
    columns, rows = size
    bands = int(np.clip(round(float(np.sqrt(jobs * rows / columns))), 1, rows))
    return -(-columns // min(columns, -(-jobs // bands))), -(-rows // bands)


def _jobs(client: Client, asked: int | None) -> int:
    if asked is not None:
        return max(1, asked)
    threads = cast("dict[str, int]", client.nthreads())
    return max(1, _JOBS_A_THREAD * sum(threads.values()))


def _checked(rays: npt.ArrayLike, rays_a_job: int) -> npt.NDArray[np.float64]:
    """Rays as an array, before they are sent in jobs."""
    if rays_a_job < 1:
        raise RadsightError(f"rays_a_job is {rays_a_job}, expected 1 or more")
    array = np.asarray(rays, np.float64)
    if array.ndim != 2 or array.shape[1] != 6:
        raise RadsightError(f"rays has shape {array.shape}, expected (n, 6): origin and direction of each")
    return array


def _starts(rays: npt.NDArray[np.float64], rays_a_job: int) -> range:
    """The first ray of each job. Without rays there is one job, for the shape of its answer."""
    return range(0, max(1, len(rays)), rays_a_job)


def _check_threads(options: dict[str, Any]) -> None:
    if "threads" in options:
        raise RadsightError("threads are the workers', expected none")
