/** Instances of one file, which the GPU draws at once. */

import { InstancedMesh, Matrix4 } from "three";
import type { BufferGeometry, Camera, Material } from "three";
import type { MlodMesh, PictureSize } from "./mlod_mesh.ts";
import { placedMesh } from "./placed_mesh.ts";

/** Instances at one level, the one that the nearest needs: call `update` in each frame. */
export class MlodInstances extends InstancedMesh<BufferGeometry, Material[]> {
    /** Asks for the level, by its `pixels` and `mostFaces`, and is not drawn. */
    readonly mesh: MlodMesh;

    /** @param copy a mesh that nobody else uses */
    constructor(copy: MlodMesh, count: number) {
        super(copy.geometry, copy.material, count);
        this.mesh = placedMesh(copy, () => this.places());
        copy.followers.push(this);
        this.add(copy);
    }

    private *places(): Iterable<Matrix4> {
        const place = new Matrix4();
        for (let i = 0; i < this.count; i++) {
            this.getMatrixAt(i, place);
            yield place;
        }
    }

    /** Asks for the level that the instance nearest to a camera needs. */
    update(camera: Camera, renderer: PictureSize): void {
        this.mesh.update(camera, renderer);
    }

    /** Frees the memory, and that of the stream with its last copy. */
    override dispose(): this {
        super.dispose();
        this.mesh.dispose();
        return this;
    }
}
