import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { MlodError } from "../src/error.ts";
import { decodeMlq } from "../src/mlq/index.ts";
import { decodeMlz } from "../src/mlz/index.ts";
import type { PackedMesh } from "../src/packed/mesh.ts";
import { MlqLoader, MlzLoader } from "../src/three/packed_loaders.ts";
import { conformanceFolder } from "./files.ts";
import { SCHEMES, mlzHeaderLength, quadMlq, quadMlz, sealMlq, sealMlz } from "./packed_files.ts";

/** Flips a bit. */
function flipped(file: Uint8Array, bit: number): Uint8Array<ArrayBuffer> {
    const wrong = file.slice();
    wrong[bit >> 3] ^= 1 << (bit & 7);
    return new Uint8Array(wrong);
}

/** Checks that a mesh is the quad. */
function isQuad({ positions, faces, wedges, materials, resources }: PackedMesh): void {
    assert.deepEqual([faces.length, new Set(faces).size], [6, 4]);
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
}

test("small files are quads with texture coordinates", () => {
    isQuad(decodeMlz(quadMlz()));
    for (const scheme of SCHEMES) isQuad(decodeMlq(quadMlq(scheme)));
});

/** Damages a file in every way of one bit, and by its end. */
function damage(file: Uint8Array, decode: (file: Uint8Array) => PackedMesh): void {
    for (let bit = 0; bit < 8 * file.length; bit++)
        assert.throws(() => decode(flipped(file, bit)), MlodError, `bit ${bit}`);
    for (let length = 0; length < file.length; length++)
        assert.throws(() => decode(file.subarray(0, length)), MlodError, `${length}`);
    assert.throws(() => decode(new Uint8Array([...file, 0])), /1 unexpected bytes/);
}

test("every flipped bit and every early end of a file is noticed", () => {
    damage(quadMlz(), decodeMlz);
    for (const scheme of SCHEMES) damage(quadMlq(scheme), decodeMlq);
});

test("a .mlq file with matching checksums that misleads is an error, or another mesh", () => {
    for (const scheme of SCHEMES) {
        const file = quadMlq(scheme);
        let [refused, read] = [0, 0];
        for (let bit = 8 * 12; bit < 8 * file.length; bit++) {
            const wrong = flipped(file, bit);
            sealMlq(wrong);
            try {
                decodeMlq(wrong);
                read++;
            } catch (error) {
                assert.ok(error instanceof MlodError, `${scheme}, bit ${bit}: ${String(error)}`);
                refused++;
            }
        }
        assert.ok(refused > 100 && read > 100, `${scheme}: ${refused} ${read}`);
    }
});

test("the damaged place of a .mlq file is named", () => {
    const file = quadMlq("blocks");
    assert.throws(() => decodeMlq(flipped(file, 8 * 60)), /the checksum of the positions/);
    new DataView(file.buffer).setUint32(56, 0x7fffffff, true);
    sealMlq(file);
    assert.throws(() => decodeMlq(file), /^MlodError: the positions: too few bytes for 2147483647/);
    file[8] = 2;
    assert.throws(() => decodeMlq(file), /the header: version 2 is not supported/);
});

test("a .mlz file with matching checksums that misleads is an error, or another mesh", () => {
    const file = quadMlz();
    const header = mlzHeaderLength(file);
    let [refused, read] = [0, 0];
    for (let bit = 8 * 20; bit < 8 * file.length; bit += 3) {
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

test("loaders make geometries, and say what is wrong with other files", async () => {
    const [mlz, mlq] = [new MlzLoader(), new MlqLoader()];
    const made = [mlz.parse(quadMlz().buffer), mlq.parse(quadMlq("blocks").buffer)];
    for (const geometry of await Promise.all(made)) {
        assert.equal(geometry.getAttribute("position").count, 4);
        assert.equal(geometry.getAttribute("uv").count, 4);
        assert.equal(geometry.index?.count, 6);
        geometry.computeBoundingBox();
        assert.ok((geometry.boundingBox?.max.x ?? 0) > 0.98);
    }
    await assert.rejects(mlz.parse(quadMlq("blocks").buffer), /start with "meshlodz"/);
    await assert.rejects(mlq.parse(new ArrayBuffer(100)), /start with "meshlodq"/);
});
