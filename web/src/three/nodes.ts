/** The nodes of a file, by which animations move its mesh. */

import { Matrix4, Mesh, SkinnedMesh, Sphere, Vector3 } from "three";
import type { AnimationClip, BufferGeometry, Group, Object3D, Skeleton } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import type { GLTFParser } from "three/addons/loaders/GLTFLoader.js";
import type { SceneInfo } from "../index.ts";
import type { SharedLevels } from "./levels.ts";
import { MeshParts } from "./mesh_parts.ts";
import type { MlodMesh } from "./mlod_mesh.ts";
import { placedMesh } from "./placed_mesh.ts";

/** Nodes with the meshes of the file at their places among them. */
export interface MlodNodes {
    /** What is added to a scene, instead of the mesh. */
    scene: Group;
    /** Clips for an AnimationMixer of `scene`. */
    animations: AnimationClip[];
    /**
     * The mesh, and copies of it, which may not be drawn themselves: `update` each in each frame, and
     * `dispose` of each in the end.
     */
    meshes: MlodMesh[];
}

/** A node that shows a mesh. */
interface Shown {
    /** Number of the mesh in the document. */
    mesh: number;
    node: Object3D;
    skeleton: Skeleton | null;
    /** From where the levels have the mesh to its own place. */
    toMesh: Matrix4;
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
const ENDED = "the stream has ended before all nodes have come";

/** What has been made of each file, and for each copy. */
const allParts = new WeakMap<SharedLevels, MeshParts>();
const allNodes = new WeakMap<MlodMesh, Promise<MlodNodes>>();

/**
 * Returns the nodes of a file, made once for each copy.
 *
 * @throws Error if the file has none, or cannot be read to its key frames
 */
export function nodesOf(mesh: MlodMesh, levels: SharedLevels): Promise<MlodNodes> {
    const nodes = allNodes.get(mesh) ?? makeNodes(mesh, levels);
    allNodes.set(mesh, nodes);
    return nodes;
}

async function makeNodes(mesh: MlodMesh, levels: SharedLevels): Promise<MlodNodes> {
    const scene = await arrived(levels, () => levels.scene);
    const hasFrames = scene.parts.some(({ kind }) => kind === "animations");
    const frames = hasFrames ? await arrived(levels, () => levels.frames) : new Uint8Array(0);
    const document = JSON.parse(scene.document) as Record<string, unknown>;
    const defs = (document.nodes ?? []) as NodeDef[];
    document.nodes = defs.map((def) => without(def, ["mesh", "skin", "extensions"]));
    const { parser, scene: root, animations } = await parse(document, [scene.buffer, frames]);
    const shown: Shown[] = [];
    for (const [i, { mesh = -1, skin }] of defs.entries()) {
        const placement = scene.meshes[mesh]?.placement;
        if (!placement) continue;
        const node = (await parser.getDependency("node", i)) as Object3D;
        if (!isBelow(root, node)) continue;
        const isSkin = skin !== undefined;
        const skeleton = isSkin ? ((await parser.getDependency("skin", skin)) as Skeleton) : null;
        const toMesh = new Matrix4().fromArray(placement).invert();
        shown.push({ mesh, node, skeleton, toMesh });
    }
    const isOne = scene.meshes.filter((mesh) => mesh !== null).length === 1;
    const geometries = isOne ? null : await geometriesOf(levels, scene);
    const nodes: MlodNodes = { scene: root, animations, meshes: [mesh] };
    if (geometries || shown.every(({ skeleton }) => skeleton)) {
        // It chooses the level, and others show it.
        mesh.layers.disableAll();
        root.add(mesh);
    }
    let isPlaced = false;
    for (const one of shown) {
        const geometry = geometries ? geometries[one.mesh] : mesh.geometry;
        if (one.skeleton) one.node.add(skinned(mesh, geometry, one.skeleton, one.toMesh));
        else if (geometries) one.node.add(still(mesh, geometry, one.toMesh));
        else placeOnly(nodes, one, isPlaced);
        isPlaced ||= !one.skeleton;
    }
    if (geometries) addPlaces(nodes, shown);
    return nodes;
}

/** Returns true for what a scene shows; a file may have several scenes. */
function isBelow(scene: Object3D, object: Object3D): boolean {
    for (let at: Object3D | null = object; at; at = at.parent) if (at === scene) return true;
    return false;
}

/** Puts the only mesh of a file, or a copy of it, at a node. */
function placeOnly({ meshes }: MlodNodes, { node, toMesh }: Shown, isPlaced: boolean): void {
    const own = isPlaced ? meshes[0].clone() : meshes[0];
    if (isPlaced) meshes.push(own);
    own.matrixAutoUpdate = false;
    own.matrix.copy(toMesh);
    node.add(own);
}

/** Adds what chooses levels for meshes that are also at other places than those of the levels. */
function addPlaces(nodes: MlodNodes, shown: readonly Shown[]): void {
    const { scene, meshes } = nodes;
    const { diagonal } = meshes[0].info;
    scene.updateMatrixWorld(true);
    const places = new Map<string, Matrix4>();
    for (const { node, skeleton, toMesh } of shown) {
        if (skeleton) continue;
        const place = node.matrixWorld.clone().multiply(toMesh);
        const size = (k: number) => (k >= 12 && k < 15 ? diagonal : 1);
        places.set(place.elements.map((x, k) => Math.round((1e3 * x) / size(k))).join(" "), place);
    }
    if (places.size < 2) return;
    const placed = placedMesh(meshes[0].clone(), () => places.values());
    meshes.push(placed);
    scene.add(placed);
}

/** Waits for the geometry of each mesh of a file. */
async function geometriesOf(levels: SharedLevels, scene: SceneInfo): Promise<BufferGeometry[]> {
    const parts = allParts.get(levels) ?? new MeshParts(levels.geometry, levels.stream, scene);
    allParts.set(levels, parts);
    while (!parts.isThere) {
        if (levels.isDisposed) throw new Error(ENDED);
        await pause();
    }
    return parts.geometries as BufferGeometry[];
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
        if (levels.hasEnded) throw new Error(ENDED);
        await pause();
    }
}

function pause(): Promise<void> {
    return new Promise((resolve) => setTimeout(resolve, PAUSE));
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

/** Shows a mesh of the file at its node. */
function still(mesh: MlodMesh, geometry: BufferGeometry, toMesh: Matrix4): Mesh {
    const shown = new Mesh(geometry, mesh.material);
    shown.matrixAutoUpdate = false;
    shown.matrix.copy(toMesh);
    mesh.followers.push(shown);
    return shown;
}

/** Shows a mesh of the file with its bones. */
function skinned(
    mesh: MlodMesh,
    geometry: BufferGeometry,
    skeleton: Skeleton,
    toMesh: Matrix4,
): SkinnedMesh {
    const shown = new SkinnedMesh(geometry, mesh.material);
    shown.bind(skeleton, toMesh);
    // Poses may be anywhere, and bounds of all vertices would take long and be those of one level.
    shown.boundingSphere = new Sphere(new Vector3(), Infinity);
    mesh.followers.push(shown);
    return shown;
}
