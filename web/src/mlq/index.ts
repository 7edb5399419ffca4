/** `.mlq` files: meshes that stay compressed where they are drawn, decoded as a whole. */

import { within } from "../error.ts";
import { crc32 } from "../file/crc32.ts";
import { mergeEqualWedges } from "../packed/mesh.ts";
import type { MeshLabels, MeshLayer, PackedMesh } from "../packed/mesh.ts";
import { readLayerCoding } from "../packed/layer_coding.ts";
import { ByteReader } from "../packed/reader.ts";
import { BLOCK } from "./block.ts";
import { readBlocks } from "./blocks.ts";
import { readLattice } from "./lattice.ts";
import { readExceptions, readParts, weldParts } from "./parts.ts";
import { readPatches } from "./patches.ts";
import type { PatchFaces } from "./patches.ts";
import { PackedRows, Rows } from "./rows.ts";
import { readStrips } from "./strips.ts";

export { MlodError } from "../error.ts";
export { buffersOf } from "../packed/mesh.ts";
export type { MeshBuffers, MeshLabels, MeshLayer, MeshWedges } from "../packed/mesh.ts";
export type { PackedMesh } from "../packed/mesh.ts";

const MAGIC = "meshlodq";
const VERSION = 1;
const HEADER = 56;
/** Schemes of positions, and flags. */
const [PARTS, LATTICE, BLOCKS] = [0, 1, 2];
const [EXTRA, MORE, STRIPS] = [1, 2, 4];
const BLOCKS_PER_PATCH = 4;
/** Most values of a node, and of all nodes for each byte of the file. */
const MOST_VALUES = 1023;
const VALUES_PER_BYTE = 256;

interface Header {
    scheme: number;
    flags: number;
    layers: number;
    /** Positions, faces, attributes, and labels with resources, if there are any. */
    sections: ByteReader[];
}

/** Faces over nodes, and the vertices of these. */
interface Surface extends PatchFaces {
    rows: Rows;
    vertexOf: Uint32Array;
    positions: Float64Array;
}

/**
 * Decodes a `.mlq` file as a mesh with each vertex once, its faces patch by patch.
 *
 * @throws MlodError if it is damaged
 */
export function decodeMlq(file: Uint8Array): PackedMesh {
    const header = within("the header", () => readHeader(file));
    const [positionBytes, faceBytes, layerBytes, more] = header.sections;
    const stored = within("the positions", () => readPositions(header.scheme, positionBytes));
    const surface = within("the faces", () => readSurface(stored, header, faceBytes));
    const { rows, vertexOf, counts } = surface;
    const layers = within("the attributes", () =>
        readLayers(header.layers, rows, VALUES_PER_BYTE * file.length, layerBytes),
    );
    const faces = surface.faces.map((node) => vertexOf[node]);
    const mesh: PackedMesh = {
        ...{ positions: surface.positions, faces, wedges: null },
        ...{ materials: null, objects: null, resources: new Uint8Array(0) },
    };
    if (layers.length > 0) {
        mesh.wedges = { count: rows.nodes, corners: surface.faces, layers };
        if (header.scheme === PARTS)
            mergeEqualWedges(mesh.wedges, faces, mesh.positions.length / 3);
    }
    if (more) {
        within("the materials and nodes", () => {
            mesh.materials = readLabels(counts, more);
            mesh.objects = readLabels(counts, more);
            mesh.resources = more.take(more.left);
        });
    }
    return mesh;
}

/** Reads the header, and checks what its checksums cover. */
function readHeader(file: Uint8Array): Header {
    const reader: ByteReader = new ByteReader(file);
    const magic = String.fromCharCode(...file.subarray(0, 8));
    reader.must(magic === MAGIC, `it does not start with "${MAGIC}"`);
    reader.take(8);
    const version = reader.u32();
    reader.must(version === VERSION, `version ${version} is not supported, only ${VERSION}`);
    const [scheme, flags, layers] = [reader.u8(), reader.u8(), reader.u16()];
    const sums = [0, 1, 2].map(() => [reader.u64(), reader.u32()] as const);
    const isWhole = crc32(file.subarray(0, HEADER - 4)) === reader.u32();
    reader.must(isWhole, "its checksum does not match: the file is damaged");
    reader.must((flags & ~(EXTRA | MORE | STRIPS)) === 0, `it has unknown flags ${flags}`);
    const names = ["positions", "faces", "attributes"];
    const sections = sums.map(([length, sum], i) => section(file, reader, names[i], length, sum));
    if (flags & MORE) {
        const [length, sum] = [reader.u64(), reader.u32()];
        sections.push(section(file, reader, "materials and nodes", length, sum));
    }
    reader.end();
    return { scheme, flags, layers, sections };
}

