/**
 * All levels of a height field: of each vertex its error, and the balls by which queries judge it.
 */

import { lengthCode, lengthOf } from "../file/lengths.ts";
import { toUnits } from "../frame.ts";
import type { Frame } from "../frame.ts";
import { Extent } from "./grid.ts";
import type { Grid, GridPoint, RightTriangle } from "./grid.ts";
import { pointAt } from "./height_field.ts";
import type { HeightField, Placement } from "./height_field.ts";

/** Part by which balls are enlarged, so that rounding makes none miss what one inside it meets. */
const SLACK = 1 + 1e-6;
const MOST_EXPONENT = 1000;
const FORCED = 0xffff;

/** Levels of right triangles, with lengths as codes of 16 bits. */
export class FieldModel {
    readonly frame: Frame;
    readonly grid: Grid;
    readonly looksDown: boolean;
    /** Three coordinates of each vertex, in units. */
    readonly positions: Float32Array;
    private readonly placement: Placement;
    private readonly errors: Uint16Array;
    /**
     * Radii of the balls around what an insertion removes, and of those that hold all dependents'.
     */
    private readonly own: Uint16Array;
    private readonly nested: Uint16Array;

    /** Measures every triangle of every level against all vertices under it. */
    constructor(field: HeightField) {
        const { grid, placement, heights } = field;
        this.grid = grid;
        this.looksDown = placement.looksDown;
        this.frame = frameOf(field);
        this.placement = inUnits(placement, this.frame);
        this.positions = new Float32Array(3 * grid.count);
        this.errors = new Uint16Array(grid.count);
        this.own = new Uint16Array(grid.count);
        this.nested = new Uint16Array(grid.count);
        const { up } = placement;
        for (let i = 0; i < grid.count; i++) {
            const { origin, unit } = this.frame;
            const height = Math.fround((heights[i] - origin[up]) * (1 / unit));
            this.positions.set(pointAt(this.placement, grid.place(i), height), 3 * i);
        }
        // The corners of the square are never inserted.
        for (const { apex, ends } of grid.roots()) {
            for (const corner of [apex, ...ends])
                if (grid.holds(corner)) this.errors[grid.index(corner)] = FORCED;
        }
        for (let depth = grid.depth - 1; depth >= 0; depth--)
            grid.insertedAt(depth, (place) => this.finish(place));
    }

    /** Number of vertices of all levels. */
    get nodes(): number {
        return this.grid.count;
    }

    /** Returns true if a vertex is in every level. */
    isForced(index: number): boolean {
        return this.errors[index] === FORCED;
    }

    /** Returns the error of a vertex, and the radii of its two balls, in units. */
    error(index: number): number {
        return lengthOf(this.errors[index]);
    }

    ownRadius(index: number): number {
        return lengthOf(this.own[index]);
    }

    nestedRadius(index: number): number {
        return lengthOf(this.nested[index]);
    }

    /** Returns the centre of the balls of a vertex. */
    center(place: GridPoint): readonly [number, number, number] {
        return pointAt(this.placement, place, this.height(this.grid.index(place)));
    }

    private height(index: number): number {
        return this.positions[3 * index + this.placement.up];
    }

    /** Writes the position of a vertex in the model. */
    position(index: number, to: { [at: number]: number }, at = 0): void {
        const { origin, unit } = this.frame;
        for (let k = 0; k < 3; k++) to[at + k] = this.positions[3 * index + k] * unit + origin[k];
    }

    /** Completes a vertex once all that depend on it are done, and passes on what it asks. */
    private finish(place: GridPoint): void {
        const { grid, errors, own, nested } = this;
        const index = grid.index(place);
        errors[index] = Math.max(errors[index], this.measure(place));
        own[index] = this.measureRadius(place);
        nested[index] = Math.max(nested[index], own[index]);
        const [x, y, z] = this.center(place);
        for (const parent of grid.parents(place)) {
            const [px, py, pz] = this.center(parent);
            const around =
                (Math.sqrt(square(px - x, py - y, pz - z)) + this.nestedRadius(index)) * SLACK;
            const above = grid.index(parent);
            errors[above] = Math.max(errors[above], errors[index]);
            nested[above] = Math.max(nested[above], lengthCode(around));
        }
    }

