"""Renders a flat Radiance scene of few types with Mitsuba 3.

Usage: with_mitsuba.py probe VARIANT
       with_mitsuba.py render VARIANT SCENE.rad OUT.pfm RADSIGHT COLUMNS ROWS RAYS DEPTH SAMPLER VIEW-OPTION...

Prints the processor time and the wall time in s of the rendering alone, without start, loading and translation. SCENE.rad holds
polygons (convex), spheres, cylinders, tubes and sources of plastic without highlight, mirror, dielectric, light and glow; a pattern may stand
only before the glow of a source, whose picture is asked of `radsight rtrace`.
"""

import math
import os
import subprocess
import sys
import time

import mitsuba as mi
import numpy as np

# Distant lights are disks this many times as far away as the scene is large.
FAR = 1000.0


def primitives(text):
    """Yields modifier, type, name, words, numbers."""
    lines = (line for line in text.split("\n") if not line.startswith("#"))
    words = iter(" ".join(lines).split())
    for modifier in words:
        kind, name = next(words), next(words)
        if kind == "alias":
            next(words)
            continue
        strings = [next(words) for _ in range(int(next(words)))]
        for _ in range(int(next(words))):
            next(words)
        numbers = [float(next(words)) for _ in range(int(next(words)))]
        yield modifier, kind, name, strings, numbers


