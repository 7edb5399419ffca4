/** Positions in parts, eight bits an axis on one grid, and the vertices that parts share. */

import { must } from "../error.ts";
import type { ByteReader } from "../packed/reader.ts";
import { Rows } from "./rows.ts";

const CENTERED = 1;
const LONG = 2;
const MOST_OFFSET = 2 ** 23;
const LEAST_NORMAL = 2 ** -126;

/** Cells of the nodes of all parts. */
export interface Parts {
    rows: Rows;
    vertices: number;
    cells: Int32Array;
    /** Position of each node. */
    positions: Float64Array;
}

/** Reads positions in parts; each part is a row of nodes. */
export function readParts(reader: ByteReader): Parts {
    const flags = reader.u8();
    reader.must((flags & ~(CENTERED | LONG)) === 0, `unknown flags ${flags} of parts`);
    const [vertices, count] = [reader.u32(), reader.u32()];
    const sides = [reader.f32(), reader.f32(), reader.f32()];
    const isGrid = sides.every((side) => side >= LEAST_NORMAL && side < Infinity);
    reader.must(isGrid, "the cells have no size");
    const isLong = (flags & LONG) !== 0;
    reader.must(count * (isLong ? 16 : 10) <= reader.left, `too few bytes for ${count} parts`);
    const sizes: number[] = [];
    const offsets: number[] = [];
    for (let part = 0; part < count; part++) {
        sizes.push(reader.u32());
        for (let k = 0; k < 3; k++) {
            const offset = isLong ? reader.i32() : reader.i16();
            reader.must(Math.abs(offset) <= MOST_OFFSET, "a part is too far from the origin");
            offsets.push(offset);
        }
    }
    const rows = new Rows(sizes);
    const { nodes } = rows;
    const isCount = nodes < 2 ** 32 && vertices <= nodes && (vertices === 0) === (nodes === 0);
    reader.must(isCount, `${vertices} vertices cannot have ${nodes} positions`);
    const local = reader.take(3 * nodes);
    const cells = new Int32Array(3 * nodes);
    const positions = new Float64Array(3 * nodes);
    const within = flags & CENTERED ? 0.5 : 0;
    for (let part = 0; part < count; part++) {
        for (let at = 3 * rows.starts[part]; at < 3 * rows.starts[part + 1]; at++) {
            cells[at] = offsets[3 * part + (at % 3)] + local[at];
            positions[at] = (cells[at] + within) * sides[at % 3];
        }
    }
    return { rows, vertices, cells, positions };
}

/** Reads pairs of a node and the first node of its vertex. */
export function readExceptions(reader: ByteReader): Uint32Array {
    const count = reader.u32();
    reader.must(8 * count <= reader.left, `too few bytes for ${count} exceptions`);
    return Uint32Array.from({ length: 2 * count }, () => reader.u32());
}

/** Returns the vertex of each node, and the positions of the vertices. */
export function weldParts(
    { cells, positions, vertices }: Parts,
    exceptions: Uint32Array,
    faces: Uint32Array,
): [Uint32Array, Float64Array] {
    const first = firstInCells(cells, faces);
    for (let i = 0; i < exceptions.length; i += 2) {
        must(exceptions[i] < first.length, "an exception names a node that does not exist");
        first[exceptions[i]] = exceptions[i + 1];
    }
    const vertexOf = new Uint32Array(first.length);
    const kept = new Float64Array(3 * vertices);
    let count = 0;
    first.forEach((is, node) => {
        must(
            is <= node && first[is] === is,
            "an exception does not lead to the first node of a vertex",
        );
        if (is < node) {
            vertexOf[node] = vertexOf[is];
            return;
        }
        if (count < vertices) kept.set(positions.subarray(3 * node, 3 * node + 3), 3 * count);
        vertexOf[node] = count++;
    });
    must(count === vertices, `expected ${vertices} vertices, found ${count}`);
    return [vertexOf, kept];
}

/** Returns for each node the first one in its cell, if both are on open edges of their parts. */
function firstInCells(cells: Int32Array, faces: Uint32Array): Uint32Array {
    const nodes = cells.length / 3;
    const sides = new Set<number>();
    const next = (corner: number) => (corner % 3 === 2 ? corner - 2 : corner + 1);
    faces.forEach((from, corner) => sides.add(from * nodes + faces[next(corner)]));
    const isOpen = new Uint8Array(nodes);
    faces.forEach((from, corner) => {
        const to = faces[next(corner)];
        if (!sides.has(to * nodes + from)) isOpen[from] = isOpen[to] = 1;
    });
    const first = Uint32Array.from({ length: nodes }, (_, node) => node);
    const byCell = new Map<number, Map<number, number>>();
    for (let node = 0; node < nodes; node++) {
        if (!isOpen[node]) continue;
        const [x, y, z] = cells.subarray(3 * node, 3 * node + 3);
        let column = byCell.get(z);
        if (!column) byCell.set(z, (column = new Map<number, number>()));
        const key = x * 2 ** 26 + y;
        const known = column.get(key);
        if (known === undefined) column.set(key, node);
        else first[node] = known;
    }
    return first;
}
