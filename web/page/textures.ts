/** Textures on the GPU, made of images when they come. */

import type { TextureUse } from "./materials.ts";

/** Images of one model, as textures in the two ways in which shaders read them. */
export class Textures {
    private readonly images = new Map<number, ImageBitmap>();
    private readonly made = new Map<string, WebGLTexture>();
    private readonly turns = new Map<number, number>();
    private isDeleted = false;
    private readonly anisotropy: EXT_texture_filter_anisotropic | null;

    constructor(
        private readonly gl: WebGL2RenderingContext,
        private readonly changed: () => void,
    ) {
        this.anisotropy = gl.getExtension("EXT_texture_filter_anisotropic");
    }

    /** Takes an image, or a larger version of one; what no browser decodes is left out. */
    async setImage(image: number, bytes: Uint8Array): Promise<void> {
        const turn = (this.turns.get(image) ?? 0) + 1;
        this.turns.set(image, turn);
        const blob = new Blob([bytes.slice()]);
        const options = { premultiplyAlpha: "none", colorSpaceConversion: "none" } as const;
        const decoded = await createImageBitmap(blob, options).catch(() => null);
        if (!decoded || this.isDeleted || this.turns.get(image) !== turn) return decoded?.close();
        this.images.get(image)?.close();
        this.images.set(image, decoded);
        for (const [key, texture] of this.made) {
            if (!key.startsWith(`${image} `)) continue;
            this.gl.deleteTexture(texture);
            this.made.delete(key);
        }
        this.changed();
    }

    /** Returns a texture, in which colours are linear or encoded, or null before its image came. */
    get({ image, repeats }: TextureUse, isColor: boolean): WebGLTexture | null {
        const bitmap = this.images.get(image);
        if (!bitmap) return null;
        const key = `${image} ${isColor} ${repeats.join()}`;
        const known = this.made.get(key);
        if (known) return known;
        const texture = this.make(bitmap, isColor, repeats);
        this.made.set(key, texture);
        return texture;
    }

    private make(bitmap: ImageBitmap, isColor: boolean, repeats: [number, number]): WebGLTexture {
        const { gl, anisotropy } = this;
        const texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        const format = isColor ? gl.SRGB8_ALPHA8 : gl.RGBA8;
        gl.texImage2D(gl.TEXTURE_2D, 0, format, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
        gl.generateMipmap(gl.TEXTURE_2D);
        const ways = [gl.REPEAT, gl.CLAMP_TO_EDGE, gl.MIRRORED_REPEAT] as number[];
        const [s, t] = repeats.map((way) => (ways.includes(way) ? way : gl.REPEAT));
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, s);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, t);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
        if (anisotropy) gl.texParameterf(gl.TEXTURE_2D, anisotropy.TEXTURE_MAX_ANISOTROPY_EXT, 4);
        return texture;
    }

    delete(): void {
        this.isDeleted = true;
        for (const bitmap of this.images.values()) bitmap.close();
        for (const texture of this.made.values()) this.gl.deleteTexture(texture);
        this.images.clear();
        this.made.clear();
    }
}
