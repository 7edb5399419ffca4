import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { MlodError } from "../src/error.ts";
import { decodeMlz } from "../src/mlz/index.ts";
import { MlzLoader } from "../src/three/packed_loaders.ts";
import { conformanceFolder } from "./files.ts";
import { mlzHeaderLength, quadMlz, sealMlz } from "./packed_files.ts";

/** Flips a bit. */
function flipped(file: Uint8Array, bit: number): Uint8Array<ArrayBuffer> {
    const wrong = file.slice();
    wrong[bit >> 3] ^= 1 << (bit & 7);
    return new Uint8Array(wrong);
}

test("a small .mlz file is a quad with texture coordinates", () => {
    const { positions, faces, wedges, materials, resources } = decodeMlz(quadMlz());
    assert.deepEqual([...faces].sort(), [0, 0, 1, 2, 2, 3]);
    assert.equal(positions.length, 12);
    assert.ok([0, 0.5, 1].every((x) => positions.some((y) => Math.abs(x - y) < 0.02)));
    const uv = wedges?.layers[0];
    assert.ok(uv && uv.kind === "uv" && wedges?.count === 4 && uv.values.length === 8);
    wedges.corners.forEach((wedge, corner) => {
        for (let k = 0; k < 2; k++) {
            const x = positions[3 * faces[corner] + k];
            assert.ok(Math.abs(uv.values[2 * wedge + k] - x) < 0.02);
        }
    });
    assert.deepEqual([materials, resources.length], [null, 0]);
});

test("every flipped bit and every early end of a .mlz file is noticed", () => {
    const file = quadMlz();
    for (let bit = 0; bit < 8 * file.length; bit++)
        assert.throws(() => decodeMlz(flipped(file, bit)), MlodError, `bit ${bit}`);
    for (let length = 0; length < file.length; length++)
        assert.throws(() => decodeMlz(file.subarray(0, length)), MlodError, `${length}`);
    assert.throws(() => decodeMlz(new Uint8Array([...file, 0])), /1 unexpected bytes/);
});

test("a .mlz file with matching checksums that misleads is an error, or another mesh", () => {
    const file = quadMlz();
    const header = mlzHeaderLength(file);
    let [refused, read] = [0, 0];
    for (let bit = 8 * 20; bit < 8 * file.length; bit++) {
        const wrong = flipped(file, bit);
        sealMlz(wrong, header);
        try {
            decodeMlz(wrong);
            read++;
        } catch (error) {
            assert.ok(error instanceof MlodError, `bit ${bit}: ${String(error)}`);
            refused++;
        }
    }
    assert.ok(refused > 100 && read > 100, `${refused} ${read}`);
});

test("the damaged place of a .mlz file is named", () => {
    const file = quadMlz();
    const header = mlzHeaderLength(file);
    const block = flipped(file, 8 * header + 3);
    sealMlz(block, header);
    assert.throws(() => decodeMlz(block), /^MlodError: block 0: its checksum does not match/);
    const blocks = file.slice();
    new DataView(blocks.buffer).setUint32(63, 0x7fffffff, true);
    sealMlz(blocks, header);
    assert.throws(() => decodeMlz(blocks), /the header: there are too few bytes for 2147483647/);
    assert.throws(() => decodeMlz(flipped(file, 0)), /the header: it does not start with/);
});

const fish = join(conformanceFolder() ?? "", "packed/fish.mlz");
const skip = conformanceFolder() === null || !existsSync(fish);
test("damaged blocks of a larger .mlz file end in errors", { skip }, () => {
    const file = new Uint8Array(readFileSync(fish));
    const header = mlzHeaderLength(file);
    let refused = 0;
    for (let i = 0; i < 50; i++) {
        const byte = header + ((i * 7919) % (file.length - header));
        const wrong = flipped(file, 8 * byte + (i % 8));
        sealMlz(wrong, header);
        try {
            decodeMlz(wrong);
        } catch (error) {
            assert.ok(error instanceof MlodError, `byte ${byte}: ${String(error)}`);
            refused++;
        }
    }
    // A bit of an attribute that is stored as it is makes another mesh.
    assert.ok(refused >= 40, `${refused}`);
});

test("MlzLoader makes a geometry, and says what is wrong with other files", async () => {
    const geometry = await new MlzLoader().parse(quadMlz().buffer);
    assert.equal(geometry.getAttribute("position").count, 4);
    assert.equal(geometry.getAttribute("uv").count, 4);
    assert.equal(geometry.index?.count, 6);
    geometry.computeBoundingBox();
    assert.ok((geometry.boundingBox?.max.x ?? 0) > 0.98);
    await assert.rejects(new MlzLoader().parse(new ArrayBuffer(100)), /start with "meshlodz"/);
});
