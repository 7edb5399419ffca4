/** A decoded mesh of `.mlq` or `.mlz`, and its vertices as a GPU wants them. */

import type { LayerKind } from "../wedges/layer.ts";

/** Values of one attribute, wedge by wedge. */
export interface MeshLayer {
    kind: LayerKind;
    /** Number of the set, as in `TEXCOORD_1`. */
    set: number;
    name: string;
    /** Number of values of a wedge. */
    width: number;
    values: Float32Array;
}

/** Attributes: each corner of a face has a wedge, and each wedge has values. */
export interface MeshWedges {
    count: number;
    /** Three wedges of each face. */
    corners: Uint32Array;
    layers: MeshLayer[];
}

/** Names, and the one that each face has. */
export interface MeshLabels {
    names: string[];
    ofFace: Uint32Array;
}

/** A mesh with every vertex once. */
export interface PackedMesh {
    /** Three coordinates of each vertex, in model units. */
    positions: Float64Array;
    /** Three vertices of each face. */
    faces: Uint32Array;
    wedges: MeshWedges | null;
    materials: MeshLabels | null;
    objects: MeshLabels | null;
    /** What else `compress` stored: the rest of a scene, or nothing. */
    resources: Uint8Array;
}

/** Arrays to be drawn: one vertex for each wedge, in the order in which faces use them. */
export interface MeshBuffers {
    positions: Float32Array;
    indices: Uint32Array;
    layers: MeshLayer[];
}

const NONE = 0xffffffff;

/** Returns a mesh as buffers in single precision, with a vertex for each wedge. */
export function buffersOf({ positions, faces, wedges }: PackedMesh): MeshBuffers {
    if (!wedges) return { positions: new Float32Array(positions), indices: faces, layers: [] };
    const spread = new Float32Array(3 * wedges.count);
    wedges.corners.forEach((wedge, corner) => {
        for (let k = 0; k < 3; k++) spread[3 * wedge + k] = positions[3 * faces[corner] + k];
    });
    return { positions: spread, indices: wedges.corners, layers: wedges.layers };
}

/** Makes wedges of a vertex with equal values one, and drops those without a corner. */
export function mergeEqualWedges(wedges: MeshWedges, faces: Uint32Array, vertices: number): void {
    const { corners, layers, count } = wedges;
    const vertexOf = new Uint32Array(count).fill(NONE);
    corners.forEach((wedge, corner) => (vertexOf[wedge] = faces[corner]));
    const [starts, sorted] = buckets(vertexOf, vertices);
    const compare = comparison(layers);
    const kept = new Uint32Array(count);
    for (let vertex = 0; vertex < vertices; vertex++) {
        const around = sorted.subarray(starts[vertex], starts[vertex + 1]);
        if (around.length > 1) around.sort(compare);
        let first = around[0];
        for (const wedge of around) {
            if (compare(first, wedge) !== 0) first = wedge;
            // Of equal wedges the sort leaves them in order: the first one has the least number.
            kept[wedge] = first;
        }
    }
    const numbers = new Uint32Array(count).fill(NONE);
    const sources: number[] = [];
    corners.forEach((wedge, corner) => {
        const source = kept[wedge];
        if (numbers[source] === NONE) {
            numbers[source] = sources.length;
            sources.push(source);
        }
        corners[corner] = numbers[source];
    });
    wedges.count = sources.length;
    for (const layer of layers) {
        const { width, values } = layer;
        layer.values = new Float32Array(width * sources.length);
        sources.forEach((source, wedge) => {
            for (let k = 0; k < width; k++)
                layer.values[width * wedge + k] = values[width * source + k];
        });
    }
}

/** Sorts wedges by their vertices; those without one are left out. */
function buckets(vertexOf: Uint32Array, vertices: number): [Uint32Array, Uint32Array] {
    const starts = new Uint32Array(vertices + 1);
    for (const vertex of vertexOf) if (vertex !== NONE) starts[vertex + 1]++;
    for (let vertex = 0; vertex < vertices; vertex++) starts[vertex + 1] += starts[vertex];
    const ends = starts.slice();
    const sorted = new Uint32Array(starts[vertices]);
    vertexOf.forEach((vertex, wedge) => {
        if (vertex !== NONE) sorted[ends[vertex]++] = wedge;
    });
    return [starts, sorted];
}

/** Orders wedges by all their values, in which −0 is 0. */
function comparison(layers: readonly MeshLayer[]): (a: number, b: number) => number {
    return (a, b) => {
        for (const { width, values } of layers) {
            for (let k = 0; k < width; k++) {
                const difference = values[width * a + k] - values[width * b + k];
                if (difference !== 0) return difference;
            }
        }
        return 0;
    };
}
