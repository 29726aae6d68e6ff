"""Times Embree's first hits of single rays on one thread.

Usage: with_embree.py SCENE.rad RAYS.f64 REPEAT

Prints the least processor time in s, the number of hits, the sum of their distances, and by how many bytes the process grew with the
scene. SCENE.rad holds triangles only.
"""

import os
import sys
import time

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh


def corners(path):
    rows = []
    with open(path) as file:
        for line in file:
            words = line.split()
            if len(words) == 3:
                try:
                    rows.append([float(word) for word in words])
                except ValueError:
                    pass
    return np.array(rows, np.float32).reshape(-1, 3, 3)


def resident():
    try:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return float("nan")


def main(scene_file, rays_file, repeat):
    triangles = corners(scene_file)
    rays = np.fromfile(rays_file, np.float64).reshape(-1, 6).astype(np.float32)
    origins, directions = np.ascontiguousarray(rays[:, :3]), np.ascontiguousarray(rays[:, 3:])
    vertices, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    before = resident()
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, vertices, index.reshape(-1, 3).astype(np.int32))
    scene.run(origins[:1], directions[:1], query="DISTANCE")
    grown = resident() - before
    least = float("inf")
    for _ in range(int(repeat)):
        start = time.process_time()
        distances = scene.run(origins, directions, query="DISTANCE")
        least = min(least, time.process_time() - start)
    met = distances[distances < 1e30]
    print(least, len(met), met.astype(np.float64).sum(), grown)


main(*sys.argv[1:])
