/** Materials of a scene as GLTFLoader makes them, with the images that are there so far. */

import { Mesh, MeshStandardMaterial } from "three";
import type { BufferGeometry, LoadingManager, Material, Texture } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import type { SceneInfo } from "../index.ts";
import type { Pictures } from "./pictures.ts";

type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
type JsonObject = { [key: string]: Json };

/** Extensions without which a document of materials can be read, too. */
const OF_GEOMETRY = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_mesh_quantization",
];

/** Makes the material of each label of a stream, in order, and one for faces without. */
export async function makeMaterials(
    scene: SceneInfo,
    images: ReadonlyMap<number, Uint8Array>,
    geometry: BufferGeometry,
    manager: LoadingManager,
    pictures: Pictures,
): Promise<{ materials: Material[]; replaced: readonly Texture[] }> {
    const glb = materialsOnly(scene.document, images);
    const loader = new GLTFLoader(manager).register((parser) => {
        pictures.lend(parser, images);
        return { name: "MLOD_pictures" };
    });
    const { parser } = await loader.parseAsync(glb, "");
    const make = async (material: number | null): Promise<Material> => {
        const own =
            material === null
                ? plainMaterial(geometry)
                : ((await parser.getDependency("material", material)) as Material);
        const mesh = new Mesh(geometry, own);
        parser.assignFinalMaterial(mesh);
        return mesh.material;
    };
    const slots = [...scene.slots.map((slot) => make(slot.material)), make(null)];
    const materials = await Promise.all(slots);
    return { materials, replaced: await pictures.keep(parser, images) };
}

/** Returns the material of faces that have none, for what a geometry has. */
export function plainMaterial(geometry: BufferGeometry): Material {
    return new MeshStandardMaterial({
        metalness: 0,
        roughness: 1,
        flatShading: !geometry.hasAttribute("normal"),
        vertexColors: geometry.hasAttribute("color"),
    });
}

/** Frees materials with their textures. */
export function disposeMaterials(materials: readonly Material[]): void {
    for (const material of materials) {
        for (const value of Object.values(material) as unknown[]) {
            if (isTexture(value)) value.dispose();
        }
        material.dispose();
    }
}

function isTexture(value: unknown): value is Texture {
    return (
        typeof value === "object" &&
        value !== null &&
        (value as Partial<Texture>).isTexture === true
    );
}

/** Returns a GLB that has the materials of a document, and the images that are there. */
function materialsOnly(text: string, images: ReadonlyMap<number, Uint8Array>): ArrayBuffer {
    const whole = JSON.parse(text) as JsonObject;
    const kept = [
        "asset",
        "materials",
        "textures",
        "samplers",
        "extensionsUsed",
        "extensionsRequired",
    ];
    const document = Object.fromEntries(
        Object.entries(whole).filter(([key]) => kept.includes(key)),
    ) as JsonObject;
    for (const key of ["extensionsUsed", "extensionsRequired"]) {
        const names = document[key];
        if (Array.isArray(names))
            document[key] = names.filter((name) => !OF_GEOMETRY.includes(String(name)));
    }
    const views: JsonObject[] = [];
    const parts: Uint8Array[] = [];
    let length = 0;
    const all = Array.isArray(whole.images) ? whole.images : [];
    document.images = all.map((_, number) => {
        const bytes = images.get(number) ?? new Uint8Array(0);
        views.push({ buffer: 0, byteOffset: length, byteLength: bytes.length });
        parts.push(bytes);
        length += bytes.length;
        return { bufferView: number, mimeType: typeOf(bytes) };
    });
    if (all.length === 0) delete document.images;
    document.bufferViews = views;
    document.buffers = [{ byteLength: length }];
    dropTextures(document, images);
    return glbOf(document, parts, length);
}

/** Removes the references to textures whose images are not there yet. */
function dropTextures(document: JsonObject, images: ReadonlyMap<number, Uint8Array>): void {
    const textures = Array.isArray(document.textures) ? (document.textures as JsonObject[]) : [];
    const isThere = (index: Json) => images.has(Number(textures[Number(index)]?.source));
    const visit = (value: Json): void => {
        if (Array.isArray(value)) return value.forEach(visit);
        if (typeof value !== "object" || value === null) return;
        for (const [key, inner] of Object.entries(value)) {
            const isTexture =
                key.endsWith("Texture") &&
                typeof inner === "object" &&
                inner !== null &&
                "index" in inner;
            if (isTexture && !isThere((inner as JsonObject).index))
                Reflect.deleteProperty(value, key);
            else visit(inner);
        }
    };
    visit(document.materials ?? null);
}

function typeOf(bytes: Uint8Array): string {
    if (bytes[0] === 0xff) return "image/jpeg";
    return bytes[0] === 0x52 ? "image/webp" : "image/png";
}

function glbOf(document: JsonObject, parts: readonly Uint8Array[], length: number): ArrayBuffer {
    const text = new TextEncoder().encode(JSON.stringify(document));
    const [jsonLength, binLength] = [text.length, length].map((length) => (length + 3) & ~3);
    const glb = new Uint8Array(28 + jsonLength + binLength);
    const words = new DataView(glb.buffer);
    const header = [0x46546c67, 2, glb.length, jsonLength, 0x4e4f534a];
    header.forEach((word, i) => words.setUint32(4 * i, word, true));
    glb.fill(0x20, 20, 20 + jsonLength);
    glb.set(text, 20);
    let at = 20 + jsonLength;
    words.setUint32(at, binLength, true);
    words.setUint32(at + 4, 0x004e4942, true);
    at += 8;
    for (const part of parts) {
        glb.set(part, at);
        at += part.length;
    }
    return glb.buffer;
}
