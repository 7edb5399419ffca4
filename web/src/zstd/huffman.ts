/** Huffman codes of literals (RFC 8878, 4.2). */

import { must } from "../error.ts";
import { BackwardBits } from "./bits.ts";
import { readFseTable } from "./fse.ts";

const MOST_BITS = 11;

/** A decoding table: symbol and length of the code that the next `bits` bits begin with. */
export interface HuffmanTable {
    bits: number;
    /** Length of the code, times 256, plus the symbol. */
    codes: Uint16Array;
}

/** Reads a table; returns it with the place after it. */
export function readHuffman(
    bytes: Uint8Array,
    start: number,
    end: number,
): { table: HuffmanTable; end: number } {
    must(start < end, "a Huffman code is missing");
    const head = bytes[start];
    if (head >= 128) {
        const count = head - 127;
        const after = start + 1 + ((count + 1) >> 1);
        must(after <= end, "a Huffman code is cut off");
        const weight = (i: number) => (bytes[start + 1 + (i >> 1)] >> (i & 1 ? 0 : 4)) & 15;
        const weights = Array.from({ length: count }, (_, i) => weight(i));
        return { table: tableOf(weights), end: after };
    }
    const after = start + 1 + head;
    must(after <= end, "a Huffman code is cut off");
    return { table: tableOf(readWeights(bytes, start + 1, after)), end: after };
}

/** Reads weights that two states take turns to code. */
function readWeights(bytes: Uint8Array, start: number, end: number): number[] {
    const { table, end: at } = readFseTable(bytes, start, end, 6, 255);
    const { symbols, counts, base } = table;
    const input = new BackwardBits(bytes, at, end);
    const states = [input.read(table.bits), input.read(table.bits)];
    const weights: number[] = [];
    for (let turn = 0; ; turn ^= 1) {
        const state = states[turn];
        weights.push(symbols[state]);
        must(weights.length < 256, "a Huffman code has too many symbols");
        states[turn] = base[state] + input.read(counts[state]);
        if (input.left < 0) {
            weights.push(symbols[states[turn ^ 1]]);
            return weights;
        }
    }
}

/** Builds the table of weights; that of the last symbol follows from the others. */
function tableOf(weights: number[]): HuffmanTable {
    must(weights.length < 256, "a Huffman code has too many symbols");
    const sum = weights.reduce((sum, weight) => sum + (weight > 0 ? 1 << (weight - 1) : 0), 0);
    must(sum > 0, "a Huffman code is empty");
    const bits = 32 - Math.clz32(sum);
    const rest = (1 << bits) - sum;
    must(bits <= MOST_BITS && (rest & (rest - 1)) === 0, "a Huffman code is incomplete");
    const all = [...weights, 32 - Math.clz32(rest)];
    const codes = new Uint16Array(1 << bits);
    let at = 0;
    for (let weight = 1; weight <= bits; weight++) {
        all.forEach((own, symbol) => {
            if (own !== weight) return;
            const length = 1 << (weight - 1);
            codes.fill(((bits + 1 - weight) << 8) | symbol, at, at + length);
            at += length;
        });
    }
    must(at === codes.length, "a Huffman code is incomplete");
    return { bits, codes };
}

/** Decodes one stream of literals, from `start` to `end`, into `out`. */
export function decodeHuffman(
    { bits, codes }: HuffmanTable,
    bytes: Uint8Array,
    start: number,
    end: number,
    out: Uint8Array,
): void {
    must(end > start && bytes[end - 1] !== 0, "a stream of literals has no end");
    let left = 8 * (end - start) - Math.clz32(bytes[end - 1]) + 23;
    const mask = (1 << bits) - 1;
    const count = out.length;
    let i = 0;
    for (; i < count && left >= bits; i++) {
        const from = left - bits;
        const at = start + (from >> 3);
        const word = bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16);
        const code = codes[(word >>> (from & 7)) & mask];
        out[i] = code;
        left -= code >> 8;
    }
    for (; i < count; i++) {
        const word = bytes[start] | (bytes[start + 1] << 8);
        const code = codes[((word & ((1 << left) - 1)) << (bits - left)) & mask];
        out[i] = code;
        left -= code >> 8;
        must(left >= 0, "a stream of literals is cut off");
    }
    must(left === 0, "a stream of literals is too long");
}
