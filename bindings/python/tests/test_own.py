"""Cameras and materials written in Python: the numbers of compiled ones, and what they raise."""

import os
import pathlib
import pickle
import subprocess

import numpy as np
import pytest
import radsight

TABLE = """void light lamp 0 0 3 100 90 80
void plastic grey 0 0 5 .5 .5 .5 0 0
lamp ring bulb 0 0 8 0 0 4 0 0 -1 0 .2
grey ring table 0 0 8 0 0 0 0 0 1 0 6
"""
VIEW = radsight.View("-vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 45")


class Lambert:
    """Half of the light, evenly."""

    def evaluate(self, outgoing, incident):
        lit = (incident[:, 2] > 0) & (outgoing[:, 2] > 0)
        return np.where(lit, 0.5 / np.pi, 0.0)


class Drawn(Lambert):
    """The same with directions that it draws itself, evenly over the hemisphere."""

    def sample(self, outgoing, u):
        z, angle = 1 - u[:, 0], 2 * np.pi * u[:, 1]
        radius = np.sqrt(np.maximum(0.0, 1 - z * z))
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)

    def pdf(self, outgoing, incident):
        return np.where(incident[:, 2] > 0, 0.5 / np.pi, 0.0)


class Pinhole:
    """As -vtv -vp 0 -4 3 -vd 0 4 -3 -vh 60 -vv 45 has it."""

    def rays(self, film, aperture):
        forward = np.array([0, 0.8, -0.6])
        right, up = np.array([1.0, 0, 0]), np.array([0, 0.6, 0.8])
        across = (2 * film[:, :1] - 1) * np.tan(np.pi / 6)
        along = (1 - 2 * film[:, 1:]) * np.tan(np.pi / 8)
        directions = forward + across * right + along * up
        origins = np.broadcast_to([0.0, -4, 3], directions.shape)
        return np.concatenate([origins, directions], axis=1)


@pytest.mark.parametrize("model", [Lambert(), Drawn()])
def test_a_material_in_python_has_the_compiled_ones_numbers(model):
    rays = np.array([[x, y, 1, 0.1, 0, -1.0] for x in (0, 1, 2) for y in (0, 1)])
    pictures = []
    for materials in (None, {"grey": model}):
        scene = radsight.Scene.from_text(TABLE, materials=materials)
        pictures.append(radsight.Renderer(scene).trace(rays).radiance_w_per_sr_m2)
    np.testing.assert_allclose(pictures[1], pictures[0], rtol=0.02)


def test_a_material_in_python_has_the_numbers_of_a_plugin(tmp_path):
    program = os.environ.get("RADSIGHT_PROGRAM")
    plugins = sorted(pathlib.Path(program or ".").parent.glob("*builtin.*"))
    if not program or not plugins:
        pytest.skip("RADSIGHT_PROGRAM names no program with plugins beside it")
    (tmp_path / "table.rad").write_text(TABLE)
    rays = np.array([[x, 0.3, 1, 0.1, 0, -1.0] for x in np.linspace(-3, 3, 200)])
    command = [program, "rtrace", "-ffd", "-h", "-ab", "1", "-aa", "0", "-ad", "512", "--brdf", "grey=builtin:lambert(.5,.5,.5)"]
    command += ["--plugin-path", str(plugins[0].parent), str(tmp_path / "table.rad")]
    run = subprocess.run(command, input=rays.astype("float32").tobytes(), capture_output=True, check=True)
    compiled = np.frombuffer(run.stdout).reshape(-1, 3)
    scene = radsight.Scene.from_text(TABLE, materials={"grey": Lambert()})
    options = {"ambient_bounces": 1, "ambient_accuracy": 0.0}
    rays = rays.astype("float32").astype(float)
    own = radsight.trace(scene, rays, **options)["radiance_w_per_sr_m2"]
    np.testing.assert_allclose(own, compiled, rtol=1e-12)


