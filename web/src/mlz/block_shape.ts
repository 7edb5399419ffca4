/** Faces of a block with what lies across their sides, and the positions of their corners. */

/** No side, wedge or entry. */
export const NONE = 0xffff;

/** Returns the next corner of the same face. */
export function next(corner: number): number {
    return corner % 3 === 2 ? corner - 2 : corner + 1;
}

/** Returns the previous corner of the same face. */
export function previous(corner: number): number {
    return corner % 3 === 0 ? corner + 2 : corner - 1;
}

/** Faces, and for each side, which has the number of its first corner, the opposite one. */
export class BlockFaces {
    /** Opposite side of each side, or `NONE`. */
    readonly twins: Uint16Array;

    /** Pairs sides between the same vertices that run in opposite directions, in order. */
    constructor(readonly corners: Uint16Array) {
        const twins = new Uint16Array(corners.length).fill(NONE);
        const waiting = new Map<number, number[]>();
        const edge = (from: number, to: number) => from * 0x10000 + to;
        corners.forEach((from, side) => {
            const to = corners[next(side)];
            // A side from a vertex to itself has no opposite.
            if (from === to) return;
            const other = waiting.get(edge(to, from))?.shift();
            if (other === undefined) {
                const same = waiting.get(edge(from, to));
                if (same) same.push(side);
                else waiting.set(edge(from, to), [side]);
                return;
            }
            twins[side] = other;
            twins[other] = side;
        });
        this.twins = twins;
    }
}

/** Faces with the positions of their corners, in cells. */
export class BlockShape {
    constructor(
        readonly faces: BlockFaces,
        private readonly cells: Float32Array,
    ) {}

    /** Writes the edge from one corner to another. */
    way(from: number, to: number, out: number[]): void {
        const { corners } = this.faces;
        const [a, b] = [3 * corners[from], 3 * corners[to]];
        for (let k = 0; k < 3; k++) out[k] = this.cells[b + k] - this.cells[a + k];
    }

    /** Returns true if a side at a corner has no opposite. */
    isOpen(corner: number): boolean {
        const { twins } = this.faces;
        return twins[corner] === NONE || twins[previous(corner)] === NONE;
    }

    /**
     * Writes where a corner is along an edge and beside it, in lengths of the edge; false if the
     * edge has no length, or the corner is on it.
     */
    frame(a: number, b: number, corner: number, out: number[]): boolean {
        const edge = [0, 0, 0];
        const way = [0, 0, 0];
        this.way(a, b, edge);
        this.way(a, corner, way);
        const squared = dot(edge, edge);
        const normal = cross(edge, way);
        out[0] = dot(way, edge) / squared;
        out[1] = Math.sqrt(dot(normal, normal)) / squared;
        return squared > 0 && out[1] > 0;
    }
}

/** Three numbers. */
export type Triple = readonly number[];

export function dot(a: Triple, b: Triple): number {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a: Triple, b: Triple): number[] {
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
