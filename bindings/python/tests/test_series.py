"""Series of captures: what single captures give, from tables, as data sets."""

import pathlib

import numpy as np
import pytest
import radsight

GRIPPS = pathlib.Path(__file__).parents[3] / "radiance-scenes" / "gripps"
TABLE = """name,rig.ring_diameter_mm,camera.exposure_ms
narrow,20,10
wide,30,10
long,30,20
"""


@pytest.fixture
def scene():
    return radsight.Scene.load(GRIPPS / "sheet-retro.rad")


def test_a_series_is_what_its_captures_are_alone(scene, tmp_path):
    (tmp_path / "series.csv").write_text(TABLE)
    pictures = radsight.read_series(tmp_path / "series.csv", GRIPPS / "fig10.toml", samples=1)
    heard: list[float] = []
    images = radsight.CaptureSeries(scene).expose(pictures, progress=heard.append)
    assert [picture.name for picture in pictures] == ["narrow", "wide", "long"] and heard[-1] == 1.0
    for picture, image in zip(pictures[:2], images[:2]):
        alone = picture.capture.expose(scene)
        np.testing.assert_array_equal(image.exposure_j_per_m2, alone.exposure_j_per_m2)
        np.testing.assert_array_equal(image.grey, alone.grey)
    np.testing.assert_allclose(images[2].exposure_j_per_m2, 2 * images[1].exposure_j_per_m2)
    assert pictures[0].capture.with_keys({"rig.ring_diameter_mm": "30"}).expose(scene).rays == images[1].rays


def test_parts_that_move_are_elsewhere_in_the_picture(scene):
    text = "void mirror steel 0 0 3 .8 .8 .8 steel sphere ball 0 0 4 0 0 .01 .008"
    lit = radsight.Scene([("ball.rad", text.encode()), ("sky.rad", b"void glow sky 0 0 4 1 1 1 0 sky source up 0 0 4 0 0 1 180")])
    camera = radsight.Capture(GRIPPS / "fig10.toml", error=0.05)
    poses = [radsight.SeriesPicture(camera, {"ball": f"-t {x} 0 0"}, name=str(x)) for x in (0, 0.02)]
    at_first, moved = (image.exposure_j_per_m2 for image in radsight.CaptureSeries(lit).expose(poses))
    assert (at_first != moved).any()
    # The same as a ball that is there from the start.
    there = radsight.Scene([("ball.rad", text.replace("0 0 .01 .008", ".02 0 .01 .008").encode()), ("sky.rad", lit.__reduce__()[1][0][1][1])])
    np.testing.assert_array_equal(moved, camera.expose(there).exposure_j_per_m2)
    with pytest.raises(radsight.RadsightError, match="rigid"):
        radsight.SeriesPicture(camera, {"ball": "-s 2"})


def test_tables_and_data_sets(scene):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    from radsight.arrays import series_to_dataset, series_to_frame

    camera = radsight.Capture(GRIPPS / "fig10.toml", samples=1)
    table = pandas.DataFrame({"name": ["a", "b"], "camera.exposure_ms": [5, 10]})
    pictures = radsight.read_series(table, camera)
    images = radsight.CaptureSeries(scene).expose(pictures)
    dataset = series_to_dataset(pictures, images)
    assert dataset.exposure.dims == ("picture", "row", "column") and dataset.exposure.attrs["units"] == "J/m2"
    np.testing.assert_array_equal(dataset.exposure.sel(picture="b"), images[1].exposure_j_per_m2)
    frame = series_to_frame(pictures, images)
    assert list(frame.index) == ["a", "b"] and list(frame["camera.exposure_ms"]) == ["5", "10"]
    np.testing.assert_allclose(frame["mean_exposure_j_per_m2"]["b"], 2 * frame["mean_exposure_j_per_m2"]["a"])
    with pytest.raises(radsight.SceneError, match="<table>:1:1: error: unknown column"):
        radsight.read_series(pandas.DataFrame({"leds": [1]}), camera)
