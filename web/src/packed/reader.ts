/** Little-endian numbers and bits from bytes that may be damaged. */

import { Damage, must } from "../error.ts";

/** Reads consecutive bytes, and throws damage with the place where they end too early. */
export class ByteReader {
    private readonly view: DataView;

    /** Reads `bytes` from a place to their end. */
    constructor(
        private readonly bytes: Uint8Array,
        public at = 0,
    ) {
        this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    }

    /** Number of bytes that are left, by which counts can be checked. */
    get left(): number {
        return this.bytes.length - this.at;
    }

    /** Returns the place of the next bytes, and goes on behind them. */
    private skip(count: number): number {
        if (!(count <= this.left)) this.fail(`expected ${count} more bytes, found ${this.left}`);
        this.at += count;
        return this.at - count;
    }

    /** Throws damage at the current place. */
    fail(why: string): never {
        throw new Damage(`${why} (at byte ${this.at})`);
    }

    /** Throws damage at the current place unless something holds. */
    must(holds: boolean, why: string): asserts holds {
        if (!holds) this.fail(why);
    }

    take(count: number): Uint8Array {
        const at = this.skip(count);
        return this.bytes.subarray(at, at + count);
    }

    u8(): number {
        return this.view.getUint8(this.skip(1));
    }

    i8(): number {
        return this.view.getInt8(this.skip(1));
    }

    u16(): number {
        return this.view.getUint16(this.skip(2), true);
    }

    i16(): number {
        return this.view.getInt16(this.skip(2), true);
    }

    u32(): number {
        return this.view.getUint32(this.skip(4), true);
    }

    i32(): number {
        return this.view.getInt32(this.skip(4), true);
    }

    /** Returns a number of 64 bits; inexact beyond 2⁵³, where no count can be right. */
    u64(): number {
        return Number(this.view.getBigUint64(this.skip(8), true));
    }

    i64(): bigint {
        return this.view.getBigInt64(this.skip(8), true);
    }

    f32(): number {
        return this.view.getFloat32(this.skip(4), true);
    }

    f64(): number {
        return this.view.getFloat64(this.skip(8), true);
    }

    /** Returns a text of a number of bytes. */
    text(length: number): string {
        try {
            return new TextDecoder("utf-8", { fatal: true, ignoreBOM: true }).decode(
                this.take(length),
            );
        } catch (error) {
            if (error instanceof Damage) throw error;
            this.fail("a name is not UTF-8");
        }
    }

    /** Returns the names of materials or objects, or null if faces have none. */
    names(): string[] | null {
        const count = this.u32();
        if (count === 0) return null;
        this.must(4 * (count - 1) <= this.left, "there are more names than bytes");
        return Array.from({ length: count - 1 }, () => this.text(this.u32()));
    }

    /** Throws damage if something is left. */
    end(): void {
        if (this.left > 0) this.fail(`${this.left} unexpected bytes at the end`);
    }
}

/** Reads numbers of any width, from the lowest bit of each byte on. */
export class BitReader {
    private held = 0;
    private count = 0;

    constructor(private readonly reader: ByteReader) {}

    /** Returns a number of at most 32 bits. */
    take(width: number): number {
        if (width > 16) return this.take(16) + this.take(width - 16) * 0x10000;
        while (this.count < width) {
            this.held |= this.reader.u8() << this.count;
            this.count += 8;
        }
        const number = this.held & ((1 << width) - 1);
        this.held >>>= width;
        this.count -= width;
        return number;
    }
}

/** Bits in memory, which are read at any place. */
export class Bits {
    /** Number of bits. */
    readonly length: number;

    constructor(private readonly bytes: Uint8Array) {
        this.length = 8 * bytes.length;
    }

    /** Returns the number in at most 32 bits from a place on; zeros follow the last bit. */
    get(at: number, width: number): number {
        const { bytes } = this;
        let number = 0;
        let have = 0;
        let byte = Math.floor(at / 8);
        let shift = at % 8;
        while (have < width) {
            const part = (bytes[byte++] ?? 0) >>> shift;
            number += part * 2 ** have;
            have += 8 - shift;
            shift = 0;
        }
        return have === width ? number : number % 2 ** width;
    }

    /** Returns the number in any number of bits from a place on. */
    getBig(at: number, width: number): bigint {
        let number = 0n;
        for (let have = 0; have < width; have += 32) {
            const part = this.get(at + have, Math.min(width - have, 32));
            number |= BigInt(part) << BigInt(have);
        }
        return number;
    }

    /** Throws damage unless there are bits up to a place. */
    reach(end: number): void {
        must(end <= this.length, "its bits end too early");
    }
}

/** Reads consecutive numbers of bits in memory. */
export class BitCursor {
    constructor(
        private readonly bits: Bits,
        public at: number,
    ) {}

    /** Returns the next number, of at most 32 bits. */
    next(width: number): number {
        this.bits.reach(this.at + width);
        this.at += width;
        return this.bits.get(this.at - width, width);
    }
}

/** Returns how many bits tell a number of values apart. */
export function bitsFor(count: number): number {
    return count > 1 ? 32 - Math.clz32(count - 1) : 0;
}
