/** Probabilities of residuals and of steps, from the codes of the header. */

import { eighthPower } from "../packed/eighths.ts";

/** Bits of the tables of residuals, and the greatest residual with a symbol of its own. */
export const RESIDUAL_BITS = 11;
export const MAX_RESIDUAL = 24;
/** The symbol of all other residuals. */
export const ESCAPE = 2 * MAX_RESIDUAL + 1;
const SLOTS = 1 << RESIDUAL_BITS;
const FREEDOM = [1, 3, 5, 7, 9, 13, 19, 31];

/** For each slot the symbol in 6 bits, its size in 12, and how far the slot is behind its start. */
export interface ResidualTable {
    readonly places: Uint32Array;
}

/** Returns the table of a class of widths with the code of its shape. */
export function residualTable(kind: number, code: number): ResidualTable {
    const parts = studentParts(kind, code);
    const all = parts.reduce((sum, part) => sum + part, 0);
    const sizes = parts.map((part) => Math.trunc((part / all) * SLOTS + 0.5));
    sizes[ESCAPE] = Math.max(sizes[ESCAPE], 1);
    sizes[MAX_RESIDUAL] += SLOTS - sizes.reduce((sum, size) => sum + size, 0);
    const places = new Uint32Array(SLOTS);
    let at = 0;
    sizes.forEach((size, symbol) => {
        for (let offset = 0; offset < size; offset++)
            places[at++] = (offset << 18) | (size << 6) | symbol;
    });
    return { places };
}

/** Integrates Student's distribution over the cell of each symbol, by Simpson's rule. */
function studentParts(kind: number, code: number): number[] {
    const width = eighthPower(2 * kind - 15 + (code & 31) - 16);
    const freedom = FREEDOM[code >> 5];
    const scale = 1 / (width * width * freedom);
    const density = (x: number) => {
        const part = 1 / (1 + x * x * scale);
        let product = 1;
        for (let i = 0; i < (freedom + 1) / 2; i++) product *= part;
        return product;
    };
    const parts = new Array<number>(ESCAPE + 1).fill(0);
    for (let d = 0; d <= MAX_RESIDUAL; d++) {
        const outer = density(d - 0.5) + density(d + 0.5);
        const part = (outer + 4 * (density(d - 0.25) + density(d + 0.25)) + 2 * density(d)) / 12;
        parts[MAX_RESIDUAL + d] = part;
        parts[MAX_RESIDUAL - d] = part;
    }
    let beyond = 0;
    for (let k = 0; k < 20; k++) beyond += density(MAX_RESIDUAL + 4 + 8 * k);
    parts[ESCAPE] = 16 * beyond;
    return parts;
}

/** Bits of the tables of steps, and the number of steps. */
export const STEP_BITS = 12;
export const STEPS = 5;

/** Returns where each step starts, and the end, from the codes of their frequencies. */
export function stepTable(codes: readonly number[]): Uint16Array {
    const parts = codes.map((code) =>
        Math.max([65536, 52016, 41285][code % 3] >> Math.floor(code / 3), 1),
    );
    const all = parts.reduce((sum, part) => sum + part, 0);
    const sizes = parts.map((part) =>
        Math.max(Math.floor((part * ((1 << STEP_BITS) - 8)) / all), 1),
    );
    return startsOf(sizes, 1 << STEP_BITS);
}

/** Most new vertices of a fan, and the number of fans: three ends after each number of them. */
export const MAX_NEW = 7;
export const FANS = 3 * (MAX_NEW + 1);

/** Returns where each fan starts, and the end, given where the steps start after some vertices. */
export function fanTable(steps: (added: number) => Uint16Array): Uint16Array {
    const whole = 1 << STEP_BITS;
    const sizes = new Array<number>(FANS);
    let part = 1;
    for (let added = 0; added <= MAX_NEW; added++) {
        const starts = steps(added);
        const size = (step: number) => starts[step + 1] - starts[step];
        const rare = added < MAX_NEW ? size(2) + size(4) : whole - size(1) - size(3);
        [size(1), size(3), rare].forEach((size, end) => {
            sizes[end * (MAX_NEW + 1) + added] = Math.max(Math.floor(part * size + 0.5), 1);
        });
        part *= size(0) / whole;
    }
    return startsOf(sizes, whole);
}

/** Returns where each size starts; the last of the greatest ones gets what is left. */
function startsOf(sizes: number[], whole: number): Uint16Array {
    const most = sizes.lastIndexOf(Math.max(...sizes));
    sizes[most] += whole - sizes.reduce((sum, size) => sum + size, 0);
    const starts = new Uint16Array(sizes.length + 1);
    sizes.forEach((size, k) => (starts[k + 1] = starts[k] + size));
    return starts;
}
