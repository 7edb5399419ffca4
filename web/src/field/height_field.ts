/** A height field, or the parts of one that a cut file holds. */

import { MlodError, must, within } from "../error.ts";
import { crc32 } from "../file/crc32.ts";
import { VERSION } from "../file/header.ts";
import type { Vector } from "../frame.ts";
import { decompress } from "../zstd/decompress.ts";
import { Grid } from "./grid.ts";
import type { GridPoint } from "./grid.ts";

export const FIELD_MAGIC = "meshlodh";
const BODY = 24;
const MOST_PER_BYTE = 256;
const FREE_HEIGHTS = 1 << 24;
const MOST_COORDINATE = 1e150;
const MOST_CELLS = 2 ** 52;
const NAME = "the height field";

/** Where a grid is in the model. */
export interface Placement {
    /** Axis of the heights. */
    up: number;
    looksDown: boolean;
    origin: readonly [number, number];
    step: readonly [number, number];
}

/** Heights over a regular grid, in model units. */
export interface HeightField {
    grid: Grid;
    placement: Placement;
    heights: Float64Array;
    /** Number of parts that are there, and of the whole field. */
    parts: number;
    allParts: number;
}

/** Returns the point of the model at a height over a place of the grid. */
export function pointAt(
    { up, origin, step }: Placement,
    { column, row }: GridPoint,
    height: number,
): Vector {
    const point: [number, number, number] = [0, 0, 0];
    point[(up + 1) % 3] = origin[0] + column * step[0];
    point[(up + 2) % 3] = origin[1] + row * step[1];
    point[up] = height;
    return point;
}

/** Returns the length of a file of a height field, as its first 24 bytes tell. */
export function fieldLength(file: Uint8Array): number {
    return BODY + Number(new DataView(file.buffer, file.byteOffset).getBigUint64(16, true));
}

/**
 * Decodes a file of a height field, or a prefix that holds its coarsest level.
 *
 * @throws MlodError if it is damaged, or ends too early
 */
export function decodeField(file: Uint8Array): HeightField {
    return within(NAME, () => {
        must(file.length >= BODY, `the file ends at byte ${file.length}, before its header does`);
        const view = new DataView(file.buffer, file.byteOffset, file.byteLength);
        const version = view.getUint32(8, true);
        must(version === VERSION, `version ${version} is not supported, only ${VERSION}`);
        const length = Number(view.getBigUint64(16, true));
        const there = file.length - BODY;
        const isWhole = length <= there;
        if (isWhole && crc32(file.subarray(16)) !== view.getUint32(12, true)) {
            throw new MlodError(NAME, "its checksum does not match: the file is damaged");
        }
        const field = new BodyReader(file.subarray(BODY)).read(!isWhole);
        must(
            isWhole || field.parts < field.allParts,
            "its stated length is wrong: the file is damaged",
        );
        return field;
    });
}

/** Reads the body of a file. */
class BodyReader {
    private at = 0;
    private readonly view: DataView;

    constructor(private readonly bytes: Uint8Array) {
        this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    }

    private next(count: number): number {
        must(this.at + count <= this.bytes.length, "it ends within its header");
        this.at += count;
        return this.at - count;
    }

    private double(): number {
        return this.view.getFloat64(this.next(8), true);
    }

    read(isPrefix: boolean): HeightField {
        const start = this.next(4);
        const [version, up, looksDown, kind] = this.bytes.subarray(start, start + 4);
        must(version === 1 && up <= 2 && looksDown <= 1 && kind <= 1, "its header is invalid");
        const power = this.view.getInt32(this.next(4), true);
        must(kind === 1 ? power === 0 : power >= -1074 && power <= 900, "its scale is invalid");
        const columns = this.view.getUint32(this.next(4), true);
        const rows = this.view.getUint32(this.next(4), true);
        must(columns >= 2 && rows >= 2 && columns * rows < 2 ** 31, "its size is invalid");
        const [x, y, dx, dy, ...fit] = Array.from({ length: 7 }, () => this.double());
        const placement = {
            up,
            looksDown: looksDown === 1,
            origin: [x, y],
            step: [dx, dy],
        } as const;
        const last = [x + (columns - 1) * dx, y + (rows - 1) * dy];
        const areNear = [x, y, ...last, ...fit].every(
            (length) => Math.abs(length) < MOST_COORDINATE,
        );
        must(
            areNear && dx > 0 && dy > 0 && fit.every((length) => length >= 0),
            "its placement is invalid",
        );
        const grid = new Grid(columns, rows);
        const least = Math.ceil(grid.count / MOST_PER_BYTE);
        must(
            this.bytes.length >= least || (isPrefix && grid.count <= FREE_HEIGHTS),
            "it is too short for its size",
        );
        const { codes, parts } = this.readCodes(grid, isPrefix);
        const rest = this.bytes.subarray(this.at);
        const isPadding = rest.every((byte) => byte === 0) && this.bytes.length === least;
        must(isPrefix || rest.length === 0 || isPadding, "unexpected data after its heights");
        const heights = kind === 1 ? codes.ofBits() : codes.ofCells(2 ** power);
        return { grid, placement, heights, parts, allParts: grid.depth + 1 };
    }

