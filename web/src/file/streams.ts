/** The streams of a section: bytes and numbers, one after the other. */

import { must } from "../error.ts";
import { decompress } from "../zstd/decompress.ts";

/** Greatest number of elements for each byte of a section, so that a short file asks for little. */
const MOST_PER_BYTE = 64;

/** Reads the streams of a compressed section, never more than the section has. */
export class Streams {
    private readonly bytes: Uint8Array;
    private at = 0;
    private left: number;

    constructor(section: Uint8Array) {
        this.left = (section.length + 1) * MOST_PER_BYTE;
        this.bytes = decompress(section, this.left);
    }

    /** Returns the next bytes. */
    take(count: number): Uint8Array {
        this.charge(count);
        must(this.at + count <= this.bytes.length, "its content ends too early");
        this.at += count;
        return this.bytes.subarray(this.at - count, this.at);
    }

    private charge(count: number): void {
        must(count <= this.left, "it has more numbers than such a section may have");
        this.left -= count;
    }

    /** Returns numbers, which are stored by planes of bytes. */
    numbers(count: number): Uint32Array {
        const planes = this.take(1)[0];
        must(planes <= 4, "a number takes too many bytes");
        if (planes === 0) this.charge(count);
        else this.charge(0);
        must(
            planes === 0 || this.at + planes * count <= this.bytes.length,
            "its content ends too early",
        );
        const numbers = new Uint32Array(count);
        for (let plane = 0; plane < planes; plane++) {
            const bytes = this.take(count);
            const shift = 8 * plane;
            for (let i = 0; i < count; i++) numbers[i] |= bytes[i] << shift;
        }
        return numbers;
    }

    /** Returns the next number. */
    one(): number {
        return this.numbers(1)[0];
    }

    /** Returns signed numbers. */
    signed(count: number): Int32Array {
        const numbers = this.numbers(count);
        for (let i = 0; i < count; i++) numbers[i] = (numbers[i] >>> 1) ^ -(numbers[i] & 1);
        return new Int32Array(numbers.buffer);
    }

    /** Returns signed numbers of up to eight bytes. */
    signedLong(count: number): BigInt64Array {
        const planes = this.take(1)[0];
        must(planes <= 8, "a number takes too many bytes");
        if (planes === 0) this.charge(count);
        must(
            planes === 0 || this.at + planes * count <= this.bytes.length,
            "its content ends too early",
        );
        const long = new BigUint64Array(count);
        const bytes = new Uint8Array(long.buffer);
        for (let plane = 0; plane < planes; plane++) {
            this.take(count).forEach((byte, i) => (bytes[8 * i + plane] = byte));
        }
        return new BigInt64Array(long.map((n) => (n >> 1n) ^ -(n & 1n)).buffer);
    }

    /** Returns the bytes of an adaptive coder that hold a number of elements. */
    coded(elements: number): Uint8Array {
        const length = this.one();
        this.charge(elements);
        return this.take(length);
    }

    /** Returns a text. */
    text(): string {
        const bytes = this.take(this.one());
        try {
            return new TextDecoder("utf-8", { fatal: true, ignoreBOM: true }).decode(bytes);
        } catch {
            must(false, "a name is not UTF-8");
        }
    }

    /** Throws damage if something follows the last stream. */
    end(): void {
        must(this.at === this.bytes.length, "unexpected data after its last stream");
    }
}
