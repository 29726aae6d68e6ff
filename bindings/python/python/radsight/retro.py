"""Retroreflectors in the terms of their trade: coefficients R_A in cd/(lx m²) at angles in degrees.

>>> import numpy as np
>>> from radsight import retro
>>> retro.models()["glass_bead"][0]
'r_half'
>>> observation_deg, entrance_deg = np.array([0.5]), np.array([0.0])
>>> retro.coefficient("glass_bead", [100.0], observation_deg, entrance_deg).round(1)
array([107.6])
"""

from ._radsight import coefficient, fit, models

__all__ = ["coefficient", "fit", "models"]
