// What all pages here share: a lit scene on a background of a colour that nothing has.

import * as THREE from "three";

export const [WIDTH, HEIGHT] = [1280, 720];
export const options = Object.fromEntries(new URLSearchParams(location.search));
export const [center, away] = ["center", "away"].map(
    (key) => new THREE.Vector3(...options[key].split(",").map(Number)),
);

export const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(WIDTH, HEIGHT, false);
document.body.append(renderer.domElement);
export const scene = new THREE.Scene();
scene.background = new THREE.Color(0xff00ff);
const sun = new THREE.DirectionalLight(0xffffff, 2);
sun.position.set(1, 3, 2);
scene.add(sun, new THREE.AmbientLight(0xffffff, 1.5));
export const camera = new THREE.PerspectiveCamera(
    45,
    WIDTH / HEIGHT,
    0.01 * away.length(),
    10 * away.length(),
);
camera.position.copy(center).add(away);
camera.lookAt(center);

/** Returns what the server has sent of the model. */
export const sent = async () => (await fetch("/sent")).json();