    private readCodes(grid: Grid, isPrefix: boolean) {
        const codes = new Codes(grid);
        let parts = 0;
        for (let part = 0; part <= grid.depth; part++) {
            const places = codes.placesOf(part);
            const residuals = this.readPart(places.length, isPrefix && part > 0);
            parts += Number(residuals !== null);
            codes.add(places, residuals);
        }
        return { codes, parts };
    }

    /** Reads a part; null if it is cut off, as all that follow are. */
    private readPart(count: number, mayBeMissing: boolean): BigUint64Array | null {
        const { bytes, view, at } = this;
        const length = at + 5 <= bytes.length ? view.getUint32(at + 1, true) : Infinity;
        if (at + 5 + length > bytes.length) {
            must(mayBeMissing, "it ends within its heights");
            this.at = bytes.length;
            return null;
        }
        const width = bytes[at];
        must(width <= 8 && (width === 0) === (length === 0), "its heights have an invalid width");
        this.at += 5 + length;
        const planes = decompress(bytes.subarray(at + 5, this.at), count * width);
        must(planes.length === count * width, "its heights are too few");
        const residuals = new BigUint64Array(count);
        const low = new Uint8Array(residuals.buffer);
        for (let k = 0; k < width; k++)
            for (let i = 0; i < count; i++) low[8 * i + k] = planes[k * count + i];
        return residuals;
    }
}

/** Heights as integers of 64 bits, in the order in which vertices are inserted. */
class Codes {
    private readonly all: BigInt64Array;

    constructor(private readonly grid: Grid) {
        this.all = new BigInt64Array(grid.count);
    }

    /** Returns the vertices of a part: the corners of the square, or those of a bisection. */
    placesOf(part: number): GridPoint[] {
        const { grid } = this;
        const places: GridPoint[] = [];
        if (part > 0) {
            grid.insertedAt(part - 1, (place) => places.push(place));
            return places;
        }
        const { side } = grid;
        const corners = [
            [0, 0],
            [side, 0],
            [0, side],
            [side, side],
        ];
        return corners
            .map(([column, row]) => ({ column, row }))
            .filter((place) => grid.holds(place));
    }

    /** Adds heights, each to the one that is predicted; without residuals these alone. */
    add(places: GridPoint[], residuals: BigUint64Array | null): void {
        places.forEach((place, i) => {
            const folded = residuals ? residuals[i] : 0n;
            const residual = BigInt.asIntN(64, (folded >> 1n) ^ -(folded & 1n));
            this.all[this.grid.index(place)] = this.guess(place) + residual;
        });
    }

    private guess(place: GridPoint): bigint {
        const { grid, all } = this;
        const diamond = grid.diamond(place);
        if (!diamond) return place.column === 0 && place.row === 0 ? 0n : all[0];
        const [a, b] = diamond.ends
            .filter((end) => grid.holds(end))
            .map((end) => all[grid.index(end)]);
        if (b !== undefined) return (a + b) / 2n;
        if (a !== undefined) return a;
        const known = grid.corners(place).find((corner) => grid.holds(corner));
        return known ? all[grid.index(known)] : 0n;
    }

    /** Returns heights that are multiples of a step. */
    ofCells(step: number): Float64Array {
        const heights = Float64Array.from(this.all, (code) => {
            must(Math.abs(Number(code)) <= MOST_CELLS, "a height is out of range");
            return Number(code) * step;
        });
        must(
            heights.every((height) => Math.abs(height) < MOST_COORDINATE),
            "a height is out of range",
        );
        return heights;
    }

    /** Returns heights whose bits these are, in the order of the values. */
    ofBits(): Float64Array {
        const bits = this.all.map((code) => (code < 0n ? code ^ 0x7fffffffffffffffn : code));
        const heights = new Float64Array(bits.buffer);
        must(
            heights.every((height) => Math.abs(height) < MOST_COORDINATE),
            "a height is out of range",
        );
        return heights;
    }
}