/** Returns a reader of a section, whose places are those of the file. */
function section(
    file: Uint8Array,
    reader: ByteReader,
    name: string,
    length: number,
    sum: number,
): ByteReader {
    const at = reader.at;
    const isWhole = crc32(reader.take(length)) === sum;
    reader.must(isWhole, `the checksum of the ${name} does not match: the file is damaged`);
    return new ByteReader(file.subarray(0, at + length), at);
}

function readPositions(scheme: number, reader: ByteReader) {
    if (scheme === PARTS) {
        const parts = readParts(reader);
        reader.end();
        return parts;
    }
    reader.must(scheme === LATTICE || scheme === BLOCKS, `unknown scheme ${scheme}`);
    const positions = scheme === LATTICE ? readLattice(reader) : readBlocks(reader);
    reader.end();
    return positions;
}

function readSurface(
    stored: ReturnType<typeof readPositions>,
    { flags }: Header,
    reader: ByteReader,
): Surface {
    if (stored instanceof Float64Array) {
        reader.must((flags & STRIPS) === 0, "strips need positions in parts");
        return readOverBlocks(stored, (flags & EXTRA) !== 0, reader);
    }
    reader.must((flags & EXTRA) === 0, "parts cannot have rows of further wedges");
    const { rows } = stored;
    const patches = flags & STRIPS ? readStrips(rows, reader) : readPatches(rows, 1, reader);
    const exceptions = readExceptions(reader);
    reader.end();
    const [vertexOf, positions] = weldParts(stored, exceptions, patches.faces);
    return { ...patches, rows, vertexOf, positions };
}

/** Reads faces over blocks of vertices, which may have a row of further wedges each. */
function readOverBlocks(positions: Float64Array, hasExtra: boolean, reader: ByteReader): Surface {
    const vertices = positions.length / 3;
    const blocks = Math.ceil(vertices / BLOCK);
    const size = (block: number) => Math.min(vertices - BLOCK * block, BLOCK);
    const sizes = Array.from({ length: blocks }, (_, block) => size(block));
    if (!hasExtra) {
        const rows = new Rows(sizes);
        const patches = readPatches(rows, BLOCKS_PER_PATCH, reader);
        reader.end();
        const vertexOf = Uint32Array.from({ length: vertices }, (_, vertex) => vertex);
        return { ...patches, rows, vertexOf, positions };
    }
    const extra = Rows.read(blocks, reader);
    const rows = new Rows(sizes.flatMap((size, block) => [size, extra.size(block)]));
    reader.must(rows.nodes < 2 ** 32, "there are more wedges than 32 bits can number");
    const packed = new PackedRows(extra, 1, reader);
    const patches = readPatches(rows, 2 * BLOCKS_PER_PATCH, reader);
    reader.end();
    const numbers = packed.all();
    const vertexOf = new Uint32Array(rows.nodes);
    let [node, next] = [0, 0];
    for (let block = 0; block < blocks; block++) {
        const first = BLOCK * block;
        for (let k = 0; k < size(block); k++) vertexOf[node++] = first + k;
        for (let left = extra.size(block); left > 0; left--)
            vertexOf[node++] = first + Math.min(numbers[next++], size(block) - 1);
    }
    return { ...patches, rows, vertexOf, positions };
}

function readLayers(
    count: number,
    rows: Rows,
    mostValues: number,
    reader: ByteReader,
): MeshLayer[] {
    const layers: MeshLayer[] = [];
    let total = 0;
    for (let i = 0; i < count; i++) {
        const coding = readLayerCoding(reader);
        const { kind, set, name, width, components } = coding;
        total += width;
        reader.must(total <= MOST_VALUES, `a node has more than ${MOST_VALUES} values`);
        const isRoom = total * rows.nodes <= mostValues;
        reader.must(isRoom, "there are more values than such a file may have");
        const numbers = new PackedRows(rows, components, reader).all();
        const values = new Float32Array(width * rows.nodes);
        for (let node = 0; node < rows.nodes; node++)
            coding.decode(numbers, components * node, values, width * node);
        layers.push({ kind, set, name, width, values });
    }
    reader.end();
    return layers;
}

/** Reads the labels of faces, patch by patch. */
function readLabels(counts: number[], reader: ByteReader): MeshLabels | null {
    const names = reader.names();
    if (!names) return null;
    const ofFace = new PackedRows(new Rows(counts), 1, reader).all();
    const isName = ofFace.every((label) => label < names.length);
    reader.must(isName, "a face has a material or an object that does not exist");
    return { names, ofFace };
}
