// 3DTilesRendererJS, with its own check that vertices are in their boxes.

import { AmbientLight, DirectionalLight, PerspectiveCamera, Scene, Sphere, Vector3 } from 'three';
import { WebGLRenderer } from 'three';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { TilesRenderer } from '/node_modules/3d-tiles-renderer/src/three/renderer/index.js';
import { GLTFExtensionsPlugin } from '/node_modules/3d-tiles-renderer/src/three/plugins/GLTFExtensionsPlugin.js';
import { TilesetValidationPlugin } from '/node_modules/3d-tiles-renderer/src/three/plugins/TilesetValidationPlugin.js';
import { settle, shown } from '/pixels.js';

const SIZE = 512;
const renderer = new WebGLRenderer({ antialias: true });
renderer.setSize(SIZE, SIZE);
document.body.append(renderer.domElement);
const scene = new Scene();
const camera = new PerspectiveCamera(60, 1, 1, 2);
const lamp = new DirectionalLight(0xffffff, 2);
scene.add(camera, lamp, new AmbientLight(0xffffff, 1));
const sphere = new Sphere();
const up = new Vector3(0, 0, 1);
let tiles;

async function open(url) {
    tiles = new TilesRenderer(url);
    tiles.registerPlugin(
        new GLTFExtensionsPlugin({ meshoptDecoder: MeshoptDecoder, metadata: false, rtc: false }),
    );
    tiles.registerPlugin(new TilesetValidationPlugin());
    tiles.addEventListener('load-error', ({ error, url }) => console.error(`${url}: ${error}`));
    tiles.setCamera(camera);
    tiles.setResolution(camera, SIZE, SIZE);
    const root = new Promise((ready) => tiles.addEventListener('load-root-tileset', ready));
    tiles.errorTarget = Infinity;
    tiles.update();
    await root;
    tiles.getBoundingSphere(sphere);
    // On the globe up is away from its middle; the scene's middle is the model's, as pictures have
    // 32 bits.
    if (sphere.center.length() > 1e6) up.copy(sphere.center).normalize();
    tiles.group.position.copy(sphere.center).negate();
    scene.add(tiles.group);
    tiles.group.updateMatrixWorld(true);
}

async function look({ from, pixels, draws }) {
    const away = new Vector3(0.3, 0.5, 0.1).cross(up).normalize().addScaledVector(up, 0.8);
    camera.position.copy(away.normalize()).multiplyScalar(from * sphere.radius);
    [camera.near, camera.far] = [1e-3 * sphere.radius, (from + 2) * sphere.radius];
    camera.up.copy(up);
    camera.lookAt(0, 0, 0);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
    lamp.position.copy(camera.position);
    tiles.errorTarget = pixels;
    await settle(() => {
        tiles.update();
        if (draws) renderer.render(scene, camera);
        return !tiles.isLoading && tiles.loadProgress === 1 && tiles.visibleTiles.size > 0;
    });
    let faces = 0;
    const count = ({ isMesh, geometry }) => isMesh && (faces += geometry.index.count / 3);
    for (const { engineData } of tiles.visibleTiles) engineData.scene.traverse(count);
    renderer.render(scene, camera);
    return { tiles: tiles.visibleTiles.size, faces, part: shown(renderer.domElement) };
}

window.judge = { open, look };
