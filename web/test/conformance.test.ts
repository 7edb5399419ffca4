import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { Cut } from "../src/cut/cut.ts";
import type { CutChange, Limits } from "../src/cut/meter.ts";
import type { Query } from "../src/cut/query.ts";
import { Decoder, decode } from "../src/decode.ts";
import { FieldCut } from "../src/field/field_cut.ts";
import { FieldModel } from "../src/field/field_model.ts";
import { decodeField } from "../src/field/height_field.ts";
import { Criterion } from "../src/cut/criterion.ts";
import { magicOf, readHeader } from "../src/file/header.ts";
import { NONE } from "../src/model.ts";
import type { Model } from "../src/model.ts";
import { conformanceFile, conformanceFolder, conformanceNames } from "./files.ts";
import { Hash } from "./hash.ts";

/** What Rust has found for a query. */
interface Answer extends Query {
    change: [number, number, number, number];
    faces: number;
    vertices: number;
    slots: number;
    wedges: number;
    patches: number;
}

interface Walk {
    chunks: number | null;
    changes: number | null;
    hysteresis: number;
    steps: Answer[];
}

interface Extract extends Query {
    chunks: number;
    bytes: number;
    faces: number;
    nodes: number;
}

interface Conformance {
    nodes: number;
    positions: number;
    most: number;
    allWedges?: number;
    values?: number;
    labels?: number;
    walks: Walk[];
    extracts?: Extract[];
}

/** A cut of either kind. */
interface AnyCut {
    readonly vertices: number;
    readonly triangles: {
        readonly nodes: Uint32Array;
        readonly wedges: Uint32Array | null;
        readonly slots: number;
        readonly count: number;
        readonly touched: readonly number[];
        readonly before: readonly number[];
    };
    update(query: Query, limits: Limits): CutChange;
}

/** Numbers of nodes and wedges as Rust has them: by their places in the forest. */
class Ranks {
    readonly nodes: Uint32Array;
    private readonly firstWedge: Uint32Array;

    constructor(private readonly model: Model) {
        const inForest = model.rankNodes();
        this.nodes = new Uint32Array(inForest);
        for (let node = 0; node < model.nodes; node++) {
            if (model.rank[node] !== NONE) this.nodes[model.rank[node]] = node;
        }
        this.firstWedge = new Uint32Array(inForest + 1);
        this.nodes.forEach((node, rank) => {
            const count = model.wedges?.countOf(node) ?? 0;
            this.firstWedge[rank + 1] = this.firstWedge[rank] + count;
        });
    }

    node(node: number): number {
        return node === NONE ? NONE : this.model.rank[node];
    }

    wedge(node: number, wedge: number): number {
        const { wedges } = this.model;
        return node === NONE || !wedges
            ? NONE
            : this.firstWedge[this.node(node)] + wedge - wedges.first[node];
    }
}

/** Returns what a query's answer is to be compared by. */
function answerOf(
    cut: AnyCut,
    { splits, merges, inspected, done }: CutChange,
    ranks: Ranks | null,
) {
    const { nodes, wedges, slots, count, touched, before } = cut.triangles;
    const rank = (node: number) => (ranks ? ranks.node(node) : node);
    const [inSlots, inWedges, inPatches] = [new Hash(), new Hash(), new Hash()];
    for (let at = 0; at < 3 * slots; at++) {
        inSlots.add(rank(nodes[at]));
        inWedges.add(ranks && wedges ? ranks.wedge(nodes[at], wedges[at]) : NONE);
    }
    touched.forEach((slot, i) => {
        const old = before.slice(3 * i, 3 * i + 3);
        const now = [...nodes.subarray(3 * slot, 3 * slot + 3)];
        if (old.every((node, k) => node === now[k])) return;
        inPatches.addAll([slot, ...old.map(rank), ...now.map(rank)]);
    });
    return {
        change: [splits, merges, inspected, Number(done)],
        faces: count,
        vertices: cut.vertices,
        slots: inSlots.value,
        wedges: inWedges.value,
        patches: inPatches.value,
    };
}

function follow(name: string, walk: Walk, cut: AnyCut, ranks: Ranks | null): void {
    const limits = walk.changes === null ? {} : { changes: walk.changes };
    walk.steps.forEach(({ focus, tolerance, ...wanted }, step) => {
        const change = cut.update({ focus, tolerance }, limits);
        assert.deepEqual(answerOf(cut, change, ranks), wanted, `${name}, step ${step}`);
    });
}

