/** Models of numbers by their role and two contexts. */

import { BitModels } from "./range_coder.ts";
import type { RangeDecoder } from "./range_coder.ts";

export const ROLES = 3;
/** Numbers of bits of absolute values. */
const CLASSES = 33;
/** First and second contexts. */
export const SIZES = 48;
export const NEAR = 16;

const BY_NEAR = ROLES * SIZES * CLASSES;
const BELOW = BY_NEAR + ROLES * NEAR * CLASSES;
const COUNT = BELOW + ROLES * CLASSES * 8;

/** Returns the number of bits of the absolute value of a number. */
export function classOf(number: number): number {
    return 32 - Math.clz32(Math.abs(number));
}

/** Models of numbers that are alike. */
export class NumberModels {
    private readonly models = new BitModels(COUNT);

    /** Decodes a number. */
    decode(decoder: RangeDecoder, role: number, size: number, near: number): number {
        const { models } = this;
        const bySize = (role * SIZES + size) * CLASSES;
        const byNear = BY_NEAR + (role * NEAR + near) * CLASSES;
        let bits = 0;
        while (bits < CLASSES - 1 && models.bit(decoder, bySize + bits, byNear + bits)) bits++;
        if (bits === 0) return 0;
        const below = BELOW + (role * CLASSES + bits) * 8;
        let coded = 1;
        let left = bits - 1;
        for (; left > 0 && coded < 4; left--) {
            // The first bit has models of its own, the second one for each value of the first.
            const own = below + 2 * coded;
            coded = (coded << 1) | models.bit(decoder, own, own + 1);
        }
        if (left > 0) coded = (coded * 2 ** left + decoder.plain(left)) >>> 0;
        const isNegative = models.bit(decoder, below, below + 1);
        return (isNegative ? -coded : coded) | 0;
    }
}
