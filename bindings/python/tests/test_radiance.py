"""`radsight.radiance` against `pyradiance`: the same signatures, and the same answers of the programs of both."""

import inspect
import os
import pathlib
import re

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

# Compiled classes and functions of pyradiance, which tell no signature.
COMPILED = {
    "RayParams",
    "View",
    "create_default_view",
    "get_default_ray_params",
    "get_ray_params_args",
    "get_view_args",
    "parse_view",
    "viewfile",
}
DOCUMENTATION = pathlib.Path(__file__).parents[3] / "docs" / "python.md"


def has_program():
    try:
        return os.path.isfile(_program.path())
    except FileNotFoundError:
        return False


needs_program = pytest.mark.skipif(not has_program(), reason="there is no program")


@pytest.mark.parametrize("name", sorted(set(radiance.__all__) - OWN - COMPILED))
def test_signatures_are_pyradiances(name):
    def parameters(of):
        return {name: (p.default, p.kind) for name, p in inspect.signature(of).parameters.items()}

    assert parameters(getattr(radiance, name)) == parameters(getattr(pyradiance, name))


def left_out():
    """Names that the documentation says are left out."""
    section = DOCUMENTATION.read_text(encoding="utf-8").split("### What is left out\n", 1)[1].split("\n## ", 1)[0]
    rows = [line.split("|")[1] for line in section.splitlines() if line.startswith("| `")]
    return {name for row in rows for name in re.findall(r"`([A-Za-z_.0-9]+)`", row)}


def test_every_name_of_pyradiance_is_there_or_told_as_left_out():
    public = {name for name in dir(pyradiance) if not name.startswith("_")}
    public = {name for name in public if not inspect.ismodule(getattr(pyradiance, name))} - {"version"}
    stated = {name for name in left_out() if "." not in name}
    own = set(radiance.__all__) - OWN
    assert own - public == set() and len(own) > 55
    assert public - own == stated


def test_classes_have_what_pyradiances_have():
    def members(of):
        return {name for name in dir(of) if not name.startswith("_")}

    classes = [name for name in radiance.__all__ if inspect.isclass(getattr(radiance, name))]
    # Dataclasses have the fields without a default in their objects alone.
    made = {"Primitive": ("void", "plastic", "white", [], []), "View": (), "RayParams": (), "Scene": ("room",)}
    made |= {"Rcontrib": (b"", "scene.oct"), "Xform": (b"",)}
    theirs = {"View": "create_default_view", "RayParams": "get_default_ray_params"}
    for name in classes:
        ours = members(getattr(radiance, name)(*made.get(name, ())))
        maker = getattr(pyradiance, theirs.get(name, name))
        expected = members(maker() if name in theirs else maker(*made.get(name, ())))
        # The command line and standard input of the builders are pyradiance's own affair.
        internal = {"args", "cmd", "inp", "stdin", "nparts", "has_input", "octree", "xres", "yres", "inform", "fout", "header"}
        missing = {f"{name}.{member}" for member in expected - ours - internal}
        assert missing <= left_out(), missing


def test_views_and_options_of_rays_are_written_as_by_pyradiance(tmp_path):
    for module in (radiance, pyradiance):
        view = module.create_default_view()
        view.type, view.vp, view.vdir, view.horiz, view.hoff, view.vaft = "a", (1, 2, 3), (4, 5, 6), 170, 0.5, 9.25
        params = module.get_default_ray_params()
        params.ab, params.aa, params.u, params.ambincl, params.amblist, params.af = 3, 0.25, False, True, ["a"], "x.amb"
        params.i, params.av, params.as_, params.lr, params.st = True, (1.0, 2.0, 3.0), 64, 8, 0
        words = module.get_view_args(view), module.get_ray_params_args(params)
        defaults = module.get_view_args(module.create_default_view()), module.get_ray_params_args(
            module.get_default_ray_params()
        )
        if module is radiance:
            expected = words, defaults
    assert (words, defaults) == expected
    everything = "-vth -vp 1 2 3 -vd 0 0 1 -vu 0 1 0 -vh 180 -vv 170 -vs .1 -vl .2 -vo 1 -va 9"
    (tmp_path / "old.vf").write_text("rvu -vtv -vp 9 9 9\nrvu " + everything + "\n")
    (tmp_path / "picture.hdr").write_bytes(b"#?RADIANCE\nrpict -x 5\nVIEW= " + everything.encode() + b"\n\n-Y 1 +X 1\n-vp 7 7 7")
    views = [
        module.get_view_args(view)
        for module in (radiance, pyradiance)
        for view in (module.parse_view(everything), module.viewfile(str(tmp_path / "old.vf")))
    ]
    views.append(radiance.get_view_args(radiance.viewfile(str(tmp_path / "picture.hdr"))))
    assert all(view == views[0] for view in views)
    with pytest.raises(radsight.RadsightError):
        radiance.parse_view("-vp 1 2")
    (tmp_path / "none.vf").write_text("nothing\n")
    with pytest.raises(ValueError, match="no view"):
        radiance.viewfile(str(tmp_path / "none.vf"))


