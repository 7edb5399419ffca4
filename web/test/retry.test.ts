import assert from "node:assert/strict";
import type { IncomingMessage, ServerResponse } from "node:http";
import { test } from "node:test";
import { HttpSource } from "../src/load/source.ts";
import { file, never, sendRange, serving } from "./server.ts";

test("what fails by the network is tried again, and given up at last", async () => {
    let asked = 0;
    const failures: ((response: ServerResponse) => void)[] = [
        (response) => response.destroy(),
        (response) => response.writeHead(503).end(),
        (response) => {
            response.writeHead(206, {
                "Content-Length": "100",
                "Content-Range": "bytes 0-99/1000",
                ETag: '"1"',
            });
            response.write(file.subarray(0, 20), () => response.destroy());
        },
    ];
    await serving(
        (request, response) =>
            (failures[asked++ % 4] ?? sendRange.bind(null, file, request))(response),
        async (url) => {
            const patient = new HttpSource(url, never, {}, fetch, [1, 1, 1]);
            assert.deepEqual(Buffer.from(await patient.start(100)), file.subarray(0, 100));
            assert.deepEqual(Buffer.from(await patient.read(700, 50)), file.subarray(700, 750));
            assert.equal(asked, 8);
            const hasty = new HttpSource(url, never, {}, fetch, [1]);
            await assert.rejects(hasty.start(100), /the server answers 503/);
            assert.equal(asked, 10);
        },
    );
});

test("a server may say when to come back, and waiting ends with the stream", async () => {
    let [asked, seconds] = [0, "0.2"];
    const answer = (request: IncomingMessage, response: ServerResponse) => {
        if (asked++ > 0) sendRange(file, request, response);
        else response.writeHead(429, { "Retry-After": seconds }).end();
    };
    await serving(answer, async (url) => {
        const start = performance.now();
        await new HttpSource(url, never, {}, fetch, [1]).start(100);
        assert.ok(performance.now() - start >= 190);
        [asked, seconds] = [0, "10"];
        const abort = new AbortController();
        const waiting = new HttpSource(url, abort.signal, {}, fetch, [1e6]).start(100);
        const timer = setInterval(() => asked > 0 && abort.abort(new Error("enough")), 20);
        await assert.rejects(waiting, /enough/);
        clearInterval(timer);
        assert.equal(asked, 1);
    });
});

test("what the file lacks is not asked for twice", async () => {
    let asked = 0;
    await serving(
        (_, response) => response.writeHead(404, { Asked: asked++ }).end(),
        (url) => assert.rejects(new HttpSource(url, never).start(100), /answers 404/),
    );
    assert.equal(asked, 1);
});
