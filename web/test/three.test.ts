import assert from "node:assert/strict";
import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { test } from "node:test";
import { Box3, Mesh, PerspectiveCamera, Raycaster, Scene, Vector2, Vector3 } from "three";
import { MlodLoader } from "../src/three/mlod_loader.ts";
import type { MlodMesh } from "../src/three/mlod_mesh.ts";
import { vectorFile } from "./files.ts";

const renderer = { getDrawingBufferSize: (size: Vector2) => size.set(640, 480) };

function loader(): MlodLoader {
    const loader = new MlodLoader();
    loader.worker = null;
    return loader;
}

/** Looks at a mesh from a distance in diagonals, until what it needs is there. */
async function look(mesh: MlodMesh, distance: number): Promise<PerspectiveCamera> {
    const { center, diagonal } = mesh.info;
    const camera = new PerspectiveCamera(45, 4 / 3, 0.01, 1e6);
    camera.position.set(center[0], center[1] + distance * diagonal, center[2]);
    camera.up.set(0, 0, 1);
    camera.lookAt(...center);
    mesh.update(camera, renderer);
    for (let i = 0; i < 100; i++) {
        await new Promise((resolve) => setTimeout(resolve, 5));
        if (i > 5 && mesh.progress?.done && mesh.progress.missing === 0) break;
    }
    return camera;
}

test("a mesh follows its camera, and goes back", async () => {
    const mesh = await loader().parse(vectorFile().buffer);
    assert.ok(mesh instanceof Mesh && mesh.isMlodMesh);
    await look(mesh, 1e5);
    assert.equal(mesh.progress?.faces, 1);
    await look(mesh, 2);
    assert.equal(mesh.progress?.faces, 32);
    const drawn = mesh.geometry.groups.reduce((sum, group) => sum + group.count, 0);
    assert.equal(drawn, 96);
    await look(mesh, 1e5);
    assert.equal(mesh.progress?.faces, 1);
    mesh.dispose();
});

test("a budget of faces is kept, and given up again", async () => {
    const mesh = await loader().parse(vectorFile().buffer);
    mesh.mostFaces = 20;
    for (let i = 0; i < 20; i++) await look(mesh, 2);
    const faces = mesh.progress?.faces ?? 0;
    assert.ok(faces > 5 && faces <= 20, `${faces} faces`);
    mesh.mostFaces = Infinity;
    for (let i = 0; i < 20; i++) await look(mesh, 2);
    assert.equal(mesh.progress?.faces, 32);
    mesh.dispose();
});

test("pixels are those of the mesh as it is scaled and placed", async () => {
    const mesh = await loader().parse(vectorFile().buffer);
    new Scene().add(mesh);
    mesh.scale.setScalar(1e5);
    mesh.position.set(0, -3e5 * mesh.info.diagonal, 0);
    await look(mesh, 1e5);
    // At four diagonals in its own place, not at 10⁵.
    assert.ok((mesh.progress?.faces ?? 0) > 20);
    mesh.dispose();
    assert.equal(mesh.parent, null);
});

test("rays hit what is shown", async () => {
    const mesh = await loader().parse(vectorFile().buffer);
    const camera = await look(mesh, 2);
    camera.updateMatrixWorld();
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(0, 0), camera);
    const [hit] = ray.intersectObject(mesh);
    assert.ok(
        hit && hit.point.distanceTo(new Vector3(...mesh.info.center)) < 0.5 * mesh.info.diagonal,
    );
    mesh.dispose();
});

test("copies share a level, the one that the nearest needs", async () => {
    const mesh = await loader().parse(vectorFile().buffer);
    const copy = mesh.clone();
    assert.ok(copy.geometry === mesh.geometry && copy.material === mesh.material);
    await look(mesh, 2);
    await look(copy, 1e5);
    assert.equal(copy.progress?.faces, 32);
    mesh.dispose();
    await look(copy, 1e5);
    assert.equal(copy.progress?.faces, 1);
    copy.dispose();
});

test("a file that is none is an error of the loader", async () => {
    await assert.rejects(loader().parse(new ArrayBuffer(100)), /does not start with "meshlodm"/);
});

test("a mesh has its coarsest level from the start, and bounds of what is shown", async () => {
    const mesh = await loader().parse(vectorFile().buffer);
    const size = () => new Box3().setFromObject(mesh).getSize(new Vector3()).length();
    assert.equal(mesh.progress?.faces, 1);
    // The origin, where unused vertices are, is outside.
    mesh.position.set(1e3, 0, 0);
    const coarse = size();
    assert.ok(coarse > 0 && coarse < 2 * mesh.info.diagonal);
    mesh.position.set(0, 0, 0);
    await look(mesh, 2);
    assert.ok(Math.abs(size() - mesh.info.diagonal) < 0.1 * mesh.info.diagonal);
    assert.notEqual(size(), coarse);
    mesh.dispose();
});

test("a mesh without size, or a camera that is nowhere, changes nothing", async () => {
    const mesh = await loader().parse(vectorFile().buffer);
    const camera = await look(mesh, 1e5);
    mesh.scale.setScalar(0);
    await look(mesh, 1e5);
    assert.equal(mesh.progress?.faces, 1);
    mesh.scale.setScalar(1);
    camera.position.x = NaN;
    mesh.update(camera, renderer);
    await look(mesh, 2);
    assert.equal(mesh.progress?.faces, 32);
    mesh.dispose();
});

test("requests have the headers that the loader is given", async () => {
    const asked: (string | undefined)[] = [];
    const server = createServer((request, response) => {
        asked.push(request.headers.authorization);
        response.end(vectorFile());
    });
    await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
    const { port } = server.address() as AddressInfo;
    const authorized = loader().setRequestHeader({ Authorization: "Bearer 1" });
    (await authorized.loadAsync(`http://127.0.0.1:${port}/`)).dispose();
    server.close();
    assert.deepEqual(asked, ["Bearer 1"]);
});
