/** An attribute layer of `.mlq` and `.mlz`: what it is, and what its integers stand for. */

import type { ByteReader } from "./reader.ts";
import { KINDS, WIDTHS } from "../wedges/layer.ts";
import type { LayerKind } from "../wedges/layer.ts";
import { unfold } from "../wedges/octahedral.ts";

const LEAST_EXPONENT = -149;
const MOST_EXPONENT = 127;
const MOST_FLOAT = (2 - 2 ** -23) * 2 ** 127;

/** A layer without its values. */
export class LayerCoding {
    /** Number of integers of a wedge. */
    readonly components: number;

    constructor(
        readonly kind: LayerKind,
        /** Number of the set, as of several texture coordinates. */
        readonly set: number,
        readonly name: string,
        /** Number of values of a wedge. */
        readonly width: number,
        /** Greatest error of a value; for directions in radians. */
        readonly maxError: number,
        /** Bits of both integers of a direction, or null. */
        readonly directionBits: number | null,
        private readonly step: number,
        private readonly least: readonly number[],
    ) {
        this.components = directionBits === null ? width : width - 1;
    }

    /** Writes the values that integers stand for, or the nearest ones that are in range. */
    decode(
        numbers: { readonly [at: number]: number },
        at: number,
        to: Float32Array,
        place: number,
    ): void {
        if (this.directionBits !== null) {
            const last = 2 ** this.directionBits - 1;
            unfold(
                Math.min(numbers[at] >>> 0, last),
                Math.min(numbers[at + 1] >>> 0, last),
                last,
                to,
                place,
            );
            if (this.width > 3) to[place + 3] = numbers[at + 2] === 1 ? -1 : 1;
            return;
        }
        for (let k = 0; k < this.width; k++) {
            const value = ((numbers[at + k] >>> 0) + this.least[k]) * this.step;
            to[place + k] = Math.min(Math.max(value, -MOST_FLOAT), MOST_FLOAT);
        }
    }
}

/** Reads what comes before the numbers of a layer. */
export function readLayerCoding(reader: ByteReader): LayerCoding {
    const [tag, set, width] = [reader.u8(), reader.u8(), reader.u8()];
    reader.must(tag < KINDS.length, "a layer has an unknown kind");
    const kind = KINDS[tag];
    const isWidth = width > 0 && (WIDTHS[kind] ?? width) === width;
    reader.must(isWidth, `a layer of kind ${kind} cannot have ${width} values`);
    const maxError = reader.f64();
    const name = reader.text(reader.u16());
    if (kind === "normal" || kind === "tangent") {
        const bits = reader.u8();
        reader.must(bits >= 3 && bits <= 16, `directions cannot have ${bits} bits`);
        return new LayerCoding(kind, set, name, width, maxError, bits, 1, []);
    }
    const exponent = reader.i16();
    const isExponent = exponent >= LEAST_EXPONENT && exponent <= MOST_EXPONENT;
    reader.must(isExponent, `a step of 2^${exponent} is out of range for f32`);
    const least = Array.from({ length: width }, () => reader.i32());
    return new LayerCoding(kind, set, name, width, maxError, null, 2 ** exponent, least);
}