@pytest.mark.parametrize("model", [Lambert, Drawn])
def test_a_batch_of_hits_has_the_bits_of_single_hits(model):
    class Counted(model):
        calls = rows = 0

        def evaluate(self, outgoing, incident):
            assert outgoing.shape == incident.shape
            self.calls, self.rows = self.calls + 1, self.rows + len(incident)
            return super().evaluate(outgoing, incident)

    counted = Counted()
    scene = radsight.Scene.from_text(TABLE, materials={"grey": counted})
    rays = np.array([[x, 0.5, 1, 0.1, 0, -1.0] for x in np.linspace(-3, 3, 4000)])
    options = {"ambient_bounces": 2, "ambient_accuracy": 0.0}
    renderer = radsight.Renderer(scene, **options)
    counted.calls = counted.rows = 0
    together = renderer.trace(rays).radiance_w_per_sr_m2
    assert counted.rows > 4000 and counted.calls < counted.rows / 8
    some = slice(0, 4000, 400)
    single = [renderer.trace(rays[place : place + 1], first=place) for place in range(4000)[some]]
    np.testing.assert_array_equal(together[some], [traced.radiance_w_per_sr_m2[0] for traced in single])


def test_a_coloured_material_may_be_used_where_all_is_grey():
    class Equal(Lambert):
        def evaluate(self, outgoing, incident):
            return np.repeat(super().evaluate(outgoing, incident)[:, np.newaxis], 3, axis=1)

    text = TABLE.replace("100 90 80", "100 100 100")
    ray = np.array([[0, 0, 1, 0, 0, -1.0]])
    one, three = (
        radsight.Renderer(radsight.Scene.from_text(text, materials={"grey": model})).trace(ray).radiance_w_per_sr_m2
        for model in (Lambert(), Equal())
    )
    np.testing.assert_array_equal(one, three)


def test_a_material_in_python_is_followed_over_bounces():
    # A glow of range 0 is found by bounces alone.
    text = "void glow lit 0 0 4 1 1 1 0 lit ring source 0 0 8 0 0 9 0 0 -1 0 9 void plastic grey 0 0 5 .1 .1 .1 0 0\n"
    text += "grey ring floor 0 0 8 0 0 0 0 0 1 0 50"
    scene = radsight.Scene.from_text(text, materials={"grey": Lambert()})
    renderer = radsight.Renderer(scene, ambient_bounces=1, ambient_accuracy=0.0, ambient_divisions=64)
    ray = np.array([[0, 0, 1, 0, 0, -1.0]])
    # The disk of radius 9 at height 9 has the form factor 1/2, and half of that is reflected.
    traced = renderer.trace(np.repeat(ray, 32, axis=0))
    np.testing.assert_allclose(traced.radiance_w_per_sr_m2.mean(), 0.25, rtol=0.1)


