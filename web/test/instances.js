// The page of `instances.mjs`: draws a file as instances and as copies at the same places, and compares.
import * as THREE from "three";
import { MlodLoader } from "/dist/three/index.js";

const SIZE = 256;
const COUNT = 5;
/** Greatest difference of a channel that is not counted. */
const MOST = 8;

/** Returns where one of them stands: in a row, each turned and of another size. */
function placeOf(number, { center, diagonal }) {
    const scale = 0.4 + 0.1 * number;
    const turned = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 1, 0), number);
    const at = new THREE.Vector3((number - (COUNT - 1) / 2) * diagonal, 0, 0);
    const place = new THREE.Matrix4().compose(at, turned, new THREE.Vector3().setScalar(scale));
    return place.multiply(new THREE.Matrix4().makeTranslation(...center.map((x) => -x)));
}

/** Draws until nothing more comes; returns the pixels. */
async function draw(renderer, camera, object, updated, shared) {
    const scene = new THREE.Scene();
    scene.background = new THREE.Color(0x0000ff);
    scene.add(object, new THREE.HemisphereLight(0xffffff, 0x888888, 3));
    for (let frame = 0, still = 0; frame < 500 && still < 30; frame++) {
        for (const one of updated) one.update(camera, renderer);
        renderer.render(scene, camera);
        await new Promise((resolve) => setTimeout(resolve, 20));
        const { progress } = shared;
        still = frame > 20 && progress.done && progress.missing === 0 ? still + 1 : 0;
    }
    const gl = renderer.getContext();
    const read = new Uint8Array(4 * SIZE * SIZE);
    gl.readPixels(0, 0, SIZE, SIZE, gl.RGBA, gl.UNSIGNED_BYTE, read);
    const { calls } = renderer.info.render;
    scene.remove(object);
    return { read, calls };
}

async function run() {
    const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    renderer.setSize(SIZE, SIZE, false);
    const mesh = await new MlodLoader().loadAsync("/model.mlod");
    const { diagonal } = mesh.info;
    const camera = new THREE.PerspectiveCamera(45, 1, diagonal / 100, diagonal * 100);
    camera.position.set(2 * diagonal, 2 * diagonal, 5 * diagonal);
    camera.lookAt(0, 0, 0);
    // The instances first: materials with larger images come while they are drawn.
    const instances = await mesh.instances(COUNT);
    for (let i = 0; i < COUNT; i++) instances.setMatrixAt(i, placeOf(i, mesh.info));
    const first = await draw(renderer, camera, instances, [instances], mesh);
    const faces = mesh.progress.faces;
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(0, 0), camera);
    const hits = ray.intersectObject(instances).map(({ instanceId }) => instanceId);
    instances.dispose();
    const copies = new THREE.Group();
    for (let i = 0; i < COUNT; i++) {
        const copy = i === 0 ? mesh : mesh.clone();
        copy.matrixAutoUpdate = false;
        copy.matrix.copy(placeOf(i, mesh.info));
        copies.add(copy);
    }
    const second = await draw(renderer, camera, copies, [...copies.children], mesh);
    let [covered, other] = [0, 0];
    for (let at = 0; at < first.read.length; at += 4) {
        const [a, b] = [first.read, second.read].map((all) => all.subarray(at, at + 3));
        if ([a, b].every((color) => color[0] + color[1] === 0 && color[2] === 255)) continue;
        covered++;
        if (a.some((x, k) => Math.abs(x - b[k]) > MOST)) other++;
    }
    const same = mesh.progress.faces;
    [...copies.children].forEach((copy) => copy.dispose());
    const calls = [first.calls, second.calls];
    return { error: null, covered, other, calls, faces: [faces, same], hits };
}

run().then(
    (result) => (window.result = result),
    (error) => (window.result = { error: String(error.stack ?? error) }),
);
