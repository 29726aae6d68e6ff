from collections.abc import Callable, Sequence
from os import PathLike
from typing import final

import numpy as np
import numpy.typing as npt

__version__: str

class RadsightError(ValueError): ...
class SceneError(RadsightError): ...

@final
class Scene:
    @staticmethod
    def load(*paths: str | PathLike[str]) -> Scene: ...
    @staticmethod
    def from_text(text: str) -> Scene: ...
    @property
    def surface_count(self) -> int: ...
    @property
    def warnings(self) -> str: ...

@final
class View:
    def __init__(self, arguments: str) -> None: ...

@final
class Renderer:
    def __init__(
        self,
        scene: Scene,
        *,
        ambient_bounces: int = 0,
        ambient_accuracy: float = 0.2,
        ambient_divisions: int = 512,
        ambient_super_samples: int = 128,
        error: float | None = None,
        samples: int | None = None,
        seed: int = 0,
        threads: int | None = None,
    ) -> None: ...
    def render(
        self, view: View, columns: int, rows: int, progress: Callable[[float], object] | None = None
    ) -> Image: ...
    def trace(self, rays: npt.NDArray[np.float64]) -> TracedRays: ...
    def contributions(self, rays: npt.NDArray[np.float64], modifiers: Sequence[str]) -> npt.NDArray[np.float64]: ...

@final
class TracedRays:
    @property
    def radiance_w_per_sr_m2(self) -> npt.NDArray[np.float64]: ...
    @property
    def distance(self) -> npt.NDArray[np.float64]: ...
    @property
    def point(self) -> npt.NDArray[np.float64]: ...
    @property
    def normal(self) -> npt.NDArray[np.float64]: ...

@final
class Image:
    @property
    def radiance_w_per_sr_m2(self) -> npt.NDArray[np.float32]: ...
    @property
    def error(self) -> float | None: ...
    @property
    def report(self) -> str: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def _repr_png_(self) -> bytes: ...

@final
class Capture:
    def __init__(
        self,
        path: str | PathLike[str],
        *,
        error: float = 0.005,
        samples: int | None = None,
        seed: int = 0,
        ambient_bounces: int = 0,
        threads: int | None = None,
    ) -> None: ...
    def expose(self, *scenes: str | PathLike[str]) -> CapturedImage: ...

@final
class CapturedImage:
    @property
    def exposure_j_per_m2(self) -> npt.NDArray[np.float64]: ...
    @property
    def grey(self) -> npt.NDArray[np.uint16]: ...
    @property
    def estimated_error(self) -> float | None: ...
    @property
    def rays(self) -> int: ...
    def _repr_png_(self) -> bytes: ...
