/** Lengths as codes of 16 bits, of which errors have 9 and radii 8, in units. */

/** 2⁻²⁸ as bits of `f32`: what code 0 would be were it not taken off. */
const LEAST_BITS = (127 - 28) << 23;
const LEAST = 2 ** -28;
const INFINITE = 0xffff;

const float = new Float32Array(1);
const bits = new Uint32Array(float.buffer);

/** Returns the length of a code of 16 bits. */
export function lengthOf(code: number): number {
    if (code === INFINITE) return Infinity;
    bits[0] = (code << 12) + LEAST_BITS;
    return float[0] - LEAST;
}

/** Returns the least code of 16 bits whose length is no shorter. */
export function lengthCode(length: number): number {
    if (length <= 0) return 0;
    if (!(length < Infinity)) return INFINITE;
    float[0] = length + LEAST;
    let code = Math.min((bits[0] - LEAST_BITS) >>> 12, INFINITE);
    while (code < INFINITE && lengthOf(code) < length) code++;
    return code;
}

/** Returns the least code of 8 bits whose radius is no shorter than a length. */
export function radiusCode(length: number): number {
    const code = lengthCode(length) + 255;
    return code >= 0xff00 ? 255 : code >> 8;
}

/** Radii by their codes of 8 bits. */
export const RADII = Float64Array.from({ length: 256 }, (_, code) =>
    lengthOf(code === 255 ? INFINITE : code << 8),
);

/** Errors by their codes of 9 bits. */
export const ERRORS = Float64Array.from({ length: 512 }, (_, code) =>
    lengthOf(code === 511 ? INFINITE : code << 7),
);
