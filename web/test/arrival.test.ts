// What has come is shown before all that was asked for has.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import type { ServerResponse } from "node:http";
import type { AddressInfo } from "node:net";
import { test } from "node:test";
import { readHeader } from "../src/file/header.ts";
import { Session } from "../src/load/session.ts";
import { conformanceFile, conformanceNames } from "./files.ts";

test(
    "chunks are shown while the request for them goes on",
    { skip: !conformanceNames().includes("pieces") && "there is no file of many chunks" },
    async () => {
        const file = conformanceFile("pieces");
        const { baseFaces } = readHeader(file);
        const steps: number[] = [];
        // Of the second request, all but the last byte come at once.
        let last: ServerResponse | null = null;
        const server = createServer((request, response) => {
            const [, at, end] = /(\d+)-(\d+)/.exec(request.headers.range ?? "") ?? [];
            const to = Math.min(Number(end) + 1, file.length);
            const range = `bytes ${at}-${to - 1}/${file.length}`;
            response.writeHead(206, { "Content-Range": range, ETag: '"1"' });
            if (Number(at) === 0) return response.end(file.subarray(0, to));
            last = response;
            return response.write(file.subarray(Number(at), to - 1));
        });
        await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
        const { port } = server.address() as AddressInfo;
        const finest = await new Promise<number>((resolve, reject) => {
            const session = new Session((event) => {
                if (event.kind === "failed") reject(new Error(event.why));
                if (event.kind !== "progress") return;
                const { faces, done, missing } = event.progress;
                if (!done) return;
                steps.push(faces);
                if (missing === 0 && steps.length > 1) resolve(faces);
                // Only once something finer is shown does the rest come.
                if (last && faces > 2 * baseFaces) {
                    last.end(file.subarray(file.length - 1));
                    last = null;
                }
            });
            const origin = { url: `http://127.0.0.1:${port}/`, access: {} };
            session.receive({ kind: "open", origin, limits: {} });
            session.receive({ kind: "query", query: { focus: null, tolerance: 0 } });
        });
        server.close();
        assert.ok(
            steps.some((faces) => faces > 2 * baseFaces && faces < finest),
            `${steps}`,
        );
    },
);
