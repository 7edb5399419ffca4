import assert from "node:assert/strict";
import type { IncomingMessage, ServerResponse } from "node:http";
import { test } from "node:test";
import { open } from "../src/load/stream.ts";
import type { MlodStream, StreamListener } from "../src/load/stream.ts";
import { HttpSource } from "../src/load/source.ts";
import { file, never, sendRange, serving } from "./server.ts";
import { conformanceFile, conformanceNames, vectorFile } from "./files.ts";

test("parts are fetched by ranges, and only these", async () => {
    let sent = 0;
    const answer = (request: IncomingMessage, response: ServerResponse) => {
        sendRange(file, request, response);
        const [from, to] =
            /bytes=(\d+)-(\d+)/
                .exec(request.headers.range ?? "")
                ?.slice(1)
                .map(Number) ?? [];
        sent += Math.min(to + 1, file.length) - from;
    };
    await serving(answer, async (url) => {
        const source = new HttpSource(url, never);
        assert.deepEqual(Buffer.from(await source.start(100)), file.subarray(0, 100));
        assert.deepEqual(Buffer.from(await source.read(20, 30)), file.subarray(20, 50));
        assert.deepEqual(Buffer.from(await source.read(700, 50)), file.subarray(700, 750));
        assert.deepEqual(Buffer.from(await source.read(90, 20)), file.subarray(90, 110));
        assert.equal(sent, 160);
        assert.deepEqual(Buffer.from(await source.start(5000)), file);
        await assert.rejects(source.read(990, 20), /ends at byte 1000, before byte 1010/);
    });
});

test("of a server without ranges, parts of the whole file are there as they come", async () => {
    const answer = (_: IncomingMessage, response: ServerResponse) => {
        response.writeHead(200).write(file.subarray(0, 300));
        setTimeout(() => response.end(file.subarray(300)), 100);
    };
    await serving(answer, async (url) => {
        const source = new HttpSource(url, never);
        const start = await source.start(100);
        assert.ok(start.length >= 100 && start.length < 1000);
        const parts = await Promise.all([source.read(600, 50), source.read(200, 50)]);
        assert.deepEqual(Buffer.from(parts[0]), file.subarray(600, 650));
        assert.deepEqual(Buffer.from(parts[1]), file.subarray(200, 250));
        await assert.rejects(source.read(990, 20), /ends at byte 1000/);
    });
});

test("other origins are asked for nothing but ranges", async () => {
    const asked: string[][] = [];
    const caches: unknown[] = [];
    const get: typeof fetch = (_, options) => {
        asked.push(Object.keys(options?.headers ?? {}));
        caches.push(options?.cache);
        const [from, to] = asked.length === 1 ? [0, 99] : [700, 749];
        const headers = { "Content-Range": `bytes ${from}-${to}/1000`, ETag: '"1"' };
        return Promise.resolve(new Response(file.subarray(from, to + 1), { status: 206, headers }));
    };
    const source = new HttpSource("https://elsewhere.test/", never, {}, get);
    await source.start(100);
    await source.read(700, 50);
    // Any other header would need the leave of the server, by a request of its own.
    assert.deepEqual(asked, [["Range"], ["Range"]]);
    // What a cache has of an older file is not taken for the start of this one.
    assert.deepEqual(caches, ["no-cache", "default"]);
});

test("a file that changes in the middle is noticed", async () => {
    let tag = '"1"';
    await serving(
        (request, response) => sendRange(file, request, response, tag),
        async (url) => {
            const source = new HttpSource(url, never);
            await source.start(100);
            tag = '"2"';
            await assert.rejects(source.read(700, 50), /has changed on the server/);
        },
    );
});

test("a server that lies about ranges, or fails, is not believed", async () => {
    const lies: ((response: ServerResponse) => void)[] = [
        (response) =>
            response
                .writeHead(206, { "Content-Range": "bytes 0-49/1000" })
                .end(file.subarray(0, 50)),
        (response) =>
            response
                .writeHead(206, { "Content-Range": "bytes 5-104/1000" })
                .end(file.subarray(5, 105)),
        // Without an end.
        (response) => {
            response.writeHead(206, { "Content-Range": "bytes 0-99/1000" });
            const more = () => void (response.destroyed || response.write(file, more));
            more();
        },
    ];
    for (const lie of lies) {
        await serving(
            (_, response) => lie(response),
            (url) => assert.rejects(new HttpSource(url, never).start(100), /sends other bytes/),
        );
    }
    await serving(
        (_, response) => response.writeHead(206).end(file.subarray(0, 100)),
        (url) => assert.rejects(new HttpSource(url, never).start(100), /expose Content-Range/),
    );
    await serving(
        (_, response) => response.writeHead(404).end(),
        (url) => assert.rejects(new HttpSource(url, never).start(100), /the server answers 404/),
    );
    await serving(
        (_, response) => {
            response.writeHead(206, {
                "Content-Range": "bytes 0-99/1000",
                "Content-Length": "100",
            });
            response.write(file.subarray(0, 40), () => response.destroy());
        },
        (url) => assert.rejects(new HttpSource(url, never, {}, fetch, []).start(100), /the file: /),
    );
});

