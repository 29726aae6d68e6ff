from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Literal, TypeAlias, final

import numpy as np
import numpy.typing as npt

from .own import Camera, Material

__version__: str
__all__ = [
    "Calibration",
    "Capture",
    "CaptureSeries",
    "CapturedImage",
    "Image",
    "JobResult",
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
    "coefficient",
    "fit",
    "models",
    "series_pictures",
]

_Progress: TypeAlias = Callable[[float], object]
_Doubles: TypeAlias = npt.NDArray[np.float64]
_Quantity: TypeAlias = Literal["radiance", "irradiance", "surface_irradiance"]
_Span: TypeAlias = tuple[int, int]

class RadsightError(ValueError): ...

class SceneError(RadsightError):
    mistakes: list[tuple[str | None, int | None, int | None, str]]

@final
class Scene:
    def __new__(
        cls,
        texts: Sequence[tuple[str, bytes]],
        *,
        files: Mapping[str, bytes] | None = None,
        materials: Mapping[str, object] | None = None,
    ) -> Scene: ...
    @staticmethod
    def load(*paths: str | PathLike[str], materials: Mapping[str, Material] | None = None) -> Scene: ...
    @staticmethod
    def from_text(text: str, *, materials: Mapping[str, Material] | None = None) -> Scene: ...
    @property
    def surface_count(self) -> int: ...
    @property
    def warnings(self) -> str: ...

@final
class View:
    def __new__(cls, arguments: str) -> View: ...
    @property
    def arguments(self) -> str: ...

@final
class Renderer:
    def __new__(
        cls,
        scene: Scene,
        *,
        ambient_bounces: int = 0,
        ambient_accuracy: float = 0.2,
        ambient_divisions: int = 512,
        ambient_super_samples: int = 128,
        error: float | None = None,
        samples: int | None = None,
        seed: int = 0,
        quantity: _Quantity = "radiance",
        threads: int | None = None,
        irradiance_cache: bytes | None = None,
    ) -> Renderer: ...
    def render(self, view: View, columns: int, rows: int, progress: _Progress | None = None) -> Image: ...
    def render_camera(
        self, camera: Camera, columns: int, rows: int, progress: _Progress | None = None
    ) -> Image: ...
    def trace(self, rays: npt.ArrayLike, *, first: int = 0, progress: _Progress | None = None) -> TracedRays: ...
    def contributions(
        self, rays: npt.ArrayLike, modifiers: Sequence[str], *, first: int = 0, progress: _Progress | None = None
    ) -> _Doubles: ...
    def fill_irradiance_cache(
        self, rays: npt.ArrayLike | None = None, *, job: RenderJob | None = None, progress: _Progress | None = None
    ) -> bytes | None: ...
    def run_job(
        self, job: RenderJob, *, camera: Capture | None = None, rays: npt.ArrayLike | None = None
    ) -> JobResult: ...

@final
class TracedRays:
    @property
    def radiance_w_per_sr_m2(self) -> _Doubles: ...
    @property
    def irradiance_w_per_m2(self) -> _Doubles: ...
    @property
    def distance(self) -> _Doubles: ...
    @property
    def point(self) -> _Doubles: ...
    @property
    def normal(self) -> _Doubles: ...
    def __len__(self) -> int: ...

@final
class Image:
    @property
    def radiance_w_per_sr_m2(self) -> npt.NDArray[np.float32]: ...
    @property
    def error(self) -> float | None: ...
    @property
    def report(self) -> str: ...
    @property
    def relative_error(self) -> npt.NDArray[np.float32] | None: ...
    @property
    def samples(self) -> npt.NDArray[np.uint32] | None: ...
    def report_html(self, title: str = "radsight") -> str: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def false_color_png(self) -> bytes: ...
    def _repr_png_(self) -> bytes: ...

@final
class Capture:
    def __new__(
        cls,
        path: str | PathLike[str],
        *,
        error: float = 0.005,
        samples: int | None = None,
        seed: int = 0,
        ambient_bounces: int = 0,
        threads: int | None = None,
    ) -> Capture: ...
    @staticmethod
    def from_text(
        text: str,
        *,
        name: str = "<text>",
        files: Mapping[str, bytes] | None = None,
        error: float = 0.005,
        samples: int | None = None,
        seed: int = 0,
        ambient_bounces: int = 0,
        threads: int | None = None,
    ) -> Capture: ...
    def expose(self, *scenes: str | PathLike[str] | Scene, progress: _Progress | None = None) -> CapturedImage: ...
    def with_ring(self, scene: Scene) -> Scene: ...
    def with_keys(self, keys: Mapping[str, str]) -> Capture: ...
    def with_threads(self, threads: int | None) -> Capture: ...
    @property
    def sensor(self) -> Sensor: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def summary(self) -> str: ...

