// Moves a camera while a model comes, and looks for cracks at random moments: for `cracks.mjs`.

import * as THREE from "three";
import { MlodLoader } from "/dist/three/index.js";
import { openEdges, placeOf } from "/test/edges.js";
import { look } from "/test/look.js";
import { coverage, readBack } from "./drawn.js";
import { HEIGHT, WIDTH, away, camera, center, options, renderer, scene } from "./stage.js";

/** Open edges that are told of at each moment, and pixels that are looked into. */
const MOST_EDGES = 20_000;
const MOST_PIXELS = 50;

/** Numbers below 1 that are the same in each run. */
let state = Number(options.seed);
function random() {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
}

/** Goes to another place, near or far, and looks past the middle. */
function moveCamera() {
    const aside = () =>
        new THREE.Vector3(random() - 0.5, random() - 0.5, random() - 0.5).normalize();
    const direction = away
        .clone()
        .normalize()
        .addScaledVector(aside(), 0.5 * random());
    camera.position.copy(center).addScaledVector(direction, away.length() * (0.6 + random()));
    camera.lookAt(center.clone().addScaledVector(aside(), 0.2 * random() * away.length()));
}

function isSame(drawn, kept, count) {
    for (let at = 0; at < count; at++) if (drawn[at] !== kept[at]) return false;
    return true;
}

/** Looks at what has just been drawn. */
function inspect(mesh) {
    const gl = renderer.getContext();
    const { index, positions } = readBack(gl);
    const { groups } = mesh.geometry;
    const kept = [mesh.geometry.index.array, mesh.geometry.getAttribute("position").array];
    const last = Math.max(...groups.map(({ start, count }) => start + count));
    const edges = openEdges(index, groups, positions);
    const { covered, where } = look(gl, WIDTH, HEIGHT);
    const matrix = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).elements;
    const view = { matrix, width: WIDTH, height: HEIGHT };
    const buffers = { index, ranges: groups, positions };
    const pixels = where.slice(0, MOST_PIXELS);
    return {
        faces: groups.reduce((sum, { count }) => sum + count / 3, 0),
        covered,
        isUploaded: isSame(index, kept[0], last) && isSame(positions, kept[1], positions.length),
        open: edges.length,
        ends: edges.slice(0, MOST_EDGES).map((ends) => ends.map((v) => placeOf(positions, 3 * v))),
        holes: where.length,
        pixels: pixels.length > 0 ? coverage(pixels, buffers, view) : [],
    };
}

export async function run() {
    const mesh = await new MlodLoader().loadAsync(options.file);
    scene.add(mesh);
    mesh.onlyInView = options.all === undefined;
    const moments = [];
    while (moments.length < Number(options.moments)) {
        if (random() < 0.25) moveCamera();
        // The worker goes on meanwhile, so several patches may come between two pictures.
        await new Promise((resolve) => setTimeout(resolve, 200 * random() ** 2));
        mesh.update(camera, renderer);
        renderer.render(scene, camera);
        if (mesh.geometry.groups.length === 0) continue;
        const { progress } = mesh;
        moments.push({ ...inspect(mesh), bytes: progress.bytes, missing: progress.missing });
    }
    return moments;
}
