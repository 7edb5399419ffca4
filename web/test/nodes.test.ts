// Nodes of a file, with the mesh at its place among them.

import assert from "node:assert/strict";
import { test } from "node:test";
import {
    AnimationMixer,
    Bone,
    Box3,
    LineSegments,
    Matrix4,
    Mesh,
    PerspectiveCamera,
    SkinnedMesh,
    Vector3,
} from "three";
import type { Object3D } from "three";
import { MlodLoader } from "../src/three/mlod_loader.ts";
import type { MlodMesh } from "../src/three/mlod_mesh.ts";
import { nodesOf } from "../src/three/nodes.ts";
import type { SharedLevels } from "../src/three/levels.ts";
import { conformanceFile, conformanceNames, vectorFile } from "./files.ts";

const skip = conformanceNames().length === 0 && "the files are not there";

async function open(file: Uint8Array<ArrayBuffer>, morph = 0): Promise<MlodMesh> {
    const loader = new MlodLoader();
    loader.limits = { morph };
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

/** Returns the triangles that a mesh draws, as sorted texts of their positions. */
function trianglesOf({ geometry }: Mesh): string[] {
    const { index, groups } = geometry;
    const { array } = geometry.getAttribute("position");
    const corner = (at: number) => {
        const vertex = index?.getX(at) ?? 0;
        return array.slice(3 * vertex, 3 * vertex + 3).join(",");
    };
    const drawn = groups.flatMap(({ start, count }) =>
        Array.from({ length: count / 3 }, (_, i) =>
            [0, 1, 2].map((k) => corner(start + 3 * i + k)).join(" "),
        ),
    );
    return drawn.sort();
}

/** Asks for all of a mesh, and waits until it is there. */
async function finest(mesh: MlodMesh): Promise<void> {
    const camera = new PerspectiveCamera(45, 1, 0.01, 1e6);
    camera.position.set(0, 0, 3 * mesh.info.diagonal);
    mesh.pixels = 0;
    for (let i = 0; i < 400; i++) {
        mesh.update(camera, { getDrawingBufferSize: (size) => size.set(640, 480) });
        await new Promise((resolve) => setTimeout(resolve, 5));
        if (i > 5 && mesh.progress?.done && mesh.progress.missing === 0) return;
    }
    assert.fail("the finest level does not come");
}

test(
    "each mesh of a file has its own triangles, at each node that shows it",
    { skip },
    async () => {
        for (const morph of [0, 30]) {
            const mesh = await open(conformanceFile("scene"), morph);
            const early = mesh.clone();
            const { scene, animations, meshes } = await mesh.nodes();
            assert.equal((await mesh.nodes()).scene, scene);
            assert.equal(animations.length, 1);
            const drawn = all(scene, Mesh).filter(({ layers }) => layers.mask !== 0);
            drawn.sort((a, b) => trianglesOf(b).length - trianglesOf(a).length);
            const [body, ...wheels] = drawn;
            assert.ok(body && wheels.length === 2 && wheels[0].geometry === wheels[1].geometry);
            for (const isFinest of [false, true]) {
                if (isFinest) await finest(mesh);
                const apart = [...trianglesOf(body), ...trianglesOf(wheels[0])];
                assert.deepEqual(apart.sort(), trianglesOf(mesh));
                assert.ok(trianglesOf(wheels[0]).length > 0);
                assert.equal(isFinest, apart.length > 2500, `${apart.length} triangles`);
            }
            assert.equal(early.geometry, mesh.geometry);
            scene.updateMatrixWorld(true);
            const [wheel, other] = wheels.map((wheels) => new Box3().setFromObject(wheels));
            assert.ok(!wheel.isEmpty() && !wheel.intersectsBox(other), "wheels are in two places");
            // The level is chosen for both places of the wheels.
            assert.ok(meshes.length === 2 && meshes.every(({ layers }) => layers.mask === 0));
            assert.ok(mesh.followers.length === 3 && mesh.followers.every(follows(mesh)));
            for (const mesh of [...meshes, early]) mesh.dispose();
        }
    },
);

function follows(mesh: MlodMesh): (other: Mesh) => boolean {
    return ({ material }) => material === mesh.material;
}

test("of several places the one nearest to the camera chooses the level", async () => {
    const mesh = await open(vectorFile());
    const instances = await mesh.instances(3);
    const { diagonal } = mesh.info;
    for (const [i, x] of [0, 1e5, 2e5].entries())
        instances.setMatrixAt(i, new Matrix4().makeTranslation(x * diagonal, 0, 0));
    const camera = new PerspectiveCamera(45, 4 / 3, 0.01, 1e6);
    const faces = async (x: number, z: number) => {
        camera.position.set(x * diagonal, 0, z * diagonal);
        for (let i = 0; i < 20; i++) {
            instances.update(camera, { getDrawingBufferSize: (size) => size.set(640, 480) });
            await new Promise((resolve) => setTimeout(resolve, 5));
        }
        return mesh.progress?.faces;
    };
    assert.equal(await faces(1e5, 2), 32);
    assert.equal(await faces(1e5, 1e5), 1);
    instances.position.x = -2e5 * diagonal;
    assert.equal(await faces(0, 2), 32);
    instances.count = 2;
    assert.equal(await faces(0, 2), 1);
    assert.ok(instances.geometry === mesh.geometry && follows(mesh)(instances));
    mesh.dispose();
    assert.equal(await faces(-1e5, 2), 32);
    instances.dispose();
});

test("files without nodes say so", { skip }, async () => {
    const bare = await open(vectorFile());
    await assert.rejects(bare.nodes(), /the file has no nodes/);
    bare.dispose();
    const ended = { info: { hasScene: true }, scene: null, hasEnded: true };
    const nodes = nodesOf(bare.clone(), ended as unknown as SharedLevels);
    await assert.rejects(nodes, /the stream has ended/);
});
