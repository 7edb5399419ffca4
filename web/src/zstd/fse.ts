/** Tables of finite state entropy codes (RFC 8878, 4.1). */

import { must } from "../error.ts";

/** A decoding table: of each state its symbol, and how the next state is made. */
export interface FseTable {
    /** Binary logarithm of the number of states. */
    bits: number;
    symbols: Uint8Array;
    /** Number of bits that are added to `base` for the next state. */
    counts: Uint8Array;
    base: Uint16Array;
}

/** A table that was read, and the place after it. */
export interface ReadTable {
    table: FseTable;
    end: number;
}

/** Builds the table of probabilities, of which −1 is less than one state. */
export function fseTable(probabilities: readonly number[], bits: number): FseTable {
    const size = 1 << bits;
    const symbols = new Uint8Array(size);
    const next = Uint16Array.from(probabilities, (p) => (p < 0 ? 1 : p));
    let high = size;
    probabilities.forEach((p, symbol) => {
        if (p < 0) symbols[--high] = symbol;
    });
    const step = (size >> 1) + (size >> 3) + 3;
    let at = 0;
    probabilities.forEach((p, symbol) => {
        for (let i = 0; i < p; i++) {
            symbols[at] = symbol;
            do at = (at + step) & (size - 1);
            while (at >= high);
        }
    });
    must(at === 0, "an entropy code is incomplete");
    const counts = new Uint8Array(size);
    const base = new Uint16Array(size);
    for (let state = 0; state < size; state++) {
        const own = next[symbols[state]]++;
        counts[state] = bits - (31 - Math.clz32(own));
        base[state] = (own << counts[state]) - size;
    }
    return { bits, symbols, counts, base };
}

/** Returns the table of a code that is always one symbol. */
export function constantTable(symbol: number): FseTable {
    const symbols = Uint8Array.of(symbol);
    return { bits: 0, symbols, counts: new Uint8Array(1), base: new Uint16Array(1) };
}

/** Reads a description of a table of at most `mostBits`, for symbols up to `last`. */
export function readFseTable(
    bytes: Uint8Array,
    start: number,
    end: number,
    mostBits: number,
    last: number,
): ReadTable {
    let bit = 8 * start;
    const peek = (count: number) => {
        const at = bit >> 3;
        const word = bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16);
        return (word >>> (bit & 7)) & ((1 << count) - 1);
    };
    must(start < end, "an entropy code is missing");
    const bits = peek(4) + 5;
    bit += 4;
    must(bits <= mostBits, "an entropy code is too long");
    const probabilities: number[] = [];
    let left = 1 << bits;
    while (left > 0) {
        must(probabilities.length <= last && bit < 8 * end, "an entropy code is malformed");
        const width = 32 - Math.clz32(left + 1);
        const below = (1 << (width - 1)) - 1;
        const short = (1 << width) - 2 - left;
        let value = peek(width);
        if ((value & below) < short) {
            bit += width - 1;
            value &= below;
        } else {
            bit += width;
            if (value > below) value -= short;
        }
        left -= Math.abs(value - 1);
        probabilities.push(value - 1);
        if (value !== 1) continue;
        for (let more = 3; more === 3;) {
            more = peek(2);
            bit += 2;
            for (let i = 0; i < more; i++) probabilities.push(0);
            must(
                probabilities.length <= last + 1 && bit <= 8 * end,
                "an entropy code is malformed",
            );
        }
    }
    must(left === 0 && bit <= 8 * end, "an entropy code is malformed");
    return { table: fseTable(probabilities, bits), end: (bit + 7) >> 3 };
}
