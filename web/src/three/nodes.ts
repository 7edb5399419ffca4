/** The nodes of a file, by which animations move its mesh. */

import { Matrix4, SkinnedMesh, Sphere, Vector3 } from "three";
import type { AnimationClip, Group, Object3D, Skeleton } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import type { GLTFParser } from "three/addons/loaders/GLTFLoader.js";
import type { SharedLevels } from "./levels.ts";
import type { MlodMesh } from "./mlod_mesh.ts";

/** Nodes with the mesh at its place among them. */
export interface MlodNodes {
    /** What is added to a scene, instead of the mesh. */
    scene: Group;
    /** Clips for an AnimationMixer of `scene`. */
    animations: AnimationClip[];
    /** The mesh, and copies for further nodes that show it: `update` each. */
    meshes: MlodMesh[];
}

/** A node of a document, as far as it matters here. */
interface NodeDef {
    mesh?: number;
    skin?: number;
}

/** A view of a buffer. */
interface ViewDef {
    buffer: number;
    byteOffset?: number;
    byteLength: number;
}

const KEPT = [
    "asset",
    "scene",
    "scenes",
    "nodes",
    "skins",
    "animations",
    "accessors",
    "bufferViews",
    "cameras",
];
/** Milliseconds between two looks at what has come. */
const PAUSE = 20;

/**
 * Makes the nodes of the only mesh of a file.
 *
 * @throws Error if the file has no nodes or several meshes, or cannot be read to its key frames
 */
export async function nodesOf(mesh: MlodMesh, levels: SharedLevels): Promise<MlodNodes> {
    const scene = await arrived(levels, () => levels.scene);
    const hasFrames = scene.parts.some(({ kind }) => kind === "animations");
    const frames = hasFrames ? await arrived(levels, () => levels.frames) : new Uint8Array(0);
    const number = scene.meshes.findIndex((mesh) => mesh !== null);
    const only = scene.meshes[number];
    const count = scene.meshes.filter((mesh) => mesh !== null).length;
    if (!only || count > 1)
        throw new Error(`the levels are of ${count} meshes, and nodes can move one only`);
    const document = JSON.parse(scene.document) as Record<string, unknown>;
    const defs = (document.nodes ?? []) as NodeDef[];
    const shows = defs.map(({ mesh, skin }) => (mesh === number ? { skin } : null));
    document.nodes = defs.map((def) => without(def, ["mesh", "skin", "extensions"]));
    const { parser, scene: root, animations } = await parse(document, [scene.buffer, frames]);
    const nodes: MlodNodes = { scene: root, animations, meshes: [mesh] };
    const toMesh = new Matrix4().fromArray(only.placement).invert();
    let isPlaced = false;
    for (const [i, shown] of shows.entries()) {
        if (!shown) continue;
        const node = (await parser.getDependency("node", i)) as Object3D;
        if (shown.skin !== undefined) {
            const skeleton = (await parser.getDependency("skin", shown.skin)) as Skeleton;
            node.add(skinned(mesh, levels, skeleton, toMesh));
            continue;
        }
        const own = isPlaced ? mesh.clone() : mesh;
        if (isPlaced) nodes.meshes.push(own);
        isPlaced = true;
        own.matrixAutoUpdate = false;
        own.matrix.copy(toMesh);
        node.add(own);
    }
    if (isPlaced) return nodes;
    // It chooses the level, and others show it.
    mesh.layers.disableAll();
    root.add(mesh);
    return nodes;
}

/** Returns an object without some of its properties. */
function without(object: object, names: readonly string[]): object {
    return Object.fromEntries(Object.entries(object).filter(([name]) => !names.includes(name)));
}

/** Waits for something, as long as it may come. */
async function arrived<T>(levels: SharedLevels, look: () => T | null): Promise<T> {
    for (;;) {
        const found = look();
        if (found !== null) return found;
        if (!levels.info.hasScene) throw new Error("the file has no nodes");
        if (levels.hasEnded) throw new Error("the stream has ended before all nodes have come");
        await new Promise((resolve) => setTimeout(resolve, PAUSE));
    }
}

/** Reads nodes, skins and animations by three.js, whose buffers are there already. */
function parse(
    document: Record<string, unknown>,
    buffers: Uint8Array[],
): Promise<{ parser: GLTFParser; scene: Group; animations: AnimationClip[] }> {
    const kept = Object.fromEntries(Object.entries(document).filter(([key]) => KEPT.includes(key)));
    const views = (document.bufferViews ?? []) as ViewDef[];
    const loader = new GLTFLoader().register(() => ({
        name: "MLOD_nodes",
        loadBufferView: (number: number) => {
            const { buffer, byteOffset = 0, byteLength } = views[number];
            const bytes = buffers[buffer].slice(byteOffset, byteOffset + byteLength);
            return Promise.resolve(bytes.buffer as ArrayBuffer);
        },
    }));
    return loader.parseAsync(JSON.stringify(kept), "");
}

function skinned(
    mesh: MlodMesh,
    levels: SharedLevels,
    skeleton: Skeleton,
    toMesh: Matrix4,
): SkinnedMesh {
    const shown = new SkinnedMesh(mesh.geometry, mesh.material);
    shown.bind(skeleton, toMesh);
    // Poses may be anywhere, and bounds of all vertices would take long and be those of one level.
    shown.boundingSphere = new Sphere(new Vector3(), Infinity);
    levels.dress(shown);
    return shown;
}
