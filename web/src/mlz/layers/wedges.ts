/** Which corners of a block share a wedge, and which wedges share the values of a layer. */

import { NONE, next, previous } from "../block_shape.ts";
import type { BlockFaces } from "../block_shape.ts";
import type { LayerCoder } from "./coder.ts";
import { ENTRY_BITS } from "./format.ts";

/** Wedges of a vertex that are tried after those across the sides of a corner. */
const OTHERS = 3;

/** Wedges of a block. */
export interface BlockWedges {
    ofCorner: Uint16Array;
    /** Vertex of each wedge. */
    vertex: number[];
}

/** Lists of what each vertex has, from the latest on. */
class Latest {
    private readonly latest = new Map<number, number>();
    private readonly before: number[] = [];

    /** Returns the latest one of a vertex, or `NONE`. */
    of(vertex: number): number {
        return this.latest.get(vertex) ?? NONE;
    }

    /** Returns the one before another one of its vertex. */
    older(number: number): number {
        return this.before[number];
    }

    /** Adds the next number to a vertex. */
    add(vertex: number): void {
        const number = this.before.length;
        this.before.push(this.of(vertex));
        this.latest.set(vertex, number);
    }
}

/** Decodes the wedge of each corner. */
export function decodeWedges(faces: BlockFaces, coder: LayerCoder): BlockWedges {
    const { corners } = faces;
    const ofCorner = new Uint16Array(corners.length).fill(NONE);
    const vertex: number[] = [];
    const latest = new Latest();
    for (let corner = 0; corner < corners.length; corner++) {
        let found = byCandidates(corner, faces, ofCorner, latest, coder);
        if (found === NONE) {
            found = vertex.length;
            vertex.push(corners[corner]);
            latest.add(corners[corner]);
        }
        ofCorner[corner] = found;
    }
    return { ofCorner, vertex };
}

/** Decodes which candidate a corner has, if any. */
function byCandidates(
    corner: number,
    { twins, corners }: BlockFaces,
    ofCorner: Uint16Array,
    latest: Latest,
    coder: LayerCoder,
): number {
    const [a, endA] = across(next(corner), twins[corner], true, ofCorner);
    const before = previous(corner);
    const [b, endB] = across(before, twins[before], false, ofCorner);
    let [first, second, context] = [a, NONE, 3 * endA];
    if (a === NONE) [first, context] = [b, 3 * endB + 1];
    else if (a === b) context = 9 + 3 * endA + endB;
    else if (b !== NONE) [second, context] = [b, 18 + 3 * endA + endB];
    if (first !== NONE && coder.bit(context)) return first;
    if (second !== NONE && coder.bit(27 + endB)) return second;
    let tried = 0;
    for (let wedge = latest.of(corners[corner]); wedge !== NONE; wedge = latest.older(wedge)) {
        if (wedge === first || wedge === second) continue;
        if (coder.bit(30 + tried)) return wedge;
        if (++tried === OTHERS) break;
    }
    return NONE;
}

/**
 * Returns the wedge that the face across a side has at a corner, and the end of the side: 1 if both
 * faces have one wedge at the other vertex, 2 if two, 0 if that is not known.
 */
function across(
    otherEnd: number,
    twin: number,
    isFirst: boolean,
    ofCorner: Uint16Array,
): [number, number] {
    if (twin === NONE) return [NONE, 0];
    const here = ofCorner[isFirst ? next(twin) : twin];
    const there = ofCorner[isFirst ? twin : next(twin)];
    const mine = ofCorner[otherEnd];
    if (here === NONE || there === NONE || mine === NONE) return [here, 0];
    return [here, mine === there ? 1 : 2];
}

/** Distinct values of a layer, called entries, in the order in which they are decoded. */
export class LayerEntries {
    readonly ofWedge: Uint16Array;
    readonly ofCorner: Uint16Array;
    /** Number of entries. */
    readonly length: number;
    private readonly corners: Uint16Array;
    private readonly starts: Uint16Array;

    /** Decodes which wedges share their values. */
    constructor(wedges: BlockWedges, coder: LayerCoder, context: number) {
        const { vertex, ofCorner } = wedges;
        this.ofWedge = new Uint16Array(vertex.length);
        const latest = new Latest();
        let count = 0;
        for (let wedge = 0; wedge < vertex.length; wedge++) {
            let entry = latest.of(vertex[wedge]);
            let tried = 0;
            while (entry !== NONE && !coder.bit(context + tried)) {
                entry = ++tried < ENTRY_BITS ? latest.older(entry) : NONE;
            }
            if (entry === NONE) {
                entry = count++;
                latest.add(vertex[wedge]);
            }
            this.ofWedge[wedge] = entry;
        }
        this.length = count;
        this.ofCorner = ofCorner.map((wedge) => this.ofWedge[wedge]);
        this.starts = new Uint16Array(count + 1);
        for (const entry of this.ofCorner) this.starts[entry + 1]++;
        for (let entry = 0; entry < count; entry++) this.starts[entry + 1] += this.starts[entry];
        const ends = this.starts.slice();
        this.corners = new Uint16Array(ofCorner.length);
        this.ofCorner.forEach((entry, corner) => (this.corners[ends[entry]++] = corner));
    }

    /** Returns the corners of an entry. */
    around(entry: number): Uint16Array {
        return this.corners.subarray(this.starts[entry], this.starts[entry + 1]);
    }

    /** Returns the entry of a corner if it precedes another one, otherwise −1. */
    before(corner: number, entry: number): number {
        const other = this.ofCorner[corner];
        return other < entry ? other : -1;
    }
}
