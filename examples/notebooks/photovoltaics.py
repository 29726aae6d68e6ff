# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Irradiance on a bifacial module at nine points
#
# `bifacial_radiance` places a tilted module over the ground, makes a Perez sky, and asks `rtrace` for the irradiance at nine points of the
# front and of the back. Here the same points are traced by a function call, with NumPy arrays in and out, and then by the command that
# `bifacial_radiance` runs.

# %%
import time

import numpy as np
import numpy.typing as npt
import radsight
from radsight import radiance

tilt, height, length, albedo = np.radians(30), 1.0, 2.0, 0.3
sky = radiance.gendaylit(altitude=45, azimuth=0, dirnorm=700, diffhor=120, silent=True).decode()
across, up = np.array([1.0, 0, 0]), np.array([0, np.cos(tilt), np.sin(tilt)])
normal = np.cross(across, up)
middle = np.array([0, 0, height])
corners = [middle + x * 0.5 * across + y * 0.5 * length * up for x, y in [(-1, -1), (1, -1), (1, 1), (-1, 1)]]
text = f"""{sky}
skyfunc glow sky_mat 0 0 4 1 1 1 0
sky_mat source sky 0 0 4 0 0 1 180
void plastic ground 0 0 5 {albedo} {albedo} {albedo} 0 0
ground ring earth 0 0 8 0 0 0 0 0 1 0 60
void plastic module 0 0 5 .1 .1 .1 0 0
module polygon panel 0 0 12 {" ".join(f"{value:.6g}" for corner in corners for value in corner)}
"""
scene = radsight.Scene.from_text(text)

# %% [markdown]
# Nine points along the module, a millimetre off its surface: irradiance on a surface that faces the ray's direction.

# %%
along = np.linspace(-0.4, 0.4, 9)[:, None] * length * up + middle
front = np.hstack([along + 1e-3 * normal, np.broadcast_to(normal, along.shape)])
back = np.hstack([along - 1e-3 * normal, np.broadcast_to(-normal, along.shape)])
rays = np.ascontiguousarray(np.vstack([front, back]))

renderer = radsight.Renderer(
    scene, quantity="irradiance", ambient_bounces=3, ambient_accuracy=0.1, ambient_divisions=2048, ambient_super_samples=256
)
begun = time.perf_counter()
irradiance = renderer.trace(rays).irradiance_w_per_m2 @ np.array([1, 1, 1]) / 3
seconds = time.perf_counter() - begun
for name, values in (("front", irradiance[:9]), ("back", irradiance[9:])):
    print(f"{name}: {values.mean():6.1f} W/m², {values.min():.1f} to {values.max():.1f}")
print(f"{seconds:.2f} s")

# %% [markdown]
# `bifacial_radiance`'s own way: an octree, and `rtrace` with text in and out (here radsight's; with `pyradiance` in the place of
# `radsight.radiance` it is Radiance's).

# %%
import importlib
import tempfile
from pathlib import Path
from typing import Any


def by_program(module: Any) -> tuple[npt.NDArray[np.float64], float]:
    """Irradiance at the points, and how long it took."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "scene.rad").write_text(text)
        begun = time.perf_counter()
        Path(folder, "scene.oct").write_bytes(module.oconv(Path(folder, "scene.rad")))
        lines = "".join(" ".join(f"{number:.9g}" for number in ray) + "\n" for ray in rays)
        options = "-ab 3 -aa .1 -ar 256 -ad 2048 -as 256".split()
        said = module.rtrace(lines.encode(), Path(folder, "scene.oct"), header=False, irradiance=True, params=options)
        return np.loadtxt(said.splitlines()).mean(axis=1), time.perf_counter() - begun


modules = {"radsight's rtrace": radiance}
try:
    modules["Radiance's rtrace"] = importlib.import_module("pyradiance")
except ImportError:
    print("pyradiance is not installed: Radiance's own numbers are left out")
for name, module in modules.items():
    values, seconds = by_program(module)
    difference = np.abs(values / irradiance - 1).max()
    print(f"{name}: front {values[:9].mean():.1f}, back {values[9:].mean():.1f} W/m², {seconds:.2f} s; ", end="")
    print(f"no point differs by more than {100 * difference:.1f} %")
    assert difference < 0.1

# %% [markdown]
# `examples/python/bifacial_nine_points.py` runs `bifacial_radiance` itself (0.5.4, `AnalysisObj` with real Radiance) on three rows of five
# modules, and traces the same points of the same scene files by `radsight.trace`. Means of the nine points in W/m², and processor time with
# reading the scene (November 2026, medians of three runs on two cores):
#
# | accuracy | front | back | time | largest difference of a point |
# |---|---|---|---|---|
# | low: `bifacial_radiance` | 825.2 | 72.2 | 1.52 s | |
# | low: `radsight` | 825.6 | 72.4 | 0.90 s | 1.4 to 2.6 % |
# | high: `bifacial_radiance` | 825.4 | 72.3 | 14.1 s | |
# | high: `radsight` | 825.6 | 72.5 | 1.0 s | 1.2 to 1.6 % |

# %% [markdown]
# By the way: front and back as a table.

# %%
ratio = irradiance[9:].mean() / irradiance[:9].mean()
print(f"bifacial gain at a bifaciality of 0.7: {100 * 0.7 * ratio:.1f} %")
assert 0.05 < ratio < 0.5
