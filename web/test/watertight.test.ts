// What is on screen has no crack, whatever has come so far and in which order.

import assert from "node:assert/strict";
import { test } from "node:test";
import { BufferAttribute } from "three";
import { Cut } from "../src/cut/cut.ts";
import type { Query } from "../src/cut/query.ts";
import { Front } from "../src/cut/front.ts";
import { decode } from "../src/decode.ts";
import { readHeader } from "../src/file/header.ts";
import type { Header } from "../src/file/header.ts";
import { Geometry } from "../src/load/geometry.ts";
import type { GeometryPatch } from "../src/load/geometry.ts";
import { Levels } from "../src/load/levels.ts";
import type { FileInfo } from "../src/load/messages.ts";
import { infoOf } from "../src/load/info.ts";
import { verticesOf } from "../src/load/vertices.ts";
import { NONE } from "../src/model.ts";
import type { Model } from "../src/model.ts";
import { StreamGeometry } from "../src/three/buffers.ts";
import { borderOf, openEdges, placeOf } from "./edges.js";
import { UploadedBuffers } from "./fake_gl.ts";
import { conformanceFile, conformanceNames } from "./files.ts";
import { randomNumbers } from "./random.ts";

const MOMENTS = 12;

/** A stream without a network: chunks come when they are told to. */
class Show {
    readonly levels: Levels;
    readonly mesh: StreamGeometry;
    private geometry: Geometry;
    private readonly uploaded = new UploadedBuffers();

    constructor(
        private readonly file: Uint8Array,
        private readonly header: Header,
    ) {
        const { at, length } = header.base;
        this.levels = new Levels(header, file.subarray(at, at + length), Infinity);
        const { model } = this.levels.cut;
        this.mesh = new StreamGeometry(infoOf(model));
        this.geometry = new Geometry(verticesOf(model));
    }

    receive(number: number, query: Query): void {
        const { at, length } = this.header.chunks[number];
        const chunk = [number, this.file.subarray(at, at + length)] as const;
        if (this.levels.add([chunk], query))
            this.geometry = new Geometry(verticesOf(this.levels.cut.model));
    }

    update(query: Query, changes: number): boolean {
        this.levels.noteGaps(query);
        const { done } = this.levels.cut.update(query, { changes });
        const patch = this.geometry.follow(this.levels.cut.triangles);
        if (patch) this.mesh.apply(patch);
        return done;
    }

    /** Returns the places of the ends of all open edges of what a GPU would draw. */
    openEnds(): string[] {
        const index = this.uploaded.upload(this.mesh.index as BufferAttribute);
        const attribute = this.mesh.getAttribute("position") as BufferAttribute;
        const positions = this.uploaded.upload(attribute);
        const open = openEdges(index, this.mesh.groups, positions);
        return open.flat().map((vertex) => placeOf(positions, 3 * vertex));
    }

    /** Number of triangles that are drawn. */
    get count(): number {
        return this.mesh.groups.reduce((sum, { count }) => sum + count / 3, 0);
    }
}

function randomQuery({ frame, diagonal }: Header, random: () => number): Query {
    const around = (reach: number): [number, number, number] => [
        frame.origin[0] + reach * diagonal * (random() - 0.5),
        frame.origin[1] + reach * diagonal * (random() - 0.5),
        frame.origin[2] + reach * diagonal * (random() - 0.5),
    ];
    const tolerance = diagonal * 10 ** (-1.5 - 3 * random());
    const kind = Math.floor(4 * random());
    if (kind === 0) return { focus: null, tolerance };
    if (kind === 1) {
        const radius = 0.3 * random() * diagonal;
        return { focus: { sphere: { center: around(1), radius } }, tolerance };
    }
    const camera = {
        eye: around(3),
        look: around(0.5),
        up: [0, 1, 0],
        fov: 0.6,
        viewport: [1280, 720],
    } as const;
    const pixels = { pixels: 0.2 + 4 * random(), camera };
    return { focus: kind === 2 ? { frustum: camera } : null, tolerance: pixels };
}

/**
 * Checks that a cut is one of the whole model's: that its updates may be applied there, by falling
 * level, and give its triangles.
 */
