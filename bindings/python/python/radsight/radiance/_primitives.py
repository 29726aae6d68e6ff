"""Scenes as objects, and pictures of them."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ._command import PathLike, run
from ._rays import getbbox, oconv, rpict, vwrays
from ._views import RayParams, View, get_ray_params_args, get_view_args


@dataclass(slots=True)
class Primitive:
    """A surface, material, pattern or texture of a scene.

    Parameters
    ----------
    modifier : str
        What modifies it; ``void`` for nothing.
    ptype : str
        Its type, such as ``plastic``.
    identifier : str
        Its name.
    sargs : sequence of str
        String arguments.
    fargs : sequence of float
        Real arguments.

    Examples
    --------
    >>> Primitive("void", "plastic", "white", [], [0.5, 0.5, 0.5, 0, 0]).bytes
    b'void plastic white 0 0 5 0.5 0.5 0.5 0 0 '
    """

    modifier: str
    ptype: str
    identifier: str
    sargs: Sequence[str]
    fargs: Sequence[float]

    @property
    def bytes(self) -> bytes:
        """Scene text in one line, without a line end."""
        counted = ([len(words), *words] for words in (self.sargs, (), self.fargs))
        words = [self.modifier, self.ptype, self.identifier, *(word for words in counted for word in words)]
        return "".join(f"{word} " for word in words).encode()

    def __str__(self) -> str:
        strings, numbers = (" ".join(map(str, arguments)) for arguments in (self.sargs, self.fargs))
        head = f"{self.modifier} {self.ptype} {self.identifier}"
        return f"{head}\n{len(self.sargs)} {strings}\n0\n{len(self.fargs)} {numbers}\n"


def parse_primitive(pstr: str | bytes) -> list[Primitive]:
    """Read the primitives of scene text.

    Parameters
    ----------
    pstr : str or bytes
        Scene text without commands and aliases.

    Returns
    -------
    list of Primitive
        In their order.

    Raises
    ------
    ValueError
        If the text ends within a primitive, or a number is none.

    Examples
    --------
    >>> parse_primitive("void plastic white 0 0 5 .5 .5 .5 0 0 # paint")[0].fargs
    [0.5, 0.5, 0.5, 0.0, 0.0]
    """
    text = pstr.decode() if isinstance(pstr, bytes) else pstr
    words = iter(re.sub(r"#.*", "", text).split())
    return [_primitive(modifier, words) for modifier in words]


def _primitive(modifier: str, words: Iterator[str]) -> Primitive:
    try:
        ptype, identifier = next(words), next(words)
        strings, integers, numbers = ([next(words) for _ in range(int(next(words)))] for _ in range(3))
    except (StopIteration, RuntimeError):
        raise ValueError(f"the text ends within the primitive of modifier {modifier!r}") from None
    return Primitive(modifier, ptype, identifier, strings, [float(number) for number in numbers])


class Scene:
    """Files and primitives of a scene, views and sensors.

    Parameters
    ----------
    sid : str
        Name of the scene; its octree is a file ``sid.oct`` in the working folder.
    **kwargs
        ``materials``, ``surfaces`` and ``sources`` to add: sequences of path-like or Primitive.

    Raises
    ------
    ValueError
        If the name is empty or has a separator of folders.

    Examples
    --------
    >>> scene = Scene("room", surfaces=[Primitive("void", "sphere", "ball", [], [0, 0, 0, 1])])
    >>> scene.octree, list(scene.surfaces)
    ('room.oct', ['ball'])
    """

    def __init__(self, sid: str, **kwargs: Sequence[PathLike | Primitive]) -> None:
        if not sid or Path(sid).name != sid:
            raise ValueError(f"sid is {sid!r}, expected a name without folders")
        self._sid, self._changed = sid, True
        self._octree, self._moctree = f"{sid}.oct", f"m{sid}.oct"
        self._materials: dict[str, str | Primitive] = {}
        self._surfaces: dict[str, str | Primitive] = {}
        self._sources: dict[str, str | Primitive] = {}
        self._views: list[View] = []
        self._sensors: list[Sequence[float]] = []
        for kind, things in kwargs.items():
            for thing in things:
                self._add(thing, kind)

    @property
    def sid(self) -> str:
        """Name of the scene."""
        return self._sid

    @property
    def octree(self) -> str:
        """File of the octree."""
        return self._octree

    @property
    def materials(self) -> dict[str, str | Primitive]:
        """Materials, by the names of their files or their own."""
        return self._materials

    @property
    def surfaces(self) -> dict[str, str | Primitive]:
        """Surfaces, by the names of their files or their own."""
        return self._surfaces

    @property
    def sources(self) -> dict[str, str | Primitive]:
        """Light sources, by the names of their files or their own."""
        return self._sources

    @property
    def views(self) -> list[View]:
        """Views."""
        return self._views

    @property
    def sensors(self) -> list[Sequence[float]]:
        """Sensors: position (scene units) and direction of each."""
        return self._sensors

    @property
    def changed(self) -> bool:
        """Whether the octree is not that of the scene."""
        return self._changed

    def _add(self, thing: PathLike | Primitive, kind: str) -> None:
        if not isinstance(thing, Primitive) and not Path(_file(thing)).exists():
            raise FileNotFoundError(f"no such file: {thing}")
        things: dict[str, str | Primitive] = getattr(self, kind)
        things[_key(thing)] = thing if isinstance(thing, Primitive) else str(thing)
        self._changed = True

    def _remove(self, thing: PathLike | Primitive, kind: str) -> None:
        things: dict[str, str | Primitive] = getattr(self, kind)
        if _key(thing) not in things:
            raise KeyError(f"{kind} have no {_key(thing)!r}")
        del things[_key(thing)]
        self._changed = True

    def add_material(self, material: PathLike | Primitive) -> None:
        """Add a material.

        Parameters
        ----------
        material : path-like or Primitive
            A scene file, or the material.
        """
        self._add(material, "materials")

    def remove_material(self, material: PathLike | Primitive) -> None:
        """Remove a material.

        Parameters
        ----------
        material : path-like or Primitive
            As it was added.
        """
        self._remove(material, "materials")

    def add_surface(self, surface: PathLike | Primitive) -> None:
        """Add a surface.

        Parameters
        ----------
        surface : path-like or Primitive
            A scene file, or the surface.
        """
        self._add(surface, "surfaces")

    def remove_surface(self, surface: PathLike | Primitive) -> None:
        """Remove a surface.

        Parameters
        ----------
        surface : path-like or Primitive
            As it was added.
        """
        self._remove(surface, "surfaces")

    def add_source(self, source: PathLike | Primitive) -> None:
        """Add a light source.

        Parameters
        ----------
        source : path-like or Primitive
            A scene file, or the source.
        """
        self._add(source, "sources")

    def remove_source(self, source: PathLike | Primitive) -> None:
        """Remove a light source.

        Parameters
        ----------
        source : path-like or Primitive
            As it was added.
        """
        self._remove(source, "sources")

    def add_view(self, view: View) -> None:
        """Add a view.

        Parameters
        ----------
        view : View
            The first one is that of `render`.
        """
        self._views.append(view)

    def add_sensor(self, sensor: Sequence[float]) -> None:
        """Add a sensor.

        Parameters
        ----------
        sensor : sequence of float
            Position (scene units) and direction: six numbers.

        Raises
        ------
        ValueError
            If these are not six numbers.
        """
        if len(sensor) != 6:
            raise ValueError(f"sensor has {len(sensor)} numbers, expected 6: position and direction")
        self._sensors.append(sensor)

    def build(self) -> None:
        """Write the octrees of materials and of the scene to the working folder, if the scene has changed."""
        if not self._changed:
            return
        _write_octree(self._moctree, [*self._materials.values()], None)
        _write_octree(self._octree, [*self._surfaces.values(), *self._sources.values()], self._moctree)
        self._changed = False


def _key(thing: PathLike | Primitive) -> str:
    return thing.identifier if isinstance(thing, Primitive) else _file(thing)


def _file(thing: PathLike) -> str:
    if not isinstance(thing, str | Path):
        raise TypeError(f"expected a path or a Primitive, not {type(thing).__name__}")
    return str(thing)


def _write_octree(octree: str, things: Sequence[str | Primitive], base: str | None) -> None:
    files = [thing for thing in things if isinstance(thing, str)]
    text = "".join(str(thing) for thing in things if isinstance(thing, Primitive)).encode()
    Path(octree).write_bytes(oconv(*files, stdin=text or None, warning=False, octree=base))


def render(
    scene: Scene,
    view: None | View = None,
    quality: str = "Medium",
    variability: str = "Medium",
    detail: str = "Medium",
    nproc: int = 1,
    ncssamp: int = 3,
    resolution: None | tuple[int, int] = None,
    ambbounce: int = 0,
    ambcache: bool = True,
    params: None | RayParams = None,
) -> bytes:
    """Render a scene with the options that ``rad`` derives from its quality.

    Writes the octrees of `Scene.build`, and ``sid.amb`` where irradiance is cached, to the working folder.

    Parameters
    ----------
    scene : Scene
        What is rendered.
    view : View, optional
        The scene's first one if not given.
    quality, variability, detail : str
        ``Low``, ``Medium`` or ``High``, as in project files of ``rad``.
    nproc : int
        Not used: ``rpict`` takes all processors.
    ncssamp : int
        Must be 3: pictures have three bands.
    resolution : (int, int), optional
        Columns and rows at most; 512 each if not given.
    ambbounce : int
        Number of diffuse interreflections.
    ambcache : bool
        Whether irradiance is cached.
    params : RayParams, optional
        Options that count more than those derived.

    Returns
    -------
    bytes
        The picture; its values are W/(sr·m²).

    Raises
    ------
    ValueError
        If there is no view, or ``ncssamp`` is not 3.
    """
    if ncssamp != 3:
        raise ValueError(f"ncssamp is {ncssamp}, expected 3: pictures of radsight.radiance have three bands")
    if view is None and not scene.views:
        raise ValueError("expected a view: the scene has none")
    seen = scene.views[0] if view is None else view
    scene.build()
    variables = {
        "ZONE": _zone(scene, seen),
        "OCTREE": scene.octree,
        "QUALITY": quality,
        "VARIABILITY": variability,
        "DETAIL": detail,
        "render": f"-ab {ambbounce}" + ("" if ambcache else " -aa 0"),
    }
    if ambbounce and ambcache:
        variables["AMBFILE"] = f"{scene.sid}.amb"
        Path(variables["AMBFILE"]).unlink(missing_ok=True)
    options = [*_options_of_rad(variables), *(get_ray_params_args(params) if params is not None else [])]
    columns, rows = resolution or (512, 512)
    said = vwrays(view=get_view_args(seen), dimensions=True, xres=columns, yres=rows).split()
    words = ["-ps", "1", *options]
    return rpict(get_view_args(seen), scene.octree, xres=int(said[1]), yres=int(said[3]), params=words)


def _zone(scene: Scene, view: View) -> str:
    """The box around the scene for ``rad``, and whether the view is inside."""
    surfaces = [thing.bytes if isinstance(thing, Primitive) else thing for thing in scene.surfaces.values()]
    box = getbbox(*surfaces)
    sides = [box[axis : axis + 2] for axis in (0, 2, 4)]
    # A flat scene has no room, which rad refuses.
    pad = 5e-4 * max(1.0, *(high - low for low, high in sides))
    sides = [[low - pad, high + pad] if high <= low else [low, high] for low, high in sides]
    half_diagonal = sum((high - low) ** 2 for low, high in sides) / 4
    from_middle = sum((eye - (low + high) / 2) ** 2 for eye, (low, high) in zip(view.vp, sides, strict=True))
    kind = "E" if from_middle > half_diagonal else "I"
    return " ".join([kind, *(str(number) for side in sides for number in side)])


def _options_of_rad(variables: dict[str, str]) -> list[str]:
    """The options of ``rpict`` that ``rad`` derives from variables of a project file."""
    with tempfile.TemporaryDirectory() as folder:
        options = Path(folder, "options")
        words = [f"{name}={value}" for name, value in {**variables, "OPTFILE": str(options)}.items()]
        run("rad", "-n", os.devnull, *words)
        return options.read_text().split()
