// Where the level changes vertices move: nothing jumps, nothing opens, and the end is the cut.

import assert from "node:assert/strict";
import { test } from "node:test";
import { Cut } from "../src/cut/cut.ts";
import type { Query } from "../src/cut/query.ts";
import { decode } from "../src/decode.ts";
import { readHeader } from "../src/file/header.ts";
import type { GeometryPatch } from "../src/load/geometry.ts";
import { Levels } from "../src/load/levels.ts";
import type { Event, StreamLimits } from "../src/load/messages.ts";
import { FRAME, MovingGeometry } from "../src/load/morph.ts";
import { Session } from "../src/load/session.ts";
import { verticesOf } from "../src/load/vertices.ts";
import type { Model } from "../src/model.ts";
import { Buffers, assertSame, trianglesOf } from "./buffers.ts";
import { conformanceFile, conformanceNames, vectorFile } from "./files.ts";
import { randomNumbers } from "./random.ts";

const TIME = 100;
/** Models without a border. */
const CLOSED = ["bare", "pieces"];

const everywhere = (tolerance: number): Query => ({ focus: null, tolerance });

/** A cut that is shown with moving vertices, at times that the test sets. */
class Show {
    readonly cut: Cut;
    readonly buffers: Buffers;
    geometry: MovingGeometry;
    now = 0;
    /** Numbers of patches that changed triangles, and of pictures in which vertices moved. */
    changes = 0;
    moves = 0;

    constructor(
        model: Model,
        private readonly isClosed: boolean,
    ) {
        this.cut = new Cut(model);
        this.geometry = new MovingGeometry(model, TIME);
        this.buffers = new Buffers(verticesOf(model).width);
        const patch = this.geometry.refine(this.cut.triangles, null);
        assert.ok(patch);
        this.buffers.apply(patch);
    }

    /** Applies a patch, which may move vertices or change triangles, but not what is seen. */
    apply(patch: GeometryPatch | null): void {
        if (!patch) return;
        const before = patch.places.length > 0 ? this.buffers.places() : null;
        this.buffers.apply(patch);
        if (before) assertSame(this.buffers.places(), before, `what is seen at ${this.now}`);
        if (before) this.changes++;
        else this.moves++;
        if (this.isClosed) assert.equal(this.buffers.openEdges(), 0, `open edges at ${this.now}`);
    }

    /** Lets time go on. */
    wait(time: number): void {
        this.now += time;
        this.geometry.tick(this.now).forEach((patch) => this.apply(patch));
    }

    /** Does what a session does in one step. */
    step(query: Query, changes: number): boolean {
        if (this.geometry.isHeld) return false;
        const { geometry, cut } = this;
        const { done } = cut.update(query, { changes }, () =>
            this.apply(geometry.refine(cut.triangles)),
        );
        this.apply(geometry.coarsen(cut.triangles));
        return done;
    }

    /** Waits until nothing moves any more. */
    settle(): void {
        for (let i = 0; i < 100 && this.geometry.isMoving; i++) this.wait(FRAME);
        assert.ok(!this.geometry.isMoving && !this.geometry.isHeld);
    }
}

for (const name of [null, ...conformanceNames().filter((name) => name !== "field")]) {
    const file = () => (name === null ? vectorFile() : conformanceFile(name));
    test(`nothing jumps where the level changes: ${name ?? "the file of the specification"}`, () => {
        const model = decode(file());
        const show = new Show(model, CLOSED.includes(name ?? ""));
        const random = randomNumbers(1);
        const { diagonal, frame } = model.header;
        for (let round = 0; round < (name === "pieces" ? 6 : 15); round++) {
            const tolerance = diagonal * 10 ** (-4 * random());
            const center = [0, 1, 2].map(
                (k) => frame.origin[k] + 0.5 * diagonal * (random() - 0.5),
            ) as [number, number, number];
            const sphere = { center, radius: 0.3 * diagonal };
            const query = { focus: random() < 0.5 ? { sphere } : null, tolerance };
            for (let i = 0; i < 8; i++) {
                show.step(query, 10 ** (4 * random()));
                show.wait(2 * FRAME * random());
            }
        }
        for (const part of [1e-3, 1]) {
            do show.settle();
            while (!show.step(everywhere(part * diagonal), Infinity));
            show.settle();
            assertSame(show.buffers.triangles(), trianglesOf(show.cut), `${part}`);
        }
        assert.ok(show.changes > 5 && show.moves > 20, `${show.changes}, ${show.moves}`);
    });
}

