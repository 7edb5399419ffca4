// In Chromium: a file that streams from a server is shown, without a crack, and disposed of; then with
// the package and the file at another origin, and with vertices that move.
// Usage: node test/browser.mjs FILE.mlod [CHROMIUM]; after `npm run build`.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import puppeteer from "puppeteer-core";

const web = join(dirname(fileURLToPath(import.meta.url)), "..");
const [file, chromium = "/usr/bin/chromium"] = process.argv.slice(2);
const TYPES = { ".js": "text/javascript", ".html": "text/html" };

const PAGE = `<!doctype html><script type="importmap">{"imports": {
    "three": "/node_modules/three/build/three.module.js",
    "three/addons/": "/node_modules/three/examples/jsm/" }}</script>
<script type="module" src="/test/page.js"></script>`;

/** Answers with ranges, and counts what is sent of the file. */
let sent = 0;
const answer = (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://a").pathname));
    if (path === "/") return response.writeHead(200, { "Content-Type": "text/html" }).end(PAGE);
    if (path === "/favicon.ico") return response.writeHead(204).end();
    let body;
    try {
        body = readFileSync(path === "/model.mlod" ? file : join(web, path));
    } catch {
        return response.writeHead(404).end();
    }
    const type = {
        "Content-Type": TYPES[extname(path)] ?? "application/octet-stream",
        ETag: '"1"',
        "Access-Control-Allow-Origin": "*",
        "Access-Control-Expose-Headers": "Content-Range, ETag",
    };
    const range = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? "");
    if (!range) return response.writeHead(200, type).end(body);
    const [at, end] = [Number(range[1]), Math.min(Number(range[2]) + 1, body.length)];
    sent += end - at;
    const head = { ...type, "Content-Range": `bytes ${at}-${end - 1}/${body.length}` };
    return response.writeHead(206, head).end(body.subarray(at, end));
};
const servers = [createServer(answer), createServer(answer)];
for (const server of servers)
    await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
const [home, other] = servers.map((server) => `http://127.0.0.1:${server.address().port}`);

const browser = await puppeteer.launch({
    executablePath: chromium,
    args: ["--no-sandbox", "--enable-unsafe-swiftshader"],
});
async function show(query) {
    sent = 0;
    const page = await browser.newPage();
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    await page.goto(`${home}/${query}`);
    await page.waitForFunction("window.result !== undefined", { timeout: 60_000 });
    const result = await page.evaluate("window.result");
    await page.close();
    console.log(JSON.stringify({ ...result, sent }));
    assert.deepEqual(errors, []);
    assert.equal(result.error, null);
    assert.ok(result.faces[1] > result.faces[0], "closer is finer");
    assert.ok(result.covered > 0.02 && result.hit, "the mesh is drawn, and rays hit it");
    assert.deepEqual(result.holes, [0, 0, 0], "pixels of the background inside the silhouette");
    const [holes, moments] = result.moments;
    assert.ok(holes <= moments, "no more than tunnels before the level is there");
    return result;
}

try {
    await show("");
    await show(`?from=${encodeURIComponent(other)}`);
    const { moments, kind } = await show("?morph=500");
    assert.ok(moments[1] > 3 || kind === "height field", "pictures of vertices on their way");
} finally {
    await browser.close();
    servers.forEach((server) => server.close());
}
