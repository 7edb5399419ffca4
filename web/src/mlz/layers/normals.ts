/** Normals as the faces around let expect them. */

import { cross, dot, next, previous } from "../block_shape.ts";
import type { BlockShape, Triple } from "../block_shape.ts";
import type { Guess } from "./directions.ts";
import type { LayerEntries } from "./wedges.ts";

/** Weights of faces: by area, by angle, by area over the squared edges. */
const [BY_AREA, BY_ANGLE] = [0, 1];

/** Returns the weighted normal of the faces around an entry. */
export function normalAround(
    entry: number,
    entries: LayerEntries,
    shape: BlockShape,
    weighting: number,
): Guess {
    const sum = [0, 0, 0];
    const [a, b] = [
        [0, 0, 0],
        [0, 0, 0],
    ];
    let [all, count] = [0, 0];
    let isOpen = false;
    for (const corner of entries.around(entry)) {
        shape.way(corner, next(corner), a);
        shape.way(corner, previous(corner), b);
        const normal = cross(a, b);
        const length = Math.sqrt(dot(normal, normal));
        isOpen ||= shape.isOpen(corner);
        if (!(length > 0)) continue;
        const weight = weightOf(weighting, a, b, length);
        for (let k = 0; k < 3; k++) sum[k] += normal[k] * weight;
        all += length * weight;
        count++;
    }
    const length = Math.sqrt(dot(sum, sum));
    const flatness = all > 0 ? length / all : 1;
    const bend = count < 2 ? 1 : flatness < 0.98 ? 2 : flatness < 0.999 ? 1 : 0;
    return { direction: length > 0 ? sum.map((x) => x / length) : null, bend, isOpen };
}

function weightOf(weighting: number, a: Triple, b: Triple, length: number): number {
    if (weighting === BY_AREA) return 1;
    if (weighting === BY_ANGLE) return angle(a, b) / length;
    return 1 / (dot(a, a) * dot(b, b));
}

/** Returns the angle between two vectors as all machines have it. */
function angle(a: Triple, b: Triple): number {
    const cosine = dot(a, b) / Math.sqrt(dot(a, a) * dot(b, b));
    const c = Math.min(Math.abs(cosine), 1);
    const part = 1.5707288 - 0.2121144 * c + 0.074261 * c * c - 0.0187293 * c * c * c;
    const acute = Math.sqrt(1 - c) * part;
    return cosine < 0 ? Math.PI - acute : acute;
}
