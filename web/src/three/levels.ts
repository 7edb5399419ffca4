/** What all copies of one file share: its stream, its geometry and its materials. */

import type { LoadingManager, Material, Mesh } from "three";
import type { MlodError, MlodStream, Progress, Query, SceneInfo } from "../index.ts";
import { StreamGeometry } from "./buffers.ts";
import { disposeMaterials, makeMaterials, plainMaterial } from "./materials.ts";
import { Pictures, closeTextures } from "./pictures.ts";

/** Milliseconds for which images are gathered before materials are made with them. */
const GATHER = 50;

/** A copy that is shown, and meshes that show it otherwise, which have its materials. */
interface Copy extends Mesh {
    readonly followers: Mesh[];
}

/** What a copy asks for, and how near it is to its camera. */
interface Asked {
    query: Query;
    nearness: number;
}

/** An open file on the GPU. */
export class SharedLevels {
    readonly geometry: StreamGeometry;
    materials: Material[];
    progress: Progress | null = null;
    private readonly copies = new Map<Copy, Asked | null>();
    scene: SceneInfo | null = null;
    /** Key frames of animations. */
    frames: Uint8Array | null = null;
    /** True if nothing more comes. */
    hasEnded = false;
    private readonly images = new Map<number, Uint8Array>();
    private timer: ReturnType<typeof setTimeout> | undefined;
    private readonly pictures = new Pictures();
    /** Ends when materials have been made: one time after the other, or images would be decoded twice. */
    private making: Promise<void> = Promise.resolve();
    private last = "";
    /** Factor of tolerances that keeps a budget, and the progress that it answers. */
    private factor = 1;
    private judged: Progress | null = null;
    private budget = Infinity;
    isDisposed = false;

    constructor(
        readonly stream: MlodStream,
        private readonly manager: LoadingManager,
        private readonly onError: (error: Error) => void,
    ) {
        this.geometry = new StreamGeometry(stream.info);
        this.materials = [plainMaterial(this.geometry)];
        this.repeatMaterial();
    }

    /** Without a scene all labels have one material. */
    private repeatMaterial(): void {
        const labels = this.stream.info.materials?.length ?? 0;
        while (this.materials.length <= labels) this.materials.push(this.materials[0]);
    }

    /** Adds a copy, which shares everything. */
    add(copy: Copy): void {
        this.copies.set(copy, null);
    }

    /** Asks for what one copy needs; of several the one nearest to its camera decides. */
    ask(copy: Copy, query: Query, nearness: number): void {
        if (this.isDisposed) return;
        this.copies.set(copy, { query, nearness });
        let best: Asked | null = null;
        for (const asked of this.copies.values())
            if (asked && (!best || asked.nearness > best.nearness)) best = asked;
        const key = JSON.stringify(best?.query);
        if (!best || key === this.last) return;
        this.last = key;
        this.stream.query(best.query);
    }

    /** Returns the factor of a tolerance that leaves about a number of faces, but no more. */
    relief(most: number): number {
        const { progress } = this;
        const isJudged = progress === this.judged && most === this.budget;
        if (!progress || isJudged) return this.factor;
        this.judged = progress;
        this.budget = most;
        const ratio = progress.faces / most;
        if (ratio > 1) this.factor *= Math.min(2, Math.max(1.25, Math.sqrt(ratio)));
        // Not while finer chunks are on their way, and not to and fro.
        else if (ratio < 0.5 && progress.done && progress.missing === 0)
            this.factor = Math.max(1, this.factor * Math.max(0.7, Math.sqrt(1.5 * ratio)));
        return this.factor;
    }

    /** Takes the scene of the file. */
    setScene(scene: SceneInfo): void {
        this.scene = scene;
        this.remakeSoon();
    }

    /** Takes an image, or a larger version of one. */
    setImage(image: number, bytes: Uint8Array): void {
        this.images.set(image, bytes);
        this.remakeSoon();
    }

    private remakeSoon(): void {
        this.timer ??= setTimeout(() => {
            this.timer = undefined;
            this.making = this.making.then(() => this.remake()).catch(this.onError);
        }, GATHER);
    }

    private async remake(): Promise<void> {
        if (!this.scene || this.isDisposed) return;
        const { scene, geometry, manager, pictures } = this;
        const images = new Map(this.images);
        const made = await makeMaterials(scene, images, geometry, manager, pictures);
        const old = this.isDisposed ? made.materials : this.materials;
        if (!this.isDisposed) this.materials = made.materials;
        for (const copy of this.copies.keys())
            for (const mesh of [copy, ...copy.followers])
                if (mesh.material === old) mesh.material = made.materials;
        disposeMaterials(old);
        closeTextures(made.replaced);
        if (this.isDisposed) pictures.dispose();
    }

    /** Forgets a copy; with the last one goes the stream. */
    remove(copy: Copy): void {
        this.copies.delete(copy);
        if (this.copies.size > 0 || this.isDisposed) return;
        this.isDisposed = this.hasEnded = true;
        clearTimeout(this.timer);
        this.stream.dispose();
        this.geometry.dispose();
        disposeMaterials(this.materials);
        this.pictures.dispose();
    }

    /** What is known of the file. */
    get info(): MlodStream["info"] {
        return this.stream.info;
    }

    /** Tells what went wrong; what is shown stays. */
    fail(error: MlodError): void {
        this.hasEnded = true;
        this.onError(error);
    }
}
