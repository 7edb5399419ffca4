import assert from "node:assert/strict";
import { test } from "node:test";
import { Cut } from "../src/cut/cut.ts";
import { decode } from "../src/decode.ts";
import { NONE } from "../src/model.ts";
import { vectorFile } from "./files.ts";

const finest = { focus: null, tolerance: 0 } as const;

test("the file of the specification has the nodes and faces that it lists", () => {
    const model = decode(vectorFile());
    const cell = (node: number) =>
        [0, 1, 2].map((k) => model.positions[3 * node + k] / model.header.cell);
    assert.deepEqual(cell(0), [32, 0, -31]);
    assert.deepEqual(
        [cell(7), cell(8)],
        [
            [-32, -1, 32],
            [28, -5, 30],
        ],
    );
    assert.deepEqual(
        [cell(36), cell(46)],
        [
            [0, -9, 16],
            [16, 0, 16],
        ],
    );
    const cut = new Cut(model);
    assert.equal(cut.triangles.count, 1);
    const change = cut.update(finest);
    assert.deepEqual([change.splits, change.done], [22, true]);
    assert.deepEqual([cut.triangles.count, cut.vertices], [32, 25]);
    const faces = facesOf(cut.triangles.nodes);
    assert.ok(faces.includes("3 10 45") && faces.includes("41 42 46") && faces.length === 32);
});

test("a cut goes back to the base mesh", () => {
    const cut = new Cut(decode(vectorFile()));
    cut.update(finest);
    const { merges } = cut.update({ focus: null, tolerance: Infinity });
    assert.deepEqual([merges, cut.triangles.count, cut.vertices], [22, 1, 3]);
});

test("invalid queries are refused and change nothing", () => {
    const cut = new Cut(decode(vectorFile()));
    for (const tolerance of [-1, NaN]) {
        assert.throws(() => cut.update({ focus: null, tolerance }), RangeError);
    }
    const point = [0, NaN, 0] as const;
    assert.throws(() => cut.update({ focus: { point }, tolerance: 0 }), RangeError);
    assert.throws(
        () =>
            cut.update({
                focus: {
                    box: [
                        [1, 0, 0],
                        [0, 1, 1],
                    ],
                },
                tolerance: 0,
            }),
        RangeError,
    );
    assert.equal(cut.triangles.count, 1);
});

/** Returns the faces, each from its lowest node. */
function facesOf(nodes: Uint32Array): string[] {
    const faces: string[] = [];
    for (let at = 0; at < nodes.length; at += 3) {
        const face = [...nodes.subarray(at, at + 3)];
        if (face[0] === NONE) continue;
        const first = face.indexOf(Math.min(...face));
        faces.push([0, 1, 2].map((k) => face[(first + k) % 3]).join(" "));
    }
    return faces;
}
