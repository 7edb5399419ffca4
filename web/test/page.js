// The page of `browser.mjs`: shows a model from far away and from near, and looks at the pixels.
import * as THREE from "three";
import { coverage, readBack } from "./figures/drawn.js";
import { look } from "./look.js";

const SIZE = 256;
const BACKGROUND = 0xff00ff;
/** Where the package and the model are: here, or at another origin. */
const parameters = new URLSearchParams(location.search);
const from = parameters.get("from") ?? "";
/** Milliseconds for which vertices move. */
const morph = Number(parameters.get("morph") ?? 0);

/** Returns how many faces are hit by rays through the middle of the picture. */
function hitsOf(mesh, camera) {
    const ray = new THREE.Raycaster();
    let hits = 0;
    for (let x = -0.5; x <= 0.5; x += 0.1) {
        for (let y = -0.5; y <= 0.5; y += 0.1) {
            ray.setFromCamera(new THREE.Vector2(x, y), camera);
            hits += ray.intersectObject(mesh).length;
        }
    }
    return hits;
}

/** Returns what tells whether a mesh is there, as far as it was asked for since some progress. */
function isDoneSince(mesh, before) {
    return () => mesh.progress !== before && mesh.progress.done && mesh.progress.missing === 0;
}

/** Looks at the pixels; `missed` are holes that a triangle covers, so that there is nothing to see through. */
function inspect(gl, mesh, camera) {
    const seen = look(gl, SIZE, SIZE);
    const matrix = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).elements;
    const buffers = { ...readBack(gl), ranges: mesh.geometry.groups };
    const counts = coverage(seen.where, buffers, { matrix, width: SIZE, height: SIZE });
    return { ...seen, missed: counts.filter(({ rounded }) => rounded > 0).length };
}

async function run() {
    const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    renderer.setSize(SIZE, SIZE, false);
    document.body.append(renderer.domElement);
    const scene = new THREE.Scene();
    scene.background = new THREE.Color(BACKGROUND);
    scene.add(new THREE.HemisphereLight(0xffffff, 0x888888, 3));
    const camera = new THREE.PerspectiveCamera(45, 1, 0.001, 1e6);
    const { MlodLoader } = await import(`${from}/dist/three/index.js`);
    const loader = new MlodLoader();
    loader.limits = { morph };
    const mesh = await loader.loadAsync(`${from}/model.mlod`);
    scene.add(mesh);
    const { center, diagonal } = mesh.info;
    const [faces, looks] = [[], []];
    // Pixels of holes in pictures before the level is there, and how many such pictures.
    const moments = [0, 0];
    // From far away, from near, and from near at the finest level.
    for (const [distance, pixels] of [
        [20, 1],
        [1.5, 1],
        [1.5, 0],
    ]) {
        camera.position.set(center[0], center[1], center[2] + distance * diagonal);
        camera.lookAt(...center);
        mesh.pixels = pixels;
        const isDone = isDoneSince(mesh, mesh.progress);
        for (let frame = 0, still = 0; frame < 1000 && still < 10; frame++) {
            mesh.update(camera, renderer); // A face that is seen from behind is no crack.
            mesh.material.forEach((material) => (material.side = THREE.DoubleSide));
            renderer.render(scene, camera);
            if (!isDone() && frame % 4 === 3) {
                moments[0] += look(renderer.getContext(), SIZE, SIZE).holes;
                moments[1]++;
            }
            await new Promise((resolve) => setTimeout(resolve, 16));
            still = isDone() ? still + 1 : 0;
        }
        faces.push(mesh.progress.faces);
        looks.push(inspect(renderer.getContext(), mesh, camera));
    }
    const hits = hitsOf(mesh, camera);
    const covered = looks[1].covered / SIZE ** 2;
    const materials = mesh.material.map(({ type, map }) => (map ? `${type} map` : type));
    const copy = mesh.clone();
    mesh.dispose();
    copy.dispose();
    return {
        error: null,
        kind: mesh.info.kind,
        faces,
        bytes: mesh.progress.bytes,
        covered,
        holes: looks.map((look) => look.holes),
        missed: looks.map((look) => look.missed),
        moments,
        hit: hits > 0,
        materials,
    };
}

run().then(
    (result) => (window.result = result),
    (error) => (window.result = { error: String(error.stack ?? error) }),
);
