// Opens chains of levels with the loader of three.js, by their guides: node levels.mjs FOLDER, where
// NAME.lods.json was written by `meshlod lods`. Ends with 1 if a level is not as its guide says.

import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { Box3, LOD, PerspectiveCamera, Texture, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

async function load(path) {
    const loader = new GLTFLoader();
    // No browser, no pictures: each texture is an empty one.
    loader.register(() => ({ name: 'no_pictures', loadTexture: async () => new Texture() }));
    const bytes = readFileSync(path);
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    const { scene } = await loader.parseAsync(buffer, '');
    scene.updateMatrixWorld(true);
    return scene;
}

function faces(object) {
    let count = 0;
    object.traverse(({ isMesh, geometry }) => {
        if (isMesh) count += (geometry.index ?? geometry.attributes.position).count / 3;
    });
    return count;
}

// What the scene has at each level; only the first where the others are linked by MSFT_lod.
async function shown(guide, folder) {
    if (guide.layout === 'files') {
        const files = guide.levels.map(({ file }) => file);
        return Promise.all(files.map((file) => load(join(folder, file))));
    }
    const scene = await load(join(folder, guide.levels[0].file));
    if (guide.layout === 'msft') return [scene];
    return guide.levels.map(({ name }) => {
        const level = scene.clone();
        const other = (object) => /_LOD\d+$/.test(object.name) && !object.name.endsWith(name);
        const others = [];
        level.traverse((object) => other(object) && others.push(object));
        others.forEach((object) => object.removeFromParent());
        return level;
    });
}

// The level that three.js shows at a distance.
function at(lod, guide, distance) {
    const camera = new PerspectiveCamera(guide.field_of_view_degrees);
    camera.position.set(0, 0, distance);
    camera.updateMatrixWorld(true);
    lod.update(camera);
    return lod.getCurrentLevel();
}

async function check(guide, folder) {
    const scenes = await shown(guide, folder);
    const faults = [];
    scenes.forEach((scene, i) => {
        const expected = guide.levels[i].faces;
        if (faces(scene) !== expected) faults.push(`LOD${i}: ${faces(scene)} faces, not ${expected}`);
        const size = new Box3().setFromObject(scene).getSize(new Vector3());
        if (i === 0 && Math.abs(Math.max(...size) / guide.size - 1) > 1e-5) faults.push('other size');
    });
    const lod = new LOD();
    scenes.forEach((scene, i) => lod.addLevel(scene, guide.levels[i].distance));
    scenes.forEach((_, i) => {
        const level = at(lod, guide, guide.levels[i].distance * 1.0001 + 1e-9);
        if (level !== i) faults.push(`LOD${i}: level ${level} is shown at its distance`);
    });
    return faults;
}

const folder = process.argv[2];
let checked = 0;
for (const name of readdirSync(folder).filter((name) => name.endsWith('.lods.json')).sort()) {
    const guide = JSON.parse(readFileSync(join(folder, name), 'utf8'));
    const faults = await check(guide, folder);
    console.log(`${name} (${guide.layout}): ${faults.length ? faults.join('; ') : 'as it says'}`);
    if (faults.length) process.exitCode = 1;
    checked += 1;
}
if (checked === 0) {
    console.log('no guides found');
    process.exitCode = 1;
}