    private measureRadius(place: GridPoint): number {
        const [x, y, z] = this.center(place);
        let most = 0;
        for (const corner of this.grid.corners(place)) {
            if (!this.grid.holds(corner)) continue;
            const [cx, cy, cz] = this.center(corner);
            most = Math.max(most, square(x - cx, y - cy, z - cz));
        }
        return lengthCode(Math.sqrt(most) * SLACK);
    }

    /** Returns the error of the triangles that a vertex bisects; infinite across the border. */
    private measure(place: GridPoint): number {
        let most = 0;
        for (const triangle of this.grid.coarse(place)) {
            const extent = this.grid.extent(triangle);
            if (extent === Extent.Across) return FORCED;
            if (extent === Extent.Inside) most = Math.max(most, this.deviation(triangle));
        }
        return lengthCode(most);
    }

    /** Returns the greatest vertical distance between a triangle and the vertices under it. */
    private deviation({ apex, ends: [a, b] }: RightTriangle): number {
        const { grid } = this;
        const base = this.height(grid.index(apex));
        const [ax, ay, az] = [
            a.column - apex.column,
            a.row - apex.row,
            this.height(grid.index(a)) - base,
        ];
        const [bx, by, bz] = [
            b.column - apex.column,
            b.row - apex.row,
            this.height(grid.index(b)) - base,
        ];
        const area = ax * by - ay * bx;
        const across = (az * by - bz * ay) / area;
        const along = (bz * ax - az * bx) / area;
        const low = Math.min(apex.row, a.row, b.row);
        const high = Math.max(apex.row, a.row, b.row);
        let most = 0;
        for (let row = low; row <= high; row++) {
            const [first, last] = columnsAt(row, [apex, a, b]);
            let expected = base + (first - apex.column) * across + (row - apex.row) * along;
            const start = grid.index({ column: first, row });
            for (let index = start; index <= start + last - first; index++) {
                most = Math.max(most, Math.abs(this.height(index) - expected));
                expected += across;
            }
        }
        return most;
    }
}

/**
 * Returns the first and last columns of a triangle in a row; sides are along rows, columns or
 * diagonals.
 */
function columnsAt(row: number, corners: GridPoint[]): [number, number] {
    let [first, last] = [Infinity, 0];
    corners.forEach((from, k) => {
        const to = corners[(k + 1) % 3];
        const [low, high] = from.row <= to.row ? [from, to] : [to, from];
        if (row < low.row || row > high.row) return;
        if (low.row === high.row) last = Math.max(last, high.column);
        if (low.row === high.row) first = Math.min(first, high.column);
        const way = low.row === high.row ? 0 : Math.sign(high.column - low.column);
        const at = low.column + way * (row - low.row);
        first = Math.min(first, at);
        last = Math.max(last, at);
    });
    return [first, last];
}

function square(x: number, y: number, z: number): number {
    return x * x + y * y + z * z;
}

/** Returns the frame about the middle of a field whose unit is not below its diagonal. */
function frameOf({ grid, placement, heights }: HeightField): Frame {
    let [low, high] = [Infinity, -Infinity];
    for (const height of heights) {
        low = Math.min(low, height);
        high = Math.max(high, height);
    }
    const a = pointAt(placement, { column: 0, row: 0 }, low);
    const b = pointAt(placement, { column: grid.columns - 1, row: grid.rows - 1 }, high);
    const half = [0, 1, 2].map((k) => Math.max(a[k], b[k]) * 0.5 - Math.min(a[k], b[k]) * 0.5);
    const longest = Math.max(...half);
    const [x, y, z] = half.map((side) => side / longest);
    const diagonal = longest > 0 ? 2 * longest * Math.sqrt(square(x, y, z)) : 0;
    const exponent = diagonal > 0 ? Math.ceil(Math.log2(diagonal)) : 0;
    const origin = [0, 1, 2].map((k) => Math.min(a[k], b[k]) * 0.5 + Math.max(a[k], b[k]) * 0.5);
    const unit = 2 ** Math.min(Math.max(exponent, -MOST_EXPONENT), MOST_EXPONENT);
    return { origin: origin as [number, number, number], unit };
}

function inUnits(placement: Placement, frame: Frame): Placement {
    const first = toUnits(frame, pointAt(placement, { column: 0, row: 0 }, 0));
    const { up, step } = placement;
    const scale = 1 / frame.unit;
    return {
        ...placement,
        origin: [first[(up + 1) % 3], first[(up + 2) % 3]],
        step: [step[0] * scale, step[1] * scale],
    };
}
