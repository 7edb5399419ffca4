// Meshes of `.mlz` and `.mlq` with what they hold beside their geometry.

import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { Mesh, MeshStandardMaterial } from "three";
import { decodeMlz } from "../src/mlz/index.ts";
import { decodeMlq } from "../src/mlq/index.ts";
import { readScene } from "../src/three/packed_mesh.ts";
import { MlqLoader, MlzLoader } from "../src/three/packed_loaders.ts";
import { conformanceFolder } from "./files.ts";
import { quadMlq, quadMlz } from "./packed_files.ts";

const path = (name: string) => join(conformanceFolder() ?? "", "packed", name);
const skip = !existsSync(path("fox.mlz")) && "the files are not there";
const bytesOf = (name: string) => new Uint8Array(readFileSync(path(name)));

test("a bare mesh has one material, for what it has", async () => {
    for (const [loader, file] of [
        [new MlzLoader(), quadMlz()],
        [new MlqLoader(), quadMlq("parts")],
    ] as const) {
        const mesh = await loader.parseMesh(file.buffer);
        assert.ok(mesh instanceof Mesh && mesh.geometry.hasAttribute("uv"));
        assert.deepEqual(mesh.geometry.groups, [{ start: 0, count: 6, materialIndex: 0 }]);
        const [material] = mesh.material;
        assert.ok(mesh.material.length === 1 && material instanceof MeshStandardMaterial);
        assert.ok(material.flatShading && !material.vertexColors);
        // As TextureLoader has them.
        const geometry = await loader.parse(file.buffer);
        assert.deepEqual(mesh.geometry.attributes.uv.array, geometry.attributes.uv.array);
    }
});

test("colours are shown", { skip }, async () => {
    const mesh = await new MlzLoader().parseMesh(bytesOf("fish.mlz").buffer);
    assert.ok(mesh.geometry.hasAttribute("color"));
    assert.ok(mesh.material.every((material) => material.vertexColors));
    const last = mesh.geometry.groups.map(({ materialIndex }) => materialIndex ?? 0);
    assert.ok(Math.max(...last) < mesh.material.length);
});

test("a scene is read with its images, from either format", { skip }, () => {
    for (const mesh of [decodeMlz(bytesOf("fox.mlz")), decodeMlq(bytesOf("fox-parts.mlq"))]) {
        const stored = readScene(mesh.resources);
        assert.ok(stored?.scene.isGltf && stored.images.size === 1);
        const { materials } = JSON.parse(stored.scene.document) as { materials: unknown[] };
        assert.equal(materials.length, 1);
        assert.equal(stored.scene.slots.length, mesh.materials?.names.length);
        assert.equal(Buffer.from(stored.images.get(0)?.subarray(1, 4) ?? []).toString(), "PNG");
    }
});

test("a scene that is cut off, or has any bytes changed, is damage or a scene", { skip }, () => {
    const { resources } = decodeMlz(bytesOf("fox.mlz"));
    const { length } = resources;
    for (const end of [1, 3, 4, 5, 100, length >> 1, length - 1])
        assert.throws(() => readScene(resources.subarray(0, end)), { name: "MlodError" }, `${end}`);
    for (let at = 0; at < 60; at++) {
        const changed = resources.slice();
        changed[at] ^= 1 << (at % 8);
        try {
            readScene(changed);
        } catch (error) {
            assert.equal((error as Error).name, "MlodError", `byte ${at}: ${String(error)}`);
        }
    }
    assert.equal(readScene(resources.subarray(0, 0)), null);
});
