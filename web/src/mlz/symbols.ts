/** Symbols of a block, by range asymmetric numeral systems. */

import { must } from "../error.ts";
import { ESCAPE, MAX_RESIDUAL, RESIDUAL_BITS } from "./tables.ts";
import type { ResidualTable } from "./tables.ts";

const LEAST_STATE = 0x10000;
/** Most bits of a raw number that are read at once, and most that are coded below a symbol. */
const CHUNK_BITS = 12;
const JOINT_LOW_BITS = 5;

/** Reads symbols; zeros follow the last word. */
export class Symbols {
    private state: number;
    private at = 4;

    constructor(private readonly bytes: Uint8Array) {
        const isState = bytes.length >= 4 && bytes.length % 2 === 0;
        this.state = isState
            ? (bytes[0] | (bytes[1] << 8) | (bytes[2] << 16) | (bytes[3] << 24)) >>> 0
            : 0;
        must(this.state >= LEAST_STATE, "it does not start with a state of the coder");
    }

    /** Returns the slot of the next symbol in a table of 2^`bits`. */
    place(bits: number): number {
        return this.state & ((1 << bits) - 1);
    }

    /**
     * Goes behind the next symbol, given its size and how far its slot is behind its start. Returns
     * its low bits.
     */
    consume(bits: number, size: number, offset: number, lowBits: number): number {
        const state = (Math.imul(size, this.state >>> bits) + offset) >>> 0;
        const low = state & ((1 << lowBits) - 1);
        const left = state >>> lowBits;
        if (left < LEAST_STATE) {
            const { bytes, at } = this;
            const word = at < bytes.length ? bytes[at] | (bytes[at + 1] << 8) : 0;
            this.state = ((left << 16) | word) >>> 0;
            this.at = at + 2;
        } else {
            this.state = left;
        }
        return low;
    }

    /** Returns one of several symbols, given where they start, and the end, of 2^`bits`. */
    among(starts: Uint16Array, bits: number): number {
        const place = this.place(bits);
        let symbol = 0;
        while (place >= starts[symbol + 1]) symbol++;
        this.consume(bits, starts[symbol + 1] - starts[symbol], place - starts[symbol], 0);
        return symbol;
    }

    /** Returns a number of a known length, up to 32 bits. */
    number(bits: number): number {
        let number = 0;
        for (let at = 0; at < bits; at += CHUNK_BITS) {
            const chunk = Math.min(bits - at, CHUNK_BITS);
            number |= this.consume(0, 1, 0, chunk) << at;
        }
        return number >>> 0;
    }

    /** Returns a number with its length before it. */
    free(): number {
        return this.number(this.number(5));
    }

    /** Returns the difference of a number from its prediction. */
    residual(table: ResidualTable, lowBits: number): number {
        const entry = table.places[this.place(RESIDUAL_BITS)];
        const symbol = entry & 63;
        const joint = lowBits <= JOINT_LOW_BITS ? lowBits : 0;
        let low = this.consume(RESIDUAL_BITS, (entry >>> 6) & 0xfff, entry >>> 18, joint);
        if (joint < lowBits) low = this.number(lowBits);
        let far = symbol - MAX_RESIDUAL;
        if (symbol === ESCAPE) {
            const isBelow = this.number(1) === 1;
            far = isBelow ? -this.free() : this.free();
        }
        return ((far << lowBits) + low - ((1 << lowBits) >> 1)) | 0;
    }

    /** Throws damage unless all symbols have been read and the checksum matches. */
    end(checksum: number): void {
        const isEnd = this.state === LEAST_STATE + checksum;
        const isPadded = this.bytes.subarray(this.at).every((byte) => byte === 0);
        must(isEnd && isPadded, "its checksum does not match: the block is damaged");
    }
}
