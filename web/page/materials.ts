/** Materials of a glTF document, and their textures as the images come. */

import { TEXTURES } from "./shaders.ts";

type TextureName = (typeof TEXTURES)[number];
type Json = Record<string, unknown>;

/** How a part is drawn. */
export interface Material {
    base: [number, number, number, number];
    emissive: [number, number, number];
    metal: number;
    rough: number;
    normalScale: number;
    occlusionStrength: number;
    /** Least opacity that is drawn. */
    cutoff: number;
    isBlended: boolean;
    isDoubleSided: boolean;
    isUnlit: boolean;
    /** Matrix of texture places, by columns. */
    uvTransform: number[];
    /** Texture of the document for each use. */
    textures: Partial<Record<TextureName, number>>;
}

/** Returns the material of faces that have none. */
export function plain(): Material {
    return {
        base: [0.72, 0.72, 0.72, 1],
        emissive: [0, 0, 0],
        metal: 0,
        rough: 0.75,
        normalScale: 1,
        occlusionStrength: 1,
        cutoff: 0,
        isBlended: false,
        isDoubleSided: true,
        isUnlit: false,
        uvTransform: [1, 0, 0, 0, 1, 0, 0, 0, 1],
        textures: {},
    };
}

/** A texture of a document: its image, and how it repeats. */
export interface TextureUse {
    image: number;
    repeats: [number, number];
}

const object = (value: unknown): Json =>
    typeof value === "object" && value !== null ? (value as Json) : {};
const list = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);
const number = (value: unknown, missing: number): number =>
    typeof value === "number" && Number.isFinite(value) ? value : missing;
const numbers = <T extends number[]>(value: unknown, missing: T): T =>
    missing.map((of, k) => number(list(value)[k], of)) as T;

/** Reads the materials of a document. */
export function readMaterials(document: unknown): Material[] {
    return list(object(document).materials).map((material) => readMaterial(object(material)));
}

/** Reads the textures of a document. */
export function readTextures(document: unknown): TextureUse[] {
    const { textures, samplers } = object(document);
    return list(textures).map((value) => {
        const texture = object(value);
        const webp = object(object(texture.extensions).EXT_texture_webp);
        const sampler = object(list(samplers)[number(texture.sampler, -1)]);
        const repeats: [number, number] = [
            number(sampler.wrapS, 10497),
            number(sampler.wrapT, 10497),
        ];
        return { image: number(webp.source ?? texture.source, -1), repeats };
    });
}

function readMaterial(material: Json): Material {
    const metallic = object(material.pbrMetallicRoughness);
    const extensions = object(material.extensions);
    const strength = object(extensions.KHR_materials_emissive_strength).emissiveStrength;
    const glow = numbers<[number, number, number]>(material.emissiveFactor, [0, 0, 0]);
    const scale = number(strength, 1);
    const normal = object(material.normalTexture);
    const occlusion = object(material.occlusionTexture);
    const mode = material.alphaMode;
    const infos: Record<TextureName, Json> = {
        base: object(metallic.baseColorTexture),
        normal,
        surface: object(metallic.metallicRoughnessTexture),
        occlusion,
        emissive: object(material.emissiveTexture),
    };
    const textures: Material["textures"] = {};
    // Places of other sets than the first are not sent to the GPU.
    for (const name of TEXTURES)
        if (typeof infos[name].index === "number" && number(infos[name].texCoord, 0) === 0)
            textures[name] = infos[name].index;
    return {
        base: numbers<Material["base"]>(metallic.baseColorFactor, [1, 1, 1, 1]),
        emissive: [glow[0] * scale, glow[1] * scale, glow[2] * scale],
        metal: number(metallic.metallicFactor, 1),
        rough: number(metallic.roughnessFactor, 1),
        normalScale: number(normal.scale, 1),
        occlusionStrength: number(occlusion.strength, 1),
        cutoff: mode === "MASK" ? number(material.alphaCutoff, 0.5) : 0,
        isBlended: mode === "BLEND",
        isDoubleSided: material.doubleSided === true,
        isUnlit: "KHR_materials_unlit" in extensions,
        uvTransform: transformOf(Object.values(infos)),
        textures,
    };
}

/** Returns the first transform of texture places; materials with several are rare. */
function transformOf(infos: Json[]): number[] {
    const transforms = infos.map((info) => object(info.extensions).KHR_texture_transform);
    const transform = object(transforms.find((value) => value !== undefined));
    const [x, y] = numbers<[number, number]>(transform.offset, [0, 0]);
    const [width, height] = numbers<[number, number]>(transform.scale, [1, 1]);
    const angle = number(transform.rotation, 0);
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [width * c, -width * s, 0, height * s, height * c, 0, x, y, 1];
}
