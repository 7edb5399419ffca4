/** The border of the part of a block that is known, to which faces are added one by one. */

/** Greatest number of faces of a block, and room for its nodes and vertices. */
export const MAX_FACES = 1024;
export const NODES = 4 * MAX_FACES;
const MASK = NODES - 1;

const OPEN = 0;
const CLOSED = 1;
const REMOVED = 2;

/** Loops of nodes, each with a vertex and the edge to that of the next node. */
export class Border {
    readonly vertex = new Uint16Array(NODES);
    readonly next = new Uint16Array(NODES);
    readonly previous = new Uint16Array(NODES);
    /** Third vertex of the face behind the edge, and the one before it in the fan. */
    readonly apex = new Uint16Array(NODES);
    readonly previousApex = new Uint16Array(NODES);
    /** Number of faces at each vertex so far, at most 255. */
    readonly faces = new Uint8ClampedArray(NODES);
    private readonly state = new Uint8Array(NODES);
    private readonly queue = new Uint16Array(2 * NODES);
    private length = 0;
    private queued = 0;
    private taken = 0;

    clear(): void {
        this.length = 0;
        this.queued = 0;
        this.taken = 0;
    }

    /** Returns the first node in the queue whose edge is open, or −1. */
    pivot(): number {
        for (; this.taken < this.queued; this.taken++) {
            const at = this.queue[this.taken];
            if (this.state[at] === OPEN) return at;
        }
        return -1;
    }

    isClosed(at: number): boolean {
        return this.state[at] === CLOSED;
    }

    /** Marks an edge as one without a face. */
    close(at: number): void {
        this.state[at] = CLOSED;
    }

    /** Adds a face of three new vertices. */
    start(first: number): void {
        const at = this.length;
        for (let k = 0; k < 3; k++) {
            const apex = first + ((k + 2) % 3);
            const node = this.push(first + k, at + ((k + 1) % 3), at + ((k + 2) % 3), apex, apex);
            this.faces[this.vertex[node]] = 0;
        }
        this.count(first, first + 1, first + 2);
    }

    private push(
        vertex: number,
        next: number,
        previous: number,
        apex: number,
        older: number,
        state = OPEN,
    ): number {
        const at = this.length++ & MASK;
        this.vertex[at] = vertex & MASK;
        this.next[at] = next & MASK;
        this.previous[at] = previous & MASK;
        this.apex[at] = apex & MASK;
        this.previousApex[at] = older & MASK;
        this.state[at] = state;
        this.queue[this.queued++] = at;
        return at;
    }

    private count(a: number, b: number, c: number): void {
        this.faces[a]++;
        this.faces[b]++;
        this.faces[c]++;
    }

    /** Links two nodes, and gives the first one's edge a new face behind it. */
    private link(at: number, next: number, apex: number): void {
        this.next[at] = next;
        this.previous[next] = at;
        this.previousApex[at] = this.apex[at];
        this.apex[at] = apex;
    }

    /** Adds a face to a new vertex; returns its third corner, as the others do. */
    addNew(at: number, vertex: number): number {
        const a = this.vertex[at];
        const second = this.next[at];
        const b = this.vertex[second];
        this.faces[vertex & MASK] = 0;
        const added = this.push(vertex, second, at, a, a);
        this.link(at, added, b);
        this.previous[second] = added;
        this.count(b, a, vertex);
        return vertex;
    }

    /** Adds a face to the vertex before the edge. */
    addPrevious(at: number): number {
        const a = this.vertex[at];
        const second = this.next[at];
        const previous = this.previous[at];
        this.state[at] = REMOVED;
        const c = this.vertex[previous];
        const b = this.vertex[second];
        this.link(previous, second, a);
        this.count(b, a, c);
        this.zip(previous);
        return c;
    }

    /** Adds a face to the vertex behind the edge. */
    addNext(at: number): number {
        const a = this.vertex[at];
        const second = this.next[at];
        const b = this.vertex[second];
        const third = this.next[second];
        this.state[second] = REMOVED;
        this.link(at, third, b);
        const c = this.vertex[third];
        this.count(b, a, c);
        this.zip(at);
        return c;
    }

    /** Removes two edges that run back and forth between two nodes: they are one inner edge. */
    private zip(at: number): void {
        const next = this.next[at];
        const { state } = this;
        if (next !== this.previous[at] || state[at] !== OPEN || state[next] !== OPEN) return;
        state[at] = REMOVED;
        state[next] = REMOVED;
    }

    /** Adds a face to the vertex of any other node, which splits a loop or joins two. */
    addOther(at: number, other: number): number {
        const a = this.vertex[at];
        const second = this.next[at];
        const b = this.vertex[second];
        const c = this.vertex[other];
        const after = this.next[other];
        const { apex, previousApex, state } = this;
        const twin = this.push(c, after, at, apex[other], previousApex[other], state[other]);
        this.previous[after] = twin;
        this.next[at] = twin;
        previousApex[at] = apex[at];
        apex[at] = b;
        this.next[other] = second;
        apex[other] = a;
        previousApex[other] = a;
        state[other] = OPEN;
        this.previous[second] = other;
        this.queue[this.queued++] = other;
        this.count(b, a, c);
        return c;
    }

    /** Returns the node at an offset along the loop. */
    along(at: number, by: number): number {
        for (; by < 0; by++) at = this.previous[at];
        for (; by > 0; by--) at = this.next[at];
        return at;
    }

    /** Returns a node if there is one of that number, otherwise the first one. */
    known(at: number): number {
        return at < this.length ? at : 0;
    }

    /** Calls back with each vertex on the border, some more than once. */
    forEachVertex(visit: (vertex: number) => void): void {
        for (let at = 0; at < this.length; at++) {
            if (this.state[at] !== REMOVED) visit(this.vertex[at]);
        }
    }
}
