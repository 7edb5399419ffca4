// The page of `same.mjs`: draws two files alike, and compares the pictures.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MlodLoader, MlqLoader, MlzLoader } from "/dist/three/index.js";

const SIZE = 256;
/** Greatest difference of a channel that is not counted. */
const MOST = 48;

/** Loads a file as what a user of its loader would show, at a time of its first animation if there is one. */
async function load(url, updated, time) {
    if (url.endsWith(".mlz")) return new MlzLoader().loadMesh(url);
    if (url.endsWith(".mlq")) return new MlqLoader().loadMesh(url);
    let shown;
    if (url.endsWith(".glb")) shown = await new GLTFLoader().loadAsync(url);
    else {
        const mesh = await new MlodLoader().loadAsync(url);
        mesh.pixels = 0;
        updated.push(mesh);
        if (time === null) return mesh;
        shown = await mesh.nodes();
        updated.push(...shown.meshes.slice(1));
    }
    if (time !== null) {
        const mixer = new THREE.AnimationMixer(shown.scene);
        mixer.clipAction(shown.animations[0]).play();
        mixer.setTime(Number(time));
    }
    return shown.scene;
}

/** Draws an object from two sides; returns the pixels. */
async function draw(url, renderer, time, ball) {
    const updated = [];
    const object = await load(url, updated, time);
    const scene = new THREE.Scene();
    scene.background = new THREE.Color(0x0000ff);
    scene.add(object, new THREE.HemisphereLight(0xffffff, 0x888888, 3));
    scene.updateMatrixWorld(true);
    ball ??= new THREE.Box3().setFromObject(object, true).getBoundingSphere(new THREE.Sphere());
    const pixels = [];
    for (const side of [1, -1]) {
        const camera = new THREE.PerspectiveCamera(45, 1, ball.radius / 100, ball.radius * 100);
        camera.position
            .set(2.5 * side, 0.7, 1.2 * side)
            .multiplyScalar(ball.radius)
            .add(ball.center);
        camera.lookAt(ball.center);
        // What was said before this camera asked does not count.
        const before = updated.map(({ progress }) => progress);
        for (let frame = 0, still = 0; frame < 500 && still < 20; frame++) {
            for (const mesh of updated) mesh.update(camera, renderer);
            renderer.render(scene, camera);
            await new Promise((resolve) => setTimeout(resolve, 20));
            const isDone = updated.every(
                ({ progress }, i) =>
                    progress !== before[i] && progress.done && progress.missing === 0,
            );
            still = isDone ? still + 1 : 0;
        }
        const gl = renderer.getContext();
        const read = new Uint8Array(4 * SIZE * SIZE);
        gl.readPixels(0, 0, SIZE, SIZE, gl.RGBA, gl.UNSIGNED_BYTE, read);
        pixels.push(read);
    }
    return { pixels, ball };
}

async function run() {
    const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    renderer.setSize(SIZE, SIZE, false);
    const urls = new URLSearchParams(location.search);
    const time = urls.get("time");
    const first = await draw(urls.get("a"), renderer, time);
    const second = await draw(urls.get("b"), renderer, time, first.ball);
    let [covered, other] = [0, 0];
    first.pixels.forEach((pixels, side) => {
        for (let at = 0; at < pixels.length; at += 4) {
            const [a, b] = [pixels, second.pixels[side]].map((all) => all.subarray(at, at + 3));
            const isBackground = (color) => color[0] + color[1] === 0 && color[2] === 255;
            if (isBackground(a) && isBackground(b)) continue;
            covered++;
            if (a.some((x, k) => Math.abs(x - b[k]) > MOST)) other++;
        }
    });
    return { error: null, covered, other };
}

run().then(
    (result) => (window.result = result),
    (error) => (window.result = { error: String(error.stack ?? error) }),
);
