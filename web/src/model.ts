/** All levels of a mesh as far as they have been read: nodes, and the updates that split them. */

import type { Header } from "./file/header.ts";
import type { ChunkEntry } from "./file/header.ts";
import type { Frame } from "./frame.ts";
import { Wedges } from "./wedges/wedges.ts";

/** Marks a missing node, update or wedge. */
export const NONE = 0xffffffff;

/** Flags of an update, as a chunk has them. */
export const OPEN = 1;
export const FUSED = 2;
export const NON_FAN = 4;
export const EXACT = [8, 16] as const;
export const RECORDED = 32;

/** A wing that is none, and one that is the node that no face follows. */
export const NO_WING = 255;
export const LAST_WING = 254;

/** Faces of an update that wings cannot describe, by nodes. */
export interface NonFan {
    /** The other two nodes of each face that the second child takes. */
    second: Uint32Array;
    /** The three nodes of each face that is created. */
    created: Uint32Array;
}

/** A run of updates, which are consecutive in the file, too. */
interface Run {
    inFile: number;
    here: number;
    count: number;
}

/**
 * Nodes and updates of the chunks that have been read.
 *
 * Nodes are numbered roots first, then the children of each update. Updates are numbered as they
 * are
 * read; `rank` has the numbers that nodes have by their place in the forest, which do not depend on
 * what else has been read. Arrays may be longer than they need to be.
 */
export class Model {
    readonly frame: Frame;
    readonly roots: number;
    updates = 0;

    /** Three coordinates of each node, in units. */
    positions = new Float32Array(0);
    /** Exact coordinates of each node in a lossless file, NaN where there are none. */
    exact: Float64Array | null = null;
    /** Update that splits each node, or `NONE`. */
    updateOf = new Uint32Array(0);
    /** Place of each node in the forest, or `NONE` below a chunk that is missing. */
    rank = new Uint32Array(0);

    /** Node that each update splits, or `NONE` in a chunk that is missing. */
    parents = new Uint32Array(0);
    levels = new Uint16Array(0);
    flags = new Uint8Array(0);
    /** Two of each update. */
    wings = new Uint8Array(0);
    /** Codes of 8 and of 9 bits. */
    radii = new Uint8Array(0);
    errors = new Uint16Array(0);
    stages = new Uint8Array(0);
    readonly nonFans = new Map<number, NonFan>();

    /** Three nodes of each face of the base mesh. */
    base = new Uint32Array(0);
    wedges: Wedges | null = null;

    private readonly runs: Run[] = [];

    constructor(readonly header: Header) {
        this.frame = header.frame;
        this.roots = header.roots;
    }

    /** Number of nodes so far. */
    get nodes(): number {
        return this.roots + 2 * this.updates;
    }

    /** Makes room for a number of updates. */
    reserve(updates: number): void {
        const nodes = this.roots + 2 * updates;
        this.positions = grown(this.positions, 3 * nodes);
        this.updateOf = grown(this.updateOf, nodes, NONE);
        this.rank = grown(this.rank, nodes, NONE);
        if (this.header.isLossless)
            this.exact = grown(this.exact ?? new Float64Array(0), 3 * nodes, NaN);
        this.parents = grown(this.parents, updates, NONE);
        this.levels = grown(this.levels, updates);
        this.flags = grown(this.flags, updates);
        this.wings = grown(this.wings, 2 * updates);
        this.radii = grown(this.radii, updates);
        this.errors = grown(this.errors, updates);
        if (this.header.hasStages) this.stages = grown(this.stages, updates);
    }

    /** Notes that the updates of a chunk come next. */
    begin(chunk: ChunkEntry): void {
        this.runs.push({ inFile: chunk.first, here: this.updates, count: chunk.updates });
    }

    /** Returns the number here of a node of the file, or `NONE` if its chunk is missing. */
    nodeHere(inFile: number): number {
        if (inFile < this.roots) return inFile;
        const child = inFile - this.roots;
        const update = child >>> 1;
        for (let i = this.runs.length - 1; i >= 0; i--) {
            const { inFile: first, here, count } = this.runs[i];
            if (update < first) continue;
            const isThere = update < first + count;
            return isThere ? this.roots + 2 * (here + update - first) + (child & 1) : NONE;
        }
        return NONE;
    }

    /** Returns the number in the file of a node here. */
    nodeInFile(here: number): number {
        if (here < this.roots) return here;
        const update = this.creator(here);
        const run = this.runs.find((run) => update < run.here + run.count);
        return run ? here + 2 * (run.inFile - run.here) : NONE;
    }

    /** Returns the update that created a node that is no root. */
    creator(node: number): number {
        return (node - this.roots) >>> 1;
    }

    /** Returns the first of the two children of an update; the other is the next. */
    firstChild(update: number): number {
        return this.roots + 2 * update;
    }

    /** Returns true if an update and the one of its first child are one step. */
    isFused(update: number): boolean {
        return (
            (this.flags[update] & FUSED) !== 0 && this.updateOf[this.firstChild(update)] !== NONE
        );
    }

    /** Returns true if an update is the second part of one step. */
    isFusedWithParent(update: number): boolean {
        const node = this.parents[update];
        const isFirst = node >= this.roots && ((node - this.roots) & 1) === 0;
        return isFirst && (this.flags[this.creator(node)] & FUSED) !== 0;
    }

    /** Returns the number of faces that an update creates. */
    createdCount(update: number): number {
        const nonFan = this.nonFans.get(update);
        if (nonFan) return nonFan.created.length / 3;
        const { wings } = this;
        return Number(wings[2 * update] !== NO_WING) + Number(wings[2 * update + 1] !== NO_WING);
    }

    /** Writes the position of a node in the model. */
    position(node: number, to: { [at: number]: number }, at = 0): void {
        const { origin, unit } = this.frame;
        for (let k = 0; k < 3; k++) {
            const exact = this.exact ? this.exact[3 * node + k] : NaN;
            const x = this.positions[3 * node + k] * unit + origin[k];
            to[at + k] = Number.isNaN(exact) ? x : exact;
        }
    }

    /** Numbers the nodes by their places in the forest; returns how many are in it. */
    rankNodes(): number {
        const { rank, roots, updateOf } = this;
        const stack: number[] = [];
        for (let root = 0; root < roots; root++) rank[root] = root;
        let next = roots;
        for (let root = 0; root < roots; root++) {
            stack.push(root);
            while (stack.length > 0) {
                const update = updateOf[stack.pop() as number];
                if (update === NONE) continue;
                const first = this.firstChild(update);
                rank[first] = next++;
                rank[first + 1] = next++;
                stack.push(first + 1, first);
            }
        }
        return next;
    }
}

type Numbers = Float32Array | Float64Array | Uint32Array | Int32Array | Uint16Array | Uint8Array;

/** Returns an array of at least a length, with what is there and a value for the rest. */
export function grown<T extends Numbers>(array: T, length: number, value = 0): T {
    if (length <= array.length) return array;
    const capacity = Math.max(length, Math.ceil(1.5 * array.length));
    const larger = new (array.constructor as new (length: number) => T)(capacity);
    larger.set(array);
    if (value !== 0) larger.fill(value, array.length);
    return larger;
}
