/** A model that is shown: what it draws, and what it asks for as the camera moves. */

import type { Query } from "../src/cut/query.ts";
import { open } from "../src/load/stream.ts";
import type { MlodStream, StreamOptions } from "../src/load/stream.ts";
import type { SceneInfo } from "../src/load/messages.ts";
import { plain, readMaterials, readTextures } from "./materials.ts";
import type { Ball } from "./orbit.ts";
import type { Drawn } from "./renderer.ts";
import { Surface } from "./surface.ts";
import { Textures } from "./textures.ts";

/** Milliseconds in which vertices move to another level. */
const MORPH = 200;

/** Figures of what is shown. */
export interface Figures {
    /** Bytes read so far, and of the whole file. */
    bytes: number;
    length: number;
    faces: number;
    /** True if nothing more is needed. */
    done: boolean;
}

/** A model on the GPU. */
export interface Model extends Ball {
    drawn: Drawn;
    figures: Figures;
    /** True if there is one level only. */
    isWhole: boolean;
    /** Number of triangles written, and milliseconds that took, since they were last set to 0. */
    written: number;
    writing: number;
    /** Asks for a level; of models without levels nothing. */
    ask(query: Query): void;
    dispose(): void;
}

/** Who hears of a model. */
export interface Watcher {
    changed(): void;
    failed(error: unknown): void;
    worker: (() => Worker) | undefined;
    signal: AbortSignal;
}

/** A whole mesh, as the decoders of the other formats return it. */
export interface WholeMesh extends Ball {
    layers: ConstructorParameters<typeof Surface>[1];
    values: Float32Array;
    index: Uint32Array;
}

/** Opens levels at an address or in memory. */
export async function openLevels(
    gl: WebGL2RenderingContext,
    file: string | Uint8Array,
    watcher: Watcher,
): Promise<Model> {
    const early: (() => void)[] = [];
    let model: Model | null = null;
    const then = (act: (model: Model) => void) => {
        const run = () => {
            if (!model || watcher.signal.aborted) return;
            act(model);
            watcher.changed();
        };
        if (model) run();
        else early.push(run);
    };
    const options: StreamOptions = {
        morph: MORPH,
        signal: watcher.signal,
        onScene: (scene) => then(({ drawn }) => wear(drawn, scene)),
        onPart: ({ kind, image }, bytes) =>
            then(({ drawn }) => {
                if (kind !== "animations") void drawn.textures.setImage(image, bytes);
            }),
        onPatch: (patch) =>
            then((model) => {
                const start = performance.now();
                model.drawn.surface.apply(patch);
                model.written += patch.places.length;
                model.writing += performance.now() - start;
            }),
        onProgress: ({ bytes, faces, done, missing }) =>
            then(({ figures }) =>
                Object.assign(figures, { bytes, faces, done: done && missing === 0 }),
            ),
        onError: (error) => watcher.failed(error),
    };
    if (watcher.worker) options.worker = watcher.worker;
    const stream = await open(file, options);
    model = modelOf(gl, stream, watcher);
    early.forEach((run) => run());
    return model;
}

function modelOf(gl: WebGL2RenderingContext, stream: MlodStream, watcher: Watcher): Model {
    const { center, diagonal, layers, length } = stream.info;
    const drawn = bare(gl, new Surface(gl, layers, true), center, watcher);
    return {
        center,
        diagonal,
        drawn,
        figures: { bytes: 0, length, faces: 0, done: false },
        isWhole: false,
        written: 0,
        writing: 0,
        ask: (query) => stream.query(query),
        dispose() {
            stream.dispose();
            free(drawn);
        },
    };
}

/** Shows a whole mesh. */
export function showWhole(
    gl: WebGL2RenderingContext,
    mesh: WholeMesh,
    bytes: number,
    watcher: Watcher,
): Model {
    const { center, diagonal, layers, values, index } = mesh;
    const drawn = bare(gl, new Surface(gl, layers, true), center, watcher);
    const faces = index.length / 3;
    drawn.surface.set(values, index, [{ start: 0, count: faces }]);
    return {
        center,
        diagonal,
        drawn,
        figures: { bytes, length: bytes, faces, done: true },
        isWhole: true,
        written: faces,
        writing: 0,
        ask: () => undefined,
        dispose: () => free(drawn),
    };
}

function bare(
    gl: WebGL2RenderingContext,
    surface: Surface,
    center: Ball["center"],
    { changed }: Watcher,
): Drawn {
    const textures = new Textures(gl, changed);
    return { surface, materials: [], rest: plain(), uses: [], textures, center };
}

function free({ surface, textures }: Drawn): void {
    surface.delete();
    textures.delete();
}

/** Takes the materials of a scene. */
function wear(drawn: Drawn, { document, slots }: SceneInfo): void {
    const scene: unknown = JSON.parse(document);
    const materials = readMaterials(scene);
    drawn.uses = readTextures(scene);
    drawn.materials = slots.map(({ material }) => materials[material ?? -1] ?? drawn.rest);
}
