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
    """Make a CIE sky: ``gensky``.

    Parameters
    ----------
    dt : datetime.datetime, optional
        Date and standard time.
    latitude : float, optional
        Degrees north.
    longitude : float, optional
        Degrees west, as for the program.
    timezone : int, optional
        Meridian of the standard time, degrees west.
    altitude : float, optional
        Altitude of the sun, degrees, instead of a date.
    azimuth : float, optional
        Azimuth of the sun, degrees west of south.
    year : int, optional
        Year for the sun's position.
    sunny_with_sun : bool
        ``+s``.
    sunny_without_sun : bool
        ``-s``.
    cloudy : bool
        ``-c``.
    intermediate_with_sun : bool
        ``+i``.
    intermediate_without_sun : bool
        ``-i``.
    uniform : bool
        ``-u``.
    ground_reflectance : float, optional
        Share, 0 to 1.
    zenith_brightness : float, optional
        W/(sr·m²).
    horizontal_brightness : float, optional
        Diffuse irradiance of the horizontal, W/m².
    solar_radiance : float, optional
        W/(sr·m²).
    horizontal_direct_irradiance : float, optional
        W/m².
    turbidity : float, optional
        Turbidity of the air.

    Returns
    -------
    bytes
        Scene text.

    Raises
    ------
    ValueError
        Without a date, and without altitude and azimuth.
    """
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
    """Make a Perez sky: ``gendaylit``.

    Parameters
    ----------
    dt : datetime.datetime, optional
        Date and standard time.
    latitude : float, optional
        Degrees north.
    longitude : float, optional
        Degrees west, as for the program.
    timezone : int, optional
        Meridian of the standard time, degrees west.
    altitude : float, optional
        Altitude of the sun, degrees, instead of a date.
    azimuth : float, optional
        Azimuth of the sun, degrees west of south.
    year : int, optional
        Year for the sun's position.
    dirnorm : float, optional
        Direct normal irradiance, W/m².
    diffhor : float, optional
        Diffuse horizontal irradiance, W/m².
    dirhor : float, optional
        Direct horizontal irradiance, W/m².
    dirnorm_illum : float, optional
        Direct normal illuminance, lx.
    diffhor_illum : float, optional
        Diffuse horizontal illuminance, lx.
    solar : bool
        Whether radiances are of the whole solar spectrum (``-O 1``).
    sky_only : bool
        Whether the sun is left out.
    silent : bool
        Whether warnings are left out.
    grefl : float, optional
        Reflectance of the ground, 0 to 1.
    interval : int, optional
        Minutes for which the irradiances are means.

    Returns
    -------
    bytes
        Scene text.

    Raises
    ------
    ValueError
        Without a date, and without altitude and azimuth.
    """
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
    """Make a box: ``genbox``.

    Parameters
    ----------
    mat : str
        Modifier of the surfaces.
    name : str
        Name of the surfaces.
    xsiz : float
        Size in x, scene units.
    ysiz : float
        Size in y.
    zsiz : float
        Size in z.
    inward : bool
        Whether normals point inward.
    beveled : float, optional
        Width of bevels.
    rounded : float, optional
        Radius of round edges.
    nsegs : int, optional
        Segments of a round edge.
    smoothing : bool
        Whether these are smooth.
    waveout : bool
        Whether a Wavefront file is made.

    Returns
    -------
    bytes
        Scene text.
    """
    words = [*switches({"-i": inward}), *option("-b", beveled), *option("-r", rounded), *option("-n", nsegs)]
    return run("genbox", mat, name, xsiz, ysiz, zsiz, *words, *switches({"-s": smoothing, "-o": waveout}))


