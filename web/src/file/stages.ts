/** Stages of updates, which mostly rise with errors. */

import { must } from "../error.ts";
import { NEAR, NumberModels, SIZES } from "./number_models.ts";
import { RangeDecoder } from "./range_coder.ts";
import type { Streams } from "./streams.ts";

/** Number of stages. */
export const STAGES = 256;

/** Reads the stages of updates, given their errors minus the least one. */
export function readStages(errorSteps: Uint32Array, input: Streams): Uint8Array {
    const least = input.one();
    const decoder = new RangeDecoder(input.coded(errorSteps.length));
    const models = new NumberModels();
    const means: (number | undefined)[] = [];
    let last = 0;
    let near = 0;
    const base = errorSteps.reduce((least, step) => Math.min(least, step), Infinity);
    const stages = new Uint8Array(errorSteps.length);
    errorSteps.forEach((step, i) => {
        const own = Math.min((step - base) >> 2, SIZES - 1);
        const mean = means[own] ?? last;
        const residual = models.decode(decoder, 0, own, near);
        const above = Math.min(Math.max((((mean + 8) >> 4) + residual) | 0, 0), STAGES);
        near = Math.min(Math.abs(residual), NEAR - 1);
        means[own] = mean + Math.trunc((16 * above - mean) / 4);
        last = 16 * above;
        must(above + least < STAGES, "a stage is out of range");
        stages[i] = above + least;
    });
    must(decoder.isAtEnd, "it has more stages than updates");
    return stages;
}
