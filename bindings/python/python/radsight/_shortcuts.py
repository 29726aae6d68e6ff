"""A function for each thing that is done once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike, fspath
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._radsight import Capture, CapturedImage, Image, Renderer, Scene, SeriesPicture, View, series_pictures

if TYPE_CHECKING:
    import pandas

Path = str | PathLike[str]


def render(
    scene: Scene,
    view: View | str,
    columns: int,
    rows: int,
    *,
    progress: Callable[[float], object] | None = None,
    **options: Any,
) -> Image:
    """Render a view.

    Parameters
    ----------
    scene : Scene
    view : View or str
    columns, rows : int
        The picture is within this size, in the view's own proportions.
    progress : callable, optional
        Called with the share that is done.
    **options
        As for `Renderer`: ``error``, ``samples``, ``ambient_bounces``, …

    Returns
    -------
    Image

    Examples
    --------
    >>> import radsight
    >>> scene = radsight.Scene.from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")
    >>> radsight.render(scene, "-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40", 32, 32, samples=4)
    <radsight.Image 32 × 32>
    """
    view = View(view) if isinstance(view, str) else view
    return Renderer(scene, **options).render(view, columns, rows, progress)


def trace(
    scene: Scene,
    rays: npt.NDArray[np.float64],
    ask: Sequence[str] = ("radiance_w_per_sr_m2",),
    *,
    progress: Callable[[float], object] | None = None,
    **options: Any,
) -> dict[str, npt.NDArray[np.float64]]:
    """Answer rays.

    Parameters
    ----------
    scene : Scene
    rays : (n, 6) array of float
        Origin (scene units) and direction of each.
    ask : sequence of str
        Any of ``radiance_w_per_sr_m2``, ``distance``, ``point``, ``normal``.
    progress : callable, optional
        Called with the share that is done.
    **options
        As for `Renderer`.

    Returns
    -------
    dict of str to array
        What was asked, an entry each.
    """
    traced = Renderer(scene, **options).trace(rays, progress=progress)
    return {name: getattr(traced, name) for name in ask}


def contributions(
    scene: Scene,
    rays: npt.NDArray[np.float64],
    modifiers: Sequence[str],
    *,
    progress: Callable[[float], object] | None = None,
    **options: Any,
) -> npt.NDArray[np.float64]:
    """What each ray owes to modifiers of these names, as ``rcontrib`` finds it.

    Parameters
    ----------
    scene : Scene
    rays : (n, 6) array of float
    modifiers : sequence of str
    progress : callable, optional
    **options
        As for `Renderer`.

    Returns
    -------
    (n, m, 3) array of float
        W/(sr·m²) by ray, modifier and band.
    """
    return Renderer(scene, **options).contributions(rays, modifiers, progress=progress)


def capture(
    camera: Path | Capture,
    *scenes: Path | Scene,
    progress: Callable[[float], object] | None = None,
    **options: Any,
) -> CapturedImage:
    """Expose a camera to scenes, with its light ring.

    Parameters
    ----------
    camera : path-like or Capture
        A camera file.
    *scenes : path-like, or one Scene
    progress : callable, optional
    **options
        As for `Capture`, where a file is given: ``error``, ``samples``, ``seed``, …

    Returns
    -------
    CapturedImage
    """
    if not isinstance(camera, Capture):
        camera = Capture(camera, **options)
    elif options:
        raise TypeError("options are for a camera file; a Capture has its own")
    return camera.expose(*scenes, progress=progress)


def read_series(table: Path | pandas.DataFrame, camera: Path | Capture, **options: Any) -> list[SeriesPicture]:
    """The pictures that a table names, for `CaptureSeries.expose`.

    Parameters
    ----------
    table : path-like or pandas.DataFrame
        A row each; a file is separated by commas. A column is ``name``, a key of the camera file such as ``rig.ring_diameter_mm``, or
        ``move NAME`` with the transform of the surfaces of that name. Empty cells change nothing.
    camera : path-like or Capture
        A camera file.
    **options
        As for `Capture`, where a file is given.

    Returns
    -------
    list of SeriesPicture

    Raises
    ------
    RadsightError
        With file, line and caret of each mistake.
    """
    if not isinstance(camera, Capture):
        camera = Capture(camera, **options)
    elif options:
        raise TypeError("options are for a camera file; a Capture has its own")
    if isinstance(table, (str, PathLike)):
        return series_pictures(File(table).read_text(encoding="utf-8"), camera, name=fspath(table))
    return series_pictures(table.to_csv(index=False), camera, name="<table>")


def progress_bar(bar: Any) -> Callable[[float], None]:
    """What moves a bar of `tqdm`, as a callback for ``progress``.

    Parameters
    ----------
    bar : tqdm
        Its total is set to 1.

    Returns
    -------
    callable

    Examples
    --------
    >>> class Bar:
    ...     n = 0
    ...     def refresh(self):
    ...         pass
    >>> bar = Bar()
    >>> progress_bar(bar)(0.25)
    >>> bar.n, bar.total
    (0.25, 1.0)
    """
    bar.total = 1.0

    def hear(done: float) -> None:
        bar.n = done
        bar.refresh()

    return hear
