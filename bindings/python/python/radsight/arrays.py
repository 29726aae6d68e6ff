"""Results as xarray and pandas objects, with units. Needs ``pip install radsight[arrays]``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._radsight import CapturedImage, Image, MergedJob, SeriesPicture, TracedRays

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["series_to_dataset", "series_to_frame", "to_dataset", "to_frame"]

_BANDS = ["red", "green", "blue"]


def to_dataset(picture: Image | CapturedImage | MergedJob) -> xarray.Dataset:
    """A picture or capture as an `xarray.Dataset`, by row and column.

    Parameters
    ----------
    picture : Image, CapturedImage or MergedJob
        Its arrays are not copied.

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
        What `Renderer.trace` gives.

    Returns
    -------
    pandas.DataFrame
        Radiance in W/(sr·m²) or irradiance in W/m² by band, distance and point in scene units.
    """
    import pandas

    try:
        values, names = traced.radiance_w_per_sr_m2, [f"radiance_{band}_w_per_sr_m2" for band in _BANDS]
    except AttributeError:
        values, names = traced.irradiance_w_per_m2, [f"irradiance_{band}_w_per_m2" for band in _BANDS]
    columns = np.concatenate([values, traced.distance[:, None], traced.point], axis=1)
    return pandas.DataFrame(columns, columns=[*names, "distance", "x", "y", "z"])


def series_to_dataset(pictures: Sequence[SeriesPicture], images: Sequence[CapturedImage]) -> xarray.Dataset:
    """The pictures of a series as an `xarray.Dataset`, by picture, row and column.

    Parameters
    ----------
    pictures : sequence of SeriesPicture
        The pictures passed to `CaptureSeries.expose`.
    images : sequence of CapturedImage
        Images of one size, returned by `CaptureSeries.expose`.

    Returns
    -------
    xarray.Dataset
        The variables of `to_dataset` that all images have. The pictures' names and keys of the camera file are coordinates.
    """
    import xarray

    dataset = xarray.concat([to_dataset(image) for image in images], dim="picture", join="exact", data_vars="all")
    keys = sorted({key for picture in pictures for key in picture.keys})
    columns: dict[str, Any] = {key: ("picture", [picture.keys.get(key, "") for picture in pictures]) for key in keys}
    return dataset.assign_coords(picture=[picture.name for picture in pictures], **columns)


def series_to_frame(pictures: Sequence[SeriesPicture], images: Sequence[CapturedImage]) -> pandas.DataFrame:
    """What is known of each picture of a series as a `pandas.DataFrame`, a row each.

    Parameters
    ----------
    pictures : sequence of SeriesPicture
        The pictures passed to `CaptureSeries.expose`.
    images : sequence of CapturedImage
        What it gave.

    Returns
    -------
    pandas.DataFrame
        By name: replaced keys of the camera file, mean exposure, its estimated relative error, rays, mean grey value (NaN without a sensor).
    """
    import pandas

    def row(picture: SeriesPicture, image: CapturedImage) -> dict[str, Any]:
        return {
            **picture.keys,
            "mean_exposure_j_per_m2": image.exposure_j_per_m2.mean(),
            "estimated_error": image.estimated_error,
            "rays": image.rays,
            "mean_grey": image.grey.mean() if image.has_sensor else np.nan,
        }

    names = pandas.Index([picture.name for picture in pictures], name="picture")
    return pandas.DataFrame([row(*pair) for pair in zip(pictures, images, strict=True)], index=names)
