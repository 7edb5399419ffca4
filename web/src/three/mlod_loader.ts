/** Loader of `.mlod` files for three.js. */

import { Loader } from "three";
import { open } from "../load/stream.ts";
import { workerOf } from "../load/worker_url.ts";
import type { GeometryPatch, StreamLimits, StreamOptions } from "../index.ts";
import { SharedLevels } from "./levels.ts";
import { MlodMesh } from "./mlod_mesh.ts";

/** Opens files as meshes, which grow while they are shown. */
export class MlodLoader extends Loader<MlodMesh> {
    /** Makes the worker of each file; null to decode on this thread. */
    worker: (() => Worker) | null = workerOf;
    /** Limits of each stream. */
    limits: StreamLimits = {};
    /**
     * Hears of errors after a mesh has been shown, such as of a file that changes on the server.
     */
    onStreamError: (error: Error) => void = (error) => console.error(error);

    override load(
        url: string,
        onLoad: (mesh: MlodMesh) => void,
        onProgress?: (event: ProgressEvent) => void,
        onError?: (error: unknown) => void,
    ): void {
        const path = this.manager.resolveURL(this.path + url);
        this.manager.itemStart(path);
        this.openMesh(path, onProgress)
            .then(onLoad)
            .catch((error: unknown) => {
                if (onError) onError(error);
                else console.error(error);
                this.manager.itemError(path);
            })
            .finally(() => this.manager.itemEnd(path));
    }

    /** Shows a file in memory. */
    parse(file: ArrayBuffer): Promise<MlodMesh> {
        return this.openMesh(file);
    }

    private async openMesh(
        file: string | ArrayBuffer,
        onProgress?: (event: ProgressEvent) => void,
    ): Promise<MlodMesh> {
        let levels: SharedLevels | null = null;
        // What comes before the mesh is there.
        const early: ((levels: SharedLevels) => void)[] = [];
        const later = (act: (levels: SharedLevels) => void) =>
            void (levels ? act(levels) : early.push(act));
        let begin: () => void = () => undefined;
        const begun = new Promise<void>((resolve) => (begin = resolve));
        const options: StreamOptions = {
            ...this.limits,
            onScene: (scene) => later((levels) => levels.setScene(scene)),
            onPart: ({ kind, image }, bytes) =>
                later((levels) => {
                    if (kind === "animations") levels.frames = bytes;
                    else levels.setImage(image, bytes);
                }),
            onPatch: (patch: GeometryPatch) => later((levels) => levels.geometry.apply(patch)),
            onError: (error) => {
                later((levels) => levels.fail(error));
                begin();
            },
            onProgress: (progress) => {
                later((levels) => (levels.progress = progress));
                begin();
                onProgress?.(new ProgressEvent("progress", { loaded: progress.bytes }));
            },
        };
        options.headers = this.requestHeader;
        if (this.withCredentials) options.credentials = "include";
        if (this.worker) options.worker = this.worker;
        const stream = await open(file, options);
        const opened = new SharedLevels(stream, this.manager, (error) => this.onStreamError(error));
        const mesh = new MlodMesh(opened);
        levels = opened;
        early.forEach((act) => act(opened));
        await begun;
        return mesh;
    }
}
