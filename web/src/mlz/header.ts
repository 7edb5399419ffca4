/** The header of a `.mlz` file and the index of its blocks. */

import { crc32 } from "../file/crc32.ts";
import { BitReader } from "../packed/reader.ts";
import type { ByteReader } from "../packed/reader.ts";
import { MAX_FACES } from "./border.ts";
import { BY_NEIGHBOURS, readLayersFormat } from "./layers/format.ts";
import type { LayersFormat } from "./layers/format.ts";
import { readModels } from "./models.ts";
import type { Models } from "./models.ts";
import { MAX_CELLS } from "./place.ts";

export const MAGIC = "meshlodz";
/** Versions: positions and faces only, with layers, with directions that follow neighbours. */
const [SURFACES, WITH_LAYERS, BY_DIRECTIONS] = [1, 2, 3];
/** Added to the version where faces are coded by fans. */
const WITH_FANS = 3;
const SUMS_END = 20;
const MOST_BITS = 21;
const FACES_PER_BYTE = 16;
/** Bytes of the coder's state, with which each block begins. */
const LEAST_BYTES = 4;
const FARTHEST = 2e38;

/** A block among all of them. */
export interface BlockSpan {
    at: number;
    bytes: number;
    faces: number;
}

/** What the front of a file says. */
export interface MlzHeader {
    origin: [number, number, number];
    cell: number;
    firstBits: [number, number, number];
    faces: number;
    vertices: number;
    /** True if faces are coded by fans instead of single steps. */
    hasFans: boolean;
    models: Models;
    layers: LayersFormat | null;
    resources: number;
    blocks: BlockSpan[];
    /** Number of bytes of all blocks, and the checksum of all that follows the index. */
    blockBytes: number;
    checksum: number;
}

/** Reads a header from the start of a file. */
export function readMlzHeader(file: Uint8Array, reader: ByteReader): MlzHeader {
    reader.must(
        String.fromCharCode(...file.subarray(0, 8)) === MAGIC,
        `it does not start with "${MAGIC}"`,
    );
    reader.take(8);
    const version = reader.u32();
    const isKnown = version >= SURFACES && version <= WITH_FANS + BY_DIRECTIONS;
    reader.must(isKnown, `version ${version} is not supported, only 1 to 6`);
    const hasFans = version > WITH_FANS;
    const base = hasFans ? WITH_FANS : 0;
    const [headerSum, checksum] = [reader.u32(), reader.u32()];
    const origin: [number, number, number] = [reader.f64(), reader.f64(), reader.f64()];
    const cell = reader.f64();
    const isNear = (x: number) => Math.abs(x) <= FARTHEST;
    const isGrid = cell > 0 && isNear(cell * MAX_CELLS) && origin.every(isNear);
    reader.must(isGrid, "the cells have no finite positions");
    const firstBits: [number, number, number] = [reader.u8(), reader.u8(), reader.u8()];
    const isShort = firstBits.every((bits) => bits <= MOST_BITS);
    reader.must(isShort, "a coordinate has too many bits");
    const [faces, vertices, count] = [reader.u32(), reader.u32(), reader.u32()];
    const models = readModels(reader);
    let layers: LayersFormat | null = null;
    let resources = 0;
    if (version - base !== SURFACES) {
        layers = readLayersFormat(reader);
        const follows = layers.layers.some(({ mode }) => mode === BY_NEIGHBOURS);
        const expected = base + (follows ? BY_DIRECTIONS : WITH_LAYERS);
        reader.must(version === expected, `its layers are of version ${expected}`);
        resources = reader.u64();
        const isEmpty = layers.layers.length === 0 && layers.labels.every(({ names }) => !names);
        if (isEmpty) layers = null;
    }
    const blocks = readIndex(count, reader);
    const all = blocks.reduce((sum, block) => sum + block.faces, 0);
    reader.must(all === faces, "the faces of its blocks are not those of the mesh");
    reader.must(vertices <= 3 * faces, "it has more vertices than corners of faces");
    const isWhole = headerSumOf(file, reader.at) === headerSum;
    reader.must(isWhole, "its checksum does not match: the file is damaged");
    const last = blocks.at(-1);
    const blockBytes = last ? last.at + last.bytes : 0;
    return {
        ...{ origin, cell, firstBits, faces, vertices, hasFans, models, layers, resources, blocks },
        ...{ blockBytes, checksum },
    };
}

/** Returns the checksum of a header; with fans, it covers the version. */
export function headerSumOf(file: Uint8Array, end: number): number {
    const sealed = file.slice(SUMS_END - 4, end);
    sealed.set(file.subarray(8, 12));
    return crc32(sealed.subarray(file[8] > WITH_FANS ? 0 : 4));
}

function readIndex(count: number, reader: ByteReader): BlockSpan[] {
    const [leastFaces, faceBits] = [reader.u32(), reader.u8()];
    const [leastWords, wordBits] = [reader.u32(), reader.u8()];
    const isNarrow = faceBits <= 32 && wordBits <= 32;
    reader.must(isNarrow, "its index has numbers of more than 32 bits");
    reader.must(count <= reader.left / LEAST_BYTES, `there are too few bytes for ${count} blocks`);
    const bits = new BitReader(reader);
    const faces = Array.from({ length: count }, () => bits.take(faceBits) + leastFaces);
    const words = Array.from({ length: count }, () => bits.take(wordBits) + leastWords);
    let at = 0;
    return faces.map((number, k) => {
        const block = { at, bytes: 2 * words[k], faces: number };
        const least = Math.ceil(Math.floor(number / FACES_PER_BYTE) / 2) * 2;
        const isBlock = number >= 1 && number <= MAX_FACES && least <= block.bytes;
        reader.must(isBlock && block.bytes <= reader.left, `block ${k} has an impossible size`);
        at += block.bytes;
        return block;
    });
}
