// Loads NAME.*.glb from a folder with the loader of three.js and compares each with
// NAME.plain.glb: node check.mjs FOLDER. Ends with 1 on any difference beyond the cells.

import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { Box3, Texture, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';

// How far attributes may be off with 8 bits for normals and colours, 12 for texture coordinates.
const ATTRIBUTES = { normal: 0.02, tangent: 0.02, uv: 1 / 4096, uv1: 1 / 4096, color: 1 / 255 };

async function load(path) {
    const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
    // No browser, no pictures: each texture is an empty one.
    loader.register(() => ({ name: 'no_pictures', loadTexture: async () => new Texture() }));
    const bytes = readFileSync(path);
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
    const { scene } = await loader.parseAsync(buffer, '');
    scene.updateMatrixWorld(true);
    const meshes = [];
    scene.traverse((object) => object.isMesh && meshes.push(object));
    return meshes.map((mesh, index) => read(mesh, index));
}

// A mesh as faces of vertices: number, place in the world, attributes.
function read(mesh, index) {
    const { attributes } = mesh.geometry;
    const at = (i) => {
        const vertex = { place: new Vector3().fromBufferAttribute(attributes.position, i) };
        vertex.place.applyMatrix4(mesh.matrixWorld);
        vertex.number = attributes._number ? attributes._number.getX(i) : `${index}/${i}`;
        for (const name of Object.keys(ATTRIBUTES).filter((name) => attributes[name])) {
            const { itemSize } = attributes[name];
            vertex[name] = [...Array(itemSize).keys()].map((k) =>
                attributes[name].getComponent(i, k),
            );
        }
        return vertex;
    };
    const vertices = [...Array(attributes.position.count).keys()].map(at);
    const faces = [];
    for (let i = 0; i < mesh.geometry.index.count; i += 3) {
        faces.push([0, 1, 2].map((k) => mesh.geometry.index.getX(i + k)));
    }
    const whole = !(attributes.position.array instanceof Float32Array);
    const cell = whole ? mesh.matrixWorld.getMaxScaleOnAxis() : 0;
    return { vertices, faces, cell, box: new Box3().setFromObject(mesh) };
}

// The numbers of each face from the least on, all sorted.
function connectivity(meshes) {
    const names = meshes.flatMap(({ vertices, faces }) =>
        faces.map((face) => {
            const numbers = face.map((i) => vertices[i].number);
            const least = numbers.indexOf(numbers.reduce((a, b) => (a < b ? a : b)));
            return [0, 1, 2].map((k) => numbers[(least + k) % 3]).join(' ');
        }),
    );
    return names.sort();
}

function compare(plain, small) {
    const faults = [];
    const count = (meshes) => meshes.reduce((sum, mesh) => sum + mesh.faces.length, 0);
    if (count(plain) !== count(small)) faults.push(`${count(small)} faces, not ${count(plain)}`);
    if (connectivity(plain).join() !== connectivity(small).join()) faults.push('other faces');
    const box = (meshes) => meshes.reduce((all, mesh) => all.union(mesh.box), new Box3());
    const [a, b] = [box(plain), box(small)];
    const size = a.getSize(new Vector3()).length() + a.max.length() + a.min.length();
    // What is shown several times has the same numbers.
    const known = new Map();
    for (const vertex of plain.flatMap((mesh) => mesh.vertices)) {
        known.set(vertex.number, [...(known.get(vertex.number) ?? []), vertex]);
    }
    let [worst, most] = [0, 0];
    for (const { vertices, cell } of small) {
        const allowed = (cell * Math.sqrt(3)) / 2 + size * 1e-6;
        most = Math.max(most, allowed);
        for (const vertex of vertices) {
            const places = (known.get(vertex.number) ?? []).map((v) => v.place);
            const off = Math.min(...places.map((place) => place.distanceTo(vertex.place)));
            worst = Math.max(worst, off);
            if (!(off <= allowed)) faults.push(`vertex ${vertex.number}: ${off} off, ${allowed} allowed`);
            const original = known.get(vertex.number)?.[0] ?? {};
            for (const [name, bound] of Object.entries(ATTRIBUTES)) {
                const values = vertex[name] ?? [];
                if (values.length !== (original[name] ?? []).length) faults.push(`${name} is missing`);
                const far = values.some((x, k) => !(Math.abs(x - original[name][k]) <= bound));
                if (far) faults.push(`vertex ${vertex.number}: ${name} ${values}, not ${original[name]}`);
            }
        }
    }
    if (!(a.min.distanceTo(b.min) <= most && a.max.distanceTo(b.max) <= most)) {
        faults.push('other bounds');
    }
    return { faults, worst };
}

const folder = process.argv[2];
const files = readdirSync(folder).filter((name) => name.endsWith('.glb')).sort();
const names = files.filter((name) => !name.endsWith('.plain.glb'));
let failed = names.length === 0;
if (failed) console.error(`${folder}: no files to compare`);
for (const name of names) {
    const plain = await load(join(folder, name.replace(/\.[^.]*\.glb$/, '.plain.glb')));
    const { faults, worst } = compare(plain, await load(join(folder, name)));
    failed ||= faults.length > 0;
    console.log(`${name}: ${faults.length ? 'WRONG' : 'ok'}, off by ${worst.toExponential(2)} at most`);
    faults.slice(0, 5).forEach((fault) => console.error(`  ${fault}`));
}
process.exit(failed ? 1 : 0);
