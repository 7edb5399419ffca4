/** The worker in which a file is decoded: a session that talks by messages. */

import type { GeometryPatch } from "./load/geometry.ts";
import type { Event, Request } from "./load/messages.ts";
import { Session } from "./load/session.ts";

interface WorkerScope {
    postMessage(event: Event, transfer: Transferable[]): void;
    onmessage: ((message: MessageEvent<Request>) => void) | null;
}

const scope = globalThis as unknown as WorkerScope;

/** Buffers that go to the other side and are not needed here. */
function buffersOf({ vertices, values, places, index }: GeometryPatch): Transferable[] {
    return [vertices.buffer, values.buffer, places.buffer, index.buffer] as ArrayBuffer[];
}

const session = new Session((event) =>
    scope.postMessage(event, event.kind === "patch" ? buffersOf(event.patch) : []),
);
scope.onmessage = ({ data }) => session.receive(data);
