// A server of this folder and of some files, and a browser that shows pages of it.

import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import puppeteer from "puppeteer-core";

const web = join(dirname(fileURLToPath(import.meta.url)), "..");
const TYPES = { ".js": "text/javascript", ".html": "text/html" };

const pageOf = (script) => `<!doctype html><script type="importmap">{"imports": {
    "three": "/node_modules/three/build/three.module.js",
    "three/addons/": "/node_modules/three/examples/jsm/" }}</script>
<script type="module" src="${script}"></script>`;

/**
 * Serves this folder and, by their paths there, some files, with ranges; `sent` counts the bytes of
 * parts. The page at the root runs a script.
 */
export async function serve(script, files) {
    const sent = { bytes: 0 };
    const server = createServer((request, response) => {
        const path = normalize(decodeURIComponent(new URL(request.url, "http://a").pathname));
        if (path === "/")
            return response.writeHead(200, { "Content-Type": "text/html" }).end(pageOf(script));
        if (path === "/favicon.ico") return response.writeHead(204).end();
        let body;
        try {
            body = readFileSync(files[path] ?? join(web, path));
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
        sent.bytes += end - at;
        const head = { ...type, "Content-Range": `bytes ${at}-${end - 1}/${body.length}` };
        return response.writeHead(206, head).end(body.subarray(at, end));
    });
    await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
    return {
        address: `http://127.0.0.1:${server.address().port}`,
        sent,
        close: () => server.close(),
    };
}

/** Starts Chromium, which draws in software. */
export function launch(chromium = "/usr/bin/chromium") {
    const args = ["--no-sandbox", "--enable-unsafe-swiftshader"];
    return puppeteer.launch({ executablePath: chromium, args });
}

/** Shows a page until it has a result; returns that with the errors that the page told. */
export async function resultOf(browser, url) {
    const page = await browser.newPage();
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    await page.goto(url);
    await page.waitForFunction("window.result !== undefined", { timeout: 60_000 });
    const result = await page.evaluate("window.result");
    await page.close();
    return { result, errors };
}
