/** Attributes and labels of one block. */

import { must } from "../../error.ts";
import { bitsFor } from "../../packed/reader.ts";
import { unfold } from "../../wedges/octahedral.ts";
import { NONE } from "../block_shape.ts";
import type { BlockFaces, BlockShape } from "../block_shape.ts";
import type { Symbols } from "../symbols.ts";
import { LayerCoder } from "./coder.ts";
import { decodeDirections } from "./directions.ts";
import type { Guess } from "./directions.ts";
import { BY_NEIGHBOURS, ENTRY_BITS } from "./format.ts";
import type { LayerFormat, LayersFormat, Predictor } from "./format.ts";
import type { LayerJob } from "./job.ts";
import { normalAround } from "./normals.ts";
import { TangentFrame } from "./tangents.ts";
import { decodeUvs } from "./uvs.ts";
import { decodeValues } from "./values.ts";
import { LayerEntries, decodeWedges } from "./wedges.ts";
import type { BlockWedges } from "./wedges.ts";

/** Integers of a layer in a block, entry by entry, and the entry of each wedge. */
export interface BlockLayer {
    ofWedge: Uint16Array;
    ofCorner: Uint16Array;
    numbers: Int32Array;
}

/** What a block has besides positions and faces. */
export interface BlockLayers {
    wedges: BlockWedges;
    layers: BlockLayer[];
    /** Materials and objects of the faces. */
    labels: (Uint32Array | null)[];
}

/** Decodes what follows the tags of a block, which has at most a number of values. */
export function decodeLayers(
    shape: BlockShape,
    format: LayersFormat,
    symbols: Symbols,
    mostValues: number,
): BlockLayers {
    const coder = new LayerCoder(symbols, format);
    let wedges: BlockWedges = { ofCorner: new Uint16Array(0), vertex: [] };
    if (format.layers.length > 0) wedges = decodeWedges(shape.faces, coder);
    const width = format.layers.reduce((sum, { coding }) => sum + coding.width, 0);
    must(wedges.vertex.length * width <= mostValues, "it has more values than its bytes allow");
    const decoder = new BlockDecoding(shape, format, coder, wedges);
    const labels = format.labels.map(({ names, bits }) =>
        names ? decodeLabels(shape.faces, names.length, bits, coder) : null,
    );
    return { wedges, layers: decoder.layers, labels };
}

/** Decodes all layers of a block. */
class BlockDecoding {
    readonly layers: BlockLayer[] = [];

    constructor(
        private readonly shape: BlockShape,
        private readonly format: LayersFormat,
        private readonly coder: LayerCoder,
        private readonly wedges: BlockWedges,
    ) {
        // Tangents follow from texture coordinates and normals.
        const isLast = (layer: LayerFormat) => layer.predictor === "tangents";
        for (const last of [false, true]) {
            format.layers.forEach((layer, i) => {
                if (isLast(layer) === last) this.layers[i] = this.decode(layer);
            });
        }
    }

    private decode(layer: LayerFormat): BlockLayer {
        const { shape, coder, wedges } = this;
        const entries = new LayerEntries(wedges, coder, layer.bits);
        const numbers = new Int32Array(layer.most.length * entries.length);
        const job: LayerJob = { shape, entries, layer, coder, numbers };
        if (layer.predictor === "uvs") decodeUvs(job);
        else if (layer.predictor === "values") decodeValues(job);
        else this.decodeDirections(job);
        return { ofWedge: entries.ofWedge, ofCorner: entries.ofCorner, numbers };
    }

    private decodeDirections(job: LayerJob): void {
        const { layer, entries } = job;
        const { mode } = layer;
        const isTangents = layer.predictor === "tangents";
        const frame = isTangents ? this.tangentFrame() : null;
        let guess: (entry: number) => Guess;
        let trust = (isTangents ? mode : Math.floor(mode / 3)) / 8;
        if (mode === BY_NEIGHBOURS) {
            guess = () => ({ direction: [0, 0, 0], bend: 0, isOpen: false });
            trust = 1;
        } else if (frame) {
            guess = (entry) => frame.guess(entry, entries);
        } else {
            guess = (entry) => normalAround(entry, entries, this.shape, mode % 3);
        }
        decodeDirections(job, guess, trust);
        frame?.decodeSigns(job, layer.bits + ENTRY_BITS);
    }

    /** Returns the first texture coordinates and normals, which come before all tangents. */
    private tangentFrame(): TangentFrame {
        const uv = this.ofCorners("uvs", 2, (numbers, at, to, place) => {
            to[place] = numbers[at];
            to[place + 1] = numbers[at + 1];
        });
        const normal = this.ofCorners("normals", 3, (numbers, at, to, place, last) =>
            unfold(numbers[at], numbers[at + 1], last, to, place),
        );
        return new TangentFrame(this.shape, uv, normal);
    }

    /** Returns values of all corners from the two numbers of the first layer of a kind. */
    private ofCorners(
        predictor: Predictor,
        width: number,
        write: (
            numbers: Int32Array,
            at: number,
            to: Float64Array,
            place: number,
            last: number,
        ) => void,
    ): Float64Array | null {
        const found = this.format.layers.findIndex((layer) => layer.predictor === predictor);
        if (found < 0) return null;
        const { ofCorner, numbers } = this.layers[found];
        const last = this.format.layers[found].most[0];
        const values = new Float64Array(width * ofCorner.length);
        ofCorner.forEach((entry, corner) =>
            write(numbers, 2 * entry, values, width * corner, last),
        );
        return values;
    }
}

/** Decodes the label of each face, one of a number of names. */
function decodeLabels(
    { twins }: BlockFaces,
    count: number,
    context: number,
    coder: LayerCoder,
): Uint32Array {
    const labels = new Uint32Array(twins.length / 3);
    for (let face = 0; face < labels.length; face++) {
        const tried: number[] = [];
        let label = -1;
        for (let k = 0; k < 3 && label < 0; k++) {
            const twin = twins[3 * face + k];
            const across = twin === NONE ? face : Math.floor(twin / 3);
            const isLast = k === 2 && tried.length === 0 && face > 0;
            if (across >= face && !isLast) continue;
            const other = labels[across < face ? across : face - 1];
            if (tried.includes(other)) continue;
            if (coder.bit(context + tried.length)) label = other;
            tried.push(other);
        }
        if (label < 0) label = coder.number(bitsFor(count));
        must(label < count, "a face has a label that does not exist");
        labels[face] = label;
    }
    return labels;
}
