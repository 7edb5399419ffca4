/** Decoder of zstandard frames (RFC 8878) without dictionaries, as sections of a file are. */

import { Damage, must } from "../error.ts";
import { BackwardBits } from "./bits.ts";
import type { FseTable } from "./fse.ts";
import { decodeHuffman, readHuffman } from "./huffman.ts";
import type { HuffmanTable } from "./huffman.ts";
import {
    LITERALS,
    LITERAL_LENGTHS,
    MATCHES,
    MATCH_LENGTHS,
    OFFSETS,
    readTable,
} from "./sequences.ts";
import { xxh64 } from "./xxh64.ts";

const FRAME = 0xfd2fb528;
const SKIPPABLE = 0x184d2a50;
const MOST_IN_BLOCK = 1 << 17;

/**
 * Decompresses frames that follow one another.
 *
 * @param most greatest length of the content; memory is taken as content comes
 * @throws Damage if the frames are malformed, or longer
 */
export function decompress(bytes: Uint8Array, most: number): Uint8Array {
    const output = new Output(Math.min(most, 4 * bytes.length + 64), most);
    let at = 0;
    while (at < bytes.length) {
        must(at + 8 <= bytes.length, "its compressed data is cut off");
        const magic = word(bytes, at);
        if ((magic & ~15) >>> 0 === SKIPPABLE) {
            at += 8 + word(bytes, at + 4);
            must(at <= bytes.length, "its compressed data is cut off");
        } else {
            must(magic === FRAME, "its compressed data is malformed");
            at = new Frame(bytes, output).read(at + 4);
        }
    }
    return output.bytes.subarray(0, output.length);
}

function word(bytes: Uint8Array, at: number): number {
    return (bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16) | (bytes[at + 3] << 24)) >>> 0;
}

/** Returns the length of a frame's content that its header states. */
function sizeOf(bytes: Uint8Array, at: number, count: number): number {
    let size = count === 2 ? 256 : 0;
    for (let k = 0; k < count; k++) size += bytes[at + k] * 2 ** (8 * k);
    return size;
}

/** Bytes that grow up to a limit. */
class Output {
    bytes: Uint8Array;
    length = 0;

    constructor(
        capacity: number,
        private readonly most: number,
    ) {
        this.bytes = new Uint8Array(capacity);
    }

    /** Makes room for more bytes. */
    reserve(count: number): void {
        const needed = this.length + count;
        if (needed <= this.bytes.length) return;
        must(needed <= this.most, "its content is longer than such a section may be");
        const grown = new Uint8Array(Math.min(this.most, Math.max(needed, 2 * this.bytes.length)));
        grown.set(this.bytes.subarray(0, this.length));
        this.bytes = grown;
    }
}

/** A frame that is being decoded, with the tables that its next block may use again. */
class Frame {
    private huffman: HuffmanTable | null = null;
    private tables: (FseTable | null)[] = [null, null, null];
    private readonly offsets = [1, 4, 8];
    private literals: Uint8Array = new Uint8Array(0);
    private start = 0;

    constructor(
        private readonly bytes: Uint8Array,
        private readonly output: Output,
    ) {}

