// A static server with ranges, as slow as a network of 20 Mbit/s and 50 ms.

import { createReadStream, readFileSync, statSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { setTimeout as wait } from "node:timers/promises";

const BYTES_PER_MS = 20e6 / 8 / 1000;
const LATENCY_MS = 50;
const PIECE = 8192;
const TYPES = {
    ".js": "text/javascript",
    ".mjs": "text/javascript",
    ".html": "text/html",
    ".json": "application/json",
};

/** Serves `/model/…` slowly from a folder, and all else at once from others. */
export async function serve(model, roots, pictures) {
    const state = { sent: 0, busy_ms: 0, requests: 0, open: 0, last: 0, free: 0, pictures: 0 };
    const server = createServer((request, response) => {
        answer(request, response, { model, roots, pictures, state }).catch(() =>
            response.destroy(),
        );
    });
    await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
    return { state, url: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}

async function answer(request, response, site) {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://a").pathname));
    if (path === "/sent") {
        const quiet_ms = performance.now() - site.state.last;
        return response.end(JSON.stringify({ ...site.state, quiet_ms }));
    }
    if (path === "/picture") return keep(request, response, site);
    if (path === "/favicon.ico") return response.writeHead(204).end();
    if (path.startsWith("/model/"))
        return sendSlowly(join(site.model, path.slice(7)), request, response, site.state);
    for (const root of site.roots) {
        try {
            const body = readFileSync(join(root, path));
            return response
                .writeHead(200, {
                    "Content-Type": TYPES[extname(path)] ?? "application/octet-stream",
                })
                .end(body);
        } catch {
            continue;
        }
    }
    return response.writeHead(404).end();
}

async function keep(request, response, { pictures, state }) {
    const parts = [];
    for await (const part of request) parts.push(part);
    const bytes = new URL(request.url, "http://a").searchParams.get("bytes");
    const number = String(state.pictures++).padStart(4, "0");
    writeFileSync(join(pictures, `${number}-${bytes}.png`), Buffer.concat(parts));
    response.end();
}

async function sendSlowly(path, request, response, state) {
    let size;
    try {
        size = statSync(path).size;
    } catch {
        return response.writeHead(404).end();
    }
    state.requests++;
    state.open++;
    response.once("close", () => state.open--);
    const arrival = performance.now();
    const range = /bytes=(\d+)-(\d+)?/.exec(request.headers.range ?? "");
    const at = range ? Number(range[1]) : 0;
    const end = Math.min(range?.[2] ? Number(range[2]) + 1 : size, size);
    await wait(LATENCY_MS);
    const type = {
        "Content-Type": TYPES[extname(path)] ?? "application/octet-stream",
        ETag: '"1"',
        "Content-Length": end - at,
    };
    if (range)
        response.writeHead(206, { ...type, "Content-Range": `bytes ${at}-${end - 1}/${size}` });
    else response.writeHead(200, type);
    for await (const piece of createReadStream(path, {
        start: at,
        end: end - 1,
        highWaterMark: PIECE,
    })) {
        const now = performance.now();
        // All connections share the line.
        state.free = Math.max(now, state.free) + piece.length / BYTES_PER_MS;
        if (state.free - now > 1) await wait(state.free - now);
        if (response.destroyed) return;
        response.write(piece);
        state.sent += piece.length;
    }
    response.end();
    const done = performance.now();
    state.busy_ms += done - Math.max(arrival, state.last);
    state.last = done;
}
