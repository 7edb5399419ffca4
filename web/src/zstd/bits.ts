/** Bits of a stream that is read from its end, as entropy codes of zstandard are. */

import { must } from "../error.ts";

/** Reads numbers of bits, the last ones first. */
export class BackwardBits {
    /** Number of bits that are left, counted from `start`. */
    left: number;

    /** Takes the bytes from `start` to `end`, the last of which has a marker above its bits. */
    constructor(
        private readonly bytes: Uint8Array,
        private readonly start: number,
        end: number,
    ) {
        must(end > start && bytes[end - 1] !== 0, "a stream of bits has no end");
        this.left = 8 * (end - start) - Math.clz32(bytes[end - 1]) + 23;
    }

    /** Reads up to 25 bits; those before the start are 0, and make `left` negative. */
    read(count: number): number {
        this.left -= count;
        if (this.left < 0) return this.beforeStart(count);
        return (this.word(this.left) & ((1 << count) - 1)) >>> 0;
    }

    /** Reads up to 32 bits. */
    readLong(count: number): number {
        if (count <= 25) return this.read(count);
        const high = this.read(count - 16);
        return high * 65536 + this.read(16);
    }

    /** Returns at least 25 bits from a place on. */
    private word(bit: number): number {
        const at = this.start + (bit >> 3);
        const { bytes } = this;
        const word =
            bytes[at] | (bytes[at + 1] << 8) | (bytes[at + 2] << 16) | (bytes[at + 3] << 24);
        return word >>> (bit & 7);
    }

    private beforeStart(count: number): number {
        const there = Math.max(this.left + count, 0);
        return ((this.word(0) & ((1 << there) - 1)) << (count - there)) >>> 0;
    }
}