    /** Decodes the frame whose header is at a place; returns the place after it. */
    read(at: number): number {
        const { bytes } = this;
        const flags = bytes[at++];
        const isSingle = (flags & 32) !== 0;
        must((flags & 11) === 0, "its compressed data needs a dictionary, or is of a later form");
        at += isSingle ? 0 : 1;
        const sizeBytes = [isSingle ? 1 : 0, 2, 4, 8][flags >> 6];
        const size = sizeOf(bytes, at, sizeBytes);
        at += sizeBytes;
        this.start = this.output.length;
        for (let isLast = false; !isLast;) {
            must(at + 3 <= bytes.length, "its compressed data is cut off");
            const head = bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16);
            isLast = (head & 1) !== 0;
            at = this.readBlock((head >> 1) & 3, head >> 3, at + 3);
        }
        const isLong = sizeBytes === 0 || this.output.length - this.start === size;
        must(isLong, "its content has another length than it states");
        if ((flags & 4) === 0) return at;
        must(at + 4 <= bytes.length, "its compressed data is cut off");
        const content = this.output.bytes.subarray(this.start, this.output.length);
        must(word(bytes, at) === xxh64(content), "its checksum does not match");
        return at + 4;
    }

    private readBlock(type: number, size: number, at: number): number {
        const { bytes, output } = this;
        const end = at + (type === 1 ? 1 : size);
        must(size <= MOST_IN_BLOCK && end <= bytes.length && type < 3, "a block is malformed");
        if (type === 2) {
            this.readCompressed(at, end);
            return end;
        }
        output.reserve(size);
        if (type === 0) output.bytes.set(bytes.subarray(at, end), output.length);
        else output.bytes.fill(bytes[at], output.length, output.length + size);
        output.length += size;
        return end;
    }

    private readCompressed(at: number, end: number): void {
        at = this.readLiterals(at, end);
        const { bytes } = this;
        must(at < end, "a block is cut off");
        let count = bytes[at++];
        if (count === 255) {
            count = (bytes[at] | (bytes[at + 1] << 8)) + 0x7f00;
            at += 2;
        } else if (count >= 128) {
            count = ((count - 128) << 8) | bytes[at++];
        }
        if (count === 0) {
            must(at === end, "a block is too long");
            this.append(this.literals, 0, this.literals.length);
            return;
        }
        must(at < end, "a block is cut off");
        const modes = bytes[at++];
        must((modes & 3) === 0, "a block is of a later form");
        [LITERALS, OFFSETS, MATCHES].forEach((code, k) => {
            const read = readTable(
                (modes >> (6 - 2 * k)) & 3,
                code,
                this.tables[k],
                bytes,
                at,
                end,
            );
            this.tables[k] = read.table;
            at = read.end;
        });
        this.readSequences(count, new BackwardBits(bytes, at, end));
    }

    private readLiterals(at: number, end: number): number {
        const { bytes } = this;
        must(at + 1 < end, "a block is cut off");
        const type = bytes[at] & 3;
        const form = (bytes[at] >> 2) & 3;
        if (type < 2) return this.readPlain(type, form, at, end);
        const size = [3, 3, 4, 5][form];
        must(at + size <= end, "literals are cut off");
        const head = word(bytes, at);
        const width = [10, 10, 14, 18][form];
        const mask = (1 << width) - 1;
        const count = (head >>> 4) & mask;
        const packed =
            form === 3 ? (head >>> 22) | (bytes[at + 4] << 10) : (head >>> (4 + width)) & mask;
        at += size;
        const last = at + packed;
        must(count <= MOST_IN_BLOCK && last <= end, "literals are cut off");
        if (type === 2) {
            const read = readHuffman(bytes, at, last);
            this.huffman = read.table;
            at = read.end;
        }
        must(this.huffman !== null, "literals have no code");
        this.literals = new Uint8Array(count);
        if (form === 0) decodeHuffman(this.huffman, bytes, at, last, this.literals);
        else this.readStreams(this.huffman, at, last);
        return last;
    }

    /** Reads literals as they are, or one that is repeated. */
    private readPlain(type: number, form: number, at: number, end: number): number {
        const { bytes } = this;
        const head = word(bytes, at);
        const size = [1, 2, 1, 3][form];
        const count = [
            (head >> 3) & 31,
            (head >> 4) & 0xfff,
            (head >> 3) & 31,
            (head >> 4) & 0xfffff,
        ][form];
        at += size;
        const last = at + (type === 0 ? count : 1);
        must(count <= MOST_IN_BLOCK && last <= end, "literals are cut off");
        this.literals =
            type === 0 ? bytes.subarray(at, last) : new Uint8Array(count).fill(bytes[at]);
        return last;
    }

    private readStreams(huffman: HuffmanTable, at: number, end: number): void {
        const { bytes, literals } = this;
        must(at + 6 <= end, "literals are cut off");
        const each = (literals.length + 3) >> 2;
        let start = at + 6;
        for (let k = 0; k < 4; k++) {
            const size = bytes[at + 2 * k] | (bytes[at + 2 * k + 1] << 8);
            const stop = k < 3 ? start + size : end;
            must(stop <= end && 3 * each <= literals.length, "literals are cut off");
            const part = literals.subarray(k * each, k < 3 ? (k + 1) * each : literals.length);
            decodeHuffman(huffman, bytes, start, stop, part);
            start = stop;
        }
    }

    private readSequences(count: number, bits: BackwardBits): void {
        const [ofLiterals, ofOffsets, ofMatches] = this.tables as [FseTable, FseTable, FseTable];
        let literal = bits.read(ofLiterals.bits);
        let offset = bits.read(ofOffsets.bits);
        let match = bits.read(ofMatches.bits);
        let used = 0;
        for (let i = 0; i < count; i++) {
            const code = ofOffsets.symbols[offset];
            const value = 2 ** code + bits.readLong(code);
            const matchCode = ofMatches.symbols[match];
            const length = MATCH_LENGTHS[0][matchCode] + bits.read(MATCH_LENGTHS[1][matchCode]);
            const literalCode = ofLiterals.symbols[literal];
            const own =
                LITERAL_LENGTHS[0][literalCode] + bits.read(LITERAL_LENGTHS[1][literalCode]);
            must(bits.left >= 0 && used + own <= this.literals.length, "sequences are cut off");
            if (own > 0) this.append(this.literals, used, used + own);
            used += own;
            this.repeat(this.distance(value, own), length);
            if (i + 1 === count) break;
            literal = ofLiterals.base[literal] + bits.read(ofLiterals.counts[literal]);
            match = ofMatches.base[match] + bits.read(ofMatches.counts[match]);
            offset = ofOffsets.base[offset] + bits.read(ofOffsets.counts[offset]);
        }
        must(bits.left === 0, "sequences are too long");
        this.append(this.literals, used, this.literals.length);
    }

    /** Returns how far back a match is, which may be as far as one of the last three. */
    private distance(value: number, literals: number): number {
        const { offsets } = this;
        if (value > 3) {
            offsets.unshift(value - 3);
            offsets.pop();
            return value - 3;
        }
        const which = value - 1 + (literals === 0 ? 1 : 0);
        if (which === 0) return offsets[0];
        const distance = which === 3 ? offsets[0] - 1 : offsets[which];
        if (which > 1) offsets[2] = offsets[1];
        offsets[1] = offsets[0];
        offsets[0] = distance;
        return distance;
    }

    private append(from: Uint8Array, start: number, end: number): void {
        const { output } = this;
        const count = end - start;
        output.reserve(count);
        if (count > 32) output.bytes.set(from.subarray(start, end), output.length);
        else for (let i = 0; i < count; i++) output.bytes[output.length + i] = from[start + i];
        output.length += count;
    }

    private repeat(distance: number, length: number): void {
        const { output } = this;
        const from = output.length - distance;
        if (distance <= 0 || from < this.start) throw new Damage("a match is before its frame");
        output.reserve(length);
        const { bytes } = output;
        let to = output.length;
        for (let at = from, end = from + length; at < end;) bytes[to++] = bytes[at++];
        output.length = to;
    }
}
