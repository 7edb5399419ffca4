/** `.mlz` files: meshes for transmission, decoded from memory. */

import { must, within } from "../error.ts";
import { crc32 } from "../file/crc32.ts";
import { mergeEqualWedges } from "../packed/mesh.ts";
import type { MeshLabels, MeshLayer, MeshWedges, PackedMesh } from "../packed/mesh.ts";
import { ByteReader } from "../packed/reader.ts";
import { BlockDecoder, INSIDE } from "./block.ts";
import type { Block } from "./block.ts";
import { readMlzHeader } from "./header.ts";
import type { MlzHeader } from "./header.ts";

export { MlodError } from "../error.ts";
export { buffersOf } from "../packed/mesh.ts";
export type { MeshBuffers, MeshLabels, MeshLayer, MeshWedges } from "../packed/mesh.ts";
export type { PackedMesh } from "../packed/mesh.ts";

/**
 * Decodes a `.mlz` file as a mesh with each vertex once, its faces block by block.
 *
 * @throws MlodError if it is damaged
 */
export function decodeMlz(file: Uint8Array): PackedMesh {
    const reader: ByteReader = new ByteReader(file);
    const header = within("the header", () => readMlzHeader(file, reader));
    const rest = within("the file", () => {
        const bytes = reader.take(header.blockBytes + header.resources);
        reader.end();
        reader.must(crc32(bytes) === header.checksum, "the checksum of its blocks does not match");
        return bytes;
    });
    const mesh = new MeshBuilder(header);
    const decoder = new BlockDecoder(header);
    header.blocks.forEach(({ at, bytes, faces }, k) =>
        within(`block ${k}`, () => mesh.add(decoder.decode(rest.subarray(at, at + bytes), faces))),
    );
    return within("the file", () => mesh.finish(rest.subarray(header.blockBytes)));
}

/** Joins blocks to a mesh. */
class MeshBuilder {
    private readonly faces: Uint32Array;
    private face = 0;
    private readonly positions: Float64Array;
    private vertices = 0;
    /** Vertices on borders by their tags and cells. */
    private readonly shared = new Map<number, Map<number, number>>();
    private readonly corners: Uint32Array;
    private wedgeCount = 0;
    /** Values of each layer, block by block. */
    private readonly values: Float32Array[][];
    private readonly labels: (Uint32Array | null)[];

    constructor(private readonly header: MlzHeader) {
        const { faces, layers } = header;
        this.faces = new Uint32Array(3 * faces);
        this.positions = new Float64Array(3 * header.vertices);
        this.values = layers?.layers.map(() => []) ?? [];
        this.corners = new Uint32Array(this.values.length > 0 ? 3 * faces : 0);
        const labels = layers?.labels ?? [];
        this.labels = labels.map(({ names }) => (names ? new Uint32Array(faces) : null));
    }

    /** Adds a block. */
    add(block: Block): void {
        const numbers = new Uint32Array(block.vertices);
        for (let v = 0; v < block.vertices; v++) numbers[v] = this.vertex(block, v);
        block.faces.forEach((v, corner) => (this.faces[3 * this.face + corner] = numbers[v]));
        if (block.layers) this.addLayers(block.layers);
        this.face += block.faces.length / 3;
    }

    /** Returns the number of a vertex of a block, which is new unless it is on a border. */
    private vertex({ cells, tags }: Block, v: number): number {
        const { positions } = this;
        const x = cells[3 * v];
        const y = cells[3 * v + 1];
        const z = cells[3 * v + 2];
        const number = this.vertices;
        if (tags[v] !== INSIDE) {
            // Two coordinates make a number of 42 bits; the third one is below the tag.
            const outer = tags[v] * 0x200000 + z;
            let cellsAt = this.shared.get(outer);
            if (!cellsAt) this.shared.set(outer, (cellsAt = new Map<number, number>()));
            const known = cellsAt.get(x * 0x200000 + y);
            if (known !== undefined) return known;
            cellsAt.set(x * 0x200000 + y, number);
        }
        const { origin, cell } = this.header;
        // Beyond its end nothing is stored, and the number is an error at the end.
        positions[3 * number] = origin[0] + cell * x;
        positions[3 * number + 1] = origin[1] + cell * y;
        positions[3 * number + 2] = origin[2] + cell * z;
        return this.vertices++;
    }

    private addLayers({ wedges, layers, labels }: NonNullable<Block["layers"]>): void {
        const formats = this.header.layers?.layers ?? [];
        const count = wedges.vertex.length;
        formats.forEach(({ coding }, i) => {
            const { ofWedge, numbers } = layers[i];
            const values = new Float32Array(coding.width * count);
            ofWedge.forEach((entry, wedge) =>
                coding.decode(numbers, coding.components * entry, values, coding.width * wedge),
            );
            this.values[i].push(values);
        });
        wedges.ofCorner.forEach(
            (wedge, corner) => (this.corners[3 * this.face + corner] = this.wedgeCount + wedge),
        );
        this.wedgeCount += count;
        labels.forEach((of, kind) => of && this.labels[kind]?.set(of, this.face));
    }

    /** Returns the mesh. */
    finish(resources: Uint8Array): PackedMesh {
        const { header, faces, positions, vertices } = this;
        must(
            vertices === header.vertices,
            `it has ${vertices} vertices, where its header says ${header.vertices}`,
        );
        const wedges = this.wedges();
        if (wedges) mergeEqualWedges(wedges, faces, vertices);
        const labels = (kind: number): MeshLabels | null => {
            const names = header.layers?.labels[kind].names;
            const ofFace = this.labels[kind];
            return names && ofFace ? { names, ofFace } : null;
        };
        return { positions, faces, wedges, materials: labels(0), objects: labels(1), resources };
    }

    private wedges(): MeshWedges | null {
        const formats = this.header.layers?.layers ?? [];
        if (formats.length === 0) return null;
        const layers = formats.map(({ coding }, i): MeshLayer => {
            const { kind, set, name, width } = coding;
            const values = new Float32Array(width * this.wedgeCount);
            let at = 0;
            for (const part of this.values[i]) {
                values.set(part, at);
                at += part.length;
            }
            return { kind, set, name, width, values };
        });
        return { count: this.wedgeCount, corners: this.corners, layers };
    }
}
