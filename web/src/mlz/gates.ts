/** Gates: the edges at which vertices are added, as they are before their steps. */

import type { Border } from "./border.ts";
import { NODES } from "./border.ts";

/** Number of contexts of steps that may have tables of their own. */
export const CONTEXTS = 7 * 6 * 4;
/** Kinds of gates, by the faces of both ends. */
export const KINDS = 5 * 4;
/** Vertices of a gate: a, b, apex, previous apex, the one before a, the one behind b. */
export const ENDS = 6;
/** Marks a corner of a face without a gate; plus the number of the corner. */
export const NO_GATE = 32;

/** The gate of each vertex of a block. */
export class Gates {
    readonly ends = new Uint16Array(ENDS * NODES);
    /** Kind of each gate, or `NO_GATE` and the number of the corner. */
    readonly kinds = new Uint8Array(NODES);
    length = 0;

    /** Adds the gate at a node's edge; returns the number of the vertex. */
    add(border: Border, at: number): number {
        const { vertex, next, previous, apex, previousApex, faces } = border;
        const second = next[at];
        const [a, b] = [vertex[at], vertex[second]];
        const { ends } = this;
        const from = ENDS * this.length;
        ends[from] = a;
        ends[from + 1] = b;
        ends[from + 2] = apex[at];
        ends[from + 3] = previousApex[at];
        ends[from + 4] = vertex[previous[at]];
        ends[from + 5] = vertex[next[second]];
        this.kinds[this.length] = 4 * (clamp(faces[a], 5) - 1) + clamp(faces[b], 4) - 1;
        return this.length++;
    }

    /** Adds the three corners of a face without a gate; returns the first. */
    addCorners(): number {
        for (let corner = 0; corner < 3; corner++) this.kinds[this.length++] = NO_GATE + corner;
        return this.length - 3;
    }
}

/** Returns the context in which the step at a node's edge is coded. */
export function contextAt(border: Border, at: number): number {
    const { vertex, next, previous, faces } = border;
    const second = next[at];
    const a = clamp(faces[vertex[at]], 7) - 1;
    const b = clamp(faces[vertex[second]], 6) - 1;
    const before = Number(border.isClosed(previous[at]));
    return ((a * 6 + b) * 2 + before) * 2 + Number(border.isClosed(second));
}

function clamp(count: number, most: number): number {
    return Math.min(Math.max(count, 1), most);
}
