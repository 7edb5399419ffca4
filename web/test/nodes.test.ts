// Nodes of a file, with the mesh at its place among them.

import assert from "node:assert/strict";
import { test } from "node:test";
import { AnimationMixer, Bone, LineSegments, Matrix4, SkinnedMesh, Vector3 } from "three";
import type { Object3D } from "three";
import { MlodLoader } from "../src/three/mlod_loader.ts";
import type { MlodMesh } from "../src/three/mlod_mesh.ts";
import { nodesOf } from "../src/three/nodes.ts";
import type { SharedLevels } from "../src/three/levels.ts";
import { conformanceFile, conformanceNames, vectorFile } from "./files.ts";

const skip = conformanceNames().length === 0 && "the files are not there";

async function open(file: Uint8Array<ArrayBuffer>): Promise<MlodMesh> {
    const loader = new MlodLoader();
    loader.worker = null;
    // Without a browser there are no images.
    loader.onStreamError = () => undefined;
    return loader.parse(file.buffer);
}

function all<T extends Object3D>(root: Object3D, is: new (...parts: never[]) => T): T[] {
    const found: T[] = [];
    root.traverse((object) => void (object instanceof is && found.push(object)));
    return found;
}

/** Returns the greatest distance between where vertices are drawn and where the file has them. */
function farthest(skinned: SkinnedMesh): number {
    const { geometry } = skinned;
    const { index } = geometry;
    const [shown, inFile] = [new Vector3(), new Vector3()];
    let most = 0;
    for (const { start, count } of geometry.groups) {
        for (let at = start; at < start + count; at++) {
            const vertex = index?.getX(at) ?? 0;
            skinned.getVertexPosition(vertex, shown).applyMatrix4(skinned.matrixWorld);
            inFile.fromBufferAttribute(geometry.getAttribute("position"), vertex);
            most = Math.max(most, shown.distanceTo(inFile));
        }
    }
    return most;
}

test("a skin has its bones and its animations, and its pose at rest", { skip }, async () => {
    const mesh = await open(conformanceFile("skinned"));
    const { scene, animations, meshes } = await mesh.nodes();
    assert.deepEqual(meshes, [mesh]);
    assert.equal(animations.length, 3);
    const [skinned, ...others] = all(scene, SkinnedMesh);
    assert.ok(skinned && others.length === 0 && skinned.geometry === mesh.geometry);
    assert.equal(all(scene, Bone).length, 24);
    scene.updateMatrixWorld(true);
    const { diagonal } = mesh.info;
    const rest = farthest(skinned);
    const mixer = new AnimationMixer(scene);
    mixer.clipAction(animations[1]).play();
    mixer.setTime(0.5);
    scene.updateMatrixWorld(true);
    const moved = farthest(skinned);
    assert.ok(
        rest < 0.05 * diagonal && moved > 2 * rest,
        `${rest / diagonal}, ${moved / diagonal}`,
    );
    assert.ok(mesh.parent === scene && !mesh.layers.test(skinned.layers), "it is drawn once");
    mesh.dispose();
});

test("a mesh that nodes move is where the file has it", { skip }, async () => {
    const mesh = await open(conformanceFile("textured"));
    const { scene, animations, meshes } = await mesh.nodes();
    assert.deepEqual([animations.length, meshes.length], [0, 1]);
    scene.updateMatrixWorld(true);
    const identity = new Matrix4();
    mesh.matrixWorld.elements.forEach((x, k) =>
        assert.ok(Math.abs(x - identity.elements[k]) < 1e-6, `${k}: ${x}`),
    );
    assert.ok(mesh.parent !== scene && all(scene, LineSegments).length === 0);
    mesh.dispose();
});

test("files without nodes, and with several meshes, say so", { skip }, async () => {
    const bare = await open(vectorFile());
    await assert.rejects(bare.nodes(), /the file has no nodes/);
    bare.dispose();
    const scene = await open(conformanceFile("scene"));
    await assert.rejects(scene.nodes(), /the levels are of 2 meshes/);
    scene.dispose();
    const ended = { info: { hasScene: true }, scene: null, hasEnded: true };
    const nodes = nodesOf(bare, ended as unknown as SharedLevels);
    await assert.rejects(nodes, /the stream has ended/);
});
