/** Models that all blocks of a file share, from the codes of the header. */

import { eighthPower } from "../packed/eighths.ts";
import { BitReader } from "../packed/reader.ts";
import type { ByteReader } from "../packed/reader.ts";
import { CONTEXTS, KINDS } from "./gates.ts";
import { STEPS, fanTable, residualTable, stepTable } from "./tables.ts";
import type { ResidualTable } from "./tables.ts";

const FEATURES = 5;
const CLASSES = 16;
const CODE_BITS = 5;

/** Models of positions and faces. */
export interface Models {
    /** For each kind of gate five weights, and the variances along the surface and across it. */
    gates: Float32Array[];
    /** Variance of the corners of a face without a gate. */
    start: number;
    residuals: ResidualTable[];
    /** For each context the starts of the steps. */
    steps: Uint16Array[];
    /** For each context the starts of the fans. */
    fans: Uint16Array[];
}

/** Reads the models. */
export function readModels(reader: ByteReader): Models {
    const gates = Array.from({ length: KINDS }, () => new Float32Array(FEATURES + 2));
    for (const gate of gates) for (let k = 0; k < FEATURES; k++) gate[k] = reader.i8() / 64;
    for (const gate of gates) {
        for (let k = FEATURES; k < FEATURES + 2; k++) gate[k] = eighthPower(32 - reader.u8());
    }
    const start = Math.fround(eighthPower(2 * reader.u8()));
    const residuals = Array.from({ length: CLASSES }, (_, kind) =>
        residualTable(kind, reader.u8()),
    );
    const bits = new BitReader(reader);
    const codes = Array.from({ length: CONTEXTS + 1 }, () => {
        if (bits.take(1) === 0) return null;
        return Array.from({ length: STEPS }, () => bits.take(CODE_BITS));
    });
    const rest = codes[CONTEXTS] ?? new Array<number>(STEPS).fill(6);
    const steps = codes.slice(0, CONTEXTS).map((own) => stepTable(own ?? rest));
    // Each new vertex adds a face to the fan's, and has one itself.
    const after = (context: number, added: number) =>
        24 * Math.min(Math.floor(context / 24) + added, 6) + (context & 2);
    const fans = steps.map((own, context) =>
        fanTable((added) => (added === 0 ? own : steps[after(context, added)])),
    );
    return { gates, start, residuals, steps, fans };
}
