/** Positions on a lattice, in blocks that integer shears have laid flat. */

import { BitCursor } from "../packed/reader.ts";
import type { Bits, ByteReader } from "../packed/reader.ts";
import { BLOCK, GROUP, WORD, checkField } from "./block.ts";
import type { HeaderField } from "./block.ts";
import { takeBits } from "./rows.ts";

const MOST_EXPONENT = 960;
const MOST_FIRST = 2n ** 52n;
const MOST_CELLS = 2 ** 19;
/** Bits of a group's header without its least midpoints. */
const GROUP_BITS = 1 + 3 * 5 + 2 * (8 + 4);

/** What the blocks of a group have in common. */
interface Group {
    isBent: boolean;
    /** Least midpoints, and the bits of what is above them. */
    first: number[];
    bits: number[];
    spans: HeaderField[];
}

/** The shear of a block; u, v and w in this order. */
interface Shear {
    axis: number;
    slopes: number[];
    bends: number[];
    spans: number[];
    middle: number[];
    /** Vertices that share a number, and its bits. */
    tuple: number;
    bits: number;
}

/** Reads positions on a lattice. */
export function readLattice(reader: ByteReader): Float64Array {
    const exponent = reader.i32();
    reader.must(Math.abs(exponent) <= MOST_EXPONENT, "the lattice's exponent is out of range");
    const first = [reader.i64(), reader.i64(), reader.i64()];
    const isNear = first.every((x) => x <= MOST_FIRST && x >= -MOST_FIRST);
    reader.must(isNear, "the first cell is too far away");
    const [vertices, words] = [reader.u32(), reader.u32()];
    const most = [reader.i32(), reader.i32(), reader.i32()];
    const isMost = most.every((x) => x >= 0 && x < MOST_CELLS);
    reader.must(isMost, "the greatest cells are out of range");
    const blocks = Math.ceil(vertices / BLOCK);
    const groups = Math.ceil(blocks / GROUP);
    reader.must(4 * groups <= reader.left, `too few bytes for ${vertices} vertices`);
    const starts = Array.from({ length: groups }, () => reader.u32());
    const bits = takeBits(words * WORD, reader);
    // Each block has a header of at least 26 bits.
    reader.must(26 * blocks <= bits.length, `too few bits for ${vertices} vertices`);
    const cells = new Float64Array(3 * vertices);
    const end = decodeGroups(bits, starts, most, cells, reader);
    reader.must(end === bits.length, `expected ${end} bits, found ${bits.length}`);
    const [side, ...from] = [2 ** exponent, ...first.map(Number)];
    return cells.map((cell, i) => (from[i % 3] + cell) * side);
}

/** Decodes the cells of all groups; returns the bit at which they end. */
function decodeGroups(
    bits: Bits,
    starts: number[],
    most: number[],
    cells: Float64Array,
    reader: ByteReader,
): number {
    const vertices = cells.length / 3;
    const widths = most.map((x) => 32 - Math.clz32(x));
    let end = 0;
    starts.forEach((start, number) => {
        reader.must(start * WORD === end, `group ${number} does not start at bit ${end}`);
        bits.reach(end + widths[0] + widths[1] + widths[2] + GROUP_BITS);
        const cursor = new BitCursor(bits, end);
        const group = readGroup(cursor, widths, reader);
        const before = number * GROUP * BLOCK;
        const count = Math.min(Math.ceil((vertices - before) / BLOCK), GROUP);
        const shears = Array.from({ length: count }, () => readShear(cursor, group));
        end = cursor.at;
        shears.forEach((shear, block) => {
            const from = before + block * BLOCK;
            const inBlock = Math.min(vertices - from, BLOCK);
            const length = Math.ceil(inBlock / shear.tuple) * shear.bits;
            bits.reach(end + length);
            decodeBlock(bits, end, shear, cells.subarray(3 * from, 3 * (from + inBlock)));
            end += length;
        });
        end = Math.ceil(end / WORD) * WORD;
    });
    return end;
}

