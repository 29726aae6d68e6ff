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
# # A view for glare
#
# A fisheye picture of a room with a window, its luminance in false colour, and the vertical illuminance at the eye, from the picture
# and from a single ray.

# %%
import numpy as np
import radsight

room = """
void glow daylight 0 0 4 8 8 8 0
void plastic wall 0 0 5 .6 .6 .6 0 0
void plastic floor 0 0 5 .3 .25 .2 0 0
daylight polygon window 0 0 12 -1 4 1  1 4 1  1 4 2.4  -1 4 2.4
wall polygon left 0 0 12 -2 0 0  -2 4 0  -2 4 3  -2 0 3
wall polygon right 0 0 12 2 0 0  2 0 3  2 4 3  2 4 0
wall polygon ceiling 0 0 12 -2 0 3  -2 4 3  2 4 3  2 0 3
floor polygon ground 0 0 12 -2 0 0  2 0 0  2 4 0  -2 4 0
wall polygon back 0 0 12 -2 0 0  -2 0 3  2 0 3  2 0 0
"""
# The wall around the window, in four pieces.
pieces = [(-2, -1, 0, 3), (1, 2, 0, 3), (-1, 1, 0, 1), (-1, 1, 2.4, 3)]
for number, (x0, x1, z0, z1) in enumerate(pieces):
    room += f"wall polygon front{number} 0 0 12 {x0} 4.01 {z0}  {x1} 4.01 {z0}  {x1} 4.01 {z1}  {x0} 4.01 {z1}\n"
scene = radsight.Scene.from_text(room)
view = radsight.View("-vta -vp 0 1 1.2 -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180")
image = radsight.render(scene, view, 80, 80, ambient_bounces=2, error=0.15)
print(image.report)

# %%
from IPython.display import Image

Image(image.false_color_png())

# %% [markdown]
# Vertical illuminance at the eye: radiance times cosine over the hemisphere. In an angular fisheye view the angle from the axis grows
# evenly with the distance from the middle, so a pixel has the solid angle (π/2)² · sin θ / θ of the square of its side.

# %%
size = image.radiance_w_per_sr_m2.shape[0]
place = (np.arange(size) + 0.5) / size * 2 - 1
x, y = np.meshgrid(place, place)
theta = np.hypot(x, y) * np.pi / 2
inside = theta < np.pi / 2
solid_angle = np.where(inside, np.sinc(theta / np.pi) * (np.pi / 2) ** 2 * (2 / size) ** 2, 0)
luminance = 179 * image.radiance_w_per_sr_m2 @ np.array([0.265, 0.670, 0.065])
from_picture = float((luminance * np.cos(theta) * solid_angle).sum())
eye = np.array([[0, 1, 1.2, 0, 1, 0.0]])
traced = radsight.trace(scene, eye, quantity="irradiance", ambient_bounces=3, ambient_accuracy=0.0, ambient_divisions=4096)
irradiance = traced["irradiance_w_per_m2"][0]
from_ray = float(179 * irradiance @ np.array([0.265, 0.670, 0.065]))
print(f"vertical illuminance at the eye: {from_picture:.0f} lx from the picture, {from_ray:.0f} lx from a ray")
assert abs(from_picture / from_ray - 1) < 0.15
print(f"the window is {luminance.max() / np.median(luminance[inside]):.0f} times as bright as the median of the view")