def test_primitives_are_pyradiances():
    text = """# paint
    void plastic white 0 0 5 .5 .5 .5 0 0
    void brightfunc sky 2 skybr skybright.cal 0 1 3 # its numbers
    white polygon floor 0 0 9 0 0 0 1 0 0 1 1 0
    """
    ours, theirs = (module.parse_primitive(text) for module in (radiance, pyradiance))
    assert [vars_of(primitive) for primitive in ours] == [vars_of(primitive) for primitive in theirs] and len(ours) == 3
    for one, other in zip(ours, theirs, strict=True):
        assert (one.bytes, str(one)) == (other.bytes, str(other))
        assert radiance.parse_primitive(str(one)) == radiance.parse_primitive(one.bytes) == [one]
    with pytest.raises(ValueError, match="ends within the primitive of modifier 'white'"):
        radiance.parse_primitive("white polygon floor 0 0 9 0 0")


def vars_of(primitive):
    return [getattr(primitive, name) for name in ("modifier", "ptype", "identifier", "sargs", "fargs")]


@needs_program
def test_a_scene_is_built_and_rendered_as_by_pyradiance(tmp_path, monkeypatch):
    means = []
    for module in (radiance, pyradiance):
        folder = tmp_path / module.__name__
        folder.mkdir()
        monkeypatch.chdir(folder)
        means.append(mean_of_a_rendered_scene(module, folder))
    np.testing.assert_allclose(means[0], means[1], rtol=0.05)


def mean_of_a_rendered_scene(module, tmp_path):
    (tmp_path / "ceiling.rad").write_text("white ring ceiling 0 0 8 0 0 6 0 0 -1 0 6\n")
    scene = module.Scene("room", surfaces=[tmp_path / "ceiling.rad"])
    for primitive in module.parse_primitive(SCENE + b"grey sphere ball 0 0 4 0 0 1 .5"):
        add = scene.add_material if primitive.modifier == "void" else scene.add_surface
        add(primitive)
    scene.add_material(module.Primitive("void", "plastic", "white", [], [0.8, 0.8, 0.8, 0, 0]))
    with pytest.raises(FileNotFoundError):
        scene.add_surface("nowhere.rad")
    with pytest.raises(KeyError):
        scene.remove_source("ceiling.rad")
    with pytest.raises(ValueError):
        scene.add_sensor([0, 0, 0])
    scene.add_view(module.parse_view("-vtv -vp 0 -4 3 -vd 0 4 -3 -vu 0 0 1 -vh 60 -vv 45"))
    picture = module.render(scene, quality="Low", ambbounce=1, resolution=(64, 48))
    assert module.get_image_dimensions(picture) == (64, 46)
    assert not scene.changed and (tmp_path / "room.oct").exists() and (tmp_path / "room.amb").exists()
    scene.remove_surface(tmp_path / "ceiling.rad")
    assert scene.changed and str(tmp_path / "ceiling.rad") not in scene.surfaces
    scene.build()
    assert not scene.changed
    assert module.write("data", b"1") == "data" and (tmp_path / "data").read_bytes() == b"1"
    with pytest.raises(FileExistsError):
        module.write("data", "2", overwrite=False, mode="w")
    return np.loadtxt(module.pvalue(picture, header=False, resstr=False, dataonly=True).splitlines()).mean()


