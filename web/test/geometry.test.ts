import assert from "node:assert/strict";
import { test } from "node:test";
import { Cut } from "../src/cut/cut.ts";
import type { Query } from "../src/cut/query.ts";
import { decode } from "../src/decode.ts";
import { readHeader } from "../src/file/header.ts";
import { Geometry } from "../src/load/geometry.ts";
import { Levels } from "../src/load/levels.ts";
import { Session } from "../src/load/session.ts";
import { verticesOf } from "../src/load/vertices.ts";
import { Buffers, assertSame, trianglesOf } from "./buffers.ts";
import { conformanceFile, conformanceNames, rewriteChecksums, vectorFile } from "./files.ts";

const everywhere = (tolerance: number): Query => ({ focus: null, tolerance });

for (const name of [null, ...conformanceNames().filter((name) => name !== "field")]) {
    test(`patches add up to the cut: ${name ?? "the file of the specification"}`, () => {
        const model = decode(name === null ? vectorFile() : conformanceFile(name));
        const cut = new Cut(model);
        const geometry = new Geometry(verticesOf(model));
        const buffers = new Buffers(verticesOf(model).width);
        const { diagonal } = model.header;
        for (const part of [1, 1e-2, 1e-3, 2e-2, 1e-4, 1e-3, 0, 1, 3e-3]) {
            cut.update(everywhere(part * diagonal));
            const patch = geometry.follow(cut.triangles);
            if (patch) buffers.apply(patch);
            assertSame(buffers.triangles(), trianglesOf(cut), `${part}`);
        }
    });
}

test("a small change costs little", { skip: conformanceNames().length === 0 }, () => {
    const model = decode(conformanceFile("bare"));
    const cut = new Cut(model);
    const geometry = new Geometry(verticesOf(model));
    cut.update(everywhere(1e-3 * model.header.diagonal));
    geometry.follow(cut.triangles);
    cut.update(everywhere(0.99e-3 * model.header.diagonal));
    const patch = geometry.follow(cut.triangles);
    assert.ok(patch === null || patch.places.length < cut.triangles.count / 10);
});

for (const name of conformanceNames().filter((name) => name !== "field")) {
    test(`chunks in any order, and some that are evicted, give the same cuts: ${name}`, () => {
        const file = conformanceFile(name);
        const header = readHeader(file);
        const part = (at: number, length: number) => file.subarray(at, at + length);
        const base = part(header.base.at, header.base.length);
        const numbers = header.chunks.map((_, number) => number);
        const bytesOf = (number: number) => {
            const { at, length } = header.chunks[number];
            return [number, part(at, length)] as const;
        };
        const query = everywhere(1e-3 * header.diagonal);
        const whole = new Cut(decode(file));
        whole.update(query);
        const levels = new Levels(header, base, Infinity);
        for (const number of numbers.reverse()) levels.add([bytesOf(number)], query);
        levels.cut.update(query);
        assertSame(trianglesOf(levels.cut), trianglesOf(whole), name);
        // Room for no more than the first chunk.
        const small = new Levels(header, base, 120 * header.chunks[0].updates);
        assert.deepEqual(small.wanted(everywhere(0)), [0]);
    });
}

test(
    "chunks that are needed but have no room go",
    { skip: conformanceNames().length === 0 },
    () => {
        const file = conformanceFile("bare");
        const header = readHeader(file);
        const { base, chunks } = header;
        assert.ok(chunks.length > 2);
        const part = (at: number, length: number) => file.subarray(at, at + length);
        const room = 120 * (chunks[0].updates + chunks[1].updates);
        const levels = new Levels(header, part(base.at, base.length), room);
        for (const number of [2, 0, 1]) {
            const { at, length } = chunks[number];
            levels.add([[number, part(at, length)]], everywhere(0));
        }
        assert.equal(levels.count, 2);
    },
);

/** Makes the index belittle the second chunk, so that the query returned goes without. */
function belittleSecond(file: Uint8Array): Query {
    const { chunks, frame } = readHeader(file);
    const [, second, third] = chunks;
    new DataView(file.buffer).setFloat32(88 + 2 * 44 - 4, 1e-3 * third.error, true);
    rewriteChecksums(file);
    assert.ok(second.error > 0.5 * third.error);
    return everywhere(0.5 * third.error * frame.unit);
}

test(
    "a cut that starts anew is shown once it is fine",
    { skip: conformanceNames().length === 0 },
    async () => {
        const file = conformanceFile("bare");
        const header = readHeader(file);
        const gap = belittleSecond(file);
        let [stage, shown, least, renewals] = [0, 0, Infinity, 0];
        await new Promise<void>((resolve, reject) => {
            const session = new Session((event) => {
                if (event.kind === "failed") reject(new Error(event.why));
                if (event.kind === "patch") {
                    shown = event.patch.parts.reduce((sum, { count }) => sum + count, 0);
                    if (stage === 2) least = Math.min(least, shown);
                    if (stage === 2 && event.patch.isNew) renewals++;
                }
                if (event.kind !== "progress" || !event.progress.done || event.progress.missing)
                    return;
                if (stage === 2) return resolve();
                const query = stage++ === 0 ? gap : everywhere(0);
                if (stage === 2) least = shown;
                session.receive({ kind: "query", query });
            });
            session.receive({ kind: "open", origin: { bytes: file }, limits: { slice: 0.1 } });
        });
        assert.ok(renewals > 0 && least > 2 * header.baseFaces, `${renewals}, ${least}`);
    },
);
