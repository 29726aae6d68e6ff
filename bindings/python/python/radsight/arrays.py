"""Results as xarray and pandas objects, with units. Needs ``pip install radsight[arrays]``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._radsight import CapturedImage, Image, MergedJob, TracedRays

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["to_dataset", "to_frame"]

_BANDS = ["red", "green", "blue"]


def to_dataset(picture: Image | CapturedImage | MergedJob) -> xarray.Dataset:
    """A picture or capture as an `xarray.Dataset`, by row and column.

    Parameters
    ----------
    picture : Image, CapturedImage or MergedJob

    Returns
    -------
    xarray.Dataset
        Each variable has its unit in ``attrs["units"]``.
    """
    import xarray

    pixel = ("row", "column")
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {}
    if isinstance(picture, Image):
        variables["radiance"] = ((*pixel, "band"), picture.radiance_w_per_sr_m2, {"units": "W/(sr m2)"})
        if picture.relative_error is not None:
            variables["relative_error"] = (pixel, picture.relative_error, {"units": "1"})
        coordinates["band"] = _BANDS
    elif isinstance(picture, CapturedImage):
        variables["exposure"] = (pixel, picture.exposure_j_per_m2, {"units": "J/m2"})
        if picture.standard_error_j_per_m2 is not None:
            variables["standard_error"] = (pixel, picture.standard_error_j_per_m2, {"units": "J/m2"})
        if picture.has_sensor:
            variables["grey"] = (pixel, picture.grey, {"units": "1"})
    else:
        is_capture = picture.values.shape[2] == 1
        name, units = ("exposure", "J/m2") if is_capture else ("radiance", "W/(sr m2)")
        for variable, values in ((name, picture.values), ("standard_error", picture.standard_errors)):
            shape = (pixel, values[..., 0]) if is_capture else ((*pixel, "band"), values)
            variables[variable] = (*shape, {"units": units})
        if not is_capture:
            coordinates["band"] = _BANDS
    return xarray.Dataset(variables, coords=coordinates)


def to_frame(traced: TracedRays) -> pandas.DataFrame:
    """What rays found as a `pandas.DataFrame`, a row each.

    Parameters
    ----------
    traced : TracedRays

    Returns
    -------
    pandas.DataFrame
        Radiance in W/(sr·m²) by band, distance and point in scene units.
    """
    import pandas

    columns = np.concatenate(
        [traced.radiance_w_per_sr_m2, traced.distance[:, None], traced.point],
        axis=1,
    )
    names = [f"radiance_{band}_w_per_sr_m2" for band in _BANDS]
    return pandas.DataFrame(columns, columns=[*names, "distance", "x", "y", "z"])