@needs_program
def test_values_become_the_picture_that_they_are_of(picture):
    values = pyradiance.pvalue(picture)
    ours, theirs = (without_header(module.pvaluer(values)) for module in (radiance, pyradiance))
    assert ours == theirs
    raw = np.arange(1, 19, dtype=np.float32).tobytes()
    words = {"xres": 3, "yres": 2, "inform": "f", "header": False, "resstr": False, "pxyz": True}
    ours, theirs = (module.pvaluer(raw, **words) for module in (radiance, pyradiance))
    assert without_header(ours) == without_header(theirs) and b"xyze" in ours


@needs_program
def test_every_program_of_both_has_its_function(tmp_path):
    radiance.run("install-links", tmp_path)
    programs = {program.stem.lower() for program in tmp_path.iterdir()}
    public = {name for name in dir(pyradiance) if callable(getattr(pyradiance, name)) and not name.startswith("_")}
    both = {name for name in public if name.lower() in programs}
    assert len(both) > 30 and both <= set(radiance.__all__)


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


def without_header(data):
    """What follows the information header, in which the programs tell their names and options."""
    return data.split(b"\n\n", 1)[1] if data.startswith(b"#?") else data


def lines(text):
    """Scene text word by word, numbers as they read, without comments."""

    def read(word):
        try:
            return float(word)
        except ValueError:
            return word

    words = b" ".join(line for line in text.split(b"\n") if not line.startswith((b"#", b"!"))).split()
    return [read(word) for word in words]


