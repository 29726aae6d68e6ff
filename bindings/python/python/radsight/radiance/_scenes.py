"""Skies, shapes and scenes in other formats."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import Any

from ._command import PathLike, Source, option, repeated, run, source_of, switches, vector


def _when(
    dt: None | datetime,
    latitude: None | float,
    longitude: None | float,
    timezone: None | int,
    year: None | int,
    altitude: None | float,
    azimuth: None | float,
    *,
    seconds: bool,
) -> list[str]:
    """Date and place of a sky, or where its sun is."""
    if dt is not None:
        hour = dt.hour + dt.minute / 60 + (dt.second / 3600 if seconds else 0)
        place = [*option("-a", latitude), *option("-o", longitude), *option("-m", timezone), *option("-y", year)]
        return [str(dt.month), str(dt.day), str(hour), *place]
    if altitude is None or azimuth is None:
        raise ValueError("expected a date, or altitude and azimuth")
    return ["-ang", str(altitude), str(azimuth)]


def gensky(
    dt: None | datetime = None,
    latitude: None | float = None,
    longitude: None | float = None,
    timezone: None | int = None,
    altitude: None | float = None,
    azimuth: None | float = None,
    year: None | int = None,
    sunny_with_sun: bool = False,
    sunny_without_sun: bool = False,
    cloudy: bool = False,
    intermediate_with_sun: bool = False,
    intermediate_without_sun: bool = False,
    uniform: bool = False,
    ground_reflectance: None | float = None,
    zenith_brightness: None | float = None,
    horizontal_brightness: None | float = None,
    solar_radiance: None | float = None,
    horizontal_direct_irradiance: None | float = None,
    turbidity: None | float = None,
) -> bytes:
    """A CIE sky: ``gensky``."""
    sun = _when(dt, latitude, longitude, timezone, year, altitude, azimuth, seconds=False)
    kinds = {
        "+s": sunny_with_sun,
        "-s": sunny_without_sun,
        "-c": cloudy,
        "+i": intermediate_with_sun,
        "-i": intermediate_without_sun,
        "-u": uniform,
    }
    words = [*sun, *switches(kinds)[:1]]
    words += option("-g", ground_reflectance)
    words += option("-b", zenith_brightness) or option("-B", horizontal_brightness)
    words += option("-r", solar_radiance) or option("-R", horizontal_direct_irradiance)
    return run("gensky", *words, *option("-t", turbidity))


def gendaylit(
    dt: None | datetime = None,
    latitude: None | float = None,
    longitude: None | float = None,
    timezone: None | int = None,
    altitude: None | float = None,
    azimuth: None | float = None,
    year: None | int = None,
    dirnorm: None | float = None,
    diffhor: None | float = None,
    dirhor: None | float = None,
    dirnorm_illum: None | float = None,
    diffhor_illum: None | float = None,
    solar: bool = False,
    sky_only: bool = False,
    silent: bool = False,
    grefl: None | float = None,
    interval: None | int = None,
) -> bytes:
    """A Perez sky: ``gendaylit``."""
    words = _when(dt, latitude, longitude, timezone, year, altitude, azimuth, seconds=True)
    words += (
        option("-W", dirnorm, diffhor)
        or option("-G", dirhor, diffhor)
        or option("-L", dirnorm_illum, diffhor_illum)
    )
    words += [*(["-O", "1"] if solar else []), *switches({"-s": sky_only, "-w": silent})]
    return run("gendaylit", *words, *option("-g", grefl), *option("-i", interval))


def genbox(
    mat: str,
    name: str,
    xsiz: float,
    ysiz: float,
    zsiz: float,
    inward: bool = False,
    beveled: None | float = None,
    rounded: None | float = None,
    nsegs: None | int = None,
    smoothing: bool = False,
    waveout: bool = False,
) -> bytes:
    """A box: ``genbox``."""
    words = [*switches({"-i": inward}), *option("-b", beveled), *option("-r", rounded), *option("-n", nsegs)]
    return run("genbox", mat, name, xsiz, ysiz, zsiz, *words, *switches({"-s": smoothing, "-o": waveout}))


class Xform:
    """Move scene text: ``xform``. Transformations are added in their order; then call it.

    Parameters
    ----------
    inp : path-like or bytes
    expand_cmd : bool
        Whether commands are expanded.
    invert : bool
        Whether surfaces are turned around.
    iprefix : str, optional
        Before all names.
    modifier : str, optional
        Of all surfaces.
    """

    def __init__(
        self,
        inp: Source,
        expand_cmd: bool = True,
        invert: bool = False,
        iprefix: None | str = None,
        modifier: None | str = None,
    ) -> None:
        self._source = inp
        self._words = [*switches({"-c": not expand_cmd}), *option("-n", iprefix), *option("-m", modifier)]
        self._words += switches({"-I": invert})

    def _add(self, *words: Any) -> Xform:
        self._words += map(str, words)
        return self

    def translate(self, x: float, y: float, z: float) -> Xform:
        """Move."""
        return self._add("-t", x, y, z)

    def rotatex(self, deg: float) -> Xform:
        """Turn about the x axis."""
        return self._add("-rx", deg)

    def rotatey(self, deg: float) -> Xform:
        """Turn about the y axis."""
        return self._add("-ry", deg)

    def rotatez(self, deg: float) -> Xform:
        """Turn about the z axis."""
        return self._add("-rz", deg)

    def scale(self, ratio: float) -> Xform:
        """Scale about the origin."""
        return self._add("-s", ratio)

    def mirrorx(self) -> Xform:
        """Mirror at the yz plane."""
        return self._add("-mx")

    def mirrory(self) -> Xform:
        """Mirror at the xz plane."""
        return self._add("-my")

    def mirrorz(self) -> Xform:
        """Mirror at the xy plane."""
        return self._add("-mz")

    def array(self, number: int) -> Xform:
        """Repeat what follows, each time once more."""
        return self._add("-a", number)

    def iterate(self, number: int) -> Xform:
        """Do what follows so often."""
        return self._add("-i", number)

    def __call__(self) -> bytes:
        word, stdin = source_of(self._source)
        return run("xform", *self._words, *word, stdin=stdin)


def genblinds(
    mat: str,
    name: str,
    depth: float,
    width: float,
    height: float,
    nslats: int,
    angle: float,
    rcurv: None | float = None,
) -> bytes:
    """Venetian blinds: ``genblinds``."""
    curved = ["+r" if rcurv > 0 else "-r", str(abs(rcurv))] if rcurv else []
    return run("genblinds", mat, name, depth, width, height, nslats, angle, *curved)


def genprism(
    mat: str,
    name: str,
    vertices: None | Sequence[float] = None,
    vfile: None | str = None,
    lvect: None | Sequence[float] = None,
    radius: None | float = None,
    no_connect: bool = False,
    no_ends: bool = False,
    stdin: None | bytes = None,
) -> bytes:
    """A prism over a polygon: ``genprism``. ``vertices`` are x and y of each corner in turn."""
    if (vertices is None) == (vfile is None):
        raise ValueError("expected either vertices or vfile")
    if vertices is not None and (len(vertices) % 2 or len(vertices) < 6):
        raise ValueError(f"vertices are {len(vertices)} numbers, expected x and y of at least 3 corners")
    if lvect is not None and len(lvect) != 3:
        raise ValueError(f"lvect has {len(lvect)} numbers, expected 3")
    corners = [vfile] if vertices is None else [len(vertices) // 2, *vertices]
    words = [*vector("-l", lvect), *option("-r", radius)]
    return run("genprism", mat, name, *corners, *words, *switches({"-c": no_connect, "-e": no_ends}), stdin=stdin)


def genrev(
    mat: str,
    name: str,
    z_t: str,
    r_t: str,
    nseg: int,
    expr: None | str = None,
    file: None | str = None,
    smooth: bool = False,
) -> bytes:
    """A surface of revolution: ``genrev``."""
    words = [*option("-e", expr), *option("-f", file), *switches({"-s": smooth})]
    return run("genrev", mat, name, z_t, r_t, nseg, *words)


def gensurf(
    mat: str,
    name: str,
    x: str,
    y: str,
    z: str,
    m: int,
    n: int,
    expr: None | str = None,
    file: None | str = None,
    invert: bool = False,
    smooth: bool = False,
    waveout: bool = False,
    stdin: None | bytes = None,
) -> bytes:
    """A surface over two parameters: ``gensurf``."""
    words = [*option("-e", expr), *option("-f", file), *switches({"-i": invert, "-s": smooth, "-o": waveout})]
    return run("gensurf", mat, name, x, y, z, m, n, *words, stdin=stdin)


def gendaymtx(
    weather_data: Source,
    verbose: bool = False,
    header: bool = True,
    average: bool = False,
    sun_only: bool = False,
    sky_only: bool = False,
    sun_file: None | str = None,
    sun_mods: None | str = None,
    daylight_hours_only: bool = False,
    dryrun: bool = False,
    sky_color: None | list[float] = None,
    ground_color: None | list[float] = None,
    rotate: None | float = None,
    outform: None | str = None,
    onesun: bool = False,
    solar_radiance: bool = False,
    mfactor: int = 1,
) -> bytes:
    """The skies of a weather file as a matrix: ``gendaymtx``."""
    kind = {"-d": sun_only, "-s": sky_only and not sun_only}
    words = ["-m", str(mfactor), *switches({"-v": verbose, "-h": not header, "-A": average, **kind})]
    words += ["-5", ".533"] if onesun else []
    words += [*vector("-c", sky_color or None), *vector("-g", ground_color or None)]
    words += switches({"-n": dryrun, "-u": daylight_hours_only, "-O1": solar_radiance})
    words += [*option("-D", sun_file), *option("-M", sun_mods), *option("-r", rotate)]
    words += [f"-o{outform}"] if outform is not None else []
    word, stdin = source_of(weather_data)
    return run("gendaymtx", *words, *word, stdin=stdin)


def ies2rad(
    *inp: PathLike,
    libdir: None | str = None,
    prefdir: None | str = None,
    outname: None | str = None,
    stdout: bool = False,
    units: None | str = None,
    radius: None | float = None,
    instancing_geometry: bool = False,
    lampdat: None | str = None,
    lamp_type: None | str = None,
    lamp_color: None | tuple[float, float, float] = None,
    set_default_lamp_color: None | str = None,
    multiply_factor: None | float = None,
) -> bytes:
    """Luminaires from IES files: ``ies2rad``. Writes files, and with ``stdout`` the scene as bytes."""
    if lamp_color is not None and len(lamp_color) != 3:
        raise ValueError(f"lamp_color has {len(lamp_color)} numbers, expected 3")
    words = [*option("-l", libdir), *option("-p", prefdir), *option("-o", outname), *switches({"-s": stdout})]
    words += [*option("-d", units), *option("-i", radius), *switches({"-g": instancing_geometry})]
    words += [*option("-f", lampdat), *option("-t", lamp_type), *vector("-c", lamp_color)]
    words += [*option("-u", set_default_lamp_color), *option("-m", multiply_factor)]
    return run("ies2rad", *words, *inp)


def mgf2rad(
    *inp: str, matfile: None | str = None, mult: None | float = None, dist: None | float = None
) -> bytes:
    """Scenes in the Materials and Geometry Format: ``mgf2rad``."""
    return run("mgf2rad", *option("-m", matfile), *option("-e", mult), *option("-g", dist), *inp)


def obj2mesh(
    inp: Source,
    matfiles: None | Sequence[str] = None,
    matlib: None | str = None,
    objlim: int = 9,
    maxres: int = 16384,
    silent: bool = False,
    stats: bool = False,
) -> bytes:
    """A Wavefront file as a compiled mesh: ``obj2mesh``."""
    words = [*switches({"-w": silent, "-v": stats}), *option("-l", matlib), "-n", str(objlim), "-r", str(maxres)]
    words += repeated("-a", matfiles)
    word, stdin = source_of(inp)
    return run("obj2mesh", *words, *word, stdin=stdin)


def obj2rad(
    inp: Source,
    quallist: bool = False,
    flatten: bool = False,
    mapfile: None | str = None,
    objname: None | str = None,
) -> bytes:
    """A Wavefront file as scene text: ``obj2rad``."""
    word, stdin = source_of(inp)
    words = [*switches({"-n": quallist, "-f": flatten}), *option("-o", objname), *option("-m", mapfile)]
    return run("obj2rad", *words, *word, stdin=stdin)


def pkgbsdf(*xml: PathLike, frozen: bool = False, stdout: bool = False) -> None | bytes:
    """A measured BSDF as a material: ``pkgBSDF``. Writes files, or with ``stdout`` gives the scene of one."""
    if stdout and len(xml) > 1:
        raise ValueError(f"{len(xml)} files, expected one with stdout")
    said = run("pkgBSDF", *switches({"-i": frozen, "-s": stdout}), *xml)
    return said if stdout else None
