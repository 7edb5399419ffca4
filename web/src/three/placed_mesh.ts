/** A mesh that is not drawn: it asks for the level that the nearest of several places needs. */

import { Matrix4, Vector3 } from "three";
import type { Camera } from "three";
import type { MlodMesh, PictureSize } from "./mlod_mesh.ts";

/** Makes a copy of a mesh stand, unseen, where `places` says that it is nearest to the camera. */
export function placedMesh(copy: MlodMesh, places: () => Iterable<Matrix4>): MlodMesh {
    copy.layers.disableAll();
    copy.matrixAutoUpdate = false;
    // What one place does not see another one may.
    copy.onlyInView = false;
    const [eye, center] = [new Vector3(), new Vector3()];
    const update = copy.update.bind(copy);
    copy.update = (camera: Camera, renderer: PictureSize): void => {
        camera.updateWorldMatrix(true, false);
        eye.setFromMatrixPosition(camera.matrixWorld);
        if (copy.parent) {
            copy.parent.updateWorldMatrix(true, false);
            eye.applyMatrix4(copy.parent.matrixWorld.clone().invert());
        }
        let least = Infinity;
        for (const place of places()) {
            center.set(...copy.info.center).applyMatrix4(place);
            const distance = center.distanceTo(eye) / place.getMaxScaleOnAxis();
            if (distance >= least) continue;
            least = distance;
            copy.matrix.copy(place);
        }
        if (least < Infinity) update(camera, renderer);
    };
    return copy;
}
