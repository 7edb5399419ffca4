/** Buffers as patches fill them, and the triangles that they should show. */

import assert from "node:assert/strict";
import type { Cut } from "../src/cut/cut.ts";
import type { GeometryPatch } from "../src/load/geometry.ts";
import { verticesOf } from "../src/load/vertices.ts";
import { NONE, grown } from "../src/model.ts";
import { openEdges } from "./edges.js";

/** Buffers as a renderer keeps them. */
export class Buffers {
    values = new Float32Array(0);
    private index = new Uint32Array(0);
    private parts: GeometryPatch["parts"] = [];

    constructor(private readonly width: number) {}

    apply(patch: GeometryPatch): void {
        this.values = grown(this.values, patch.capacity * this.width);
        this.index = grown(this.index, 3 * patch.triangles);
        patch.vertices.forEach((vertex, i) => {
            const values = patch.values.subarray(i * this.width, (i + 1) * this.width);
            this.values.set(values, vertex * this.width);
        });
        patch.places.forEach((place, i) =>
            this.index.set(patch.index.subarray(3 * i, 3 * i + 3), 3 * place),
        );
        this.parts = patch.parts;
    }

    /** Returns the triangles as sorted texts: the part, and all values of each corner. */
    triangles(): string[] {
        const corner = (vertex: number) =>
            this.values.subarray(vertex * this.width, (vertex + 1) * this.width).join(",");
        const all = this.parts.flatMap(({ start, count }, part) =>
            Array.from({ length: count }, (_, i) => {
                const at = 3 * (start + i);
                return `${part}: ${[0, 1, 2].map((k) => corner(this.index[at + k])).join(" ")}`;
            }),
        );
        return all.sort();
    }

    /** Returns the triangles with an area as sorted texts: places, from the least corner on. */
    places(): string[] {
        const place = (vertex: number) =>
            this.values.subarray(vertex * this.width, vertex * this.width + 3).join(",");
        const all: string[] = [];
        for (const { start, count } of this.parts) {
            for (let at = 3 * start; at < 3 * (start + count); at += 3) {
                const corners = [0, 1, 2].map((k) => place(this.index[at + k]));
                if (new Set(corners).size < 3) continue;
                const first = corners.indexOf([...corners].sort()[0]);
                all.push([0, 1, 2].map((k) => corners[(first + k) % 3]).join(" "));
            }
        }
        return all.sort();
    }

    /** Number of edges without an opposite one, where vertices at one place count as one. */
    openEdges(): number {
        const count = this.values.length / this.width;
        const positions = new Float32Array(3 * count);
        for (let at = 0; at < count; at++)
            positions.set(this.values.subarray(at * this.width, at * this.width + 3), 3 * at);
        const ranges = this.parts.map(({ start, count }) => ({
            start: 3 * start,
            count: 3 * count,
        }));
        return openEdges(this.index, ranges, positions).length;
    }
}

/** Returns the triangles of a cut in the same form. */
export function trianglesOf(cut: Cut): string[] {
    const vertices = verticesOf(cut.model);
    const { nodes, wedges, slots } = cut.triangles;
    const row = new Float32Array(vertices.width);
    const all: string[] = [];
    for (let at = 0; at < 3 * slots; at += 3) {
        if (nodes[at] === NONE) continue;
        const corners = [at, at + 1, at + 2].map((corner) => {
            vertices.write(nodes[corner], (wedges ?? nodes)[corner], row, 0);
            return row.join(",");
        });
        all.push(`${vertices.partOf((wedges ?? nodes)[at])}: ${corners.join(" ")}`);
    }
    return all.sort();
}

/** A list of differences would take minutes. */
export function assertSame(is: string[], wanted: string[], what: string): void {
    const at = wanted.findIndex((triangle, i) => triangle !== is[i]);
    assert.ok(
        is.length === wanted.length && at < 0,
        `${what}: ${is.length} of ${wanted.length}, ${at}`,
    );
}
