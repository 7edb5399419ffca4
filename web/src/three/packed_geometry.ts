/** Geometries of three.js from decoded meshes. */

import { BufferAttribute, BufferGeometry } from "three";
import { buffersOf } from "../packed/mesh.ts";
import type { MeshLabels, PackedMesh } from "../packed/mesh.ts";
import { attributeName } from "./attribute_name.ts";

/**
 * Returns a mesh as a geometry with a group for each material that has faces.
 *
 * `userData` has the names of `materials` and `objects`. Texture coordinates grow upwards, as
 * textures of TextureLoader do.
 */
export function geometryOf(mesh: PackedMesh): BufferGeometry {
    const { positions, indices, layers } = buffersOf(mesh);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    for (const { kind, set, width, values } of layers) {
        const name = attributeName(kind, set);
        if (name !== null) geometry.setAttribute(name, new BufferAttribute(values, width));
    }
    const { materials, objects } = mesh;
    const sorted = materials ? byMaterial(indices, materials, geometry) : indices;
    geometry.setIndex(new BufferAttribute(sorted, 1));
    geometry.userData = { materials: materials?.names ?? [], objects: objects?.names ?? [] };
    return geometry;
}

/** Sorts faces by their materials, and adds a group for each. */
function byMaterial(
    indices: Uint32Array,
    { names, ofFace }: MeshLabels,
    geometry: BufferGeometry,
): Uint32Array {
    const ends = new Uint32Array(names.length + 1);
    for (const label of ofFace) ends[label + 1] += 3;
    for (let label = 0; label < names.length; label++) {
        if (ends[label + 1] > 0) geometry.addGroup(ends[label], ends[label + 1], label);
        ends[label + 1] += ends[label];
    }
    const sorted = new Uint32Array(indices.length);
    ofFace.forEach((label, face) => {
        sorted.set(indices.subarray(3 * face, 3 * face + 3), ends[label]);
        ends[label] += 3;
    });
    return sorted;
}
