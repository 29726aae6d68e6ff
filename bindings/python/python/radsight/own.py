"""Cameras and materials written in Python: what they have to look like.

They are for trying ideas out. Python is called while rays are traced, once for a batch of many, so they take longer than compiled
ones; their numbers are the same.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


class Camera(Protocol):
    """A custom camera for `Renderer.render_camera`.

    Examples
    --------
    >>> import numpy as np, radsight
    >>> class Orthographic:
    ...     def rays(self, film, aperture):
    ...         x, y = 2 * film[:, 0] - 1, 1 - 2 * film[:, 1]
    ...         zero = np.zeros_like(x)
    ...         return np.stack([x, zero, y, zero, zero + 1, zero], axis=1)
    >>> scene = radsight.Scene.from_text("void glow white 0 0 4 1 1 1 0 white sphere ball 0 0 4 0 5 0 .5")
    >>> image = radsight.Renderer(scene, samples=64).render_camera(Orthographic(), 32, 32)
    >>> round(float(image.radiance_w_per_sr_m2[..., 0].mean()) * 16 / np.pi, 2)
    1.0
    """

    def rays(self, film: Array, aperture: Array) -> Array:
        """Rays through many points at once.

        Parameters
        ----------
        film : (n, 2) array of float
            Points of the film, (0, 0) its top left corner and (1, 1) the bottom right one.
        aperture : (n, 2) array of float
            Points of the aperture in the unit square.

        Returns
        -------
        (n, 6) or (n, 7) array of float
            Origin (scene units), direction, and if wanted what the radiance is multiplied by; NaN where nothing is seen.
        """
        ...


class Material(Protocol):
    """A custom reflectance model, which replaces a material of a scene: ``Scene.load(…, materials={"name": model})``.

    Directions are unit vectors away from the surface, in a frame with +z on the shading normal. A call gets the pairs of directions of
    many hits; a row's result must not depend on the other rows, as with NumPy's functions of single elements.

    Incident directions are drawn cosine-weighted, unless the object also has these two methods:

    ``sample(outgoing, u)``
        Incident directions for (n, 3) outgoing ones and (n, 3) points of the unit cube; NaN or zeros for absorption.
    ``pdf(outgoing, incident)``
        The densities, 1/sr, with which it does so: (n,).

    Examples
    --------
    >>> import numpy as np, radsight
    >>> class Lambert:
    ...     def evaluate(self, outgoing, incident):
    ...         return np.where(incident[:, 2] > 0, 0.5 / np.pi, 0.0)
    >>> text = '''void light lamp 0 0 3 100 100 100  lamp ring bulb 0 0 8 0 0 4 0 0 -1 0 .05
    ... void plastic grey 0 0 5 .9 .9 .9 0 0  grey ring table 0 0 8 0 0 0 0 0 1 0 6'''
    >>> scene = radsight.Scene.from_text(text, materials={"grey": Lambert()})
    >>> traced = radsight.Renderer(scene).trace(np.array([[0, 0, 1, 0, 0, -1.0]]))
    >>> round(float(traced.radiance_w_per_sr_m2[0, 0]) / (0.5 * 100 * 0.05**2 / 16), 2)
    1.0
    """

    def evaluate(self, outgoing: Array, incident: Array) -> Array:
        """Values of the BRDF, 1/sr, without the cosine.

        Parameters
        ----------
        outgoing, incident : (n, 3) array of float
            A row for each pair of directions.

        Returns
        -------
        (n,) or (n, 3) array of float
            Finite, and 0 or more; a rounding error below zero (down to -1e-9) counts as zero. Other numbers raise ``ValueError``.
        """
        ...
