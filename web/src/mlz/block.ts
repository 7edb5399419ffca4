/** One block of a file: its faces, the cells of its vertices, tags, attributes and labels. */

import { Border, NODES } from "./border.ts";
import { Gates, contextAt } from "./gates.ts";
import type { MlzHeader } from "./header.ts";
import { BlockFaces, BlockShape } from "./block_shape.ts";
import { decodeLayers } from "./layers/block_layers.ts";
import type { BlockLayers } from "./layers/block_layers.ts";
import { Places } from "./place.ts";
import { STEP_BITS } from "./tables.ts";
import { Symbols } from "./symbols.ts";
import { must } from "../error.ts";

/** Steps, as they are numbered. */
const [NEW, PREVIOUS, NEXT, NOTHING] = [0, 1, 2, 3];
/** Where other nodes mostly are along the loop, and their slots of 256. */
const NEARBY = [
    [-2, 222],
    [-3, 18],
    [-4, 5],
    [3, 4],
    [4, 2],
    [-5, 2],
    [5, 1],
] as const;
const NEARBY_BITS = 8;
const NODE_BITS = 12;
const VALUES_PER_BYTE = 256;
/** Halves of the factor of the checksum, 2⁶⁴ / golden ratio. */
const MIX_HIGH = 0x9e3779b9;
const MIX_LOW = 0x7f4a7c15;

/** A vertex that no other block has. */
export const INSIDE = -1;

/** What a block holds; the arrays are good until the next one is decoded. */
export interface Block {
    vertices: number;
    /** Three coordinates of each vertex. */
    cells: Float32Array;
    faces: Uint16Array;
    /** Tag of each vertex that other blocks may have, otherwise `INSIDE`. */
    tags: Float64Array;
    layers: BlockLayers | null;
}

/** Decodes blocks, one after the other. */
export class BlockDecoder {
    private readonly border = new Border();
    private readonly gates = new Gates();
    private readonly places: Places;

    constructor(private readonly header: MlzHeader) {
        this.places = new Places(NODES, header.models);
    }

    /** Decodes a block of a number of faces. */
    decode(bytes: Uint8Array, count: number): Block {
        const { header, gates } = this;
        const symbols = new Symbols(bytes);
        const first = header.firstBits.map((bits) => symbols.number(bits));
        const faces = this.connect(symbols, count);
        const cells = this.places.decode(gates, symbols, first);
        const tags = this.readTags(symbols);
        let layers = null;
        if (header.layers) {
            const shape = new BlockShape(new BlockFaces(faces), cells);
            const most = VALUES_PER_BYTE * bytes.length;
            layers = decodeLayers(shape, header.layers, symbols, most);
        }
        symbols.end(checksum(cells));
        this.places.end();
        return { vertices: gates.length, cells, faces, tags, layers };
    }

    /** Decodes the faces, and the gates of the vertices. */
    private connect(symbols: Symbols, count: number): Uint16Array {
        const { border, gates } = this;
        border.clear();
        gates.length = 0;
        const faces = new Uint16Array(3 * count);
        for (let at = 0; at < faces.length;) {
            const pivot = border.pivot();
            if (pivot < 0) {
                const first = gates.addCorners();
                border.start(first);
                for (let k = 0; k < 3; k++) faces[at++] = first + k;
                continue;
            }
            const a = border.vertex[pivot];
            const b = border.vertex[border.next[pivot]];
            const third = this.step(symbols, pivot);
            if (third < 0) continue;
            faces[at++] = b;
            faces[at++] = a;
            faces[at++] = third;
        }
        return faces;
    }

    /** Decodes a step; returns the third corner of its face, or −1. */
    private step(symbols: Symbols, at: number): number {
        const { border, gates } = this;
        const starts = this.header.models.steps[contextAt(border, at)];
        const place = symbols.place(STEP_BITS);
        let step = 0;
        while (place >= starts[step + 1]) step++;
        symbols.consume(STEP_BITS, starts[step + 1] - starts[step], place - starts[step], 0);
        if (step === NEW) return border.addNew(at, gates.add(border, at));
        if (step === PREVIOUS) return border.addPrevious(at);
        if (step === NEXT) return border.addNext(at);
        if (step !== NOTHING) return border.addOther(at, this.other(symbols, at));
        border.close(at);
        return -1;
    }

    private other(symbols: Symbols, at: number): number {
        const place = symbols.place(NEARBY_BITS);
        let start = 0;
        for (const [by, size] of NEARBY) {
            if (place < start + size) {
                symbols.consume(NEARBY_BITS, size, place - start, 0);
                return this.border.along(at, by);
            }
            start += size;
        }
        symbols.consume(NEARBY_BITS, (1 << NEARBY_BITS) - start, place - start, 0);
        return this.border.known(symbols.number(NODE_BITS));
    }

    private readTags(symbols: Symbols): Float64Array {
        const tags = new Float64Array(this.gates.length).fill(INSIDE);
        this.border.forEachVertex((vertex) => (tags[vertex] = 0));
        if (symbols.number(1) === 0) return tags;
        for (let left = symbols.number(NODE_BITS); left > 0; left--) {
            const vertex = symbols.number(NODE_BITS);
            const tag = symbols.free();
            must(vertex < tags.length, "a tag names a vertex that does not exist");
            tags[vertex] = tag;
        }
        return tags;
    }
}

/** Returns the checksum over the cells of a block, of which the halves of 64 bits are numbers. */
function checksum(cells: Float32Array): number {
    let [low, high] = [0, 0];
    for (let at = 0; at < cells.length; at += 3) {
        const [x, y, z] = [cells[at], cells[at + 1], cells[at + 2]];
        const a = ((low << 23) | (high >>> 9)) ^ (x | (y << 21));
        const b = ((high << 23) | (low >>> 9)) ^ ((y >>> 11) | (z << 10));
        low = Math.imul(a, MIX_LOW);
        high = highProduct(a) + Math.imul(a, MIX_HIGH) + Math.imul(b, MIX_LOW);
    }
    return (high >>> 16) & 0xffff;
}

/** Returns the high 32 bits of a number times the lower half of the factor. */
function highProduct(a: number): number {
    const [low, high] = [a & 0xffff, a >>> 16];
    const [factorLow, factorHigh] = [MIX_LOW & 0xffff, MIX_LOW >>> 16];
    const middle = low * factorHigh + ((low * factorLow) >>> 16);
    const other = high * factorLow + (middle & 0xffff);
    return high * factorHigh + Math.floor(middle / 0x10000) + Math.floor(other / 0x10000);
}
