/** A mesh whose level follows a camera. */

import { Matrix4, Mesh, Vector2, Vector3 } from "three";
import type {
    BufferGeometry,
    Camera,
    Material,
    OrthographicCamera,
    PerspectiveCamera,
} from "three";
import type { FileInfo, Progress, Query, Vector } from "../index.ts";
import type { SharedLevels } from "./levels.ts";
import type { MlodInstances } from "./instances.ts";
import type { MlodNodes } from "./nodes.ts";

/** What tells the size of a picture; every renderer of three.js does. */
export interface PictureSize {
    getDrawingBufferSize(target: Vector2): Vector2;
}

/**
 * Levels of a file as a mesh: call `update` in each frame, before it is drawn.
 *
 * Its geometry belongs to the stream; copies share it, and the one nearest to its camera decides.
 */
export class MlodMesh extends Mesh<BufferGeometry, Material[]> {
    readonly isMlodMesh = true;
    /** Number of pixels that an error may span. */
    pixels = 1;
    /**
     * Number of faces beyond which errors may span more pixels. It may be exceeded for some frames,
     * and has no effect on a level of 0 pixels.
     */
    mostFaces = Infinity;
    /** True to refine only what the camera sees, false to refine all around it. */
    onlyInView = false;
    /** Meshes that show the same otherwise; their materials follow until this is disposed of. */
    readonly followers: Mesh[] = [];
    private readonly toLocal = new Matrix4();
    private readonly eye = new Vector3();
    private readonly ahead = new Vector3();
    private readonly upward = new Vector3();
    private readonly size = new Vector2();

    constructor(private readonly levels: SharedLevels) {
        super(levels.geometry, levels.materials);
        levels.add(this);
    }

    /** What is known of the file. */
    get info(): FileInfo {
        return this.levels.info;
    }

    /** How far the stream has come, or null before it has begun. */
    get progress(): Progress | null {
        return this.levels.progress;
    }

    /** Asks for the level that a camera needs; patches of the geometry come when they are ready. */
    update(camera: Camera, renderer: PictureSize): void {
        renderer.getDrawingBufferSize(this.size);
        this.updateWorldMatrix(true, false);
        camera.updateWorldMatrix(true, false);
        this.toLocal.copy(this.matrixWorld).invert().multiply(camera.matrixWorld);
        this.eye.setFromMatrixPosition(this.toLocal);
        this.ahead.set(0, 0, -1).transformDirection(this.toLocal);
        this.upward.set(0, 1, 0).transformDirection(this.toLocal);
        // Nothing is seen of what has no size, or from nowhere.
        if (this.matrixWorld.determinant() === 0) return;
        if (!this.toLocal.elements.every(Number.isFinite)) return;
        const query = this.queryOf(camera, this.pixels * this.levels.relief(this.mostFaces));
        if (query) this.levels.ask(this, query, this.nearness(query));
    }

    private queryOf(camera: Camera, pixels: number): Query | null {
        const [width, height] = [this.size.x, this.size.y];
        if (!(width > 0 && height > 0)) return null;
        if (isOrthographic(camera)) {
            const scale = this.toLocal.getMaxScaleOnAxis();
            const pixel = (Math.abs(camera.top - camera.bottom) / camera.zoom / height) * scale;
            return { focus: null, tolerance: pixels * pixel };
        }
        if (!isPerspective(camera)) return null;
        const fov = (camera.getEffectiveFOV() * Math.PI) / 180;
        const look = this.ahead.clone().add(this.eye);
        const view = {
            eye: vector(this.eye),
            look: vector(look),
            up: vector(this.upward),
            fov,
            viewport: [width, height],
        } as const;
        const tolerance = { pixels, camera: view };
        return { focus: this.onlyInView ? { frustum: view } : null, tolerance };
    }

    /** Returns the greater number for the finer query. */
    private nearness({ tolerance }: Query): number {
        if (typeof tolerance === "number") return 1 / tolerance;
        const { center } = this.levels.info;
        return 1 / (this.pixels * this.eye.distanceTo(new Vector3(...center)));
    }

    /**
     * Returns the nodes of the file, which its animations move, with its meshes at their places;
     * once they have come. There is one set of nodes for each copy.
     */
    async nodes(): Promise<MlodNodes> {
        return (await import("./nodes.ts")).nodesOf(this, this.levels);
    }

    /**
     * Returns instances that the GPU draws at once, all at the level that the nearest needs:
     * `setMatrixAt` places them, and `update` is theirs.
     */
    async instances(count: number): Promise<MlodInstances> {
        return new (await import("./instances.ts")).MlodInstances(this.clone(), count);
    }

    /** Returns a copy that shares geometry and materials, and counts when the level is chosen. */
    override clone(recursive?: boolean): this {
        return new MlodMesh(this.levels).copy(this, recursive) as this;
    }

    override copy(source: this, recursive?: boolean): this {
        super.copy(source, recursive);
        this.pixels = source.pixels;
        this.mostFaces = source.mostFaces;
        this.onlyInView = source.onlyInView;
        this.material = source.material;
        return this;
    }

    /** Ends the stream with the last copy, and frees its memory. */
    dispose(): void {
        this.removeFromParent();
        this.levels.remove(this);
    }
}

function vector({ x, y, z }: Vector3): Vector {
    return [x, y, z];
}

function isPerspective(camera: Camera): camera is PerspectiveCamera {
    return (camera as Partial<PerspectiveCamera>).isPerspectiveCamera === true;
}

function isOrthographic(camera: Camera): camera is OrthographicCamera {
    return (camera as Partial<OrthographicCamera>).isOrthographicCamera === true;
}
