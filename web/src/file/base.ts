/** The base mesh: the coarsest level, as differences between neighbours. */

import { must, within } from "../error.ts";
import { Model } from "../model.ts";
import { readBaseWedges } from "../wedges/base_wedges.ts";
import { readExact } from "./exact.ts";
import { check } from "./header.ts";
import type { Header } from "./header.ts";
import { Streams } from "./streams.ts";

/**
 * Decodes the base mesh into a new model.
 *
 * @throws MlodError if it is damaged
 */
export function readBase(header: Header, bytes: Uint8Array): Model {
    check(header.base, bytes);
    return within(header.base.name, () => {
        const input = new Streams(bytes);
        const model = new Model(header);
        readVertices(model, input);
        readFaces(model, input);
        if (header.isLossless) readExactRoots(model, input);
        if (header.hasWedges) model.wedges = readBaseWedges(model, input);
        input.end();
        model.rankNodes();
        return model;
    });
}

function readVertices(model: Model, input: Streams): void {
    const { roots, header } = model;
    const axes = [0, 1, 2].map(() => sums(input.signed(roots)));
    model.reserve(0);
    for (let k = 0; k < 3; k++) {
        const cells = axes[k];
        for (let root = 0; root < roots; root++) {
            const cell = cells[root];
            must(Math.abs(cell) <= header.mostCells, "a vertex is out of range");
            const x = Math.fround(cell * header.cell);
            must(isFinitePlace(model, x, k), "a vertex is out of range");
            model.positions[3 * root + k] = x;
        }
    }
}

/** Returns true if a coordinate is finite in the model. */
export function isFinitePlace({ frame }: Model, x: number, axis: number): boolean {
    return Number.isFinite(x * frame.unit + frame.origin[axis]);
}

function readFaces(model: Model, input: Streams): void {
    const { baseFaces } = model.header;
    const corners = [0, 1, 2].map(() => sums(input.signed(baseFaces)));
    model.base = new Uint32Array(3 * baseFaces);
    for (let face = 0; face < baseFaces; face++) {
        const [a, b, c] = [corners[0][face], corners[1][face], corners[2][face]];
        const isVertex = (v: number) => v >= 0 && v < model.roots;
        must(isVertex(a) && isVertex(b) && isVertex(c), "a face refers to a missing vertex");
        must(a !== b && b !== c && c !== a, "a face repeats a vertex");
        model.base.set([a, b, c], 3 * face);
    }
}

function readExactRoots(model: Model, input: Streams): void {
    const flags = input.take(model.roots);
    must(
        flags.every((flag) => flag <= 1),
        "it has flags unknown to this program",
    );
    const all = Uint32Array.from({ length: model.roots }, (_, root) => root);
    readExact(
        model,
        all.filter((root) => flags[root] === 1),
        () => true,
        input,
    );
}

/** Returns the sums of differences. */
function sums(steps: Int32Array): Float64Array {
    let sum = 0;
    return Float64Array.from(steps, (step) => (sum += step));
}