function readGroup(cursor: BitCursor, widths: number[], reader: ByteReader): Group {
    const isBent = cursor.next(1) === 1;
    const first = widths.map((width) => cursor.next(width));
    const bits = [0, 0, 0].map(() => cursor.next(5));
    reader.must(
        bits.every((bits) => bits < 20),
        "a group has midpoints of more than 19 bits",
    );
    const spans = [0, 0].map(() => checkField(cursor.next(8), cursor.next(4), reader));
    return { isBent, first, bits, spans };
}

function readShear(cursor: BitCursor, group: Group): Shear {
    const axis = cursor.next(2) % 3;
    const coarse = [0, 0].map(() => 4 * (cursor.next(5) - 16));
    const fine = [0, 0].map(() => cursor.next(7) - 64);
    const bends = [0, 0, 0].map(() => (group.isBent ? cursor.next(6) - 32 : 0));
    const spans: number[] = [];
    const middle: number[] = [];
    for (let k = 0; k < 3; k++) {
        const turned = (axis + 1 + k) % 3;
        const { least, bits } = group.spans[k >> 1];
        spans.push(spanOf(least + cursor.next(bits)));
        middle.push(group.first[turned] + cursor.next(group.bits[turned]));
    }
    const volume = spans.reduce((product, span) => product * BigInt(span), 1n);
    const four = bitsBelow(volume ** 4n);
    const tuple = four <= 128 ? 4 : 1;
    const bits = tuple === 4 ? four : bitsBelow(volume);
    return { axis, slopes: [...coarse, ...fine], bends, spans, middle, tuple, bits };
}

/** Returns the number of cells that a code stands for. */
function spanOf(code: number): number {
    return code < 16 ? code + 1 : ((code & 15) + 17) * 2 ** ((code >> 4) - 1);
}

/** Returns the bits of the numbers below another one. */
function bitsBelow(count: bigint): number {
    return count > 1n ? (count - 1n).toString(2).length : 0;
}

/** Decodes the cells of a block, whose numbers start at a bit. */
function decodeBlock(bits: Bits, start: number, shear: Shear, cells: Float64Array): void {
    const { tuple, spans } = shear;
    const [a, b, c] = spans.map(BigInt);
    const volume = a * b * c;
    const isSmall = volume <= BigInt(Number.MAX_SAFE_INTEGER);
    let number = 0n;
    for (let at = 0; at < cells.length / 3; at++) {
        if (at % tuple === 0) {
            number = bits.getBig(start, shear.bits);
            start += shear.bits;
        }
        const own = number % volume;
        number /= volume;
        const digits = [0, 0, 0];
        if (isSmall) {
            const small = Number(own);
            digits[0] = small % spans[0];
            digits[1] = Math.floor(small / spans[0]) % spans[1];
            digits[2] = Math.floor(small / (spans[0] * spans[1]));
        } else {
            digits[0] = Number(own % a);
            digits[1] = Number((own / a) % b);
            digits[2] = Number(own / a / b);
        }
        unshear(shear, digits, cells, 3 * at);
    }
}

/** Undoes a shear. */
function unshear(shear: Shear, digits: number[], cells: Float64Array, at: number): void {
    const { axis, slopes, bends, spans, middle } = shear;
    let [u, v, w] = digits.map((digit, k) => digit - Math.floor(spans[k] / 2));
    const sheared = (slope: number, by: number) => Math.floor((slope * by) / 64);
    v += sheared(slopes[1], u);
    u += sheared(slopes[0], v);
    w += sheared(slopes[2], u) + sheared(slopes[3], v);
    const [uu, uv, vv] = bends;
    if (uu !== 0 || uv !== 0 || vv !== 0) {
        w += Math.floor((u * (uu * u + uv * v)) / (64 * spans[0]));
        w += Math.floor((vv * v * v) / (64 * spans[1]));
    }
    cells[at + ((axis + 1) % 3)] = middle[0] + u;
    cells[at + ((axis + 2) % 3)] = middle[1] + v;
    cells[at + axis] = middle[2] + w;
}
