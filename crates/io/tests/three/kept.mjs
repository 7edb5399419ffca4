// Compares what the loader of three.js finds in two GLB files beside geometry, such as a file and
// its simplification: node kept.mjs INPUT OUTPUT. Ends with 1 if a count or a name differs.

import { readFileSync } from 'node:fs';
import { Texture } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

async function load(path) {
    const loader = new GLTFLoader();
    // No browser, no pictures: a texture is named after the image that it would show.
    loader.register(({ json }) => ({
        name: 'no_pictures',
        loadTexture: async (index) => {
            const texture = new Texture();
            const { name, mimeType } = json.images[json.textures[index].source];
            texture.name = `${json.textures[index].name} ${name} ${mimeType}`;
            return texture;
        },
    }));
    const bytes = readFileSync(path);
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    return loader.parseAsync(buffer, '');
}

// Names of everything in a file, by kind.
async function names(path) {
    const gltf = await load(path);
    const found = { nodes: [], cameras: [], skins: [], joints: [] };
    gltf.scene.traverse((object) => {
        found.nodes.push(`${object.type} ${object.name} ${object.material?.name}`);
        if (object.isCamera) found.cameras.push(object.name);
        if (object.isSkinnedMesh) {
            found.skins.push(object.name);
            found.joints.push(...object.skeleton.bones.map(({ name }) => name));
        }
    });
    for (const kind of ['material', 'texture']) {
        const all = await gltf.parser.getDependencies(kind);
        found[`${kind}s`] = all.map(({ name }) => name);
    }
    // A track is named after its node or, without a name, after a random number.
    const key = ({ name, times }) => `${name.replace(/^[0-9A-F-]{36}\./i, '')} ${times.length}`;
    found.animations = gltf.animations.map(
        ({ name, duration, tracks }) => `${name} ${duration} ${tracks.map(key)}`,
    );
    return found;
}

const [input, output] = await Promise.all(process.argv.slice(2, 4).map(names));
const kinds = Object.keys(input);
const counts = kinds.map((kind) => `${input[kind].length} ${kind}`).join(', ');
const other = kinds.filter((kind) => input[kind].join('\n') !== output[kind].join('\n'));
console.log(`${process.argv[3]}: ${other.length ? `other ${other.join(', ')}` : `kept ${counts}`}`);
if (other.length > 0) process.exitCode = 1;
