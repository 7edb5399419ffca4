#!/usr/bin/env python3
"""Levels of a bare mesh by other programs, for `cargo xtask parts`.

    peers.py MESH.ply FOLDER FACES...

Writes FOLDER/PEER-FACES.ply for each peer and each number of faces. A peer that leaves no face, or
fails, writes no file.
"""
import pathlib
import sys

import meshoptimizer
import numpy
import pymeshlab
import trimesh

# Bit of meshopt_SimplifyPrune.
PRUNE = 8


def by_pymeshlab(path, faces, out):
    """Quadrics with optimal placement; everything else by default, which lets the topology go."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=faces, optimalplacement=True)
    if meshes.current_mesh().face_number():
        meshes.save_current_mesh(str(out), save_vertex_color=False, save_vertex_quality=False)


def by_meshoptimizer(options):
    """Simplification that moves no vertex, without a limit of the error."""

    def run(path, faces, out):
        mesh = trimesh.load(path, process=False)
        vertices = numpy.ascontiguousarray(mesh.vertices, numpy.float32)
        indices = numpy.ascontiguousarray(mesh.faces.reshape(-1), numpy.uint32)
        level = numpy.zeros_like(indices)
        count = meshoptimizer.simplify(
            level, indices, vertices,
            target_index_count=3 * faces, target_error=1e9, options=options,
        )
        if count:
            triangles = level[:count].reshape(-1, 3)
            trimesh.Trimesh(vertices, triangles, process=False).export(out)

    return run


PEERS = {
    "pymeshlab": by_pymeshlab,
    "meshopt": by_meshoptimizer(0),
    "meshopt-prune": by_meshoptimizer(PRUNE),
}


def main():
    path, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    for faces in map(int, sys.argv[3:]):
        for name, simplify in PEERS.items():
            try:
                simplify(path, faces, folder / f"{name}-{faces}.ply")
            except Exception as error:
                print(f"{name}, {faces} faces: {error}", file=sys.stderr)


if __name__ == "__main__":
    main()
