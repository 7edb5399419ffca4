/** Positions in blocks, each with a frame and cells that follow the surface. */

import { eighthPower } from "../packed/eighths.ts";
import { BitCursor } from "../packed/reader.ts";
import type { Bits, ByteReader } from "../packed/reader.ts";
import { BLOCK, GROUP, WORD, checkField } from "./block.ts";
import type { HeaderField } from "./block.ts";
import { takeBits } from "./rows.ts";

const MOST_LENGTH = 1e60;
const LEAST_UNIT = 2 ** -1022;
const WIDEST = 56;
/** Bits below which a number of a pair is exact with some to spare. */
const EXACT = 45;
const TAN_HALF = 0.41421356237309505;

/** What all blocks share. */
interface Layout {
    center: number[];
    unit: number;
    reach: number;
    /** Steps of anchors along the surface and across it. */
    anchors: number[];
    /** Widths along and across, then steps along and across. */
    fields: HeaderField[];
}

interface Group {
    start: number;
    middle: number[];
    bits: number[];
}

/** A block: the sides of its cells, its first cell, and the bits of a pair along each axis. */
interface Block {
    sides: number[][];
    first: number[];
    widths: number[];
}

/** Reads positions in blocks. */
export function readBlocks(reader: ByteReader): Float64Array {
    const [vertices, words] = [reader.u32(), reader.u32()];
    const length = (least: number) => {
        const x = reader.f64();
        reader.must(x >= least && x < MOST_LENGTH, `${x} is out of range for a length`);
        return x;
    };
    const center = [0, 0, 0].map(() => length(-MOST_LENGTH));
    const [unit, reach] = [length(LEAST_UNIT), length(0)];
    const anchors = [reader.u8(), reader.u8()];
    const fields = [0, 0, 0, 0].map(() => checkField(reader.u8(), reader.u8(), reader));
    const blocks = Math.ceil(vertices / BLOCK);
    const count = Math.ceil(blocks / GROUP);
    reader.must(10 * count <= reader.left, `too few bytes for ${vertices} vertices`);
    const groups = Array.from({ length: count }, (): Group => {
        const start = reader.u32();
        const middle = [reader.i8(), reader.i8(), reader.i8()];
        const bits = [reader.u8(), reader.u8(), reader.u8()];
        reader.must(
            bits.every((bits) => bits <= 31),
            "an anchor has more than 31 bits",
        );
        return { start, middle, bits };
    });
    const bits = takeBits(words * WORD, reader);
    // Each block has a header of at least 21 bits.
    reader.must(21 * blocks <= bits.length, `too few bits for ${vertices} vertices`);
    const positions = new Float64Array(3 * vertices);
    const layout = { center, unit, reach, anchors, fields };
    const end = decodeGroups(bits, layout, groups, positions, reader);
    reader.must(end === bits.length, `expected ${end} bits, found ${bits.length}`);
    return positions;
}

/** Decodes the positions of all groups; returns the bit at which they end. */
function decodeGroups(
    bits: Bits,
    layout: Layout,
    groups: Group[],
    positions: Float64Array,
    reader: ByteReader,
): number {
    const vertices = positions.length / 3;
    let end = 0;
    groups.forEach((group, number) => {
        reader.must(group.start * WORD === end, `group ${number} does not start at bit ${end}`);
        const cursor = new BitCursor(bits, end);
        const before = number * GROUP * BLOCK;
        const count = Math.min(Math.ceil((vertices - before) / BLOCK), GROUP);
        const blocks = Array.from({ length: count }, () => readBlock(cursor, layout, group));
        end = cursor.at;
        blocks.forEach((block, k) => {
            const isNarrow = block.widths.every((width) => width <= WIDEST);
            reader.must(isNarrow, `a block has a width above ${WIDEST}`);
            const from = before + k * BLOCK;
            const to = Math.min(from + BLOCK, vertices);
            const [a, b, c] = block.widths;
            const length = Math.ceil((to - from) / 2) * (a + b + c);
            bits.reach(end + length);
            decodeBlock(bits, end, block, positions.subarray(3 * from, 3 * to));
            end += length;
        });
        end = Math.ceil(end / WORD) * WORD;
    });
    return end;
}

/** Reads the header of a block. */
function readBlock(cursor: BitCursor, layout: Layout, group: Group): Block {
    const axes = axesOf(cursor.next(8), cursor.next(8), cursor.next(5));
    const widths: number[] = [];
    const sides: number[][] = [];
    const shift = [0, 0, 0];
    for (let k = 0; k < 3; k++) {
        const across = Number(k === 2);
        const [width, step] = [layout.fields[across], layout.fields[2 + across]];
        widths.push(width.least + cursor.next(width.bits));
        const size = layout.unit * eighthPower(step.least + cursor.next(step.bits));
        const bits = group.bits[k];
        const anchor = cursor.next(bits) - (bits === 0 ? 0 : 2 ** (bits - 1));
        const away = anchor * (layout.unit * eighthPower(layout.anchors[across]));
        sides.push(axes[k].map((x) => x * size));
        axes[k].forEach((x, i) => (shift[i] += x * away));
    }
    const first = shift.map((x, i) => layout.center[i] + (group.middle[i] * layout.reach + x));
    return { sides, first, widths };
}

/** Returns two axes along the surface, and the normal, from the codes of a frame. */
function axesOf(p: number, q: number, angle: number): number[][] {
    const [a, b] = [(2 * p) / 255 - 1, (2 * q) / 255 - 1];
    const [x, y] = [(a + b) * 0.5, (a - b) * 0.5];
    const z = Math.max(1 - Math.abs(x) - Math.abs(y), 0);
    const length = Math.sqrt(x * x + y * y + z * z);
    const [nx, ny, nz] = [x / length, y / length, z / length];
    const along = 1 / (1 + nz);
    const u = [1 - nx * nx * along, -nx * ny * along, -nx];
    const v = [-nx * ny * along, 1 - ny * ny * along, -ny];
    const t = (angle / 16 - 1) * TAN_HALF;
    const cos = (1 - t * t) / (1 + t * t);
    const sin = (2 * t) / (1 + t * t);
    return [
        u.map((x, k) => x * cos + v[k] * sin),
        v.map((x, k) => x * cos - u[k] * sin),
        [nx, ny, nz],
    ];
}

/** Decodes the positions of a block, whose numbers start at a bit. */
function decodeBlock(bits: Bits, start: number, block: Block, to: Float64Array): void {
    const { widths, sides, first } = block;
    const counts = widths.map((width) => Math.floor(Math.sqrt(2 ** width)));
    for (let at = 0; at < to.length; at += 6) {
        const pair = widths.map((width, k) => {
            const both = pairAt(bits, start, width, counts[k]);
            start += width;
            return both;
        });
        const count = Math.min((to.length - at) / 3, 2);
        for (let which = 0; which < count; which++) {
            const [u, v, w] = pair.map((both) => both[which]);
            for (let k = 0; k < 3; k++) {
                const sum = sides[0][k] * u + sides[1][k] * v + sides[2][k] * w;
                to[at + 3 * which + k] = sum + first[k];
            }
        }
    }
}

/** Returns the remainder and the quotient of a number, as `u32`. */
function pairAt(bits: Bits, at: number, width: number, count: number): [number, number] {
    if (width <= EXACT) {
        const both = width <= 32 ? bits.get(at, width) : Number(bits.getBig(at, width));
        return [both % count, Math.floor(both / count)];
    }
    const both = bits.getBig(at, width);
    return [Number(both % BigInt(count)), Number(both / BigInt(count))];
}