function checkPositions(
    nodes: Iterable<number>,
    model: Model | FieldModel,
    wanted: Conformance,
): void {
    const [hash, point] = [new Hash(), new Float64Array(3)];
    const words = new Uint32Array(point.buffer);
    for (const node of nodes) {
        model.position(node, point);
        hash.addAll(words);
    }
    assert.equal(hash.value, wanted.positions);
}

function checkValues(model: Model, { nodes }: Ranks, wanted: Conformance): void {
    const [values, labels] = [new Hash(), new Hash()];
    const { wedges } = model;
    const row = new Float32Array(wedges?.width ?? 0);
    const bits = new Uint32Array(row.buffer);
    for (const node of wedges ? nodes : []) {
        for (
            let wedge = wedges?.first[node] ?? 0;
            wedge < (wedges?.first[node + 1] ?? 0);
            wedge++
        ) {
            wedges?.values(wedge, row, 0);
            values.addAll(bits);
            labels.add(wedges?.materials ? wedges.materialOf(wedge) : NONE);
            labels.add(wedges?.objects ? wedges.objectOf(wedge) : NONE);
        }
    }
    assert.deepEqual(
        [wedges?.count ?? 0, values.value, labels.value],
        [wanted.allWedges, wanted.values, wanted.labels],
    );
}

/** Reads what a query needs, and no more. */
function extract(file: Uint8Array, query: Query) {
    const header = readHeader(file);
    const part = (at: number, length: number) => file.subarray(at, at + length);
    const decoder = new Decoder(header, part(header.base.at, header.base.length));
    const criterion = new Criterion(query, header.frame);
    const chunks = header.chunks.filter((chunk) => criterion.mayRequire(chunk));
    decoder.add(chunks.map((chunk) => [chunk, part(chunk.at, chunk.length)] as const));
    const cut = new Cut(decoder.model);
    cut.update(query);
    const hash = new Hash();
    const { nodes, slots, count } = cut.triangles;
    for (let at = 0; at < 3 * slots; at++)
        if (nodes[at] !== NONE) hash.add(decoder.model.rank[nodes[at]]);
    const bytes = chunks.reduce(
        (sum, chunk) => sum + chunk.length,
        header.base.at + header.base.length,
    );
    return { chunks: chunks.length, bytes, faces: count, nodes: hash.value };
}

const folder = conformanceFolder();

test(
    "conformance files are there",
    { skip: folder === null && "MLOD_CONFORMANCE names no folder" },
    () => {
        assert.ok(conformanceNames().length >= 3);
    },
);

for (const name of conformanceNames()) {
    const wanted = JSON.parse(
        readFileSync(join(folder ?? "", `${name}.json`), "utf8"),
    ) as Conformance;
    const file = conformanceFile(name);
    if (magicOf(file) === "meshlodh") {
        test(`${name}: heights, and every cut of right triangles`, () => {
            const model = new FieldModel(decodeField(file));
            checkPositions(
                Array.from({ length: model.nodes }, (_, index) => index),
                model,
                wanted,
            );
            for (const walk of wanted.walks) follow(name, walk, new FieldCut(model), null);
        });
        continue;
    }
    test(`${name}: positions, attribute values and labels of all levels`, () => {
        const model = decode(file);
        const ranks = new Ranks(model);
        assert.equal(ranks.nodes.length, wanted.nodes);
        checkPositions(ranks.nodes, model, wanted);
        checkValues(model, ranks, wanted);
    });
    test(`${name}: every step of random walks`, () => {
        for (const walk of wanted.walks) {
            const model = decode(file, walk.chunks ?? Infinity);
            follow(name, walk, new Cut(model, walk.hysteresis), new Ranks(model));
        }
    });
    test(`${name}: queries that read only what they need`, () => {
        wanted.extracts?.forEach(({ focus, tolerance, ...answer }, at) => {
            assert.deepEqual(extract(file, { focus, tolerance }), answer, `${name}, query ${at}`);
        });
    });
    test(`${name}: chunk after chunk gives the values of all at once`, () => {
        const header = readHeader(file);
        const part = (at: number, length: number) => file.subarray(at, at + length);
        const decoder = new Decoder(header, part(header.base.at, header.base.length));
        for (const chunk of header.chunks) decoder.add([[chunk, part(chunk.at, chunk.length)]]);
        checkValues(decoder.model, new Ranks(decoder.model), wanted);
    });
}