def test_a_camera_in_python_sees_what_the_view_sees():
    scene = radsight.Scene.from_text(TABLE)
    seen = radsight.Renderer(scene, samples=64).render(VIEW, 40, 29).radiance_w_per_sr_m2
    rows, columns, _ = seen.shape
    own = radsight.Renderer(scene, samples=64).render_camera(Pinhole(), columns, rows).radiance_w_per_sr_m2
    # The view's own proportions are those of the tangents; a column or row of rounding apart the pictures agree.
    np.testing.assert_allclose(own.mean(), seen.mean(), rtol=0.03)
    np.testing.assert_allclose(own[rows // 2, columns // 2], seen[rows // 2, columns // 2], rtol=0.03)


def test_a_picture_of_a_camera_in_python_is_the_mean_of_its_rays():
    class Recording:
        def __init__(self):
            self.film, self.given = [], []

        def rays(self, film, aperture):
            directions = np.stack([2 * film[:, 0] - 1, np.ones(len(film)), 1 - 2 * film[:, 1]], axis=1)
            self.film.append(film.copy())
            self.given.append(np.hstack([np.zeros_like(directions), directions]))
            return self.given[-1]

    # Light that needs no random numbers: the radiance of a ray is that of the glow alone.
    text = "void brightfunc stripes 2 1+.5*sin(9*Px)+Pz/9 . 0 0 stripes glow lit 0 0 4 1 2 3 0 lit ring wall 0 0 8 0 6 0 0 -1 0 0 9"
    scene = radsight.Scene.from_text(text)
    camera, columns, rows = Recording(), 8, 6
    image = radsight.Renderer(scene, samples=16).render_camera(camera, columns, rows).radiance_w_per_sr_m2
    film, given = np.vstack(camera.film), np.vstack(camera.given)
    # It is also asked about the middle of each pixel, whose radiance does not count.
    is_middle = np.isclose((film * [columns, rows]) % 1, 0.5, atol=1e-12).all(axis=1)
    film, given = film[~is_middle], given[~is_middle]
    assert len(film) == 16 * columns * rows
    row, column = (film[:, ::-1] * [rows, columns]).astype(int).T
    sums = np.zeros((rows, columns, 3))
    np.add.at(sums, (row, column), radsight.trace(scene, given)["radiance_w_per_sr_m2"])
    np.testing.assert_allclose(image, sums / 16, rtol=1e-6)


def test_exceptions_of_python_code_end_the_work():
    class Broken:
        def evaluate(self, outgoing, incident):
            raise ZeroDivisionError("a mistake")

    class Short:
        def evaluate(self, outgoing, incident):
            return np.zeros(len(incident) + 1)

    class NotANumber:
        def evaluate(self, outgoing, incident):
            return np.full(len(incident), np.nan)

    class Negative:
        def evaluate(self, outgoing, incident):
            return np.full(len(incident), -0.1)

    class Number:
        def evaluate(self, outgoing, incident):
            return 0.5 / np.pi

    class Density(Drawn):
        def pdf(self, outgoing, incident):
            return np.full(len(incident), np.inf)

    class Direction(Drawn):
        def sample(self, outgoing, u):
            return u[:, :2]

    rays = np.array([[0, 0, 1, 0, 0, -1.0]])
    for model, error, said in (
        (Broken(), ZeroDivisionError, "a mistake"),
        (Short(), ValueError, r'"grey": evaluate gave an array of shape \(\d+,\), expected \(\d+,\) or \(\d+, 3\)'),
        (NotANumber(), ValueError, r"evaluate gave NaN for outgoing \(.*\) and incident \("),
        (Negative(), ValueError, r"evaluate gave -0.1 for outgoing \(.*\), expected a finite number of 0 or more"),
        (Number(), ValueError, r"evaluate gave an array of shape \(\)"),
        (Density(), ValueError, "pdf gave inf for outgoing"),
        (Direction(), ValueError, r"sample gave an array of shape \(\d+, 2\), expected \(\d+, 3\)"),
    ):
        scene = radsight.Scene.from_text(TABLE, materials={"grey": model})
        with pytest.raises(error, match=said):
            radsight.Renderer(scene).trace(rays)
        with pytest.raises(error, match=said):
            radsight.Renderer(scene).render(VIEW, 16, 12)
    with pytest.raises(ValueError, match="evaluate"):
        radsight.Scene.from_text(TABLE, materials={"grey": object()})

    class Nothing:
        def evaluate(self, outgoing, incident):
            return None

    with pytest.raises(ValueError, match="\"grey\": evaluate gave NoneType, expected an array"):
        radsight.Renderer(radsight.Scene.from_text(TABLE, materials={"grey": Nothing()})).trace(rays)


def test_a_rounding_error_of_a_material_below_zero_is_zero():
    class Black:
        def evaluate(self, outgoing, incident):
            return np.full(len(incident), -1e-17)

    scene = radsight.Scene.from_text(TABLE, materials={"grey": Black()})
    traced = radsight.Renderer(scene).trace(np.array([[0, 0, 1, 0, 0, -1.0]]))
    np.testing.assert_array_equal(traced.radiance_w_per_sr_m2, np.zeros((1, 3)))


def with_row(*numbers):
    """Rays of which all are these numbers."""
    return lambda film: np.tile(np.array(numbers, float), (len(film), 1))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (lambda film: np.zeros((len(film), 5)), r"gave an array of shape \(64, 5\), expected \(64, 6\), .* or \(64, 7\)"),
        (lambda film: np.zeros((len(film) + 1, 6)), r"gave an array of shape \(65, 6\), expected \(64, 6\)"),
        (lambda film: np.zeros(6), r"gave an array of shape \(6,\)"),
        (lambda film: None, "gave NoneType, expected an array"),
        (lambda film: "rays", "gave str, expected an array"),
        (lambda film: np.zeros((len(film), 6), complex), "gave an array of complex128"),
        (with_row(0, 0, 1, 0, 0, 0), r"gave \(0, 0, 1, 0, 0, 0\) for the film point \(0\.\d+, 0\.\d+\), expected finite numbers"),
        (with_row(0, 0, np.inf, 0, 0, -1), r"gave \(0, 0, inf, 0, 0, -1\) for the film point"),
        (with_row(0, 0, 1, 0, 0, -1, np.nan), r"gave \(0, 0, 1, 0, 0, -1, NaN\) for the film point"),
    ],
    ids=["columns", "rows", "one ray", "None", "text", "complex", "no direction", "infinite", "weight"],
)
def test_wrong_rays_of_a_camera_name_it_and_the_shape(given, said):
    class Blind:
        def rays(self, film, aperture):
            return given(film)

    renderer = radsight.Renderer(radsight.Scene.from_text(TABLE), samples=1)
    with pytest.raises(ValueError, match="camera Blind: rays " + said):
        renderer.render_camera(Blind(), 8, 8)


