import assert from "node:assert/strict";
import { test } from "node:test";
import { MlodError } from "../src/error.ts";
import { FieldCut } from "../src/field/field_cut.ts";
import { FieldModel } from "../src/field/field_model.ts";
import { decodeField } from "../src/field/height_field.ts";
import { xxh64 } from "../src/zstd/xxh64.ts";
import { conformanceFile, conformanceNames } from "./files.ts";

const skip = !conformanceNames().includes("field");
const field = skip ? new Uint8Array(0) : conformanceFile("field");

test("hashes are those of the specification of XXH64", () => {
    const hash = (text: string) => xxh64(new TextEncoder().encode(text)).toString(16);
    assert.equal(hash(""), "51d8e999");
    assert.equal(hash("abc"), "ad770999");
});

test("a prefix of a height field is a coarser field", { skip }, () => {
    const whole = decodeField(field);
    assert.equal(whole.parts, whole.allParts);
    let parts = 0;
    for (let length = 0; length < field.length; length += 7) {
        const part = field.subarray(0, length);
        if (parts === 0 && length < 200) {
            try {
                decodeField(part);
            } catch (error) {
                assert.ok(error instanceof MlodError, `${length}: ${String(error)}`);
                continue;
            }
        }
        const found = decodeField(part);
        assert.ok(found.parts >= parts && found.parts < found.allParts, `${length}`);
        parts = found.parts;
    }
    assert.ok(parts > 3);
});

test("flipped bits of a height field are noticed, also in a prefix", { skip }, () => {
    const length = field.length - 200;
    const prefix = decodeField(field.subarray(0, length));
    for (let at = 8; at < field.length; at += 3) {
        const wrong = field.slice();
        wrong[at] ^= 1 << (at & 7);
        assert.throws(() => decodeField(wrong), MlodError, `${at}`);
        // Behind the header, in the parts that are there.
        if (at < 96 || at >= length - 300) continue;
        const part = wrong.subarray(0, length);
        try {
            const found = decodeField(part);
            // Some bits of a frame mean nothing; a length that is too great is a part that is cut
            // off.
            const isSame = found.heights.every((height, i) => height === prefix.heights[i]);
            assert.ok(found.parts < prefix.parts || isSame, `${at}`);
        } catch (error) {
            assert.ok(error instanceof MlodError, `${at}: ${String(error)}`);
        }
    }
});

test("a cut of a height field goes to all faces and back", { skip }, () => {
    const model = new FieldModel(decodeField(field));
    const cut = new FieldCut(model);
    const coarse = cut.triangles.count;
    assert.ok(cut.update({ focus: null, tolerance: 0 }).done);
    const { columns, rows } = model.grid;
    assert.equal(cut.triangles.count, 2 * (columns - 1) * (rows - 1));
    cut.update({ focus: null, tolerance: Infinity });
    assert.equal(cut.triangles.count, coarse);
});
