/** Vertices that move from one level to the next, where a change would show at once. */

import { parentOf } from "../cut/split_wedges.ts";
import { NONE } from "../model.ts";
import type { Model } from "../model.ts";
import { Geometry } from "./geometry.ts";
import type { GeometryPatch, Slots } from "./geometry.ts";
import { verticesOf } from "./vertices.ts";

/** Milliseconds between two pictures of what moves. */
export const FRAME = 16;
/** Changes of more vertices are shown at once: each picture sends all that move. */
const MOST_MOVING = 20_000;
/** Layers whose values may be between those of two wedges. */
const BLENDED = ["uv", "normal", "tangent", "color"];

/** A vertex under way: its values at both ends, and when it left. */
interface Move {
    from: Float32Array;
    to: Float32Array;
    start: number;
}

/**
 * Buffers that follow a cut in two steps. What refines it is shown at once, with new vertices where
 * the nearest vertex above them was; then they move. What coarsens it is held back until vertices
 * that will go have moved to those that replace them.
 *
 * All vertices of a node are at one place at any time, so that there is no crack.
 */
export class MovingGeometry extends Geometry {
    private readonly moves = new Map<number, Move>();
    /** What is shown is as of this time. */
    private clock = 0;
    /** What coarsens the cut once all has moved. */
    private held: GeometryPatch | null = null;
    private last: GeometryPatch | null = null;
    private readonly isBlended: boolean[];

    /** @param time milliseconds that a vertex is under way */
    constructor(
        private readonly model: Model,
        private readonly time: number,
        parts?: readonly number[],
    ) {
        super(verticesOf(model, parts));
        this.isBlended = [true, true, true];
        for (const { kind, width } of model.wedges?.layers ?? [])
            for (let k = 0; k < width; k++)
                this.isBlended.push(BLENDED.includes(kind) && (kind !== "tangent" || k < 3));
    }

    /** True while vertices move. */
    get isMoving(): boolean {
        return this.moves.size > 0;
    }

    /** True while the buffers lag behind the cut. */
    get isHeld(): boolean {
        return this.held !== null;
    }

    /** Moves what is under way to where it is at a time. */
    tick(now: number): GeometryPatch[] {
        const { moves, last } = this;
        if (last && moves.size > 0 && now < this.clock + FRAME) return [];
        this.clock = now;
        if (!last || moves.size === 0) return [];
        const vertices = Uint32Array.from(moves.keys());
        const values = this.valuesOf(vertices);
        for (const [vertex, { start }] of moves) if (now >= start + this.time) moves.delete(vertex);
        const patches: GeometryPatch[] = [
            {
                ...last,
                isNew: false,
                vertices,
                values,
                places: new Uint32Array(0),
                index: new Uint32Array(0),
            },
        ];
        if (this.held && moves.size === 0) {
            patches.push(this.held);
            this.last = this.held;
            this.held = null;
        }
        return patches;
    }

    /** Takes in what has refined the cut, or, of what is shown otherwise, the whole. */
    refine(cut: Slots, shown: MovingGeometry | null = this): GeometryPatch | null {
        const old = this.take(cut);
        if (!old) return null;
        const count = this.newVertices.length + this.moves.size;
        if (shown) {
            this.clock = shown.clock;
            this.leave(shown, count <= MOST_MOVING);
        }
        for (const vertex of this.drop(old)) this.moves.delete(vertex);
        return this.patchNow(cut);
    }

    /** Takes in what has coarsened the cut; it may be held back. */
    coarsen(cut: Slots): GeometryPatch | null {
        const old = this.take(cut);
        if (!old) return null;
        const isNew = new Set(this.newVertices.map(([vertex]) => vertex));
        const gone = this.drop(old).filter((vertex) => !isNew.has(vertex));
        const ends = gone.length + this.moves.size > MOST_MOVING ? [] : this.endsOf(gone);
        if (ends.length === 0) {
            for (const vertex of gone) this.moves.delete(vertex);
            this.leave(this, false);
            return this.patchNow(cut);
        }
        for (const [vertex, to] of ends)
            this.moves.set(vertex, { from: this.currentOf(vertex), to, start: this.clock });
        this.held = this.patch(cut.slots);
        return null;
    }

    /** Returns the patch of what was taken in, with new vertices where they are now. */
    private patchNow(cut: Slots): GeometryPatch {
        this.last = this.patch(cut.slots);
        this.last.values = this.valuesOf(this.last.vertices);
        return this.last;
    }

    private valuesOf(vertices: Uint32Array): Float32Array {
        const { width } = this.vertices;
        const values = new Float32Array(width * vertices.length);
        vertices.forEach((vertex, i) => values.set(this.currentOf(vertex), width * i));
        return values;
    }

