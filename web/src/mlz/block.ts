/** One block of a file: its faces, the cells of its vertices, tags, attributes and labels. */

import { Border, NODES } from "./border.ts";
import { Gates, contextAt } from "./gates.ts";
import type { MlzHeader } from "./header.ts";
import { BlockFaces, BlockShape } from "./block_shape.ts";
import { decodeLayers } from "./layers/block_layers.ts";
import type { BlockLayers } from "./layers/block_layers.ts";
import { Places } from "./place.ts";
import { MAX_NEW, STEP_BITS } from "./tables.ts";
import { Symbols } from "./symbols.ts";
import { must } from "../error.ts";

/** Steps, as they are numbered. */
const [NEW, PREVIOUS, NEXT, NOTHING, OTHER] = [0, 1, 2, 3, 4];
/** Where other nodes mostly are along the loop, and where their slots of 256 start. */
const NEARBY = [-2, -3, -4, 3, 4, -5, 5];
const NEARBY_STARTS = Uint16Array.of(0, 222, 240, 245, 249, 251, 253, 254, 256);
/** Starts of steps after fans: a new vertex, the next one, those nearby, any other. */
const RARE = Uint16Array.of(0, 4, 40, 226, 240, 244, 248, 250, 252, 254, 256);
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
    /** Faces of the block, and the number of their corners so far. */
    private faces = new Uint16Array(0);
    private at = 0;

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
        this.faces = new Uint16Array(3 * count);
        for (this.at = 0; this.at < this.faces.length;) {
            const pivot = border.pivot();
            if (pivot < 0) {
                const first = gates.addCorners();
                border.start(first);
                for (let k = 0; k < 3; k++) this.faces[this.at++] = first + k;
            } else if (this.header.hasFans) {
                this.fan(symbols, pivot);
            } else {
                this.add(pivot, symbols.among(this.stepsAt(pivot), STEP_BITS), symbols);
            }
        }
        return this.faces;
    }

    /** Decodes a fan: new vertices, and how it ends. */
    private fan(symbols: Symbols, at: number): void {
        const fan = symbols.among(this.header.models.fans[contextAt(this.border, at)], STEP_BITS);
        for (let left = fan % (MAX_NEW + 1); left > 0; left--) {
            this.add(at, NEW, symbols);
            if (this.at === this.faces.length) return;
        }
        const end = Math.floor(fan / (MAX_NEW + 1));
        if (end < 2) {
            this.add(at, end === 0 ? PREVIOUS : NOTHING, symbols);
            return;
        }
        const rare = symbols.among(RARE, NEARBY_BITS);
        if (rare < 2) this.add(at, rare === 0 ? NEW : NEXT, symbols);
        else this.add(at, OTHER, symbols, this.nearby(symbols, at, rare - 2));
    }

    private stepsAt(at: number): Uint16Array {
        return this.header.models.steps[contextAt(this.border, at)];
    }

    /** Does a step, and adds its face. */
    private add(at: number, step: number, symbols: Symbols, other = -1): void {
        const { border, gates } = this;
        const a = border.vertex[at];
        const b = border.vertex[border.next[at]];
        let third: number;
        if (step === NEW) third = border.addNew(at, gates.add(border, at));
        else if (step === PREVIOUS) third = border.addPrevious(at);
        else if (step === NEXT) third = border.addNext(at);
        else if (step === NOTHING) {
            border.close(at);
            return;
        } else {
            const node = other < 0 ? this.other(symbols, at) : other;
            third = border.addOther(at, node);
        }
        this.faces[this.at++] = b;
        this.faces[this.at++] = a;
        this.faces[this.at++] = third;
    }

    private other(symbols: Symbols, at: number): number {
        return this.nearby(symbols, at, symbols.among(NEARBY_STARTS, NEARBY_BITS));
    }

    /** Returns a node that is often hit, given its number, or else one whose number follows. */
    private nearby(symbols: Symbols, at: number, which: number): number {
        if (which < NEARBY.length) return this.border.along(at, NEARBY[which]);
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
