// A server of files that knows what it has sent.

import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';

const TYPES = {
    '.css': 'text/css',
    '.html': 'text/html',
    '.js': 'text/javascript',
    '.json': 'application/json',
    '.mjs': 'text/javascript',
    '.wasm': 'application/wasm',
};

// Serves the files beside this one and, under /tiles/N/, those of each folder. `sent` has the bytes
// of each file of a tileset that was asked for, `missing` the paths that there are not.
export async function serve(folders) {
    const here = fileURLToPath(new URL('.', import.meta.url));
    const [sent, missing] = [new Map(), []];
    const server = createServer(async (request, response) => {
        const path = normalize(decodeURIComponent(new URL(request.url, 'http://-').pathname));
        const [, of, rest] = path.match(/^\/tiles\/(\d+)(\/.*)$/) ?? [];
        const file = of === undefined ? join(here, path) : join(folders[of], rest);
        try {
            const bytes = await readFile(file);
            if (of !== undefined) sent.set(path, bytes.length);
            const type = TYPES[extname(path)] ?? 'application/octet-stream';
            response.writeHead(200, { 'Content-Type': type, 'Cache-Control': 'no-store' });
            response.end(bytes);
        } catch {
            if (path !== '/favicon.ico') missing.push(path);
            response.writeHead(path === '/favicon.ico' ? 204 : 404).end();
        }
    });
    await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
    return { url: `http://127.0.0.1:${server.address().port}`, sent, missing, server };
}