test(
    "half of the time is half of the way, of attributes, too",
    { skip: !conformanceNames().includes("textured") && "the file is not there" },
    () => {
        const model = decode(conformanceFile("textured"));
        const show = new Show(model, false);
        const { width } = verticesOf(model);
        const { diagonal } = model.header;
        const places = () => Array.from(show.buffers.values);
        for (const tolerance of [1e-3 * diagonal, 1e-2 * diagonal]) {
            show.step(everywhere(tolerance), Infinity);
            const from = places();
            show.wait(TIME / 2);
            const middle = places();
            const room = show.buffers.values.slice();
            const moved = new Buffers(width);
            Object.assign(moved, { values: room });
            show.geometry
                .tick(show.now + TIME)
                .forEach((patch, i) => i === 0 && moved.apply(patch));
            const to = Array.from(moved.values);
            let [most, attributes] = [0, 0];
            middle.forEach((x, at) => {
                const half = (from[at] + to[at]) / 2;
                assert.ok(Math.abs(x - half) <= 1e-5 * (diagonal + Math.abs(half)), `${at}`);
                const way = Math.abs(to[at] - from[at]);
                if (at % width < 3) most = Math.max(most, way);
                else if (way > 0) attributes++;
            });
            assert.ok(most > 0.01 * diagonal, "some vertices have a way to go");
            assert.ok(attributes > 100, "and so have their attributes");
            show.geometry = new MovingGeometry(model, TIME);
            const patch = show.geometry.refine(show.cut.triangles, null);
            if (patch) show.buffers.apply(patch);
            show.now = 0;
        }
    },
);

test(
    "of too many vertices nothing moves",
    { skip: !conformanceNames().includes("pieces") && "the file is not there" },
    () => {
        const model = decode(conformanceFile("pieces"));
        const cut = new Cut(model);
        const geometry = new MovingGeometry(model, TIME);
        geometry.refine(cut.triangles, null);
        cut.update(everywhere(0), {}, () => void geometry.refine(cut.triangles));
        assert.ok(cut.vertices > 20_000 && !geometry.isMoving);
        cut.update(everywhere(1e-3 * model.header.diagonal));
        geometry.coarsen(cut.triangles);
        assert.ok(!geometry.isMoving && !geometry.isHeld);
    },
);

test(
    "a cut that is decoded anew goes on from what is shown",
    { skip: !conformanceNames().includes("bare") && "the file is not there" },
    () => {
        const file = conformanceFile("bare");
        const header = readHeader(file);
        const part = (at: number, length: number) => file.subarray(at, at + length);
        const chunk = (number: number) => {
            const { at, length } = header.chunks[number];
            return [number, part(at, length)] as const;
        };
        const query = everywhere(0);
        const levels = new Levels(header, part(header.base.at, header.base.length), Infinity);
        levels.add([chunk(0), chunk(2)], query);
        levels.noteGaps(query);
        levels.cut.update(query);
        const before = new MovingGeometry(levels.cut.model, TIME);
        const buffers = new Buffers(3);
        const first = before.refine(levels.cut.triangles, null);
        if (first) buffers.apply(first);
        const places = buffers.places();
        assert.ok(levels.add([chunk(1)], query), "the cut is another one");
        levels.noteGaps(query);
        levels.cut.update(query);
        const after = new MovingGeometry(levels.cut.model, TIME);
        const patch = after.refine(levels.cut.triangles, before);
        assert.ok(patch?.isNew && after.isMoving);
        buffers.apply(patch);
        assertSame(buffers.places(), places, "what is seen");
        for (let now = 0; after.isMoving; now += FRAME)
            after.tick(now).forEach((moved) => buffers.apply(moved));
        assert.notDeepEqual(buffers.places(), places);
        assertSame(buffers.triangles(), trianglesOf(levels.cut), "the end");
    },
);

/** Shows a file as fine and then as coarse as it is; returns all that is told. */
function eventsOf(file: Uint8Array, limits: StreamLimits): Promise<Event[]> {
    const events: Event[] = [];
    let stage = 0;
    return new Promise((resolve, reject) => {
        const session = new Session((event) => {
            events.push(event);
            if (event.kind === "failed") reject(new Error(event.why));
            if (event.kind !== "progress" || !event.progress.done || event.progress.missing > 0)
                return;
            if (stage === 2) return resolve(events);
            const query = everywhere(stage++ === 0 ? 0 : 1e9);
            session.receive({ kind: "query", query });
        });
        session.receive({
            kind: "open",
            origin: { bytes: file },
            limits: { slice: 1e9, ...limits },
        });
    });
}

test("a stream is done when nothing moves, and without morphs it sends none", async () => {
    const shown = (events: Event[]) => {
        const buffers = new Buffers(3);
        const patches = events.flatMap((event) => (event.kind === "patch" ? [event.patch] : []));
        const { length } = patches[0].vertices;
        assert.equal(patches[0].values.length, 3 * length);
        for (const patch of patches) buffers.apply(patch);
        return { end: buffers.triangles(), patches };
    };
    const still = shown(await eventsOf(vectorFile(), {}));
    const moving = shown(await eventsOf(vectorFile(), { morph: 50 }));
    assert.deepEqual(moving.end, still.end);
    assert.ok(still.patches.every(({ places }) => places.length > 0));
    const moves = moving.patches.filter(({ places }) => places.length === 0);
    assert.ok(moves.length >= 2, `${moves.length} pictures in between`);
});
