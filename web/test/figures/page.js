// The page of `figures.mjs`: shows a model while it comes, and sends pictures of it.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { look } from "/test/look.js";

const [WIDTH, HEIGHT] = [1280, 720];
const options = Object.fromEntries(new URLSearchParams(location.search));
const { kind, file } = options;
const [center, away] = ["center", "away"].map(
    (key) => new THREE.Vector3(...options[key].split(",").map(Number)),
);

const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(WIDTH, HEIGHT, false);
document.body.append(renderer.domElement);
const scene = new THREE.Scene();
scene.background = new THREE.Color(0xff00ff);
const sun = new THREE.DirectionalLight(0xffffff, 2);
sun.position.set(1, 3, 2);
scene.add(sun, new THREE.AmbientLight(0xffffff, 1.5));
const camera = new THREE.PerspectiveCamera(
    45,
    WIDTH / HEIGHT,
    0.01 * away.length(),
    10 * away.length(),
);
camera.position.copy(center).add(away);
camera.lookAt(center);

const sent = async () => (await fetch("/sent")).json();

/** Opens a model; returns what to do in a frame, and whether all is there. */
const openers = {
    async mlod() {
        const { MlodLoader } = await import("/dist/three/index.js");
        const mesh = await new MlodLoader().loadAsync(file);
        scene.add(mesh);
        mesh.onlyInView = options.all === undefined;
        const isDone = () => mesh.progress.done && mesh.progress.missing === 0;
        return {
            update: () => mesh.update(camera, renderer),
            isDone,
            faces: () => mesh.progress.faces,
        };
    },
    async glb() {
        const { scene: model } = await new GLTFLoader()
            .setMeshoptDecoder(MeshoptDecoder)
            .loadAsync(file);
        scene.add(model);
        return {
            update: () => undefined,
            isDone: () => true,
            faces: () => renderer.info.render.triangles,
        };
    },
    async tiles() {
        const { TilesRenderer } = await import("3d-tiles-renderer");
        const tiles = new TilesRenderer(file);
        tiles.errorTarget = 1;
        tiles.setCamera(camera);
        tiles.setResolution(camera, WIDTH, HEIGHT);
        const handler = new GLTFLoader(tiles.manager).setMeshoptDecoder(MeshoptDecoder);
        tiles.manager.addHandler(/\.gl(b|tf)$/, handler);
        // The third axis of tiles is up.
        tiles.group.rotation.x = -0.5 * Math.PI;
        scene.add(tiles.group);
        const isDone = () => tiles.visibleTiles.size > 0 && tiles.loadProgress === 1;
        return {
            update: () => tiles.update(),
            isDone,
            faces: () => renderer.info.render.triangles,
        };
    },
};

async function run() {
    const start = performance.now();
    const { update, isDone, faces } = await openers[kind]();
    const holes = [];
    let [first, still, before] = [null, 0, -1];
    while (still < 5 && performance.now() - start < 240_000) {
        const state = await sent();
        update();
        renderer.render(scene, camera);
        const { covered, holes: found } = look(renderer.getContext(), WIDTH, HEIGHT);
        if (covered > 0) {
            first ??= {
                bytes: state.sent,
                ms: Math.round(performance.now() - start),
                network_ms: Math.round(state.busy_ms),
            };
            holes.push(found);
        }
        still = isDone() ? still + 1 : 0;
        if (covered > 0 && (state.sent !== before || still === 5)) {
            before = state.sent;
            const picture = await new Promise((resolve) => renderer.domElement.toBlob(resolve));
            await fetch(`/picture?bytes=${state.sent}`, { method: "POST", body: picture });
        }
        await new Promise((resolve) => setTimeout(resolve, 20));
    }
    const state = await sent();
    const ms = Math.round(performance.now() - start);
    return {
        first,
        bytes: state.sent,
        requests: state.requests,
        network_ms: Math.round(state.busy_ms),
        ms,
        faces: faces(),
        holes,
    };
}

run().then(
    (result) => (window.result = result),
    (error) => (window.result = { error: String(error.stack ?? error) }),
);
