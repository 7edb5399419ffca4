/** Tangents as positions, texture coordinates and normals let expect them. */

import { dot, next, previous } from "../block_shape.ts";
import type { BlockShape, Triple } from "../block_shape.ts";
import type { Guess } from "./directions.ts";
import type { LayerJob } from "./job.ts";
import type { LayerEntries } from "./wedges.ts";

/** Texture coordinates and normals of all corners, where the file has them. */
export class TangentFrame {
    constructor(
        private readonly shape: BlockShape,
        private readonly uv: Float64Array | null,
        private readonly normal: Float64Array | null,
    ) {}

    /** Returns the direction in which u grows around an entry, at right angles to the normal. */
    guess(entry: number, entries: LayerEntries): Guess {
        const { shape, uv } = this;
        if (!uv) return { direction: null, bend: 1, isOpen: false };
        const sum = [0, 0, 0];
        const a = [0, 0, 0];
        const b = [0, 0, 0];
        let isOpen = false;
        let normal: Triple | null = null;
        for (const corner of entries.around(entry)) {
            isOpen ||= shape.isOpen(corner);
            shape.way(corner, next(corner), a);
            shape.way(corner, previous(corner), b);
            normal = this.normalAt(corner);
            const area = this.area(uv, corner);
            if (area === 0) continue;
            const sign = area < 0 ? -1 : 1;
            const va = uv[2 * next(corner) + 1] - uv[2 * corner + 1];
            const vb = uv[2 * previous(corner) + 1] - uv[2 * corner + 1];
            const along = a.map((x, k) => (x * vb - b[k] * va) * sign);
            if (normal) flatten(along, normal);
            const scale = 1 / Math.sqrt(dot(along, along));
            if (!Number.isFinite(scale)) continue;
            for (let k = 0; k < 3; k++) sum[k] += along[k] * scale;
        }
        if (normal) flatten(sum, normal);
        const length = Math.sqrt(dot(sum, sum));
        return { direction: length > 0 ? sum.map((x) => x / length) : null, bend: 0, isOpen };
    }

    private normalAt(corner: number): Triple | null {
        const { normal } = this;
        return normal && [normal[3 * corner], normal[3 * corner + 1], normal[3 * corner + 2]];
    }

    /** Returns twice the area of a corner's face in texture coordinates. */
    private area(uv: Float64Array, corner: number): number {
        const way = (to: number, k: number) => uv[2 * to + k] - uv[2 * corner + k];
        const [a, b] = [next(corner), previous(corner)];
        return way(a, 0) * way(b, 1) - way(a, 1) * way(b, 0);
    }

    /** Decodes the signs of tangents, the third of their numbers. */
    decodeSigns({ entries, layer, coder, numbers }: LayerJob, context: number): void {
        const { uv } = this;
        for (let entry = 0; entry < entries.length; entry++) {
            let side = 0;
            if (uv) {
                let area = 0;
                for (const corner of entries.around(entry)) area += this.area(uv, corner);
                side = area > 0 ? 1 : 2;
            }
            numbers[layer.most.length * entry + 2] = Number(coder.bit(context + side));
        }
    }
}

/** Takes the part along a normal from a vector. */
function flatten(vector: number[], normal: Triple): void {
    const height = dot(normal, vector);
    for (let k = 0; k < 3; k++) vector[k] -= normal[k] * height;
}
