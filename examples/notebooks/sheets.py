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
# # Two sheets before one camera
#
# A retroreflecting sheet and a diffuse one, exposed by the same camera and light ring, as one data set.

# %%
from pathlib import Path

import numpy as np
import radsight
from radsight import retro

folder = next(path for path in Path.cwd().resolve().parents if (path / "radiance-scenes").is_dir()) / "radiance-scenes/gripps"
camera = radsight.Capture(folder / "fig10.toml", error=0.05)
sheets = {"retro": "sheet-retro.rad", "diffuse": "sheet-lambertian.rad"}
images = {name: camera.expose(radsight.Scene.load(folder / file)) for name, file in sheets.items()}
for name, image in images.items():
    exposure = image.exposure_j_per_m2
    print(f"{name}: mean {exposure.mean():.3e} J/m², mean grey value {image.grey.mean():.1f}")
gain = images["retro"].exposure_j_per_m2.mean() / images["diffuse"].exposure_j_per_m2.mean()
print(f"the retroreflecting sheet is {gain:.1f} times as bright")
assert gain > 2

# %% [markdown]
# With `xarray` (`pip install radsight[arrays]`) both are one data set with units.

# %%
try:
    import xarray

    from radsight.arrays import to_dataset

    both = xarray.concat([to_dataset(image) for image in images.values()], dim=xarray.Variable("sheet", list(images)))
    print(both.exposure.mean(("row", "column")).to_series(), both.exposure.attrs["units"])
except ImportError:
    print("xarray is not installed")

# %% [markdown]
# Coefficients of retroreflection R_A of a model, in the terms of the trade.

# %%
print("models:", ", ".join(retro.models()))
observation = np.array([0.1, 0.2, 0.33, 0.5, 1.0])
values = retro.coefficient("glass_bead", [100.0], observation, np.full(5, 5.0))
for angle, value in zip(observation, values, strict=True):
    print(f"observation {angle:4.2f}°: {value:7.1f} cd/(lx m²)")
