"""Compares meshlod.simplify with other packages: distance, and CPU time of alternating runs.

    pip install fast-simplification pyvista open3d trimesh
    RAYON_NUM_THREADS=1 python bench.py --rounds 5 MESH …

Times are CPU seconds of the process, arrays in and out included, so that other load counts little;
medians of alternating runs, as ratios to fast_simplification's. Distances are mean distances in
both directions in % of the diagonal, measured by meshlod with 500,000 samples each. A package that
is not there is left out, and named.
"""

import argparse
import importlib
import statistics
import time
import warnings

import meshlod
import numpy as np

REDUCTIONS = (0.9, 0.99)


def ours(points, faces, reduction):
    return meshlod.simplify(points, faces, reduction)


def fast_simplification(points, faces, reduction):
    return importlib.import_module("fast_simplification").simplify(points, faces, reduction)


def pyvista(points, faces, reduction):
    package = importlib.import_module("pyvista")
    level = package.PolyData.from_regular_faces(points, faces).decimate(reduction)
    return np.array(level.points), np.array(level.regular_faces)


def open3d(points, faces, reduction):
    package = importlib.import_module("open3d")
    mesh = package.geometry.TriangleMesh(
        package.utility.Vector3dVector(points), package.utility.Vector3iVector(faces)
    )
    level = mesh.simplify_quadric_decimation(int(len(faces) * (1 - reduction)))
    return np.array(level.vertices), np.array(level.triangles)


def trimesh(points, faces, reduction):
    mesh = importlib.import_module("trimesh").Trimesh(points, faces, process=False)
    level = mesh.simplify_quadric_decimation(percent=reduction)
    return np.array(level.vertices), np.array(level.faces)


OTHERS = (fast_simplification, pyvista, open3d, trimesh)
PEERS = {"meshlod": ours, **{simplify.__name__: simplify for simplify in OTHERS}}


def compare(path, reduction, peers, rounds):
    """Prints a row for each peer."""
    mesh = meshlod.load(path)
    points, faces = np.array(mesh.vertices), np.array(mesh.faces)
    seconds = {name: [] for name in peers}
    levels = {}
    for _ in range(rounds):
        for name, simplify in peers.items():
            start = time.process_time()
            levels[name] = simplify(points, faces, reduction)
            seconds[name].append(time.process_time() - start)
    base = statistics.median(seconds.get("fast_simplification") or seconds["meshlod"])
    for name, (out, triangles) in levels.items():
        distance = mesh.measure(meshlod.Mesh(out, triangles))
        mean, most = (100 * x / distance.diagonal for x in (distance.mean, distance.max))
        ratio = statistics.median(seconds[name]) / base
        left = 100 * (1 - reduction)
        stem = path.rsplit("/", 1)[-1]
        figures = f"{len(triangles)} | {mean:.5f} | {most:.3f} | {ratio:.2f}"
        print(f"| {stem}, {left:.0f} % | {name} | {figures} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="+", metavar="MESH")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--packages", nargs="*", default=list(PEERS), metavar="NAME")
    options = parser.parse_args()
    warnings.simplefilter("ignore", meshlod.MeshlodWarning)
    peers = {}
    for name, simplify in PEERS.items():
        if name not in options.packages:
            continue
        try:
            importlib.import_module(name)
            peers[name] = simplify
        except ImportError:
            print(f"left out: {name} is not installed")
    print("| mesh, faces kept | package | faces | mean % | max % | CPU time, fast_simplification = 1 |")
    print("| --- | --- | --: | --: | --: | --: |")
    for path in options.meshes:
        for reduction in REDUCTIONS:
            compare(path, reduction, peers, options.rounds)


if __name__ == "__main__":
    main()
