// Measures how a model comes over a network of 20 Mbit/s and 50 ms, in Chromium with OpenGL in software.
// Usage: node figures.mjs OUT MODEL...; each a .mlod, a .glb or a tileset.json, after `npm run build`
// and `npm install` here. The first .mlod before tells where the camera is. PYTHON has flip_evaluator.

import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { basename, dirname, extname, join, resolve } from "node:path";
import puppeteer from "puppeteer-core";
import { serve } from "./server.mjs";

const here = import.meta.dirname;
const web = join(here, "../..");
const [out, ...models] = process.argv.slice(2);
const { PYTHON = "python3", CHROMIUM = "/usr/bin/chromium", SPAN = "0.9" } = process.env;
const KINDS = { ".mlod": "mlod", ".glb": "glb", ".json": "tiles" };
const browser = await puppeteer.launch({
    executablePath: CHROMIUM,
    args: ["--no-sandbox", "--enable-unsafe-swiftshader", "--use-angle=swiftshader"],
    protocolTimeout: 300_000,
});
let view = null;
for (const [number, model] of models.entries()) {
    const kind = KINDS[extname(model)];
    if (kind === "mlod") view = viewOf(model);
    const pictures = join(out, String(number));
    mkdirSync(pictures, { recursive: true });
    const site = await serve(
        dirname(resolve(model)),
        [here, web, join(here, "node_modules")],
        pictures,
    );
    const page = await browser.newPage();
    page.on("pageerror", (error) => console.error(String(error)));
    page.on("console", (message) => message.type() === "error" && console.error(message.text()));
    const query = new URLSearchParams({ kind, file: `/model/${basename(model)}`, ...view });
    await page.goto(`${site.url}/page.html?${query}`);
    await page.waitForFunction("window.result !== undefined", { timeout: 280_000 });
    const result = await page.evaluate("window.result");
    await page.close();
    site.close();
    const flip = execFileSync(PYTHON, [join(here, "flip.py"), pictures], {
        encoding: "utf8",
        stdio: ["ignore", "pipe", process.env.VERBOSE ? "inherit" : "ignore"],
    });
    console.log(JSON.stringify({ model, ...result, alike_bytes: Number(flip) }));
}
await browser.close();

/** Looks at the middle of a file of contractions, obliquely from above. */
function viewOf(path) {
    const head = readFileSync(path).subarray(0, 80);
    const center = [40, 48, 56].map((at) => head.readDoubleLE(at));
    const away = [0.35, 0.45, 0.75].map((x) => x * Number(SPAN) * head.readDoubleLE(72));
    return { center: center.join(","), away: away.join(",") };
}
