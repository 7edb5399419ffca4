/** A mesh on the GPU: one buffer of vertices, one of indices, changed where patches say. */

import type { GeometryPatch, PartRange } from "../src/load/geometry.ts";
import type { LayerInfo } from "../src/load/messages.ts";
import { ATTRIBUTES } from "./shaders.ts";

/** Elements between two changes that are sent along, and number of pieces that are sent. */
const GAP = 32;
const MOST_PIECES = 64;

type Layer = Pick<LayerInfo, "kind" | "set" | "width">;

/** A buffer with a copy in memory. */
class Mirror<A extends Float32Array | Uint32Array> {
    private readonly buffer: WebGLBuffer;
    private room = 0;

    constructor(
        private readonly gl: WebGL2RenderingContext,
        private readonly target: GLenum,
        public array: A,
    ) {
        this.buffer = gl.createBuffer();
    }

    bind(): void {
        this.gl.bindBuffer(this.target, this.buffer);
    }

    /** Sends elements of some width, all of them if the buffer has become too small. */
    send(elements: Uint32Array, width: number): void {
        const { gl, target, array } = this;
        this.bind();
        if (this.room < array.length) {
            gl.bufferData(target, array, gl.DYNAMIC_DRAW);
            this.room = array.length;
            return;
        }
        for (const [from, to] of pieces(elements))
            gl.bufferSubData(target, 4 * from * width, array, from * width, (to - from) * width);
    }

    delete(): void {
        this.gl.deleteBuffer(this.buffer);
    }
}

/** Returns ranges that cover all of some elements. */
export function pieces(elements: Uint32Array): [number, number][] {
    const ranges: [number, number][] = [];
    for (const at of elements.slice().sort()) {
        const last = ranges[ranges.length - 1];
        if (last !== undefined && at <= last[1] + GAP) last[1] = Math.max(last[1], at + 1);
        else ranges.push([at, at + 1]);
    }
    if (ranges.length <= MOST_PIECES) return ranges;
    return [[ranges[0][0], ranges[ranges.length - 1][1]]];
}

/** A mesh, whose vertices are numbers one after the other: a position and layers. */
export class Surface {
    parts: PartRange[] = [];
    readonly hasNormals: boolean;
    private readonly vertices: Mirror<Float32Array>;
    private readonly index: Mirror<Uint32Array>;
    private readonly vertexArray: WebGLVertexArrayObject;
    private readonly width: number;

    constructor(
        private readonly gl: WebGL2RenderingContext,
        layers: readonly Layer[],
        /** True if second texture coordinates grow upwards, as in our files. */
        readonly growsUpwards: boolean,
    ) {
        this.width = layers.reduce((sum, layer) => sum + layer.width, 3);
        this.vertices = new Mirror(gl, gl.ARRAY_BUFFER, new Float32Array(0));
        this.index = new Mirror(gl, gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(0));
        this.hasNormals = layers.some(({ kind, set }) => kind === "normal" && set === 0);
        this.vertexArray = gl.createVertexArray();
        gl.bindVertexArray(this.vertexArray);
        this.index.bind();
        this.vertices.bind();
        this.point(0, 3, 0);
        let start = 3;
        for (const { kind, set, width } of layers) {
            const location = ATTRIBUTES.findIndex((name) => name === kind);
            if (location > 0 && set === 0) this.point(location, width, start);
            start += width;
        }
        gl.bindVertexArray(null);
    }

    private point(location: number, width: number, start: number): void {
        this.gl.enableVertexAttribArray(location);
        const [size, stride] = [Math.min(width, 4), 4 * this.width];
        this.gl.vertexAttribPointer(location, size, this.gl.FLOAT, false, stride, 4 * start);
    }

    /** Changes what a patch says. */
    apply(patch: GeometryPatch): void {
        const { vertices, index, width } = this;
        vertices.array = roomy(vertices.array, patch.capacity * width);
        patch.vertices.forEach((vertex, i) =>
            vertices.array.set(patch.values.subarray(i * width, (i + 1) * width), vertex * width),
        );
        index.array = roomy(index.array, 3 * patch.triangles);
        patch.places.forEach((place, i) =>
            index.array.set(patch.index.subarray(3 * i, 3 * i + 3), 3 * place),
        );
        this.gl.bindVertexArray(this.vertexArray);
        if (patch.vertices.length > 0) vertices.send(patch.vertices, width);
        if (patch.places.length > 0) index.send(patch.places, 3);
        this.gl.bindVertexArray(null);
        this.parts = patch.parts;
    }

    /** Takes a whole mesh. */
    set(values: Float32Array, index: Uint32Array, parts: PartRange[]): void {
        this.vertices.array = values;
        this.index.array = index;
        this.gl.bindVertexArray(this.vertexArray);
        this.vertices.send(new Uint32Array(0), this.width);
        this.index.send(new Uint32Array(0), 3);
        this.gl.bindVertexArray(null);
        this.parts = parts;
    }

    /** Draws one part. */
    draw(part: number): void {
        const { start, count } = this.parts[part];
        this.gl.bindVertexArray(this.vertexArray);
        this.gl.vertexAttrib4f(3, 1, 1, 1, 1);
        this.gl.drawElements(this.gl.TRIANGLES, 3 * count, this.gl.UNSIGNED_INT, 12 * start);
    }

    delete(): void {
        this.vertices.delete();
        this.index.delete();
        this.gl.deleteVertexArray(this.vertexArray);
    }
}

/** Returns an array with room for a number of values, which has those of another. */
function roomy<A extends Float32Array | Uint32Array>(array: A, count: number): A {
    if (array.length >= count) return array;
    const make = array.constructor as new (length: number) => A;
    const larger = new make(Math.ceil(1.5 * count));
    larger.set(array);
    return larger;
}
