"""A function for each thing that is done once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike, fspath
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ._radsight import Capture, CapturedImage, Image, RadsightError, Renderer, Scene, SeriesPicture, View, series_pictures

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
        What is rendered.
    view : View or str
        A view, or Radiance's options of one.
    columns, rows : int
        The picture is within this size, in the view's own proportions.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.
    **options
        As for `Renderer`, such as ``error``, ``samples`` and ``ambient_bounces``.

    Returns
    -------
    Image
        Radiances, W/(sr·m²).

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
    rays: npt.ArrayLike,
    ask: Sequence[str] | None = None,
    *,
    progress: Callable[[float], object] | None = None,
    **options: Any,
) -> dict[str, npt.NDArray[np.float64]]:
    """Trace rays.

    Parameters
    ----------
    scene : Scene
        The scene.
    rays : (n, 6) array of float
        Origin (scene units) and direction of each. An array of doubles is read in place.
    ask : sequence of str, optional
        Any of ``radiance_w_per_sr_m2`` (which is there alone if not given), ``distance``, ``point`` and ``normal``. With
        ``quantity="irradiance"`` and ``"surface_irradiance"`` it is ``irradiance_w_per_m2`` instead of the radiance.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.
    **options
        As for `Renderer`.

    Returns
    -------
    dict of str to array
        One entry for each requested quantity, as in `TracedRays`: radiance (n, 3) in W/(sr·m²), distance (n,) and point (n, 3) in scene
        units, normal (n, 3), irradiance (n, 3) in W/m².

    Raises
    ------
    RadsightError
        If the rays have a wrong shape, or a name in ``ask`` is unknown.

    Examples
    --------
    >>> import radsight
    >>> scene = radsight.Scene.from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")
    >>> radsight.trace(scene, [[0, 0, 0, 0, 1, 0]], ["distance"])
    {'distance': array([7.])}
    """
    names = answers(ask, options)
    traced = Renderer(scene, **options).trace(rays, progress=progress)
    return {name: getattr(traced, name) for name in names}


def answers(ask: Sequence[str] | None, options: dict[str, Any]) -> Sequence[str]:
    """The requested quantities: names of attributes that `TracedRays` has with these options."""
    is_radiance = options.get("quantity", "radiance") == "radiance"
    value = "radiance_w_per_sr_m2" if is_radiance else "irradiance_w_per_m2"
    for name in ask or ():
        if name not in (value, "distance", "point", "normal"):
            raise RadsightError(f"ask has {name!r}, expected {value}, distance, point or normal")
    return (value,) if ask is None else ask


def contributions(
    scene: Scene,
    rays: npt.ArrayLike,
    modifiers: Sequence[str],
    *,
    progress: Callable[[float], object] | None = None,
    **options: Any,
) -> npt.NDArray[np.float64]:
    """Contributions of modifiers to each ray, as ``rcontrib`` computes them.

    Parameters
    ----------
    scene : Scene
        The scene.
    rays : (n, 6) array of float
        Origin (scene units) and direction of each. An array of doubles is read in place.
    modifiers : sequence of str
        Names of materials and lights.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.
    **options
        As for `Renderer`.

    Returns
    -------
    (n, m, 3) array of float
        W/(sr·m²) by ray, modifier and band; W/m² with ``quantity="irradiance"``.

    Raises
    ------
    RadsightError
        If the rays have a wrong shape.
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
        What it is exposed to.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.
    **options
        As for `Capture`, where a file is given, such as ``error``, ``samples`` and ``seed``.

    Returns
    -------
    CapturedImage
        Exposures, their errors and grey values.

    Raises
    ------
    SceneError
        With every mistake in the files.
    TypeError
        If options are given with a `Capture`.
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
        A picture for each row.

    Raises
    ------
    SceneError
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
        Of the share that is done.

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
