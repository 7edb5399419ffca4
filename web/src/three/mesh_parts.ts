/** The meshes of a file by themselves: groups of the geometry that all of them share. */

import { BufferGeometry } from "three";
import type { GeometryPatch, MlodStream, SceneInfo } from "../index.ts";
import type { StreamGeometry } from "./buffers.ts";

/** Triangles of one mesh with one material. */
interface Part {
    mesh: number;
    material: number;
}

/** What the stream shows of one mesh. */
class PartGeometry extends BufferGeometry {
    constructor(private readonly whole: StreamGeometry) {
        super();
        this.boundingSphere = whole.boundingSphere;
        whole.addEventListener("dispose", () => this.dispose());
        this.share();
    }

    /** Takes all of the other geometry but its groups. */
    share(): void {
        this.boundingBox = null;
        this.clearGroups();
        this.setIndex(this.whole.index);
        Object.assign(this.attributes, this.whole.attributes);
    }

    /** The bounds of all meshes, whatever is shown. */
    override computeBoundingSphere(): void {}

    override computeBoundingBox(): void {
        this.whole.computeBoundingBox.call(this);
    }
}

/** A geometry for each mesh, which follows that of the stream. */
export class MeshParts {
    /** By number of the mesh in the document; none for meshes that are not in the levels. */
    readonly geometries: (PartGeometry | null)[];
    /** True once each has its triangles. */
    isThere = false;
    private readonly parts: Part[] = [];
    /** Number of the first part: those before are by material alone. */
    private readonly first: number;

    constructor(
        private readonly whole: StreamGeometry,
        stream: MlodStream,
        { meshes }: SceneInfo,
    ) {
        const { info } = stream;
        this.geometries = meshes.map((mesh) => mesh && new PartGeometry(whole));
        this.first = Math.max(1, info.materials?.length ?? 1);
        const meshOf = meshes.flatMap((mesh, i) => Array<number>(mesh?.objects ?? 0).fill(i));
        const known = new Map<string, number>();
        const parts: number[] = [];
        const pairs = info.pairs ?? [0, 0];
        for (let at = 0; at < pairs.length; at += 2) {
            const part = { mesh: meshOf[pairs[at + 1]] ?? -1, material: pairs[at] };
            const key = `${part.mesh} ${part.material}`;
            if (!known.has(key)) known.set(key, this.parts.push(part) - 1);
            parts.push(this.first + (known.get(key) ?? 0));
        }
        const apply = whole.apply.bind(whole);
        whole.apply = (patch) => {
            apply(patch);
            this.follow(patch);
        };
        stream.split(parts);
    }

    private follow({ parts }: GeometryPatch): void {
        this.isThere ||= parts.length > this.first;
        if (!this.isThere) return;
        const { whole, geometries, first } = this;
        for (const geometry of geometries) geometry?.share();
        // A patch of before has groups by material, and is shown until the next one comes.
        if (parts.length <= first) return;
        whole.clearGroups();
        this.parts.forEach(({ mesh, material }, i) => {
            const { start, count } = parts[first + i] ?? { start: 0, count: 0 };
            if (count === 0) return;
            for (const geometry of [whole, geometries[mesh]])
                geometry?.addGroup(3 * start, 3 * count, material);
        });
    }
}
