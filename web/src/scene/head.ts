/** The head of a scene: its document, and what materials, meshes and images are in the file. */

import { must, within } from "../error.ts";
import { Streams } from "../file/streams.ts";

/** A mesh of the scene that is in the levels. */
export interface SceneMesh {
    /** 4×4 matrix by columns: where the levels have the mesh. */
    placement: Float64Array;
    /** True if the only node that shows it has it there. */
    isOnly: boolean;
    /** Number of objects of the levels that are this mesh. */
    objects: number;
    /** Attribute layers that it has: number in the levels, and width. */
    layers: (readonly [number, number])[];
}

/** A material label of the levels: a material of the document or null. */
export interface Slot {
    material: number | null;
    /** Number of labels before it, in the same mesh, that have the material. */
    ordinal: number;
}

/**
 * A part of the scene behind its head: key frames, a smaller version of an image, or an image
 * itself.
 */
export interface ScenePart {
    kind: "animations" | "preview" | "image";
    image: number;
}

/** What the first resource of a scene holds. */
export interface SceneHead {
    /** True if the scene was read from glTF. */
    isGltf: boolean;
    /** Null for meshes whose geometry is in the document. */
    meshes: (SceneMesh | null)[];
    slots: Slot[];
    images: number;
    parts: ScenePart[];
    /** JSON of the glTF document, and its buffer 0. */
    document: string;
    buffer: Uint8Array;
}

/** Returns the bytes of a resource, which may be compressed. */
export function unpackResource(name: string, stored: Uint8Array): Uint8Array {
    return within(name, () => {
        const form = stored[0];
        must(form === 0 || (form === 1 && stored.length >= 5), "it is damaged");
        if (form === 0) return stored.subarray(1);
        const length = new DataView(stored.buffer, stored.byteOffset).getUint32(1, true);
        const input = new Streams(stored.subarray(5));
        const bytes = input.take(length);
        input.end();
        return bytes;
    });
}

/** Reads the head of a scene. */
export function readHead(bytes: Uint8Array): SceneHead {
    return within("the head of the scene", () => {
        const input = new Input(bytes);
        const kind = input.byte();
        must(kind <= 3, "it is of a later form");
        if (kind >= 2) input.numbers(2);
        const meshes = input.list(1, () => readMesh(input));
        const slots = input.list(8, (): Slot => {
            const [material, ordinal] = input.numbers(2);
            return { material: material === 0xffffffff ? null : material, ordinal };
        });
        const images = input.number();
        const parts = input.list(8, (): ScenePart => {
            const [code, image] = input.numbers(2);
            must(
                code <= 2 && (code === 0 ? image === 0 : image < images),
                "one of its parts is invalid",
            );
            return { kind: (["animations", "preview", "image"] as const)[code], image };
        });
        const document = new TextDecoder().decode(input.take(input.number()));
        return {
            isGltf: (kind & 1) === 1,
            meshes,
            slots,
            images,
            parts,
            document,
            buffer: input.rest(),
        };
    });
}

function readMesh(input: Input): SceneMesh | null {
    const isThere = input.byte();
    must(isThere <= 1, "one of its meshes is invalid");
    if (!isThere) return null;
    const placement = Float64Array.from({ length: 16 }, () => input.double());
    must(placement.every(Number.isFinite), "a placement is not finite");
    const isOnly = input.byte() === 1;
    const objects = input.number();
    const layers = input.list(8, () => input.numbers(2) as [number, number]);
    return { placement, isOnly, objects: objects === 0 ? 1 : objects - 1, layers };
}

/** Reads numbers, none behind the end. */
class Input {
    private at = 0;
    private readonly view: DataView;

    constructor(private readonly bytes: Uint8Array) {
        this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    }

    private next(count: number): number {
        must(this.at + count <= this.bytes.length, "it is cut off");
        this.at += count;
        return this.at - count;
    }

    byte(): number {
        return this.bytes[this.next(1)];
    }

    number(): number {
        return this.view.getUint32(this.next(4), true);
    }

    numbers(count: number): number[] {
        return Array.from({ length: count }, () => this.number());
    }

    double(): number {
        return this.view.getFloat64(this.next(8), true);
    }

    take(count: number): Uint8Array {
        const at = this.next(count);
        return this.bytes.subarray(at, at + count);
    }

    rest(): Uint8Array {
        return this.bytes.subarray(this.at);
    }

    /** Reads a list, each element of which takes some bytes at least. */
    list<T>(least: number, element: () => T): T[] {
        const count = this.number();
        must(count * least <= this.bytes.length - this.at, "it is cut off");
        return Array.from({ length: count }, element);
    }
}
