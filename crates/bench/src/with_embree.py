"""Times Embree's first hits of single rays on one thread.

Usage: with_embree.py SCENE.rad RAYS.f64

Prints by how many bytes the process grew with the scene. Then answers each line of standard input with a turn: its processor time
in s, the number of hits and the sum of their distances. SCENE.rad holds triangles only.
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


def main(scene_file, rays_file):
    triangles = corners(scene_file)
    rays = np.fromfile(rays_file, np.float64).reshape(-1, 6).astype(np.float32)
    origins, directions = np.ascontiguousarray(rays[:, :3]), np.ascontiguousarray(rays[:, 3:])
    vertices, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    before = resident()
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, vertices, index.reshape(-1, 3).astype(np.int32))
    scene.run(origins[:1], directions[:1], query="DISTANCE")
    print(resident() - before, flush=True)
    for _ in sys.stdin:
        start = time.process_time()
        distances = scene.run(origins, directions, query="DISTANCE")
        seconds = time.process_time() - start
        met = distances[distances < 1e30]
        print(seconds, len(met), met.astype(np.float64).sum(), flush=True)


main(*sys.argv[1:])
