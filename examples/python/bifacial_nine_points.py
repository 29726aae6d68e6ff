# pyright: reportMissingImports=false
"""The nine points of `bifacial_radiance`: its own way with real Radiance, and the same points through `radsight.trace`.

Needs ``pip install bifacial_radiance pyradiance``; `pyradiance` brings Radiance's programs. Prints irradiances and times.

    python examples/python/bifacial_nine_points.py
"""

from __future__ import annotations

import contextlib
import io
import os
import resource
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import radsight

# Options of AnalysisObj.analysis for its accuracies.
OPTIONS: dict[str, dict[str, Any]] = {
    "low": {"ambient_bounces": 2, "ambient_accuracy": 0.1, "ambient_divisions": 2048, "ambient_super_samples": 256},
    "high": {"ambient_bounces": 5, "ambient_accuracy": 0.08, "ambient_divisions": 2048, "ambient_super_samples": 512},
}
DIRECT_NORMAL_W_PER_M2, DIFFUSE_HORIZONTAL_W_PER_M2 = 700, 120
# As for gendaylit -ang: the azimuth is west of south.
SUN_ALTITUDE_DEG, SUN_AZIMUTH_DEG = 45, 0

Array = npt.NDArray[np.float64]


def processor_seconds() -> float:
    """Of this process and of those that it has run."""
    usages = [resource.getrusage(of) for of in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def radiance_on_path() -> None:
    """Let `bifacial_radiance` find the programs of `pyradiance`."""
    import pyradiance

    folder = Path(pyradiance.__file__).parent
    os.environ["PATH"] = f"{folder / 'bin'}{os.pathsep}{os.environ['PATH']}"
    os.environ["RAYPATH"] = f".{os.pathsep}{folder / 'lib'}"


def their_scene(folder: Path) -> tuple[list[str], str, object]:
    """Scene files, octree and scene of a row of modules, made by `bifacial_radiance`."""
    from bifacial_radiance import RadianceObj

    radiance = RadianceObj("nine", path=str(folder))
    radiance.setGround(0.3)
    radiance.gendaylit2manual(DIRECT_NORMAL_W_PER_M2, DIFFUSE_HORIZONTAL_W_PER_M2, SUN_ALTITUDE_DEG, SUN_AZIMUTH_DEG)
    module = radiance.makeModule(name="module", x=1, y=2)
    row = {"tilt": 30, "pitch": 5, "clearance_height": 0.5, "azimuth": 180, "nMods": 5, "nRows": 3}
    scene = radiance.makeScene(module, sceneDict=row)
    return radiance.getfilelist(), radiance.makeOct(radiance.getfilelist()), scene


def their_way(octree: str, scene: object, accuracy: str) -> tuple[Array, Array]:
    """Rays towards front and back of the middle module at nine points each, and their irradiances."""
    from bifacial_radiance import AnalysisObj

    analysis = AnalysisObj(octree, "nine")
    scans = analysis.moduleAnalysis(scene, sensorsy=9)
    analysis.analysis(octree, "nine", *scans, accuracy=accuracy)
    rays = [rays_of(analysis, scan) for scan in scans]
    return np.vstack(rays), np.concatenate([analysis.Wm2Front, analysis.Wm2Back])


def rays_of(analysis: Any, scan: dict[str, Any]) -> Array:
    """The points of a scan as `bifacial_radiance` writes them for rtrace."""
    return np.array(analysis._linePtsMakeDict(scan).split(), float).reshape(-1, 6)


def our_way(files: list[str], rays: Array, accuracy: str) -> Array:
    """Irradiance of the surfaces that the rays meet."""
    scene = radsight.Scene.load(*files)
    traced = radsight.trace(scene, rays, quantity="surface_irradiance", **OPTIONS[accuracy])
    return np.asarray(traced["irradiance_w_per_m2"].mean(axis=1))


def compare(accuracy: str) -> float:
    """Print both ways, and give the largest relative difference of a point."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder), contextlib.redirect_stdout(io.StringIO()):
        files, octree, scene = their_scene(Path(folder))
        begun = processor_seconds()
        rays, theirs = their_way(octree, scene, accuracy)
        between = processor_seconds()
        ours = our_way(files, rays, accuracy)
        seconds = between - begun, processor_seconds() - between
    difference = np.abs(ours / theirs - 1)
    print(f"accuracy {accuracy!r}, W/m² (bifacial_radiance | radsight):")
    for name, part in (("front", slice(0, 9)), ("back", slice(9, 18))):
        for point, (one, other) in enumerate(zip(theirs[part], ours[part], strict=True), 1):
            print(f"  {name} {point}: {one:7.2f} | {other:7.2f}")
        print(f"  {name} mean: {theirs[part].mean():7.2f} | {ours[part].mean():7.2f}")
    print(f"processor time: {seconds[0]:.2f} s | {seconds[1]:.2f} s; largest difference {100 * difference.max():.1f} %")
    return float(difference.max())


if __name__ == "__main__":
    radiance_on_path()
    for asked in OPTIONS:
        compare(asked)
