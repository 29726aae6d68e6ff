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
# # Measuring a part with scikit-image, OpenCV and Matplotlib
#
# The washer is dark in front of the bright sheet. How well does this camera measure its diameter, which is 25 mm?

# %%
from pathlib import Path

import cv2
import matplotlib.pyplot as plt
import numpy as np
import radsight
from skimage.filters import threshold_otsu

folder = next(path for path in Path.cwd().resolve().parents if (path / "radiance-scenes").is_dir()) / "radiance-scenes/gripps"
sheet = radsight.capture(folder / "fig14.toml", folder / "sheet-retro.rad", error=0.05)
part = radsight.capture(folder / "fig14.toml", folder / "sheet-retro.rad", folder / "washer.rad", error=0.05)

# %% [markdown]
# The exposure with the part over that without it takes the uneven light of the ring away.

# %%
ratio = part.exposure_j_per_m2 / sheet.exposure_j_per_m2
otsu = threshold_otsu(ratio)

# %% [markdown]
# OpenCV fits an ellipse to the outline of the dark pixels. Pixels are not square: the outline is scaled to millimetres on the top of the
# washer, 478 mm before the pinhole.

# %%
mm_per_pixel = np.array([13.75e-3, 16.0e-3]) * 478.0 / 6.75


def diameter_mm(threshold: float) -> float:
    """Mean axis of the ellipse through the outline of what is darker."""
    dark = (ratio < threshold).astype(np.uint8)
    outlines, _ = cv2.findContours(dark, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    outline = max(outlines, key=cv2.contourArea).reshape(-1, 2)
    _, axes, _ = cv2.fitEllipse((outline * mm_per_pixel).astype(np.float32))
    # The outline joins the centres of the outermost dark pixels, half a pixel inside of the edge.
    return float(np.mean(axes) + mm_per_pixel.mean())


# %% [markdown]
# Half of the contrast is the edge of a blurred silhouette. Otsu's threshold lies higher, and makes the part larger by the blur.

# %%
print(f"threshold 0.5: {diameter_mm(0.5):.2f} mm; Otsu's, {otsu:.2f}: {diameter_mm(otsu):.2f} mm; true: 25 mm")
assert abs(diameter_mm(0.5) - 25.0) < 1.0 < diameter_mm(otsu) - 25.0

# %% [markdown]
# A profile through the washer's centre shows the blur of the pinhole, which is 7 pixels wide.

# %%
row = int(np.argwhere(ratio < 0.5)[:, 0].mean())
figure, axis = plt.subplots(figsize=(7, 3))
axis.plot(ratio[row], label="with the part, over without")
axis.axhline(otsu, linestyle="--", color="grey", label="Otsu's threshold")
axis.set(xlabel="column", ylabel="relative exposure")
axis.legend()
figure.tight_layout()
