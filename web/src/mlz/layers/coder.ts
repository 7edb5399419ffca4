/** Decisions of the layers of a block: bits whose chances follow those before, and residuals. */

import type { Symbols } from "../symbols.ts";
import type { LayersFormat, ResidualModel } from "./format.ts";

const BIT_BITS = 12;
const SLOTS = 1 << BIT_BITS;
const LEAST = 8;

/** Reads the decisions of one block. */
export class LayerCoder {
    private readonly chances: Uint16Array;
    private readonly models: readonly ResidualModel[];

    constructor(
        private readonly symbols: Symbols,
        format: LayersFormat,
    ) {
        this.chances = format.chances.slice();
        this.models = format.models;
    }

    /** Returns a bit of a context. */
    bit(context: number): boolean {
        const { symbols, chances } = this;
        const chance = chances[context];
        const place = symbols.place(BIT_BITS);
        const bit = place >= chance;
        if (bit) symbols.consume(BIT_BITS, SLOTS - chance, place - chance, 0);
        else symbols.consume(BIT_BITS, chance, place, 0);
        const to = bit ? LEAST : SLOTS - LEAST;
        chances[context] = chance + Math.trunc((to - chance) / 32);
        return bit;
    }

    /** Returns the difference of a number from its prediction. */
    residual(context: number): number {
        const { table, lowBits } = this.models[context];
        return this.symbols.residual(table, lowBits);
    }

    /** Returns one of 2^`bits` equally likely numbers. */
    number(bits: number): number {
        return this.symbols.number(bits);
    }
}

const LEVELS = [0.3, 1, 2, 4, 8, 16, 48];

/** Sizes of the residuals of entries, from which those of the next one are guessed. */
export class Energy {
    private readonly sizes: Float64Array;
    private sum = 0;
    private count = 0;

    constructor(entries: number) {
        this.sizes = new Float64Array(entries);
    }

    clear(): void {
        this.sum = 0;
        this.count = 0;
    }

    /** Adds a neighbour. */
    see(entry: number): void {
        this.sum += this.sizes[entry];
        this.count++;
    }

    /** Returns the mean over the neighbours, 0 without any. */
    around(): number {
        return this.sum / Math.max(this.count, 1);
    }

    /** Adds a residual of an entry. */
    add(entry: number, size: number): void {
        this.sizes[entry] += size;
    }

    /** Returns the level of a size. */
    static level(size: number): number {
        let level = 0;
        while (level < LEVELS.length && size > LEVELS[level]) level++;
        return level;
    }
}

/** Returns the integer nearest to a prediction, from 0 to `most`. */
export function nearest(x: number, most: number): number {
    return Math.min(Math.max(Math.floor(x + 0.5), 0), most) | 0;
}