def test_a_camera_may_see_nothing_raise_or_give_single_precision():
    renderer = radsight.Renderer(radsight.Scene.from_text(TABLE), samples=1)

    class Pinhole32(Pinhole):
        def rays(self, film, aperture):
            return super().rays(film, aperture).astype(np.float32)

    class HalfBlind(Pinhole):
        def rays(self, film, aperture):
            return np.where(film[:, :1] < 0.5, super().rays(film, aperture), np.nan)

    class Broken:
        def rays(self, film, aperture):
            raise ZeroDivisionError("a mistake")

    seen = renderer.render_camera(Pinhole(), 16, 12).radiance_w_per_sr_m2
    single = renderer.render_camera(Pinhole32(), 16, 12).radiance_w_per_sr_m2
    np.testing.assert_allclose(single, seen, rtol=1e-3)
    half = renderer.render_camera(HalfBlind(), 16, 12).radiance_w_per_sr_m2
    np.testing.assert_array_equal(half[:, :8], seen[:, :8])
    assert (half[:, 8:] == 0).all() and half[:, :8].any()
    with pytest.raises(ZeroDivisionError, match="a mistake"):
        renderer.render_camera(Broken(), 16, 12)
    with pytest.raises(ValueError, match=r"camera int has no method rays\(film, aperture\)"):
        renderer.render_camera(5, 16, 12)
    # What was raised is not raised again.
    assert renderer.render_camera(Pinhole(), 4, 3).radiance_w_per_sr_m2.any()


@pytest.mark.parametrize("work", ["render", "trace", "contributions", "render_camera", "fill_irradiance_cache"])
def test_progress_that_cannot_be_called_or_raises_is_told(work):
    renderer = radsight.Renderer(radsight.Scene.from_text(TABLE), samples=1)
    rays = np.array([[0, 0, 1, 0, 0, -1.0]])
    arguments = {
        "render": (VIEW, 8, 6),
        "trace": (rays,),
        "contributions": (rays, ["lamp"]),
        "render_camera": (Pinhole(), 8, 6),
        "fill_irradiance_cache": (rays,),
    }[work]

    def stop(done):
        raise ZeroDivisionError(f"at {done}")

    with pytest.raises(TypeError, match="progress is int, expected a callable"):
        getattr(renderer, work)(*arguments, progress=5)
    with pytest.raises(ZeroDivisionError, match="at "):
        getattr(renderer, work)(*arguments, progress=stop)


def test_scenes_with_materials_and_files_can_be_pickled(tmp_path):
    (tmp_path / "half.cal").write_text("half = .5;")
    (tmp_path / "panel.rad").write_text(
        "void brightfunc dim 2 half half.cal 0 0 dim glow panel 0 0 4 2 2 2 0 panel sphere s 0 0 4 0 0 0 5\n"
    )
    scene = radsight.Scene.load(tmp_path / "panel.rad")
    data = pickle.dumps(scene)
    (tmp_path / "half.cal").unlink()
    (tmp_path / "panel.rad").unlink()
    rays = np.array([[0, 0, -9, 0, 0, 1.0]])
    again = radsight.Renderer(pickle.loads(data)).trace(rays).radiance_w_per_sr_m2
    np.testing.assert_array_equal(again, [[1, 1, 1]])
    own = pickle.loads(pickle.dumps(radsight.Scene.from_text(TABLE, materials={"grey": Lambert()})))
    assert radsight.Renderer(own).trace(np.array([[0, 0, 1, 0, 0, -1.0]])).radiance_w_per_sr_m2[0, 0] > 0