@final
class CapturedImage:
    @property
    def exposure_j_per_m2(self) -> _Doubles: ...
    @property
    def grey(self) -> npt.NDArray[np.uint16]: ...
    @property
    def has_sensor(self) -> bool: ...
    @property
    def estimated_error(self) -> float | None: ...
    @property
    def rays(self) -> int: ...
    @property
    def standard_error_j_per_m2(self) -> _Doubles | None: ...
    def report_html(self, title: str = "radsight") -> str: ...
    def _repr_png_(self) -> bytes: ...

@final
class SeriesPicture:
    def __new__(cls, capture: Capture, moves: Mapping[str, str] = ..., name: str = ...) -> SeriesPicture: ...
    @property
    def name(self) -> str: ...
    @property
    def capture(self) -> Capture: ...
    @property
    def keys(self) -> dict[str, str]: ...

@final
class CaptureSeries:
    def __new__(cls, scene: Scene) -> CaptureSeries: ...
    def expose(
        self, pictures: Sequence[SeriesPicture], progress: _Progress | None = None
    ) -> list[CapturedImage]: ...

def series_pictures(text: str, camera: Capture, *, name: str = "<series>") -> list[SeriesPicture]: ...
@final
class Sensor:
    def grey(self, exposure_j_per_m2: npt.ArrayLike, *, seed: int = 0) -> npt.NDArray[np.uint16]: ...
    @property
    def bits(self) -> int: ...
    @property
    def largest(self) -> int: ...

@final
class Calibration:
    @property
    def k(self) -> float: ...
    @property
    def gamma(self) -> float: ...
    @property
    def grey_background(self) -> float: ...
    @property
    def grey_max(self) -> float | None: ...
    @property
    def rms_residual(self) -> float: ...
    @property
    def saturated(self) -> int: ...
    @property
    def unit(self) -> str: ...
    @property
    def k_interval(self) -> tuple[float, float]: ...
    @property
    def gamma_interval(self) -> tuple[float, float]: ...
    @property
    def grey_background_interval(self) -> tuple[float, float]: ...

def calibrate(exposure: npt.ArrayLike, grey: npt.ArrayLike, *, unit: str = "uJ/cm2") -> Calibration: ...

@final
class RenderJob:
    def __new__(
        cls,
        *,
        samples: int,
        view: View | None = None,
        columns: int = 0,
        rows: int = 0,
        camera: str | None = None,
        rays: str | None = None,
        quantity: _Quantity = "radiance",
        scenes: Sequence[str] = ...,
        seed: int = 0,
        ambient_bounces: int = 0,
        ambient_accuracy: float = 0.0,
        ambient_divisions: int | None = None,
        ambient_super_samples: int | None = None,
        irradiance_cache: str | None = None,
    ) -> RenderJob: ...
    @staticmethod
    def from_json(text: str, name: str = "<job>") -> RenderJob: ...
    def to_json(self) -> str: ...
    @property
    def samples(self) -> int: ...
    @property
    def rows(self) -> _Span | None: ...
    @property
    def columns(self) -> _Span | None: ...
    @property
    def rays(self) -> _Span | None: ...
    @property
    def picture_size(self) -> tuple[int, int]: ...
    def split(self, parts: int, size: tuple[int, int] | None = None) -> list[RenderJob]: ...
    def split_tiles(self, columns: int, rows: int, size: tuple[int, int] | None = None) -> list[RenderJob]: ...
    def split_rays(self, rays: int, all: int) -> list[RenderJob]: ...
    def with_samples(self, samples: int) -> RenderJob: ...

@final
class JobResult:
    @staticmethod
    def from_bytes(data: bytes, name: str = "<part>") -> JobResult: ...
    def to_bytes(self) -> bytes: ...
    @property
    def job(self) -> RenderJob: ...

@final
class MergedJob:
    def __new__(cls, parts: Sequence[JobResult]) -> MergedJob: ...
    @property
    def values(self) -> npt.NDArray[np.float32]: ...
    @property
    def radiance_w_per_sr_m2(self) -> npt.NDArray[np.float32]: ...
    @property
    def irradiance_w_per_m2(self) -> npt.NDArray[np.float32]: ...
    @property
    def exposure_j_per_m2(self) -> npt.NDArray[np.float32]: ...
    @property
    def standard_errors(self) -> npt.NDArray[np.float32]: ...
    @property
    def relative_error(self) -> float | None: ...
    @property
    def missing(self) -> list[tuple[_Span, _Span]]: ...
    @property
    def job(self) -> RenderJob: ...
    def _repr_png_(self) -> bytes: ...

def models() -> dict[str, list[str]]: ...
def coefficient(
    model: str,
    numbers: Sequence[float],
    observation_deg: npt.ArrayLike,
    entrance_deg: npt.ArrayLike,
    *,
    rotation_deg: float = 0.0,
    word: str | None = None,
) -> _Doubles: ...
def fit(
    model: str,
    observation_deg: npt.ArrayLike,
    entrance_deg: npt.ArrayLike,
    coefficient_cd_per_lx_m2: npt.ArrayLike,
    *,
    word: str | None = None,
) -> dict[str, float]: ...
