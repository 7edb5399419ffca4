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
    postMessage?: (event: Event) => void;
}

/** Asks for all of a file; returns what is told until it is there, but for progress. */
function eventsOf(file: Uint8Array, start: (hear: (event: Event) => void) => Send) {
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
        send({ kind: "open", origin: { bytes: file }, limits: { slice: 1e9 } });
        send({ kind: "query", query: { focus: null, tolerance: 0 } });
        isAsked = true;
    });
}

type Send = (request: Request) => void;

test(
    "the bundled worker tells what its sources tell",
    { skip: !existsSync(built) && "it has not been built" },
    async () => {
        const scope = globalThis as unknown as Scope;
        const damaged = vectorFile();
        damaged[300] ^= 1;
        const names = conformanceNames().filter((name) => name !== "pieces");
        const files = [vectorFile(), damaged, ...names.map(conformanceFile)];
        for (const [number, file] of files.entries()) {
            const own = await eventsOf(file, (hear) => {
                const session = new Session(hear);
                return (request) => session.receive(request);
            });
            // A worker has one session.
            await import(`${pathToFileURL(built).href}?${number}`);
            const bundled = await eventsOf(file, (hear) => {
                scope.postMessage = hear;
                return (data) => scope.onmessage?.({ data });
            });
            assert.ok(own.length > 1);
            assert.deepEqual(bundled, own);
        }
    },
);