/** Opens a file, asks for its finest level, and waits until that is there. */
function finest(from: string | Uint8Array, listener: StreamListener = {}): Promise<MlodStream> {
    return new Promise((resolve, reject) => {
        let stream: MlodStream | null = null;
        const onProgress: StreamListener["onProgress"] = (progress) => {
            listener.onProgress?.(progress);
            if (stream && progress.done && progress.missing === 0 && progress.faces > 1)
                resolve(stream);
        };
        open(from, { ...listener, onProgress, onError: reject }).then((opened) => {
            stream = opened;
            opened.query({ focus: null, tolerance: 0 });
        }, reject);
    });
}

test("a stream shows all faces of a file on a server, and how far it has come", async () => {
    const body = Buffer.from(vectorFile());
    await serving(
        (request, response) => sendRange(body, request, response),
        async (url) => {
            const seen: number[] = [];
            const stream = await finest(url, { onProgress: ({ faces }) => seen.push(faces) });
            assert.deepEqual([seen.at(-1), stream.info.chunks], [32, 1]);
            stream.dispose();
        },
    );
});

test("a stream tells of damage once, and keeps what it has shown", async () => {
    const body = Buffer.from(vectorFile());
    body[500] ^= 1;
    let [errors, faces] = [0, 0];
    await new Promise<void>((resolve, reject) => {
        const onError = (error: Error) => {
            errors++;
            assert.match(error.message, /chunk 0: its checksum does not match/);
            setTimeout(resolve, 100);
        };
        const onPatch: StreamListener["onPatch"] = (patch) => (faces += patch.places.length);
        open(body, { onError, onPatch }).then(
            (stream) => stream.query({ focus: null, tolerance: 0 }),
            reject,
        );
    });
    assert.deepEqual([errors, faces], [1, 1]);
});

test("opening can be aborted, and fails for what is no such file", async () => {
    const abort = new AbortController();
    const opening = open(vectorFile(), { signal: abort.signal });
    abort.abort(new Error("enough"));
    await assert.rejects(opening, /enough/);
    await assert.rejects(open(file), /does not start with "meshlodm"/);
});

test(
    "the length of a height field is that of its file",
    { skip: conformanceNames().length === 0 },
    async () => {
        const field = conformanceFile("field");
        const stream = await open(field.slice(0, field.length >> 1));
        assert.equal(stream.info.length, field.length);
        stream.dispose();
    },
);

test("an invalid query is refused, and does not end the stream", async () => {
    const stream = await finest(vectorFile());
    assert.throws(() => stream.query({ focus: null, tolerance: NaN }), RangeError);
    stream.dispose();
});

/** A worker that does nothing by itself. */
class IdleWorker {
    isTerminated = false;
    onmessage: ((event: { data: unknown }) => void) | null = null;
    onerror: ((event: object) => void) | null = null;
    postMessage(): void {}
    terminate(): void {
        this.isTerminated = true;
    }
}

test("no worker is left by an opening that has been aborted", async () => {
    const made: IdleWorker[] = [];
    const worker = () => {
        made.push(new IdleWorker());
        return made[made.length - 1] as unknown as Worker;
    };
    const before = AbortSignal.abort(new Error("enough"));
    await assert.rejects(open(vectorFile(), { worker, signal: before }), /enough/);
    const abort = new AbortController();
    const opening = open(vectorFile(), { worker, signal: abort.signal });
    abort.abort(new Error("enough"));
    await assert.rejects(opening, /enough/);
    assert.ok(made.length > 0 && made.every((worker) => worker.isTerminated));
});

test("a worker that does not start is an error", async () => {
    const idle = new IdleWorker();
    const opening = open(vectorFile(), { worker: () => idle as unknown as Worker });
    idle.onerror?.({});
    await assert.rejects(opening, /its script cannot be loaded/);
    assert.ok(idle.isTerminated);
});

test("nothing is heard of a stream that has been disposed of", async () => {
    let [patches, later] = [0, 0];
    const stream: MlodStream = await open(vectorFile(), {
        onPatch: () => {
            patches++;
            stream.dispose();
        },
        onProgress: () => void later++,
    });
    stream.query({ focus: null, tolerance: 0 });
    await new Promise((resolve) => setTimeout(resolve, 50));
    assert.deepEqual([patches, later], [1, 0]);
});

test("headers and credentials are those of the options", async () => {
    const body = Buffer.from(vectorFile());
    const asked: (string | undefined)[] = [];
    await serving(
        (request, response) => {
            asked.push(request.headers.authorization);
            sendRange(body, request, response);
        },
        async (url) => {
            const headers = { Authorization: "Bearer 1" };
            (await open(url, { headers, credentials: "include" })).dispose();
        },
    );
    assert.deepEqual(asked, ["Bearer 1"]);
    let credentials: string | undefined;
    const get: typeof fetch = (_, options) => {
        credentials = options?.credentials;
        return Promise.resolve(new Response(file));
    };
    await new HttpSource("https://a.test/", never, { credentials: "include" }, get).start(9);
    assert.equal(credentials, "include");
});

test("a section of absurd length is not fetched", async () => {
    const body = Buffer.from(vectorFile());
    body.writeUInt32LE(0x08000000, 36);
    await serving(
        (_, response) => response.writeHead(200).end(body),
        (url) => assert.rejects(open(url), /the header: its \d+ bytes are more than/),
    );
});
