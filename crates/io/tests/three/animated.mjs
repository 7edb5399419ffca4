// Compares the animations of two files in the loader of three.js, at 100 times of each clip:
// node animated.mjs OLD.glb NEW.glb DEGREES. Ends with 1 if a clip or a track is missing, or a pose
// is farther off than rotations by that angle, and vectors by its arc, may be.

import { readFileSync } from 'node:fs';
import { Texture } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';

async function clips(path) {
    const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
    loader.register(() => ({ name: 'no_pictures', loadTexture: async () => new Texture() }));
    const bytes = readFileSync(path);
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    const { animations, scene, parser } = await loader.parseAsync(buffer, '');
    // Tracks of nodes without names go by ids that differ from load to load.
    const ids = new Map();
    scene.traverse((node) => ids.set(node.uuid, `node ${parser.associations.get(node)?.nodes}`));
    for (const track of animations.flatMap((clip) => clip.tracks)) {
        const [id, property] = track.name.split('.');
        track.name = `${ids.get(id) ?? id}.${property}`;
    }
    return animations;
}

function off(track, a, b, angle) {
    if (track.ValueTypeName === 'quaternion') {
        const [p, q] = [a, b].map((q) => q.map((x) => x / Math.hypot(...q)));
        const sign = p.reduce((sum, x, k) => sum + x * q[k], 0) < 0 ? -1 : 1;
        const chord = Math.hypot(...p.map((x, k) => x - sign * q[k]));
        return (4 * Math.asin(Math.min(1, chord / 2))) / angle;
    }
    let largest = 0;
    for (let i = 0; i < track.values.length; i += a.length) {
        largest = Math.max(largest, Math.hypot(...track.values.slice(i, i + a.length)));
    }
    return Math.hypot(...a.map((x, k) => x - b[k])) / (angle * largest || 1e-30);
}

const [, , oldPath, newPath, degrees] = process.argv;
const angle = (Number(degrees) * Math.PI) / 180;
const [old, packed] = await Promise.all([oldPath, newPath].map(clips));
let [worst, tracks, failed] = [0, 0, old.length === 0 || old.length !== packed.length];
for (const [i, clip] of old.entries()) {
    failed ||= clip.name !== packed[i].name || clip.duration !== packed[i].duration;
    failed ||= clip.tracks.length !== packed[i].tracks.length;
    for (const track of clip.tracks) {
        const other = packed[i].tracks.find(({ name }) => name === track.name);
        if (!other) {
            console.log(`${clip.name}: ${track.name} is missing`);
            failed = true;
            continue;
        }
        tracks += 1;
        const [p, q] = [track, other].map((track) => track.createInterpolant());
        for (let k = 0; k < 100; k += 1) {
            const time = (clip.duration * k) / 99;
            const [a, b] = [p, q].map((at) => [...at.evaluate(time)]);
            worst = Math.max(worst, off(track, a, b, angle));
        }
    }
}
console.log(`${old.length} clips, ${tracks} tracks: worst error ${worst.toFixed(3)} of what may be`);
// The loader interpolates in 32 bits, and nearly equal rotations along the chord.
process.exit(failed || !(worst <= 1.01) ? 1 : 0);
