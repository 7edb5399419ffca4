/** The triangles of a cut in slots, with a list of corners around each vertex. */

import { NONE, grown } from "../model.ts";

/** Longest search in a list of corners; only hubs have longer lists. */
export const MOST_SEARCHED = 128;

/** The faces around a vertex, each by its corner there and the next two nodes. */
export class Star {
    count = 0;
    corners = new Uint32Array(256);
    a = new Uint32Array(256);
    b = new Uint32Array(256);

    push(corner: number, a: number, b: number): void {
        const at = this.count++;
        if (at === this.corners.length) {
            this.corners = grown(this.corners, at + 1);
            this.a = grown(this.a, at + 1);
            this.b = grown(this.b, at + 1);
        }
        this.corners[at] = corner;
        this.a[at] = a;
        this.b[at] = b;
    }

    swap(i: number, j: number): void {
        swap(this.corners, i, j);
        swap(this.a, i, j);
        swap(this.b, i, j);
    }
}

function swap(list: Uint32Array, i: number, j: number): void {
    const own = list[i];
    list[i] = list[j];
    list[j] = own;
}

/** Triangles by slot; corner `3 t + k` is the `k`-th of triangle `t`. */
export class Triangles {
    /** Three nodes of each slot; `NONE` in empty ones. */
    nodes = new Uint32Array(0);
    /** Wedges at the corners, if the model has any. */
    wedges: Uint32Array | null;
    /** Number of slots, empty ones included. */
    slots = 0;
    /** Slots written since the mark. */
    readonly touched: number[] = [];
    /** The three nodes that each of these had at the mark. */
    readonly before: number[] = [];

    /** Next corner at the same vertex. */
    private next = new Uint32Array(0);
    private touchedAt = new Uint32Array(0);
    private readonly holes: number[] = [];
    private mark = 1;

    constructor(hasWedges: boolean) {
        this.wedges = hasWedges ? new Uint32Array(0) : null;
    }

    /** Number of triangles. */
    get count(): number {
        return this.slots - this.holes.length;
    }

    /** Starts a new record of changes. */
    begin(): void {
        this.mark++;
        this.touched.length = 0;
        this.before.length = 0;
    }

    /** Appends the faces around a vertex to a star, given the first corner of its list. */
    gather(first: number, star: Star): void {
        const { nodes, next } = this;
        for (let corner = first; corner !== NONE; corner = next[corner]) {
            star.push(corner, nodes[after(corner)], nodes[before(corner)]);
        }
    }

    /** Returns true if some neighbour of a vertex passes a test. */
    someAround(first: number, test: (node: number) => boolean): boolean {
        const { nodes, next } = this;
        for (let corner = first; corner !== NONE; corner = next[corner]) {
            if (test(nodes[after(corner)]) || test(nodes[before(corner)])) return true;
        }
        return false;
    }

    /** Puts a corner at the head of a vertex's list, in place of the one that was there. */
    attach(corner: number, node: number, head: Uint32Array): void {
        this.touch(slotOf(corner));
        this.nodes[corner] = node;
        this.next[corner] = head[node];
        head[node] = corner;
    }

    /** Returns a slot for a triangle whose corners are still to be attached. */
    add(): number {
        const hole = this.holes.pop();
        if (hole !== undefined) return hole;
        const slot = this.slots++;
        this.nodes = grown(this.nodes, 3 * this.slots, NONE);
        this.next = grown(this.next, 3 * this.slots, NONE);
        this.touchedAt = grown(this.touchedAt, this.slots);
        if (this.wedges) this.wedges = grown(this.wedges, 3 * this.slots, NONE);
        return slot;
    }

    /** Frees the slot of a triangle that is in no list any more. */
    remove(slot: number): void {
        this.touch(slot);
        this.nodes.fill(NONE, 3 * slot, 3 * slot + 3);
        this.holes.push(slot);
    }

    /** Takes a triangle out of a vertex's list, unless it is not among its first corners. */
    unlink(slot: number, node: number, head: Uint32Array, among: number): boolean {
        const { next } = this;
        if (slotOf(head[node]) === slot) {
            head[node] = next[head[node]];
            return true;
        }
        let at = head[node];
        for (let i = 0; i < among && at !== NONE; i++) {
            const following = next[at];
            if (slotOf(following) === slot) {
                next[at] = next[following];
                return true;
            }
            at = following;
        }
        return false;
    }

    /**
     * Takes out a corner near the start of a list whose triangle has none of some nodes; `NONE` if
     * there is none.
     */
    unlinkWithout(node: number, head: Uint32Array, without: readonly number[]): number {
        const { nodes, next } = this;
        let last = NONE;
        let at = head[node];
        for (let i = 0; i < MOST_SEARCHED && at !== NONE; i++) {
            const t = 3 * slotOf(at);
            if (
                !without.includes(nodes[t]) &&
                !without.includes(nodes[t + 1]) &&
                !without.includes(nodes[t + 2])
            ) {
                if (last === NONE) head[node] = next[at];
                else next[last] = next[at];
                return at;
            }
            last = at;
            at = next[at];
        }
        return NONE;
    }

    /** Puts corner `by` in the place of another in the list of its vertex. */
    replace(corner: number, by: number, node: number, head: Uint32Array): void {
        const { next } = this;
        const following = next[corner];
        if (head[node] === corner) {
            head[node] = by;
        } else {
            let at = head[node];
            while (next[at] !== corner) at = next[at];
            next[at] = by;
        }
        this.touch(slotOf(by));
        this.nodes[by] = node;
        next[by] = following;
        if (this.wedges) this.wedges[by] = this.wedges[corner];
    }

    private touch(slot: number): void {
        if (this.touchedAt[slot] === this.mark) return;
        this.touchedAt[slot] = this.mark;
        const { nodes } = this;
        this.touched.push(slot);
        this.before.push(nodes[3 * slot], nodes[3 * slot + 1], nodes[3 * slot + 2]);
    }
}

/** Returns the slot of a corner. */
export function slotOf(corner: number): number {
    return Math.floor(corner / 3);
}

/** Returns the corner of the same face after one. */
export function after(corner: number): number {
    return corner % 3 === 2 ? corner - 2 : corner + 1;
}

/** Returns the corner of the same face before one. */
export function before(corner: number): number {
    return corner % 3 === 0 ? corner + 2 : corner - 1;
}
