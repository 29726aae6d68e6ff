"""`radsight.radiance` against `pyradiance`: the same signatures, and the same answers of the programs of both."""

import inspect
import os

import numpy as np
import pytest
import radsight
from radsight import _program, radiance

pyradiance = pytest.importorskip("pyradiance")

SCENE = b"""void light lamp 0 0 3 100 100 100
void plastic grey 0 0 5 .5 .4 .3 0 0
lamp sphere bulb 0 0 4 0 0 4 .05
grey ring table 0 0 8 0 0 0 0 0 1 0 6
"""
OWN = {"run"}


def has_program():
    try:
        return os.path.isfile(_program.path())
    except FileNotFoundError:
        return False


needs_program = pytest.mark.skipif(not has_program(), reason="there is no program")


@pytest.mark.parametrize("name", sorted(set(radiance.__all__) - OWN))
def test_signatures_are_pyradiances(name):
    def parameters(of):
        return {name: (p.default, p.kind) for name, p in inspect.signature(of).parameters.items()}

    assert parameters(getattr(radiance, name)) == parameters(getattr(pyradiance, name))


@pytest.fixture
def octree(tmp_path):
    (tmp_path / "scene.rad").write_bytes(SCENE)
    (tmp_path / "scene.oct").write_bytes(radiance.oconv(tmp_path / "scene.rad"))
    return tmp_path / "scene.oct"


@needs_program
def test_rays_bring_what_radiances_bring(octree):
    rays = b"".join(b"%g 0 1 0 0 -1\n" % x for x in np.linspace(0, 3, 7))
    ours, theirs = (
        np.loadtxt(module.rtrace(rays, octree, header=False, params=["-dj", "0"]).splitlines())
        for module in (radiance, pyradiance)
    )
    np.testing.assert_allclose(ours, theirs, rtol=0.02)
    irradiance = radiance.rtrace(b"0 0 0 0 0 1\n", octree, header=False, irradiance=True)
    np.testing.assert_allclose(float(irradiance.split()[0]), 100 * np.pi * 0.05**2 / 16, rtol=0.02)


@needs_program
def test_pictures_can_be_passed_on(octree):
    view = ["-vp", "0", "-4", "3", "-vd", "0", "4", "-3", "-vh", "60", "-vv", "45"]
    picture = radiance.rpict(view, octree, xres=64, yres=64)
    columns, rows = radiance.get_image_dimensions(picture)
    assert (columns, rows) == pyradiance.get_image_dimensions(picture)
    small = radiance.pfilt(picture, xres="16", yres="16", one_pass=True)
    assert b"pfilt" in radiance.get_header(small)
    ours, theirs = (
        np.loadtxt(module.pvalue(small, header=False, resstr=False).splitlines()) for module in (radiance, pyradiance)
    )
    np.testing.assert_allclose(ours, theirs)
    assert radiance.pcond(picture, human=True).startswith(b"#?RADIANCE")
    assert radiance.falsecolor(picture, scale="10").startswith(b"#?RADIANCE")


@needs_program
def test_scenes_and_numbers_are_radiances():
    assert radiance.getbbox(SCENE) == pyradiance.getbbox(SCENE)
    moved = [
        module.Xform(SCENE, modifier="grey").translate(1, 2, 3).rotatez(30)().split(b"\n", 1)[1].split()
        for module in (radiance, pyradiance)
    ]
    assert moved[0] == moved[1]
    box = [module.genbox("grey", "box", 1, 2, 3) for module in (radiance, pyradiance)]
    assert box[0].split(b"\n", 1)[1].split() == box[1].split(b"\n", 1)[1].split()
    assert radiance.cnt(2, 2) == pyradiance.cnt(2, 2)
    assert radiance.rcalc(b"1 2\n3 4\n", expr="$1=$1+$2") == pyradiance.rcalc(b"1 2\n3 4\n", expr="$1=$1+$2")
    matrix = b"#?RADIANCE\nNROWS=2\nNCOLS=2\nNCOMP=1\nFORMAT=ascii\n\n1 2\n3 4\n"
    for module in (radiance, pyradiance):
        assert [float(number) for number in module.rmtxop(matrix, transpose=True).split()[-4:]] == [1, 3, 2, 4]


@needs_program
def test_contributions_are_radiances(octree):
    for module in (radiance, pyradiance):
        rays = b"0 0 1 0 0 -1\n"
        said = module.Rcontrib(rays, octree, inform="a", outform="a", params=["-h", "-V+", "-ab", "0"])
        said.add_modifier(modifier="lamp")
        value = float(said().split()[0])
        np.testing.assert_allclose(value, 0.5 * 100 * 0.05**2 / 16, rtol=0.04)


@needs_program
def test_failures_are_exceptions_with_messages(tmp_path):
    with pytest.raises(RuntimeError, match="chrome"):
        (tmp_path / "bad.rad").write_text("chrome sphere ball 0 0 4 0 0 0 1\n")
        radiance.oconv(tmp_path / "bad.rad")
    with pytest.raises(TypeError):
        radiance.rtrace("0 0 0 0 0 1", "scene.oct")


@needs_program
def test_the_program_tells_its_version(capfd, monkeypatch):
    monkeypatch.setattr("sys.argv", ["radsight", "--version"])
    assert _program.main() == 0
    assert radsight.__version__ in capfd.readouterr().out
