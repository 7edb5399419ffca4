/** A file that streams, as its user sees it. */

import { checkQuery } from "../cut/query.ts";
import type { Query } from "../cut/query.ts";
import { MlodError } from "../error.ts";
import type { ScenePart } from "../scene/head.ts";
import type { GeometryPatch } from "./geometry.ts";
import type {
    Event,
    FileInfo,
    Origin,
    Progress,
    Request,
    SceneInfo,
    StreamLimits,
} from "./messages.ts";
import type { Session } from "./session.ts";
import type { Access } from "./source.ts";

/** Who hears of what happens to a stream. */
export interface StreamListener {
    /** The scene of the file is known; files of bare meshes have none. */
    onScene?(scene: SceneInfo): void;
    /** Another part of the scene is there, such as a larger version of an image. */
    onPart?(part: ScenePart, bytes: Uint8Array): void;
    /** The buffers change. */
    onPatch?(patch: GeometryPatch): void;
    onProgress?(progress: Progress): void;
    /** The stream has ended by an error; what has been shown stays. */
    onError?(error: MlodError): void;
}

/** Options of `open`. */
export interface StreamOptions extends StreamListener, StreamLimits, Access {
    /** Ends the stream, and rejects its opening. */
    signal?: AbortSignal;
    /** Makes the worker in which the file is decoded; without one that is done on this thread. */
    worker?: () => Worker;
}

/** An open file. */
export interface MlodStream {
    readonly info: FileInfo;
    /**
     * Asks for a level; its geometry comes by patches.
     *
     * @throws RangeError if the query is invalid; the one before goes on
     */
    query(query: Query): void;
    /**
     * Divides what is shown into other parts than one for each material: `parts` has the part of
     * each pair of `info.pairs`. The next new patch has them.
     */
    split(parts: readonly number[]): void;
    /** Ends all work, and frees the memory. */
    dispose(): void;
}

/**
 * Opens a file at an address or in memory; resolves once its coarsest level can be shown.
 *
 * @throws MlodError if it cannot be read, or is damaged
 */
export function open(
    file: string | URL | ArrayBuffer | Uint8Array,
    options: StreamOptions = {},
): Promise<MlodStream> {
    const { signal, worker, memory, request, slice, morph } = options;
    const limits = withoutMissing({ memory, request, slice, morph });
    return new Promise((resolve, reject) => {
        if (signal?.aborted) return void reject(signal.reason as Error);
        const port = worker ? workerPort(worker()) : localPort();
        const abort = () => {
            dispose();
            reject(signal?.reason as Error);
        };
        const dispose = () => {
            signal?.removeEventListener("abort", abort);
            port.close();
        };
        const query = (query: Query) => {
            checkQuery(query);
            port.send({ kind: "query", query });
        };
        let isOpen = false;
        port.listen((event) => {
            if (event.kind === "opened") {
                isOpen = true;
                resolve({
                    info: event.info,
                    query,
                    split: (parts) => port.send({ kind: "split", parts }),
                    dispose,
                });
            } else if (event.kind === "failed" && !isOpen) {
                dispose();
                reject(new MlodError(event.section, event.why));
            } else tell(options, event);
        });
        signal?.addEventListener("abort", abort);
        port.send({ kind: "open", origin: originOf(file, options), limits });
    });
}

function tell(listener: StreamListener, event: Event): void {
    if (event.kind === "scene") listener.onScene?.(event.scene);
    else if (event.kind === "part") listener.onPart?.(event.part, event.bytes);
    else if (event.kind === "patch") listener.onPatch?.(event.patch);
    else if (event.kind === "progress") listener.onProgress?.(event.progress);
    else if (event.kind === "failed") listener.onError?.(new MlodError(event.section, event.why));
}

function originOf(
    file: string | URL | ArrayBuffer | Uint8Array,
    { headers, credentials }: Access,
): Origin {
    if (file instanceof ArrayBuffer) return { bytes: new Uint8Array(file) };
    if (file instanceof Uint8Array) return { bytes: file };
    const base = typeof document === "undefined" ? undefined : document.baseURI;
    const access: Access = {};
    if (headers) access.headers = headers;
    if (credentials) access.credentials = credentials;
    return { url: new URL(file, base).href, access };
}

function withoutMissing(limits: { [key in keyof StreamLimits]: number | undefined }): StreamLimits {
    return Object.fromEntries(Object.entries(limits).filter(([, limit]) => limit !== undefined));
}

/** Where a session is. */
interface Port {
    send(request: Request): void;
    listen(hear: (event: Event) => void): void;
    close(): void;
}

function workerPort(worker: Worker): Port {
    return {
        send: (request) => worker.postMessage(request),
        listen: (hear) => {
            worker.onmessage = ({ data }: MessageEvent<Event>) => hear(data);
            // Where the worker does not start there is no message.
            worker.onerror = ({ message }: Partial<ErrorEvent>) =>
                hear({
                    kind: "failed",
                    section: "the worker",
                    why: message ?? "its script cannot be loaded",
                });
        },
        close: () => {
            worker.onmessage = worker.onerror = null;
            worker.terminate();
        },
    };
}

/** A session on this thread, whose code is only loaded where there is one. */
function localPort(): Port {
    const nobody = (): void => undefined;
    let hear: (event: Event) => void = nobody;
    const session: Promise<Session | null> = import("./session.ts").then(
        ({ Session }) => new Session((event) => hear(event)),
        (error: unknown) => {
            hear({ kind: "failed", section: "the decoder", why: String(error) });
            return null;
        },
    );
    const send = (request: Request) => void session.then((session) => session?.receive(request));
    const close = () => {
        hear = nobody;
        send({ kind: "close" });
    };
    return { send, listen: (listener) => (hear = listener), close };
}