    /** Returns the values with which a vertex is shown. */
    private currentOf(vertex: number): Float32Array {
        const move = this.moves.get(vertex);
        if (!move) return this.finalOf(vertex);
        const part = Math.min(1, (this.clock - move.start) / this.time);
        return move.to.map((to, k) => (part < 1 ? move.from[k] + part * (to - move.from[k]) : to));
    }

    private finalOf(vertex: number): Float32Array {
        const values = new Float32Array(this.vertices.width);
        const key = this.keys[vertex];
        this.vertices.write(this.nodeOf(key), key, values, 0);
        return values;
    }

    private nodeOf(key: number): number {
        const { wedges, nodes } = this.model;
        if (!wedges) return key;
        let [low, high] = [0, nodes];
        while (high - low > 1) {
            const middle = (low + high) >>> 1;
            if (wedges.first[middle] <= key) low = middle;
            else high = middle;
        }
        return low;
    }

    /** Lets new vertices leave from what is shown; of nodes that are shown they go with those. */
    private leave(shown: MovingGeometry, mayMove: boolean): void {
        const isNew = new Set(shown === this ? this.newVertices.map(([vertex]) => vertex) : []);
        const isThere = (vertex: number) => !isNew.has(vertex);
        for (const [vertex, node, key] of this.newVertices) {
            const above = this.above(node, key, shown, isThere);
            if (!above) continue;
            const move = shown.moves.get(above.vertex);
            const isOwn = above.node === node;
            if (isOwn ? !move : !mayMove) continue;
            const to = this.finalOf(vertex);
            const start = isOwn && move ? move.start : this.clock;
            const source = isOwn && move ? move.from : shown.currentOf(above.vertex);
            this.moves.set(vertex, { from: this.blend(to, source, above.isSame), to, start });
        }
    }

    /** Returns where vertices end that are not in the cut any more, unless their nodes are. */
    private endsOf(gone: readonly number[]): [number, Float32Array][] {
        const ends: [number, Float32Array][] = [];
        for (const vertex of gone) {
            const key = this.keys[vertex];
            const node = this.nodeOf(key);
            const above = this.above(node, key, this, () => true);
            if (!above || above.node === node) continue;
            const end = this.finalOf(above.vertex);
            ends.push([vertex, this.blend(this.finalOf(vertex), end, above.isSame)]);
        }
        return ends;
    }

    /** Returns values at the place of others, with as much of the others as can be between. */
    private blend(own: Float32Array, other: Float32Array, isSame: boolean): Float32Array {
        return own.map((x, k) => (k < 3 || (isSame && this.isBlended[k]) ? other[k] : x));
    }

    /**
     * Returns the vertex of a node, or else of the nearest one above that is shown; `isSame` is
     * true if its wedge is the one that continues as `key`.
     */
    private above(
        node: number,
        key: number,
        shown: MovingGeometry,
        isThere: (vertex: number) => boolean,
    ): { node: number; vertex: number; isSame: boolean } | null {
        const { model } = this;
        const { wedges } = model;
        for (;;) {
            const vertex = shown.vertexAt(this, node, key, isThere);
            if (vertex !== NONE) {
                const isSame = key !== NONE && shown.keys[vertex] === shown.keyOf(this, node, key);
                return { node, vertex, isSame };
            }
            if (node < model.roots) return null;
            const parent = model.parents[model.creator(node)];
            if (parent === NONE) return null;
            if (!wedges) key = parent;
            else if (key !== NONE) key = parentOf(model, wedges, node, key);
            node = parent;
        }
    }

    /** Returns the key here of one of another decoding of the file. */
    private keyOf({ model }: MovingGeometry, node: number, key: number): number {
        if (model === this.model) return key;
        const here = this.model.nodeHere(model.nodeInFile(node));
        if (here === NONE || !model.wedges || !this.model.wedges) return here;
        return this.model.wedges.first[here] + key - model.wedges.first[node];
    }

    /** Returns a vertex of a node, that of a wedge if there is one; `NONE` if it is not shown. */
    private vertexAt(
        from: MovingGeometry,
        node: number,
        key: number,
        isThere: (vertex: number) => boolean,
    ): number {
        const { wedges } = from.model;
        const first = wedges ? wedges.first[node] : node;
        const count = wedges ? wedges.countOf(node) : 1;
        let found = NONE;
        for (let at = first; at < first + count; at++) {
            const vertex = this.vertexOf[this.keyOf(from, node, at)] ?? NONE;
            if (vertex === NONE || !isThere(vertex)) continue;
            if (at === key) return vertex;
            if (found === NONE) found = vertex;
        }
        return found;
    }
}
