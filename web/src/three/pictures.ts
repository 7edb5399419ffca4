/** Images of a scene, each decoded once however often materials are made. */

import type { Texture } from "three";
import type { GLTFParser } from "three/addons/loaders/GLTFLoader.js";

/** What a parser of three.js has decoded, by the numbers of images. */
interface Sources {
    sourceCache: Record<number, Promise<Texture | null> | undefined>;
}

/** A decoded image, and what it was decoded from. */
interface Picture {
    bytes: Uint8Array;
    texture: Texture;
}

/** Keeps decoded images from one making of materials to the next. */
export class Pictures {
    private readonly all = new Map<number, Picture>();

    /** Gives a parser what has been decoded of the images that it will ask for. */
    lend(parser: GLTFParser, images: ReadonlyMap<number, Uint8Array>): void {
        const { sourceCache } = parser as unknown as Sources;
        for (const [image, { bytes, texture }] of this.all)
            if (images.get(image) === bytes) sourceCache[image] = Promise.resolve(texture);
    }

    /** Keeps what a parser has decoded; returns what that replaces. */
    async keep(
        parser: GLTFParser,
        images: ReadonlyMap<number, Uint8Array>,
    ): Promise<readonly Texture[]> {
        const { sourceCache } = parser as unknown as Sources;
        const replaced: Texture[] = [];
        for (const [image, bytes] of images) {
            const old = this.all.get(image);
            const texture = await sourceCache[image]?.catch(() => null);
            if (!texture || texture === old?.texture) continue;
            if (old) replaced.push(old.texture);
            this.all.set(image, { bytes, texture });
        }
        return replaced;
    }

    /** Frees all. */
    dispose(): void {
        closeTextures([...this.all.values()].map(({ texture }) => texture));
        this.all.clear();
    }
}

/** Frees textures with their bitmaps. */
export function closeTextures(textures: readonly Texture[]): void {
    for (const texture of textures) {
        const { data } = texture.source as { data: { close?: () => void } | null };
        texture.dispose();
        data?.close?.();
    }
}
