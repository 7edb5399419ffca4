/** Arithmetic of right triangles over a grid: which there are, and what depends on what. */

/** A vertex of the grid. */
export interface GridPoint {
    column: number;
    row: number;
}

/** A right triangle: its right angle, and the ends of its hypotenuse, counter-clockwise. */
export interface RightTriangle {
    apex: GridPoint;
    ends: [GridPoint, GridPoint];
}

/** The triangles that share a hypotenuse. */
interface Diamond {
    ends: [GridPoint, GridPoint];
    apexes: GridPoint[];
}

/** How a triangle lies to the field. */
export const enum Extent {
    Inside,
    Across,
    Outside,
}

/** A grid in the corner of a square of 2ᵏ cells a side, which triangles halve again and again. */
export class Grid {
    readonly side: number;

    constructor(
        readonly columns: number,
        readonly rows: number,
    ) {
        this.side = 2 ** Math.ceil(Math.log2(Math.max(columns, rows) - 1));
    }

    get count(): number {
        return this.columns * this.rows;
    }

    holds({ column, row }: GridPoint): boolean {
        return column < this.columns && row < this.rows;
    }

    index({ column, row }: GridPoint): number {
        return row * this.columns + column;
    }

    place(index: number): GridPoint {
        return { column: index % this.columns, row: Math.floor(index / this.columns) };
    }

    /** Number of times that the square is bisected. */
    get depth(): number {
        return 2 * Math.log2(this.side);
    }

    roots(): RightTriangle[] {
        const { side } = this;
        const [low, high] = [point(0, 0), point(side, side)];
        return [
            { apex: point(side, 0), ends: [high, low] },
            { apex: point(0, side), ends: [low, high] },
        ];
    }

    /** Returns the triangles that a vertex bisects; null for the corners of the square. */
    diamond({ column, row }: GridPoint): Diamond | null {
        const any = column | row;
        const step = any & -any;
        const { side } = this;
        if (any === 0 || step === side) return null;
        if (column & row & step) {
            // Cells halved along the rising and the falling diagonal alternate as on a chessboard.
            const rising: [GridPoint, GridPoint] = [
                point(column - step, row - step),
                point(column + step, row + step),
            ];
            const falling: [GridPoint, GridPoint] = [
                point(column + step, row - step),
                point(column - step, row + step),
            ];
            const isRising = ((column ^ row) & (2 * step)) === 0;
            return isRising ? { ends: rising, apexes: falling } : { ends: falling, apexes: rising };
        }
        const isAcross = (column & step) !== 0;
        const [across, along] = isAcross ? [step, 0] : [0, step];
        const beside = isAcross ? row : column;
        const apexes: GridPoint[] = [];
        if (beside > 0) apexes.push(point(column - along, row - across));
        if (beside < side) apexes.push(point(column + along, row + across));
        return {
            ends: [point(column - across, row - along), point(column + across, row + along)],
            apexes,
        };
    }

    /** Returns the vertices that one depends on. */
    parents(place: GridPoint): GridPoint[] {
        return this.diamond(place)?.apexes.filter((apex) => this.holds(apex)) ?? [];
    }

    /** Returns the vertices that depend on one, by their numbers. */
    dependents(place: GridPoint): number[] {
        const dependents: number[] = [];
        const diamond = this.diamond(place);
        if (!diamond) return dependents;
        const [a, b] = diamond.ends;
        for (const apex of diamond.apexes) {
            const isLeft = turn(apex, a, b) > 0;
            this.pushMiddle(apex, isLeft ? a : b, dependents);
            this.pushMiddle(apex, isLeft ? b : a, dependents);
        }
        return dependents;
    }

    /** Appends the middle of a leg, unless it is that of half a cell or outside the field. */
    private pushMiddle(apex: GridPoint, end: GridPoint, to: number[]): void {
        const column = apex.column + end.column;
        const row = apex.row + end.row;
        if ((column | row) & 1 || column >= 2 * this.columns || row >= 2 * this.rows) return;
        to.push((row >> 1) * this.columns + (column >> 1));
    }

    /** Returns the triangles that a vertex bisects. */
    coarse(place: GridPoint): RightTriangle[] {
        const diamond = this.diamond(place);
        if (!diamond) return [];
        const [a, b] = diamond.ends;
        return diamond.apexes.map((apex) => ({
            apex,
            ends: turn(apex, a, b) > 0 ? [a, b] : [b, a],
        }));
    }

    /** Returns the corners of a vertex's diamond. */
    corners(place: GridPoint): GridPoint[] {
        const diamond = this.diamond(place);
        return diamond ? [...diamond.ends, ...diamond.apexes] : [];
    }

    extent({ apex, ends }: RightTriangle): Extent {
        const corners = [apex, ...ends];
        const [right, top] = [this.columns - 1, this.rows - 1];
        if (corners.every(({ column, row }) => column <= right && row <= top)) return Extent.Inside;
        const isOutside =
            corners.every(({ column }) => column >= right) ||
            corners.every(({ row }) => row >= top) ||
            corners.every(({ column, row }) => column + row >= right + top);
        return isOutside ? Extent.Outside : Extent.Across;
    }

    /** Visits the vertices that are inserted at a depth, row by row. */
    insertedAt(depth: number, visit: (place: GridPoint) => void): void {
        const step = this.side / 2 ** ((depth >> 1) + 1);
        const isSide = depth % 2 === 1;
        for (let row = isSide ? 0 : step; row < this.rows; row += isSide ? step : 2 * step) {
            const first = isSide && row & step ? 0 : step;
            for (let column = first; column < this.columns; column += 2 * step)
                visit({ column, row });
        }
    }
}

function point(column: number, row: number): GridPoint {
    return { column, row };
}

/** Returns the middle of two places. */
export function middle([a, b]: [GridPoint, GridPoint]): GridPoint {
    return { column: (a.column + b.column) / 2, row: (a.row + b.row) / 2 };
}

/** Returns the halves of a triangle. */
export function halvesOf({
    apex,
    ends: [start, end],
}: RightTriangle): [RightTriangle, RightTriangle] {
    const at = middle([start, end]);
    return [
        { apex: at, ends: [apex, start] },
        { apex: at, ends: [end, apex] },
    ];
}

/** Returns true for half cells. */
export function isFinest({ ends: [a, b] }: RightTriangle): boolean {
    return (a.column + b.column) % 2 === 1;
}

/** Returns on which of the four sides of its right angle the hypotenuse lies. */
export function sideOf({ apex, ends: [a, b] }: RightTriangle): number {
    const right = a.column + b.column - 2 * apex.column;
    const above = a.row + b.row - 2 * apex.row;
    if (right > 0 && above >= 0) return 0;
    if (right <= 0 && above > 0) return 1;
    return right < 0 ? 2 : 3;
}

function turn(apex: GridPoint, a: GridPoint, b: GridPoint): number {
    const [ax, ay] = [a.column - apex.column, a.row - apex.row];
    return ax * (b.row - apex.row) - ay * (b.column - apex.column);
}