@needs_program
@pytest.mark.parametrize(
    "call",
    [
        lambda module: module.genblinds("grey", "slats", 0.05, 1, 1.2, 4, 30, rcurv=0.1),
        lambda module: module.genprism("grey", "bar", vertices=[0, 0, 1, 0, 0, 1], lvect=[0, 0, 2]),
        lambda module: module.genrev("grey", "vase", "t", "1+t", 5, smooth=True),
        lambda module: module.gensurf("grey", "wave", "s", "t", "s*t", 3, 4, invert=True),
        lambda module: module.obj2rad(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", objname="part"),
    ],
    ids=["genblinds", "genprism", "genrev", "gensurf", "obj2rad"],
)
def test_generated_scenes_are_radiances(call):
    ours, theirs = (lines(call(module)) for module in (radiance, pyradiance))
    assert len(ours) == len(theirs) > 10
    for a, b in zip(ours, theirs, strict=True):
        assert a == (b if isinstance(b, bytes) else pytest.approx(b, rel=1e-5, abs=1e-9))


@pytest.fixture
def picture(octree):
    view = ["-vp", "0", "-4", "3", "-vd", "0", "4", "-3", "-vh", "60", "-vv", "45"]
    return pyradiance.rpict(view, octree, xres=32, yres=32)


@needs_program
@pytest.mark.parametrize(
    "call",
    [
        lambda module, picture: module.Pcomb(expression="ro=2*ri(1);go=gi(1);bo=bi(1)").add(picture, scaler=0.5)(),
        lambda module, picture: module.Pcomb(xres=3, yres=2, expression=["ro=x", "go=y"], fout=False)(),
        lambda module, picture: module.pcompos([picture], pos=[(2, 3)], xres=40, yres=40, background=(1, 0, 0)),
        lambda module, picture: module.pcompos([picture], ncols=1, spacing=2),
        lambda module, picture: module.ra_ppm(picture, exposure=-1, greyscale=True),
        lambda module, picture: module.ra_rgbe(picture, rle=True, exposure=1),
        lambda module, picture: module.ra_xyze(picture),
    ],
    ids=["Pcomb", "Pcomb without input", "pcompos", "pcompos in columns", "ra_ppm", "ra_rgbe", "ra_xyze"],
)
def test_pictures_are_changed_as_by_radiance(call, picture):
    ours, theirs = (without_header(call(module, picture)) for module in (radiance, pyradiance))
    assert len(theirs) > 20 and ours == theirs


@needs_program
def test_extremes_and_tiffs_are_radiances(picture, tmp_path):
    assert tuple(radiance.pextrem(picture)) == tuple(pyradiance.pextrem(picture))
    assert radiance.pextrem(picture)[1].R > 0
    for module, name in ((radiance, "ours.tif"), (pyradiance, "theirs.tif")):
        assert module.ra_tiff(picture, str(tmp_path / name), ieee32=True) is None
    back = [radiance.ra_tiff(tmp_path / name, reverse=True) for name in ("ours.tif", "theirs.tif")]
    assert without_header(back[0]) == without_header(back[1])
    brighter = [without_header(radiance.ra_ppm(picture, exposure=stops)) for stops in (0, 1)]
    assert sum(brighter[1]) > sum(brighter[0])
    with pytest.raises(ValueError, match="expected out"):
        radiance.ra_tiff(picture)


@needs_program
def test_matrices_and_records_are_joined_as_by_radiance(tmp_path):
    matrix = b"#?RADIANCE\nNROWS=2\nNCOLS=2\nNCOMP=1\nFORMAT=ascii\n\n1 2\n3 4\n"
    (tmp_path / "m.mtx").write_bytes(matrix)
    (tmp_path / "columns.txt").write_text("5 6\n7 8\n")
    for call in (
        lambda module: module.Rmtxop().add_input(matrix, scale=2).add_input(tmp_path / "m.mtx", op="+")(),
        lambda module: module.Rmtxop().add_input(tmp_path / "m.mtx").add_input(matrix, transpose=True)(),
        lambda module: module.Rcomb(expression="co(i)=ci(1,i)*2", header=False).add_input(matrix)(),
        lambda module: module.rlam(b"1 2\n3 4\n", tmp_path / "columns.txt"),
    ):
        ours, theirs = (without_header(call(module)).split() for module in (radiance, pyradiance))
        assert len(theirs) >= 4 and [float(word) for word in ours] == [float(word) for word in theirs]
    # pyradiance comes without this program.
    assert without_header(radiance.rcollate(matrix, ncomp=1, transpose=True)).split() == [b"1", b"3", b"2", b"4"]
    with pytest.raises(ValueError, match="at most one"):
        radiance.rlam(b"1\n", b"2\n")


@needs_program
def test_files_of_others_become_scenes_as_by_radiance(tmp_path, octree):
    weather = "place x\nlatitude 40\nlongitude 105\ntime_zone 105\nsite_elevation 0\nweather_data_file_units 1\n"
    weather += "6 21 12.0 800 100\n"
    skies = [
        np.array(without_header(module.gendaymtx(weather.encode(), sky_only=True)).split(), float)
        for module in (radiance, pyradiance)
    ]
    assert skies[0].size == 146 * 3
    np.testing.assert_allclose(skies[0], skies[1], rtol=0.01, atol=1e-3)
    lamp = "IESNA91\nTILT=NONE\n1 1000 1 3 1 1 2 .1 .1 0\n1 1 50\n0 45 90\n0\n100 50 0\n"
    (tmp_path / "lamp.ies").write_text(lamp)
    for module, name in ((radiance, "ours"), (pyradiance, "theirs")):
        module.ies2rad(tmp_path / "lamp.ies", outname=str(tmp_path / name), lamp_color=(1, 0.9, 0.8))
    ours, theirs = (lines((tmp_path / f"{name}.rad").read_bytes()) for name in ("ours", "theirs"))
    assert len(ours) == len(theirs) > 10
    triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    assert radiance.obj2mesh(triangle, matfiles=None).startswith(b"#?RADIANCE")
    (tmp_path / "room.mgf").write_text("v a =\np 0 0 0\nv b =\np 1 0 0\nv c =\np 0 1 0\nf a b c\n")
    ours, theirs = (lines(module.mgf2rad(str(tmp_path / "room.mgf"))) for module in (radiance, pyradiance))
    assert [word for word in ours if word == b"polygon"] == [word for word in theirs if word == b"polygon"] != []
    window = b"#@mkillum i=pane d=4 s=4 b=0\ngrey polygon pane 0 0 12 0 0 2 1 0 2 1 1 2 0 1 2\n"
    assert b"illum" in radiance.mkillum(window, octree)


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
