// Loads a model with the client and looks at it from ever nearer: what is shown then, for needle.mjs.

import * as THREE from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { useNeedleProgressive } from '@needle-tools/gltf-progressive';

const { searchParams } = new URL(location.href);
const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(640, 480);
// A colour that nothing has: metal without surroundings is black.
renderer.setClearColor(0xff00ff);
document.body.append(renderer.domElement);
const loader = new GLTFLoader();
const manager = useNeedleProgressive(loader, renderer);
// The models are small: levels have to change while they are.
manager.targetTriangleDensity = Number(searchParams.get('density'));
manager.updateInterval = 1;

const scene = new THREE.Scene();
scene.add(new THREE.HemisphereLight(0xffffff, 0x808080, 3));
const camera = new THREE.PerspectiveCamera(50, 640 / 480, 0.001, 1e6);

const frame = () => new Promise((resolve) => requestAnimationFrame(resolve));

// Draws until nothing is loaded any more.
async function settle() {
    for (let quiet = 0; quiet < 3; ) {
        const before = performance.getEntriesByType('resource').length;
        const loading = manager.awaitLoading({ frames: 4, maxPromisesPerObject: 8 });
        for (let i = 0; i < 6; i++) {
            renderer.render(scene, camera);
            await frame();
        }
        await Promise.race([loading, new Promise((resolve) => setTimeout(resolve, 2000))]);
        quiet = performance.getEntriesByType('resource').length === before ? quiet + 1 : 0;
    }
}

// What each primitive and texture is shown by.
function shown(root) {
    const [primitives, textures] = [[], {}];
    root.traverse((object) => {
        if (!object.isMesh) return;
        const { geometry, material } = object;
        const { key, level, index } = geometry.userData.LODS ?? {};
        geometry.computeBoundingBox();
        primitives.push({
            guid: key, level, primitive: index ?? 0, indices: geometry.index.count,
            hasNormals: 'normal' in geometry.attributes, isFlat: material.flatShading === true,
        });
        for (const [slot, texture] of Object.entries(material)) {
            if (texture?.isTexture) textures[`${material.name}.${slot}`] = texture.image.width;
        }
    });
    return { primitives, textures };
}

// Counts the pixels that are not of the background.
function covered() {
    const { width, height } = renderer.domElement;
    const flat = document.createElement('canvas');
    Object.assign(flat, { width, height });
    const context = flat.getContext('2d');
    context.drawImage(renderer.domElement, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
        if (data[i] !== 255 || data[i + 1] !== 0 || data[i + 2] !== 255) count += 1;
    }
    return count / (width * height);
}

async function run() {
    const { scene: model } = await loader.loadAsync(searchParams.get('model'));
    scene.add(model);
    const ball = new THREE.Box3().setFromObject(model).getBoundingSphere(new THREE.Sphere());
    const looks = [];
    // From far to near, near with room for all triangles, and back.
    const radii = searchParams.get('radii').split(',').map(Number);
    const views = radii.map((radii) => ({ name: `${radii} radii`, radii }));
    views.push({ name: 'all', radii: radii.at(-1), density: 1e12 });
    views.push({ name: 'back', radii: radii.at(-3) });
    const density = manager.targetTriangleDensity;
    for (const { name, radii, density: own } of views) {
        manager.targetTriangleDensity = own ?? density;
        const away = new THREE.Vector3(0.6, 0.5, 1).normalize().multiplyScalar(radii * ball.radius);
        camera.position.copy(ball.center).add(away);
        camera.lookAt(ball.center);
        await settle();
        looks.push({ name, ...shown(model), covered: covered() });
    }
    return looks;
}

run().then(
    (looks) => Object.assign(window, { result: { looks } }),
    (error) => Object.assign(window, { result: { error: String(error.stack) } }),
);
