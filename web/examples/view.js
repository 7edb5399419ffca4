// Shows a model in every canvas that names one: <canvas data-mlod="model.mlod"></canvas>
import { HemisphereLight, PerspectiveCamera, Scene, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { MlodLoader } from "meshlod/three";

for (const canvas of document.querySelectorAll("canvas[data-mlod]")) {
    const mesh = await new MlodLoader().loadAsync(canvas.dataset.mlod);
    const { center, diagonal } = mesh.info;
    const scene = new Scene().add(mesh, new HemisphereLight(0xffffff, 0x888888, 3));
    const camera = new PerspectiveCamera(45, 1, 1e-3 * diagonal, 100 * diagonal);
    const controls = new OrbitControls(camera, canvas);
    controls.target.set(...center);
    camera.position.set(center[0], center[1], center[2] + 1.5 * diagonal);
    const renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    renderer.setPixelRatio(devicePixelRatio);
    renderer.setAnimationLoop(() => {
        const { clientWidth, clientHeight } = canvas;
        renderer.setSize(clientWidth, clientHeight, false);
        camera.aspect = clientWidth / clientHeight;
        camera.updateProjectionMatrix();
        controls.update();
        mesh.update(camera, renderer);
        renderer.render(scene, camera);
    });
}
