/** As much of WebGL as three.js needs to fill buffers, with buffers that can be read. */

import type { BufferAttribute } from "three";
import { WebGLAttributes } from "three/src/renderers/webgl/WebGLAttributes.js";

interface FakeBuffer {
    bytes: Uint8Array;
}

type Numbers = Float32Array | Uint32Array;

/** Buffers as a renderer of three.js keeps them. */
export class UploadedBuffers {
    private bound: FakeBuffer = { bytes: new Uint8Array(0) };
    private readonly attributes: WebGLAttributes;

    constructor() {
        const gl = {
            createBuffer: (): FakeBuffer => ({ bytes: new Uint8Array(0) }),
            bindBuffer: (_: number, buffer: FakeBuffer) => (this.bound = buffer),
            bufferData: (_: number, { buffer, byteOffset, byteLength }: Numbers) =>
                (this.bound.bytes = new Uint8Array(buffer, byteOffset, byteLength).slice()),
            bufferSubData: (_: number, at: number, array: Numbers, from = 0, count?: number) => {
                const part = array.subarray(from, count === undefined ? undefined : from + count);
                const bytes = new Uint8Array(part.buffer, part.byteOffset, part.byteLength);
                this.bound.bytes.set(bytes, at);
            },
            deleteBuffer: () => undefined,
        };
        this.attributes = new WebGLAttributes(gl as unknown as WebGL2RenderingContext);
    }

    /** Sends what has changed of an attribute; returns all that has been sent so far. */
    upload(attribute: BufferAttribute): Numbers {
        this.attributes.update(attribute, 0);
        const { buffer } = this.attributes.get(attribute) as unknown as { buffer: FakeBuffer };
        const make = attribute.array.constructor as new (buffer: ArrayBufferLike) => Numbers;
        return new make(buffer.bytes.buffer);
    }
}
