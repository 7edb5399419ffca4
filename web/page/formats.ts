/** Decoders of `.mlz` and `.mlq`, which the page fetches with the first such file. */

import { decodeMlq } from "../src/mlq/index.ts";
import { decodeMlz } from "../src/mlz/index.ts";
import { buffersOf } from "../src/packed/mesh.ts";
import type { WholeMesh } from "./model.ts";

/** Returns the mesh of a file as one buffer of vertices. */
export function decodePacked(file: Uint8Array, isMlq: boolean): WholeMesh {
    const { positions, indices, layers } = buffersOf(isMlq ? decodeMlq(file) : decodeMlz(file));
    const count = positions.length / 3;
    const columns = [{ width: 3, values: positions }, ...layers];
    const width = columns.reduce((sum, column) => sum + column.width, 0);
    const values = new Float32Array(width * count);
    let start = 0;
    for (const column of columns) {
        for (let i = 0; i < count; i++)
            for (let k = 0; k < column.width; k++)
                values[i * width + start + k] = column.values[i * column.width + k];
        start += column.width;
    }
    return { layers, values, index: indices, ...ballOf(positions, indices) };
}

function ballOf(
    positions: Float32Array,
    indices: Uint32Array,
): Pick<WholeMesh, "center" | "diagonal"> {
    const [low, high] = [Array(3).fill(Infinity), Array(3).fill(-Infinity)] as [number[], number[]];
    for (const vertex of indices) {
        for (let k = 0; k < 3; k++) {
            const x = positions[3 * vertex + k];
            low[k] = Math.min(low[k], x);
            high[k] = Math.max(high[k], x);
        }
    }
    if (!(low[0] <= high[0])) return { center: [0, 0, 0], diagonal: 1 };
    const middle = (k: number) => (low[k] + high[k]) / 2;
    return {
        center: [middle(0), middle(1), middle(2)],
        diagonal: Math.hypot(...high.map((x, k) => x - low[k])),
    };
}