class Scene:
    """Triangles by material, other shapes, sources."""

    def __init__(self, text):
        self.materials, self.triangles, self.shapes, self.sources = {}, {}, [], []
        self.modifiers = []
        for modifier, kind, name, strings, numbers in primitives(text):
            if kind == "polygon":
                corners = np.array(numbers, np.float32).reshape(-1, 3)
                fan = [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
                self.triangles.setdefault(modifier, []).extend(fan)
            elif kind in ("sphere", "cylinder", "tube"):
                self.shapes.append((modifier, kind, numbers))
            elif kind == "source":
                self.sources.append((modifier, name, numbers))
            else:
                self.materials[name] = (kind, numbers)
                self.modifiers.append((modifier, kind, name, strings, numbers))

    def sky_text(self):
        """The part of the scene that a ray into the sky meets, without lights."""
        parts = [
            f"{modifier} {kind} {name} {len(strings)} {' '.join(strings)} 0 {len(numbers)} {' '.join(map(repr, numbers))}\n"
            for modifier, kind, name, strings, numbers in self.modifiers
        ]
        for modifier, name, numbers in self.sources:
            if self.materials[modifier][0] == "glow":
                parts.append(f"{modifier} source {name} 0 0 4 {' '.join(map(repr, numbers))}\n")
        return "".join(parts)


def bsdf(material):
    kind, numbers = material
    color = {"type": "rgb", "value": numbers[:3]}
    if kind == "plastic" and numbers[3] == 0:
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": color}}
    if kind == "mirror":
        return {"type": "twosided", "bsdf": {"type": "conductor", "material": "none", "specular_reflectance": color}}
    if kind == "dielectric" and numbers[:3] == [1, 1, 1]:
        return {"type": "dielectric", "int_ior": numbers[3], "ext_ior": 1.0}
    if kind in ("light", "glow"):
        return {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
    sys.exit(f"with_mitsuba.py: no translation of {kind} {numbers}")


def with_material(shape, material):
    shape["bsdf"] = bsdf(material)
    kind, numbers = material
    if kind in ("light", "glow"):
        shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": numbers[:3]}}
    return shape


def mesh(name, triangles, material):
    corners = np.array(triangles, np.float32).reshape(-1, 3)
    properties = mi.Properties()
    for key, value in with_material({}, material).items():
        properties[key] = mi.load_dict(value)
    made = mi.Mesh(name, len(corners), len(corners) // 3, properties)
    parameters = mi.traverse(made)
    parameters["vertex_positions"] = corners.ravel()
    parameters["faces"] = np.arange(len(corners), dtype=np.uint32)
    parameters.update()
    return made


def sky_picture(text, folder, radsight, rows=512):
    """Radiance by direction, as Mitsuba's envmap has it with its pole along z."""
    path = os.path.join(folder, "sky-only.rad")
    with open(path, "w") as file:
        file.write(text)
    v, u = np.meshgrid((np.arange(rows) + 0.5) / rows, (np.arange(2 * rows) + 0.5) / (2 * rows), indexing="ij")
    theta, phi = v * np.pi, u * 2 * np.pi
    # The envmap's own axes: y up; u = 0 along -z.
    own = np.stack([np.sin(phi) * np.sin(theta), np.cos(theta), -np.cos(phi) * np.sin(theta)], -1)
    directions = np.stack([own[..., 0], -own[..., 2], own[..., 1]], -1).reshape(-1, 3)
    rays = np.concatenate([np.zeros_like(directions), directions], 1).astype(np.float32).tobytes()
    command = [radsight, "rtrace", "-h", "-fff", path]
    told = subprocess.run(command, input=rays, stdout=subprocess.PIPE, check=True).stdout
    return np.frombuffer(told, np.float32).reshape(rows, 2 * rows, 3).copy()


def options(words):
    found = {"-vh": [45.0]}
    for at, word in enumerate(words):
        if word in ("-vp", "-vd", "-vu"):
            found[word] = [float(number) for number in words[at + 1 : at + 4]]
        elif word in ("-vh", "-vv"):
            found[word] = [float(words[at + 1])]
    return found


def load(path, radsight, columns, rows, sampler, view):
    with open(path) as file:
        scene = Scene(file.read())
    made = {"type": "scene"}
    to_world = mi.ScalarTransform4f
    for name, triangles in scene.triangles.items():
        made[f"mesh_{len(made)}"] = mesh(name, triangles, scene.materials[name])
    for name, kind, numbers in scene.shapes:
        shape = {"type": "sphere" if kind == "sphere" else "cylinder"}
        if kind == "sphere":
            shape.update(center=numbers[:3], radius=numbers[3])
        else:
            shape.update(p0=numbers[:3], p1=numbers[3:6], radius=numbers[6])
        made[f"shape_{len(made)}"] = with_material(shape, scene.materials[name])
    eye = np.array(view["-vp"])
    for name, _, numbers in scene.sources:
        if scene.materials[name][0] != "light":
            continue
        direction = np.array(numbers[:3]) / np.linalg.norm(numbers[:3])
        size = max((np.abs(np.array(t)).max() for t in scene.triangles.values()), default=1.0)
        center, radius = eye + direction * FAR * size, FAR * size * math.tan(math.radians(numbers[3] / 2))
        placed = to_world().look_at(origin=center.tolist(), target=eye.tolist(), up=[0.3, 0.5, 0.8])
        placed = placed @ to_world().scale([float(radius)] * 3)
        made[f"sun_{len(made)}"] = with_material({"type": "disk", "to_world": placed}, scene.materials[name])
    if any(scene.materials[name][0] == "glow" for name, _, _ in scene.sources):
        picture = sky_picture(scene.sky_text(), os.path.dirname(path), radsight)
        turned = to_world().rotate([1, 0, 0], 90)
        made["sky"] = {"type": "envmap", "bitmap": mi.Bitmap(picture), "to_world": turned}
    target = eye + np.array(view["-vd"])
    made["sensor"] = {
        "type": "perspective",
        "fov": view["-vh"][0],
        "fov_axis": "x",
        "to_world": to_world().look_at(origin=eye.tolist(), target=target.tolist(), up=view["-vu"]),
        "film": {"type": "hdrfilm", "width": columns, "height": rows, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
        "sampler": {"type": sampler},
    }
    return mi.load_dict(made)


def write_pfm(path, image):
    with open(path, "wb") as file:
        file.write(f"PF\n{image.shape[1]} {image.shape[0]}\n-1.0\n".encode())
        file.write(np.ascontiguousarray(image[::-1], np.float32).tobytes())


def render(path, out, radsight, columns, rows, rays, depth, sampler, *view):
    columns, rows, rays, depth = int(columns), int(rows), int(rays), int(depth)
    scene = load(path, radsight, columns, rows, sampler, options(view))
    integrator = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 5})
    start, processor = time.perf_counter(), time.process_time()
    picture, left, seed = 0, rays, 1
    # Large wavefronts need much memory.
    at_once = rays if "scalar" in mi.variant() else min(rays, max(1, (1 << 24) // (columns * rows)))
    while left > 0:
        now = min(left, at_once)
        picture = picture + now * np.array(mi.render(scene, integrator=integrator, spp=now, seed=seed))
        left, seed = left - now, seed + 1
    processor, wall = time.process_time() - processor, time.perf_counter() - start
    write_pfm(out, picture / rays)
    print(processor, wall)


def main(words):
    mi.set_variant(words[1])
    if words[0] == "probe":
        mi.render(mi.load_dict(mi.cornell_box()), spp=1)
        print(mi.__version__)
    else:
        render(*words[2:])


main(sys.argv[1:])
