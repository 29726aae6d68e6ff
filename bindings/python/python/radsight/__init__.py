"""Radiance scenes through a real camera, as NumPy arrays.

Lengths are in scene units; radiance is W/(sr·m²) in three bands (red, green, blue of Radiance's primaries), exposure J/m².
Requested errors are relative: 0.02 is 2 %. Results depend on scene, options and seed only, not on the number of threads.

>>> import radsight
>>> scene = radsight.Scene.from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 9 0 2")
>>> view = radsight.View("-vp 0 0 0 -vd 0 1 0 -vh 40 -vv 40")
>>> image = radsight.Renderer(scene, error=0.05).render(view, 32, 32)
>>> image.radiance_w_per_sr_m2[16, 16]
array([1., 1., 1.], dtype=float32)
"""

from typing import TYPE_CHECKING

from . import retro
from ._radsight import (
    Calibration,
    Capture,
    CaptureDerivatives,
    CapturedImage,
    CaptureSeries,
    ExposureDerivatives,
    FisherInformation,
    Image,
    JobResult,
    MergedJob,
    RadsightError,
    RenderJob,
    Renderer,
    Scene,
    SceneError,
    Sensor,
    SeriesPicture,
    TracedRays,
    View,
    __version__,
    calibrate,
)
from ._shortcuts import capture, contributions, progress_bar, read_series, render, trace
from .own import Camera, Material

if TYPE_CHECKING:
    from types import ModuleType

    from . import arrays as arrays
    from . import distributed as distributed
    from . import radiance as radiance
else:
    # Imported at first use: they need packages that are optional, or many names.
    _LATE = {"arrays", "distributed", "radiance"}

    def __getattr__(name: str) -> "ModuleType":
        if name not in _LATE:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib import import_module

        return import_module(f".{name}", __name__)

__all__ = [
    "Calibration",
    "Camera",
    "Capture",
    "CaptureDerivatives",
    "CaptureSeries",
    "CapturedImage",
    "ExposureDerivatives",
    "FisherInformation",
    "Image",
    "JobResult",
    "Material",
    "MergedJob",
    "RadsightError",
    "RenderJob",
    "Renderer",
    "Scene",
    "SceneError",
    "Sensor",
    "SeriesPicture",
    "TracedRays",
    "View",
    "__version__",
    "calibrate",
    "capture",
    "contributions",
    "progress_bar",
    "read_series",
    "render",
    "retro",
    "trace",
]
