/** Attribute layers: what their integers stand for. */

import { must } from "../error.ts";
import type { Streams } from "../file/streams.ts";
import { unfold } from "./octahedral.ts";

/** Kinds of layers, in the order of their numbers in files. */
export const KINDS = [
    "normal",
    "uv",
    "color",
    "tangent",
    "joints",
    "weights",
    "other",
    "labels",
] as const;
export type LayerKind = (typeof KINDS)[number];

/** Number of values of a wedge, for kinds that have only one. */
export const WIDTHS: Partial<Record<LayerKind, number>> = {
    normal: 3,
    uv: 2,
    tangent: 4,
    joints: 4,
    weights: 4,
};
const MOST_WIDTH = 64;
const MOST_LAYERS = 4096;
const LEAST_EXPONENT = -149;
const MOST_EXPONENT = 104;

/** Codings of values: by bits of `f32`, as multiples of a power of two, as directions. */
const BITS = 0;
const STEPS = 1;
const DIRECTIONS = 2;

/** An attribute of wedges. */
export class Layer {
    /** Number of integers of a wedge, and the first of them among those of all layers. */
    readonly columns: number;
    /** Bits of each coordinate of a direction, if it is one. */
    readonly directionBits: number | null;
    private readonly step: number;

    constructor(
        readonly kind: LayerKind,
        /** Number of the set, as of several texture coordinates. */
        readonly set: number,
        readonly name: string,
        /** Number of values of a wedge. */
        readonly width: number,
        private readonly coding: number,
        parameter: number,
        readonly start: number,
    ) {
        this.columns = coding === DIRECTIONS ? width - 1 : width;
        this.directionBits = coding === DIRECTIONS ? parameter : null;
        this.step = coding === STEPS ? 2 ** (parameter + LEAST_EXPONENT) : 1;
    }

    /** How far an integer of a split wedge may be off, as half of the steps at most. */
    leeway(column: number): number {
        if (this.coding === DIRECTIONS) return column < 2 ? 6 : 0;
        if (this.coding === BITS) return 0;
        return this.kind === "uv" ? 1 : this.kind === "color" ? 7 : 0;
    }

    /**
     * Decodes the values of a wedge, whose integers start at a place of `rows`; false if one is not
     * finite.
     */
    decode(rows: Int32Array, at: number, to: Float32Array, place: number): boolean {
        if (this.directionBits !== null) {
            const last = 2 ** this.directionBits - 1;
            const clamp = (x: number) => Math.min(Math.max(x, 0), last);
            unfold(clamp(rows[at]), clamp(rows[at + 1]), last, to, place);
            if (this.width > 3) to[place + 3] = rows[at + 2] === 1 ? -1 : 1;
            return true;
        }
        let isFinite = true;
        for (let k = 0; k < this.width; k++) {
            to[place + k] =
                this.coding === STEPS ? rows[at + k] * this.step : floatOf(rows[at + k]);
            isFinite &&= Number.isFinite(to[place + k]);
        }
        return isFinite;
    }
}

const bits = new Int32Array(1);
const float = new Float32Array(bits.buffer);

/** Returns the `f32` of an integer in the order of the values. */
function floatOf(number: number): number {
    bits[0] = number < 0 ? number ^ 0x7fffffff : number;
    return float[0];
}

/** Reads the layers of a file. */
export function readLayers(input: Streams): Layer[] {
    const count = input.one();
    must(count <= MOST_LAYERS, "it has too many attribute layers");
    const layers: Layer[] = [];
    let start = 0;
    for (let i = 0; i < count; i++) {
        const [kind, set, width, coding, parameter] = input.numbers(5);
        const layer = new Layer(KINDS[kind], set, input.text(), width, coding, parameter, start);
        must(
            kind < KINDS.length && set < 256 && isCoding(layer.kind, width, coding, parameter),
            "an attribute layer is invalid",
        );
        layers.push(layer);
        start += layer.columns;
    }
    return layers;
}

function isCoding(kind: LayerKind, width: number, coding: number, parameter: number): boolean {
    const isWidth = width >= 1 && width <= MOST_WIDTH && (WIDTHS[kind] ?? width) === width;
    const isDirection = kind === "normal" || kind === "tangent";
    if (coding === DIRECTIONS) return isWidth && isDirection && parameter >= 3 && parameter <= 16;
    return (
        isWidth &&
        (coding === BITS || (coding === STEPS && parameter <= MOST_EXPONENT - LEAST_EXPONENT))
    );
}
