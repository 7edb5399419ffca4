// Shows a model while it comes, and sends pictures of it: for `figures.mjs`.

import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { look } from "/test/look.js";
import { HEIGHT, WIDTH, camera, options, renderer, scene, sent } from "./stage.js";

const { kind, file } = options;
/** Milliseconds without a request after which a client that does not say so is done. */
const QUIET = 3000;

const gltfLoader = () => new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
const drawn = () => renderer.info.render.triangles;

/** Opens a model; returns what to do in a frame, and whether all is there. */
const openers = {
    async mlod() {
        const { MlodLoader } = await import("/dist/three/index.js");
        const mesh = await new MlodLoader().loadAsync(file);
        scene.add(mesh);
        mesh.onlyInView = options.all === undefined;
        const isDone = () => mesh.progress.done && mesh.progress.missing === 0;
        const update = () => mesh.update(camera, renderer);
        return { update, isDone, faces: () => mesh.progress.faces };
    },
    async glb() {
        scene.add((await gltfLoader().loadAsync(file)).scene);
        return { update: () => undefined, isDone: () => true, faces: drawn };
    },
    async needle() {
        const { useNeedleProgressive } = await import("@needle-tools/gltf-progressive");
        const loader = gltfLoader();
        useNeedleProgressive(loader, renderer);
        scene.add((await loader.loadAsync(file)).scene);
        const isDone = ({ open, quiet_ms }) => open === 0 && quiet_ms > QUIET;
        return { update: () => undefined, isDone, faces: drawn };
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
        return { update: () => tiles.update(), isDone, faces: drawn };
    },
};

/** Sends the picture that is shown, with the number of bytes that had come. */
async function sendPicture(bytes) {
    const picture = await new Promise((resolve) => renderer.domElement.toBlob(resolve));
    await fetch(`/picture?bytes=${bytes}`, { method: "POST", body: picture });
}

export async function run() {
    const start = performance.now();
    const { update, isDone, faces } = await openers[kind]();
    let [first, still, before] = [null, 0, -1];
    while (still < 5 && performance.now() - start < 240_000) {
        const state = await sent();
        update();
        renderer.render(scene, camera);
        const { covered } = look(renderer.getContext(), WIDTH, HEIGHT);
        if (covered > 0) {
            first ??= {
                bytes: state.sent,
                ms: Math.round(performance.now() - start),
                network_ms: Math.round(state.busy_ms),
            };
        }
        still = isDone(state) ? still + 1 : 0;
        if (covered > 0 && (state.sent !== before || still === 5)) {
            before = state.sent;
            await sendPicture(state.sent);
        }
        await new Promise((resolve) => setTimeout(resolve, 20));
    }
    const { sent: bytes, requests, busy_ms } = await sent();
    const ms = Math.round(performance.now() - start);
    return { first, bytes, requests, network_ms: Math.round(busy_ms), ms, faces: faces() };
}
