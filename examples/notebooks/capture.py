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
# # A capture: Fig. 14 in ten lines
#
# A camera file, its light ring and two scene files give exposures in J/m² and the sensor's grey values.

# %%
from pathlib import Path

import radsight

folder = next(path for path in Path.cwd().resolve().parents if (path / "radiance-scenes").is_dir()) / "radiance-scenes/gripps"
image = radsight.capture(folder / "fig14.toml", folder / "sheet-retro.rad", folder / "washer.rad", error=0.05)
print(image.grey.shape, image.grey.dtype, f"mean exposure {image.exposure_j_per_m2.mean():.3e} J/m²")
assert image.estimated_error is not None
print(f"estimated error {100 * image.estimated_error:.1f} % of the mean exposure")

# %% [markdown]
# A captured image shows itself in false colour, with a scale in J/m².

# %%
image

# %% [markdown]
# The retroreflecting sheet is bright, the washer before it dark: that is what the method is for.

# %%
bright, dark = (float(value) for value in (image.grey.max(), image.grey.min()))
print(f"grey values {dark:.0f} to {bright:.0f}")
assert bright > 2 * dark

# %% [markdown]
# The sensor alone: grey values of any exposures, and a calibration that finds its parameters again.

# %%
import numpy as np

sensor = radsight.Capture(folder / "fig14.toml").sensor
exposure = np.linspace(0, float(image.exposure_j_per_m2.max()), 50)
fit = radsight.calibrate(exposure, sensor.grey(exposure).astype(float), unit="J/m2")
print(f"gamma {fit.gamma:.3f}, 99 % between {fit.gamma_interval[0]:.3f} and {fit.gamma_interval[1]:.3f}")
