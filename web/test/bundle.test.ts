// The worker of the package, whose names are shortened, says what its sources say.

import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import type { Event, Request } from "../src/load/messages.ts";
import { Session } from "../src/load/session.ts";
import { conformanceFile, conformanceNames, vectorFile } from "./files.ts";

const built = join(process.cwd(), "dist/worker.min.js");

/** As much of a worker as its script needs. */
interface Scope {
    onmessage?: (message: { data: Request }) => void;
    postMessage?: (event: Event, transfer: Transferable[]) => void;
}

/** Asks for all of a file; returns what is told until it is there, but for progress. */
function eventsOf(file: Uint8Array, start: (hear: (event: Event) => void) => Send, morph = 0) {
    return new Promise<Event[]>((resolve) => {
        const events: Event[] = [];
        const send = start((event) => {
            if (event.kind !== "progress") events.push(event);
            const isOver = event.kind === "progress" && event.progress.done;
            if (event.kind === "failed" || (isOver && event.progress.missing === 0 && isAsked))
                resolve([...events]);
        });
        let isAsked = false;
        // One slice for all, so that patches do not depend on the clock.
        send({ kind: "open", origin: { bytes: file }, limits: { slice: 1e9, morph } });
        send({ kind: "query", query: { focus: null, tolerance: 0 } });
        isAsked = true;
    });
}

type Send = (request: Request) => void;

/** Loads the script anew, as a worker has one session. */
async function startBundled(number: number): Promise<(hear: (event: Event) => void) => Send> {
    const scope = globalThis as unknown as Scope;
    await import(`${pathToFileURL(built).href}?${number}`);
    return (hear) => {
        // As a worker does, which gives away what it transfers.
        scope.postMessage = (event, transfer) => hear(structuredClone(event, { transfer }));
        return (data) => scope.onmessage?.({ data });
    };
}

test(
    "the bundled worker tells what its sources tell",
    { skip: !existsSync(built) && "it has not been built" },
    async () => {
        const damaged = vectorFile();
        damaged[300] ^= 1;
        const names = conformanceNames().filter((name) => name !== "pieces");
        const files = [vectorFile(), damaged, ...names.map(conformanceFile)];
        for (const [number, file] of files.entries()) {
            const own = await eventsOf(file, (hear) => {
                const session = new Session(hear);
                return (request) => session.receive(request);
            });
            const bundled = await eventsOf(file, await startBundled(number));
            const moving = await eventsOf(file, await startBundled(number + 0.5), 20);
            assert.ok(own.length > 1);
            assert.deepEqual(bundled, own);
            // Only the clock says how many pictures of vertices there are on their way.
            const failures = (events: Event[]) => events.filter(({ kind }) => kind === "failed");
            assert.deepEqual(failures(moving), failures(own));
            assert.ok(moving.length >= own.length);
        }
    },
);
