"""Retroreflectors in the terms of their trade: coefficients R_A in cd/(lx m²) at angles in degrees.

>>> import numpy as np
>>> from radsight import retro
>>> "gaussian" in retro.models() or len(retro.models()) > 0
True
"""

from ._radsight import coefficient, fit, models

__all__ = ["coefficient", "fit", "models"]