function assertIsCutOf(whole: Model, cut: Cut): void {
    const inFile = new Uint32Array(cut.model.nodes);
    for (let node = 0; node < whole.nodes; node++) {
        const here = cut.model.nodeHere(node);
        if (here !== NONE) inFile[here] = node;
    }
    const { nodes, slots } = cut.triangles;
    const faces: number[] = [];
    const updates = new Set<number>();
    for (let at = 0; at < 3 * slots; at++) {
        if (nodes[at] === NONE) continue;
        let node = inFile[nodes[at]];
        faces.push(node);
        while (node >= whole.roots && !updates.has(whole.creator(node))) {
            updates.add(whole.creator(node));
            node = whole.parents[whole.creator(node)];
        }
    }
    const front = new Front(whole);
    for (const update of [...updates].sort((a, b) => whole.levels[b] - whole.levels[a])) {
        assert.ok(front.maySplit(update, []), `update ${update} comes before what it depends on`);
        front.apply(update);
    }
    const { triangles } = front;
    const all = triangles.nodes.subarray(0, 3 * triangles.slots).filter((node) => node !== NONE);
    assert.deepEqual(sorted(faces), sorted(all));
}

/** Returns triangles from their least nodes on, in an order that depends on nothing else. */
function sorted(faces: ArrayLike<number>): string[] {
    const all: string[] = [];
    for (let at = 0; at < faces.length; at += 3) {
        const [a, b, c] = [faces[at], faces[at + 1], faces[at + 2]];
        const first = Math.min(a, b, c);
        const turned = first === a ? [a, b, c] : first === b ? [b, c, a] : [c, a, b];
        all.push(turned.join(" "));
    }
    return all.sort();
}

for (const name of conformanceNames().filter((name) => name !== "field")) {
    test(`no crack while chunks come in any order: ${name}`, () => {
        const file = conformanceFile(name);
        const header = readHeader(file);
        const finest = new Cut(decode(file));
        finest.update({ focus: null, tolerance: 0 });
        const border = borderOf(finest.model, finest.triangles);
        const random = randomNumbers(1);
        // With few chunks none is missing between others.
        const turns = header.chunks.length > 3 ? 10 : 3;
        let checked = 0;
        for (let turn = 0; turn < turns; turn++) {
            const show = new Show(file, header);
            let query = randomQuery(header, random);
            for (let moment = 0; moment < MOMENTS; moment++) {
                if (random() < 0.3) query = randomQuery(header, random);
                const wanted = show.levels.wanted(query);
                if (wanted.length > 0 && random() < 0.7)
                    show.receive(wanted[Math.floor(random() * wanted.length)], query);
                show.update(query, Math.floor(10 ** (4 * random())));
                if (random() < 0.5) continue;
                const cracks = show.openEnds().filter((place) => !border.has(place));
                assert.equal(cracks.length, 0, `turn ${turn}, moment ${moment}`);
                assertIsCutOf(finest.model, show.levels.cut);
                checked += show.count;
            }
            for (const number of show.levels.wanted(query)) show.receive(number, query);
            while (!show.update(query, Infinity));
            const whole = new Cut(decode(file));
            whole.update(query);
            assert.equal(show.levels.cut.triangles.count, whole.triangles.count);
            assert.equal(show.count, whole.triangles.count);
        }
        assert.ok(checked > 100, `${checked} triangles`);
    });
}

/** Returns a patch that writes one triangle in each of some places, and its vertices. */
function scattered(places: number[], value: number): GeometryPatch {
    const vertices = Uint32Array.from(
        places.flatMap((place) => [0, 1, 2].map((k) => 3 * place + k)),
    );
    return {
        isNew: false,
        capacity: 6000,
        vertices,
        values: new Float32Array(3 * vertices.length).fill(value),
        triangles: 2000,
        places: Uint32Array.from(places),
        index: vertices,
        parts: [{ start: 0, count: 2000 }],
    };
}

test("patches between two pictures are all sent, however many there are", () => {
    const layers: FileInfo["layers"] = [];
    const info = { center: [0, 0, 0], diagonal: 1, layers } as unknown as FileInfo;
    const mesh = new StreamGeometry(info);
    const buffers = new UploadedBuffers();
    mesh.apply(scattered([0], 1));
    const position = mesh.getAttribute("position") as BufferAttribute;
    const index = mesh.index as BufferAttribute;
    for (const patches of [1, 60, 200, 3]) {
        for (const attribute of [index, position]) buffers.upload(attribute);
        for (let patch = 0; patch < patches; patch++) {
            const places = Array.from({ length: 30 }, (_, i) => (61 * i + 7 * patch) % 2000);
            mesh.apply(scattered(places, patch + patches));
        }
        for (const attribute of [index, position])
            assert.deepEqual(buffers.upload(attribute), attribute.array, `${patches} patches`);
    }
});