class Xform:
    """Move scene text: ``xform``.

        Add transformations in their order, then call it for the bytes of the moved scene.

    Parameters
    ----------
    inp : path-like or bytes
        Scene file or text.
    expand_cmd : bool
        Whether commands are expanded.
    invert : bool
        Whether surfaces are turned around.
    iprefix : str, optional
        Text before all names.
    modifier : str, optional
        Modifier of all surfaces.
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
        """Move.

        Parameters
        ----------
        x, y, z : float
            Scene units.

        Returns
        -------
        Xform
            This object, for the next call.
        """
        return self._add("-t", x, y, z)

    def rotatex(self, deg: float) -> Xform:
        """Turn about the x axis.

        Parameters
        ----------
        deg : float
            Degrees.

        Returns
        -------
        Xform
            This object, for the next call.
        """
        return self._add("-rx", deg)

    def rotatey(self, deg: float) -> Xform:
        """Turn about the y axis.

        Parameters
        ----------
        deg : float
            Degrees.

        Returns
        -------
        Xform
            This object, for the next call.
        """
        return self._add("-ry", deg)

    def rotatez(self, deg: float) -> Xform:
        """Turn about the z axis.

        Parameters
        ----------
        deg : float
            Degrees.

        Returns
        -------
        Xform
            This object, for the next call.
        """
        return self._add("-rz", deg)

    def scale(self, ratio: float) -> Xform:
        """Scale about the origin.

        Parameters
        ----------
        ratio : float
            The factor.

        Returns
        -------
        Xform
            This object, for the next call.
        """
        return self._add("-s", ratio)

    def mirrorx(self) -> Xform:
        """Mirror at the yz plane.

        Returns
        -------
        Xform
            This object, for the next call.
        """
        return self._add("-mx")

    def mirrory(self) -> Xform:
        """Mirror at the xz plane.

        Returns
        -------
        Xform
            This object, for the next call.
        """
        return self._add("-my")

    def mirrorz(self) -> Xform:
        """Mirror at the xy plane.

        Returns
        -------
        Xform
            This object, for the next call.
        """
        return self._add("-mz")

    def array(self, number: int) -> Xform:
        """Repeat what follows, each time once more.

        Parameters
        ----------
        number : int
            How often.

        Returns
        -------
        Xform
            This object, for the next call.
        """
        return self._add("-a", number)

    def iterate(self, number: int) -> Xform:
        """Apply what follows so often.

        Parameters
        ----------
        number : int
            How often.

        Returns
        -------
        Xform
            This object, for the next call.
        """
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
    """Make Venetian blinds: ``genblinds``.

    Parameters
    ----------
    mat : str
        Modifier of the surfaces.
    name : str
        Name of the surfaces.
    depth : float
        Depth of a slat, scene units.
    width : float
        Width of the blinds.
    height : float
        Height of the blinds.
    nslats : int
        Number of slats.
    angle : float
        Tilt of the slats, degrees.
    rcurv : float, optional
        Radius of their curvature; its sign tells the side.

    Returns
    -------
    bytes
        Scene text.
    """
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
    """Make a prism over a polygon: ``genprism``.

    Parameters
    ----------
    mat : str
        Modifier of the surfaces.
    name : str
        Name of the surfaces.
    vertices : sequence of float, optional
        Corners: x and y of each in turn, scene units.
    vfile : str, optional
        File of the corners instead.
    lvect : sequence of float, optional
        Vector from base to top.
    radius : float, optional
        Radius of round edges.
    no_connect : bool
        Whether the last corner is not joined to the first.
    no_ends : bool
        Whether base and top are left out.
    stdin : bytes, optional
        The corners, where ``vfile`` is ``-``.

    Returns
    -------
    bytes
        Scene text.

    Raises
    ------
    ValueError
        Without corners, or with fewer than three.
    """
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
    """Make a surface of revolution: ``genrev``.

    Parameters
    ----------
    mat : str
        Modifier of the surfaces.
    name : str
        Name of the surfaces.
    z_t : str
        Height as an expression of t, 0 to 1.
    r_t : str
        Radius as an expression of t.
    nseg : int
        Number of segments.
    expr : str, optional
        Definitions (``-e``).
    file : str, optional
        File of definitions (``-f``).
    smooth : bool
        Whether normals are smooth.

    Returns
    -------
    bytes
        Scene text.
    """
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
    """Make a surface over two parameters: ``gensurf``.

    Parameters
    ----------
    mat : str
        Modifier of the surfaces.
    name : str
        Name of the surfaces.
    x : str
        Expression of s and t, 0 to 1.
    y, z : str
        Expression of s and t.
    m : int
        Divisions of s.
    n : int
        Divisions of t.
    expr : str, optional
        Definitions (``-e``).
    file : str, optional
        File of definitions (``-f``).
    invert : bool
        Whether normals are turned around.
    smooth : bool
        Whether normals are smooth.
    waveout : bool
        Whether a Wavefront file is made.
    stdin : bytes, optional
        Numbers, where a name is ``-``.

    Returns
    -------
    bytes
        Scene text.
    """
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
    """Make the skies of a weather file: ``gendaymtx``.

    Parameters
    ----------
    weather_data : path-like or bytes
        Weather in ``.wea`` or ``.epw`` form.
    verbose : bool
        Whether progress is printed.
    header : bool
        Whether the output has an information header.
    average : bool
        Whether all time steps are averaged.
    sun_only : bool
        Whether the sky is left out (``-d``).
    sky_only : bool
        Whether the sun is left out (``-s``).
    sun_file : str, optional
        File for the suns (``-D``).
    sun_mods : str, optional
        File for their modifiers (``-M``).
    daylight_hours_only : bool
        Whether nights are left out.
    dryrun : bool
        Whether only suns and modifiers are written.
    sky_color : list of float, optional
        Red, green and blue of the sky.
    ground_color : list of float, optional
        Red, green and blue of the ground.
    rotate : float, optional
        Rotation of the sky, degrees.
    outform : str, optional
        ``a``, ``f`` or ``d``.
    onesun : bool
        Whether a sun is one patch of its own size (``-5``).
    solar_radiance : bool
        Whether radiances are of the whole solar spectrum (``-O1``).
    mfactor : int
        Factor of the Reinhart division of the sky.

    Returns
    -------
    bytes
        A row for each patch, a column for each time step, W/(sr·m²).
    """
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
    """Convert luminaires from IES files: ``ies2rad``.

    Parameters
    ----------
    *inp : path-like
        IES files.
    libdir : str, optional
        Folder of the library.
    prefdir : str, optional
        Subfolder of it.
    outname : str, optional
        Name of the files that are written.
    stdout : bool
        Whether the scene is returned instead of written.
    units : str, optional
        Unit of the scene, such as ``m``.
    radius : float, optional
        Radius of an ``illum`` sphere, scene units.
    instancing_geometry : bool
        Whether geometry is an instance.
    lampdat : str, optional
        File of lamp types.
    lamp_type : str, optional
        Lamp type.
    lamp_color : (float, float, float), optional
        Red, green and blue.
    set_default_lamp_color : str, optional
        Default lamp type.
    multiply_factor : float, optional
        Factor of all values.

    Returns
    -------
    bytes
        Scene text with ``stdout``, otherwise nothing.

    Raises
    ------
    ValueError
        If the colour is not three numbers.
    """
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
    """Convert scenes of the Materials and Geometry Format: ``mgf2rad``.

    Parameters
    ----------
    *inp : str
        Files.
    matfile : str, optional
        File for the materials.
    mult : float, optional
        Factor of emission.
    dist : float, optional
        Radius of influence of glow, scene units.

    Returns
    -------
    bytes
        Scene text.
    """
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
    """Compile a Wavefront file to a mesh: ``obj2mesh``.

    Parameters
    ----------
    inp : path-like or bytes
        A Wavefront file.
    matfiles : sequence of str, optional
        Scene files of materials.
    matlib : str, optional
        An octree of materials.
    objlim : int
        Triangles in a cell.
    maxres : int
        Largest number of cells along an axis.
    silent : bool
        Whether warnings are left out.
    stats : bool
        Whether statistics are printed.

    Returns
    -------
    bytes
        The mesh.
    """
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
    """Convert a Wavefront file to scene text: ``obj2rad``.

    Parameters
    ----------
    inp : path-like or bytes
        A Wavefront file.
    quallist : bool
        Whether only qualifiers are listed.
    flatten : bool
        Whether smoothing is left out.
    mapfile : str, optional
        File that maps qualifiers to modifiers.
    objname : str, optional
        Name of the surfaces.

    Returns
    -------
    bytes
        Scene text.
    """
    word, stdin = source_of(inp)
    words = [*switches({"-n": quallist, "-f": flatten}), *option("-o", objname), *option("-m", mapfile)]
    return run("obj2rad", *words, *word, stdin=stdin)


def pkgbsdf(*xml: PathLike, frozen: bool = False, stdout: bool = False) -> None | bytes:
    """Make a material of measured BSDFs: ``pkgBSDF``.

    Parameters
    ----------
    *xml : path-like
        BSDF files.
    frozen : bool
        Whether geometry is a mesh.
    stdout : bool
        Whether the scene of one file is returned instead of written.

    Returns
    -------
    bytes or None
        Scene text with ``stdout``, otherwise ``None``.

    Raises
    ------
    ValueError
        If ``stdout`` is asked for several files.
    """
    if stdout and len(xml) > 1:
        raise ValueError(f"{len(xml)} files, expected one with stdout")
    said = run("pkgBSDF", *switches({"-i": frozen, "-s": stdout}), *xml)
    return said if stdout else None
