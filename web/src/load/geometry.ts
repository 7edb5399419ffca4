/** Vertices and triangles of a cut as buffers for a renderer, changed where the cut has changed. */

import { NONE, grown } from "../model.ts";

/** What a cut shows: triangles by slot, with those that the last update wrote. */
export interface Slots {
    readonly nodes: Uint32Array;
    readonly wedges: Uint32Array | null;
    readonly slots: number;
    readonly touched: readonly number[];
}

/** How the vertices of a model are found. */
export interface Vertices {
    /** Number of numbers of a vertex: its position, and then its attributes. */
    readonly width: number;
    /** Writes the numbers of a vertex; `key` is its wedge, or its node if there are no wedges. */
    write(node: number, key: number, to: Float32Array, at: number): void;
    /** Returns the part that the triangles of a vertex are in, such as those of one material. */
    partOf(key: number): number;
}

/** A range of the index that belongs to one part. */
export interface PartRange {
    start: number;
    /** Number of triangles. */
    count: number;
}

/** Changes of the buffers; renderers apply one after the other. */
export interface GeometryPatch {
    /** True if all that was there is gone. */
    isNew: boolean;
    /** Number of vertices for which there must be room. */
    capacity: number;
    /** Vertices that are written, and their numbers. */
    vertices: Uint32Array;
    values: Float32Array;
    /** Number of triangles for which there must be room. */
    triangles: number;
    /** Places of triangles in the index that are written, and three vertices for each. */
    places: Uint32Array;
    index: Uint32Array;
    /** The range of each part. */
    parts: PartRange[];
}

const LEAST_CAPACITY = 64;

/** Triangles of one part, one right after the other. */
class Part {
    start = 0;
    capacity = 0;
    /** Slot of the cut of each triangle. */
    readonly slots: number[] = [];
}

/** Keeps buffers that show a cut. */
export class Geometry {
    /** Vertex of each wedge or node, and how many corners use each vertex. */
    protected vertexOf = new Uint32Array(0);
    private uses = new Uint32Array(0);
    protected keys = new Uint32Array(0);
    private readonly unused: number[] = [];
    private vertexCount = 0;
    /** Three vertices of each slot of the cut, its part and its place there. */
    private corners = new Uint32Array(0);
    private partOf = new Uint32Array(0);
    private placeIn = new Uint32Array(0);
    private readonly parts: Part[] = [];
    /** True until the first patch. */
    isNew = true;
    /** Vertices and slots that the next patch writes. */
    protected readonly newVertices: [number, number, number][] = [];
    private readonly changed = new Set<number>();

    constructor(protected readonly vertices: Vertices) {}

    /**
     * Takes in what the last update of a cut has written; returns the patch, or null if nothing
     * changed.
     */
    follow(cut: Slots): GeometryPatch | null {
        const old = this.take(cut);
        if (!old) return null;
        this.drop(old);
        return this.patch(cut.slots);
    }

    /**
     * Shows what has been written; returns the vertices that it took the place of, corner by corner,
     * or null if nothing changed.
     */
    protected take(cut: Slots): number[] | null {
        const touched = this.isNew
            ? Array.from({ length: cut.slots }, (_, slot) => slot)
            : cut.touched;
        if (touched.length === 0) return null;
        this.corners = grown(this.corners, 3 * cut.slots, NONE);
        this.partOf = grown(this.partOf, cut.slots, NONE);
        this.placeIn = grown(this.placeIn, cut.slots);
        // New ones first, so that vertices which go on are not written again.
        const old: number[] = [];
        for (const slot of touched) old.push(...this.corners.subarray(3 * slot, 3 * slot + 3));
        for (const slot of touched) this.show(slot, cut);
        return old;
    }

    /** Releases corners; returns the vertices that nothing uses any more. */
    protected drop(corners: readonly number[]): number[] {
        return corners.filter((vertex) => vertex !== NONE && this.release(vertex));
    }

    /** Shows what is in a slot of the cut now. */
    private show(slot: number, { nodes, wedges }: Slots): void {
        const at = 3 * slot;
        if (nodes[at] === NONE) {
            this.corners.fill(NONE, at, at + 3);
            return this.moveTo(slot, NONE);
        }
        const keys = wedges ?? nodes;
        for (let k = 0; k < 3; k++)
            this.corners[at + k] = this.acquire(nodes[at + k], keys[at + k]);
        this.moveTo(slot, this.vertices.partOf(keys[at]));
        this.changed.add(slot);
    }

    private acquire(node: number, key: number): number {
        this.vertexOf = grown(this.vertexOf, key + 1, NONE);
        let vertex = this.vertexOf[key];
        if (vertex === NONE) {
            vertex = this.unused.pop() ?? this.vertexCount++;
            this.uses = grown(this.uses, this.vertexCount);
            this.keys = grown(this.keys, this.vertexCount);
            this.vertexOf[key] = vertex;
            this.keys[vertex] = key;
            this.newVertices.push([vertex, node, key]);
        }
        this.uses[vertex]++;
        return vertex;
    }

    private release(vertex: number): boolean {
        if (--this.uses[vertex] > 0) return false;
        this.vertexOf[this.keys[vertex]] = NONE;
        this.unused.push(vertex);
        return true;
    }

    /** Moves a slot to a part, or out of all. */
    private moveTo(slot: number, to: number): void {
        const from = this.partOf[slot];
        if (from === to) return;
        if (from !== NONE) {
            const { slots } = this.parts[from];
            const last = slots.pop() as number;
            if (last !== slot) {
                slots[this.placeIn[slot]] = last;
                this.placeIn[last] = this.placeIn[slot];
                this.changed.add(last);
            }
        }
        this.partOf[slot] = to;
        if (to === NONE) return;
        while (this.parts.length <= to) this.parts.push(new Part());
        this.placeIn[slot] = this.parts[to].slots.push(slot) - 1;
    }

    protected patch(slots: number): GeometryPatch {
        const { newVertices, changed, parts } = this;
        if (parts.some((part) => part.slots.length > part.capacity)) {
            this.layOut();
            for (let slot = 0; slot < slots; slot++)
                if (this.partOf[slot] !== NONE) changed.add(slot);
        }
        const { width } = this.vertices;
        // Some may have gone again in the same update.
        const values = new Float32Array(newVertices.length * width);
        newVertices.forEach(([, node, key], i) =>
            this.vertices.write(node, key, values, i * width),
        );
        const written = [...changed].filter((slot) => this.partOf[slot] !== NONE);
        const index = new Uint32Array(3 * written.length);
        const places = Uint32Array.from(written, (slot, i) => {
            index.set(this.corners.subarray(3 * slot, 3 * slot + 3), 3 * i);
            return parts[this.partOf[slot]].start + this.placeIn[slot];
        });
        const patch: GeometryPatch = {
            isNew: this.isNew,
            capacity: this.vertexCount,
            vertices: Uint32Array.from(newVertices, ([vertex]) => vertex),
            values,
            triangles: parts.reduce((sum, part) => sum + part.capacity, 0),
            places,
            index,
            parts: parts.map((part) => ({ start: part.start, count: part.slots.length })),
        };
        this.isNew = false;
        newVertices.length = 0;
        changed.clear();
        return patch;
    }

    /** Gives each part room to grow. */
    private layOut(): void {
        let start = 0;
        for (const part of this.parts) {
            part.start = start;
            part.capacity = Math.max(
                part.capacity,
                LEAST_CAPACITY,
                Math.ceil(1.5 * part.slots.length),
            );
            start += part.capacity;
        }
    }
}
