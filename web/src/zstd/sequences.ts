/**
 * Sequences of literals and matches, of which a compressed block consists (RFC 8878, 3.1.1.3.2).
 */

import { must } from "../error.ts";
import { constantTable, fseTable, readFseTable } from "./fse.ts";
import type { FseTable } from "./fse.ts";

/** What one of the three codes of a sequence stands for. */
export interface SequenceCode {
    /** Table of a block that brings none. */
    preset: FseTable;
    mostBits: number;
    /** Greatest symbol. */
    last: number;
}

export const LITERALS: SequenceCode = {
    preset: fseTable(
        [4, 3, ...repeat(2, 11), 1, 1, 1, ...repeat(2, 9), 3, 2, ...repeat(1, 5), ...repeat(-1, 4)],
        6,
    ),
    mostBits: 9,
    last: 35,
};

export const MATCHES: SequenceCode = {
    preset: fseTable([1, 4, 3, ...repeat(2, 6), ...repeat(1, 37), ...repeat(-1, 7)], 6),
    mostBits: 9,
    last: 52,
};

export const OFFSETS: SequenceCode = {
    preset: fseTable([...repeat(1, 6), 2, 2, 2, ...repeat(1, 15), ...repeat(-1, 5)], 5),
    mostBits: 8,
    last: 31,
};

/** Least length of each code, and number of bits that are added to it. */
export const LITERAL_LENGTHS = lengths(0, 16, [1, 1, 1, 1, 2, 2, 3, 3, 4, ...count(6, 16)]);
export const MATCH_LENGTHS = lengths(3, 32, [1, 1, 1, 1, 2, 2, 3, 3, 4, 4, 5, ...count(7, 16)]);

function lengths(first: number, plain: number, more: number[]): [Uint32Array, Uint8Array] {
    const bits = [...repeat(0, plain), ...more];
    let next = first;
    const base = bits.map((extra) => {
        const own = next;
        next += 1 << extra;
        return own;
    });
    return [Uint32Array.from(base), Uint8Array.from(bits)];
}

function repeat(x: number, times: number): number[] {
    return Array<number>(times).fill(x);
}

function count(from: number, to: number): number[] {
    return Array.from({ length: to - from + 1 }, (_, i) => from + i);
}

/** Reads the table of a code in one of four modes; the last is the table of the block before. */
export function readTable(
    mode: number,
    code: SequenceCode,
    before: FseTable | null,
    bytes: Uint8Array,
    at: number,
    end: number,
): { table: FseTable; end: number } {
    switch (mode) {
        case 0:
            return { table: code.preset, end: at };
        case 1:
            must(at < end && bytes[at] <= code.last, "a code of sequences is out of range");
            return { table: constantTable(bytes[at]), end: at + 1 };
        case 2:
            return readFseTable(bytes, at, end, code.mostBits, code.last);
        default:
            must(before !== null, "a code of sequences is missing");
            return { table: before, end: at };
    }
}
