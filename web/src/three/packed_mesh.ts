/** Meshes of three.js from decoded files, with the materials of their scenes. */

import { Mesh } from "three";
import type { BufferAttribute, BufferGeometry, LoadingManager, Material } from "three";
import { must, within } from "../error.ts";
import type { SceneInfo } from "../index.ts";
import type { PackedMesh } from "../packed/mesh.ts";
import { readHead, unpackResource } from "../scene/head.ts";
import type { makeMaterials, plainMaterial } from "./materials.ts";
import { geometryOf } from "./packed_geometry.ts";
import type { Pictures } from "./pictures.ts";

/** What makes materials: it is there already, and here it would be loaded twice. */
export interface MaterialMaker {
    make: typeof makeMaterials;
    plain: typeof plainMaterial;
    pictures: Pictures;
    manager: LoadingManager;
}

/** A scene as it is stored behind a mesh. */
interface PackedScene {
    scene: SceneInfo;
    images: Map<number, Uint8Array>;
}

/** Reads what `compress` stored of a scene; null if there was none. */
export function readScene(resources: Uint8Array): PackedScene | null {
    if (resources.length === 0) return null;
    const all: Uint8Array[] = [];
    within("the scene", () => {
        const view = new DataView(resources.buffer, resources.byteOffset, resources.length);
        for (let at = 0; at < resources.length;) {
            must(at + 4 <= resources.length, "it is cut off");
            const end = at + 4 + view.getUint32(at, true);
            must(end <= resources.length, "it is cut off");
            all.push(unpackResource("a part of the scene", resources.subarray(at + 4, end)));
            at = end;
        }
    });
    const scene = readHead(all[0]);
    const images = new Map<number, Uint8Array>();
    scene.parts.forEach(({ kind, image }, i) => {
        if (kind === "image" && i + 1 < all.length) images.set(image, all[i + 1]);
    });
    return { scene, images };
}

/** Returns a mesh with a material for each label; without a scene they only have names. */
export async function meshOf(
    mesh: PackedMesh,
    { make, plain, pictures, manager }: MaterialMaker,
): Promise<Mesh<BufferGeometry, Material[]>> {
    const geometry = geometryOf(mesh);
    const stored = readScene(mesh.resources);
    if (geometry.groups.length === 0) geometry.addGroup(0, geometry.index?.count ?? 0, 0);
    if (!stored) {
        const named = (name: string) => Object.assign(plain(geometry), { name });
        return new Mesh(geometry, (mesh.materials?.names ?? [""]).map(named));
    }
    const { materials } = await make(stored.scene, stored.images, geometry, manager, pictures);
    flipPlaces(geometry);
    return new Mesh(geometry, materials);
}

/** Makes texture coordinates grow downwards, as textures of glTF do. */
function flipPlaces(geometry: BufferGeometry): void {
    for (const [name, attribute] of Object.entries(geometry.attributes)) {
        if (!/^uv\d*$/.test(name)) continue;
        const { array } = attribute as BufferAttribute;
        for (let at = 1; at < array.length; at += 2) array[at] = 1 - array[at];
    }
}
