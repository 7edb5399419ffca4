// CesiumJS, without a globe.

import { settle, shown } from '/pixels.js';

const { Cartesian3, Cesium3DTileset, CesiumWidget, Color } = window.Cesium;
const widget = new CesiumWidget('globe', {
    baseLayer: false,
    contextOptions: { webgl: { preserveDrawingBuffer: true } },
    globe: false,
    shouldAnimate: false,
    skyAtmosphere: false,
    skyBox: false,
    useDefaultRenderLoop: false,
});
const { camera, scene } = widget;
scene.backgroundColor = Color.BLACK;
let tileset;

async function open(url) {
    tileset = await Cesium3DTileset.fromUrl(url, {
        dynamicScreenSpaceError: false,
        foveatedScreenSpaceError: false,
    });
    tileset.tileFailed.addEventListener(({ url, message }) => console.error(`${url}: ${message}`));
    scene.primitives.add(tileset);
}

async function look({ from, pixels }) {
    const { center, radius } = tileset.boundingSphere;
    const isFar = Cartesian3.magnitude(center) > 1e6;
    const up = isFar ? Cartesian3.normalize(center, new Cartesian3()) : Cartesian3.UNIT_Z.clone();
    const of = (operation, ...values) => operation(...values, new Cartesian3());
    const side = of(Cartesian3.cross, new Cartesian3(0.3, 0.5, 0.1), up);
    Cartesian3.normalize(side, side);
    const away = of(Cartesian3.add, side, of(Cartesian3.multiplyByScalar, up, 0.8));
    Cartesian3.normalize(away, away);
    camera.frustum.near = 1e-3 * radius;
    camera.frustum.far = (from + 2) * radius;
    camera.position = of(Cartesian3.add, center, of(Cartesian3.multiplyByScalar, away, from * radius));
    camera.direction = of(Cartesian3.negate, away);
    camera.right = of(Cartesian3.normalize, of(Cartesian3.cross, camera.direction, up));
    camera.up = of(Cartesian3.cross, camera.right, camera.direction);
    tileset.maximumScreenSpaceError = pixels;
    await settle(() => {
        widget.resize();
        widget.render();
        return tileset.tilesLoaded && tileset.statistics.selected > 0;
    });
    widget.render();
    const { selected, numberOfTrianglesSelected } = tileset.statistics;
    return { tiles: selected, faces: numberOfTrianglesSelected, part: shown(scene.canvas) };
}

window.judge = { open, look };
