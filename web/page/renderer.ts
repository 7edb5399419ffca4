/** Draws a surface with its materials by WebGL 2. */

import type { Vector } from "../src/frame.ts";
import type { Material, TextureUse } from "./materials.ts";
import type { Orbit } from "./orbit.ts";
import { FRAGMENT, TEXTURES, VERTEX } from "./shaders.ts";
import type { Surface } from "./surface.ts";
import type { Textures } from "./textures.ts";
import { add, cross, unit } from "./vector.ts";

/** What is drawn. */
export interface Drawn {
    surface: Surface;
    /** Material of each part; parts beyond have `rest`. */
    materials: readonly Material[];
    rest: Material;
    uses: readonly TextureUse[];
    textures: Textures;
    center: Vector;
}

/** The program on the GPU. */
export class Renderer {
    private readonly program: WebGLProgram;
    private readonly places = new Map<string, WebGLUniformLocation | null>();

    /** @throws Error if the shaders do not compile */
    constructor(private readonly gl: WebGL2RenderingContext) {
        this.program = programOf(gl);
    }

    private at(name: string): WebGLUniformLocation | null {
        let place = this.places.get(name);
        if (place === undefined) {
            place = this.gl.getUniformLocation(this.program, name);
            this.places.set(name, place);
        }
        return place;
    }

    /** Draws a model, or nothing if there is none, as the camera sees it. */
    draw(drawn: Drawn | null, orbit: Orbit): void {
        const { gl } = this;
        const { drawingBufferWidth: width, drawingBufferHeight: height } = gl;
        gl.viewport(0, 0, width, height);
        gl.depthMask(true);
        gl.clearColor(0, 0, 0, 0);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        if (!drawn) return;
        gl.useProgram(this.program);
        gl.enable(gl.DEPTH_TEST);
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        this.see(drawn, orbit, width, height);
        const parts = drawn.surface.parts.map((_, part) => part);
        const materialOf = (part: number) => drawn.materials[part] ?? drawn.rest;
        for (const isBlended of [false, true]) {
            (isBlended ? gl.enable : gl.disable).call(gl, gl.BLEND);
            gl.depthMask(!isBlended);
            for (const part of parts.filter((part) => materialOf(part).isBlended === isBlended)) {
                if (drawn.surface.parts[part].count === 0) continue;
                this.wear(materialOf(part), drawn);
                drawn.surface.draw(part);
            }
        }
    }

    private see({ surface, center }: Drawn, orbit: Orbit, width: number, height: number): void {
        const { gl } = this;
        const { eye, look, up } = orbit.camera(width, height);
        const back = unit(add(eye, look, -1));
        const right = cross(up, back);
        const lamp = unit(add(add(back, up, 0.7), right, -0.6));
        gl.uniformMatrix4fv(this.at("toClip"), false, orbit.matrix(width / height));
        gl.uniform3fv(this.at("center"), center);
        gl.uniform3fv(this.at("eye"), add(eye, center, -1));
        gl.uniform3fv(this.at("upward"), orbit.upward);
        gl.uniform3fv(this.at("lamp"), lamp);
        gl.uniform1i(this.at("hasNormals"), Number(surface.hasNormals));
        gl.uniform1i(this.at("growsUpwards"), Number(surface.growsUpwards));
    }

    private wear(material: Material, { uses, textures }: Drawn): void {
        const { gl } = this;
        gl.uniform4fv(this.at("base"), material.base);
        gl.uniform3fv(this.at("emissive"), material.emissive);
        gl.uniform1f(this.at("metal"), material.metal);
        gl.uniform1f(this.at("rough"), material.rough);
        gl.uniform1f(this.at("normalScale"), material.normalScale);
        gl.uniform1f(this.at("occlusionStrength"), material.occlusionStrength);
        gl.uniform1f(this.at("cutoff"), material.cutoff);
        gl.uniform1i(this.at("isUnlit"), Number(material.isUnlit));
        gl.uniformMatrix3fv(this.at("uvTransform"), false, material.uvTransform);
        (material.isDoubleSided ? gl.disable : gl.enable).call(gl, gl.CULL_FACE);
        TEXTURES.forEach((name, unit) => {
            const use = uses[material.textures[name] ?? -1];
            const isColor = name === "base" || name === "emissive";
            gl.activeTexture(gl.TEXTURE0 + unit);
            const texture = use ? textures.get(use, isColor) : null;
            gl.bindTexture(gl.TEXTURE_2D, texture);
            gl.uniform1i(this.at(`has[${unit}]`), Number(texture !== null));
            gl.uniform1i(this.at(`maps[${unit}]`), unit);
        });
    }
}

function programOf(gl: WebGL2RenderingContext): WebGLProgram {
    const program = gl.createProgram();
    for (const [kind, source] of [
        [gl.VERTEX_SHADER, VERTEX],
        [gl.FRAGMENT_SHADER, FRAGMENT],
    ] as const) {
        const shader = gl.createShader(kind);
        if (!shader) continue;
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
        throw new Error(`the shaders do not compile: ${gl.getProgramInfoLog(program)}`);
    return program;
}
