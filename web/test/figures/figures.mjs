// Measures how a model comes over a network of 20 Mbit/s and 50 ms: README.md.
// Usage: node figures.mjs OUT MODEL...; each a .mlod, a .glb or a tileset.json. The first .mlod before
// tells where the camera is. PYTHON has flip_evaluator.

import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { basename, dirname, extname, join, resolve } from "node:path";
import { resultOf, startBrowser } from "./chromium.mjs";
import { viewOf } from "./view.mjs";

const [out, ...models] = process.argv.slice(2);
const { PYTHON = "python3" } = process.env;
const browser = await startBrowser();
let view = null;
for (const [number, model] of models.entries()) {
    const kind = kindOf(model);
    if (kind === "mlod") view = viewOf(model);
    const pictures = join(out, String(number));
    mkdirSync(pictures, { recursive: true });
    const result = await resultOf(browser, {
        script: "stream",
        folder: dirname(resolve(model)),
        pictures,
        query: { kind, file: `/model/${basename(model)}`, ...view },
    });
    const flip = execFileSync(PYTHON, [join(import.meta.dirname, "flip.py"), pictures], {
        encoding: "utf8",
        stdio: ["ignore", "pipe", process.env.VERBOSE ? "inherit" : "ignore"],
    });
    console.log(JSON.stringify({ model, kind, ...result, alike_bytes: Number(flip) }));
}
await browser.close();

/** Returns the client that shows a file. */
function kindOf(path) {
    const ending = extname(path);
    if (ending !== ".glb") return { ".mlod": "mlod", ".json": "tiles" }[ending];
    const bytes = readFileSync(path);
    const { extensionsUsed = [] } = JSON.parse(
        bytes.toString("utf8", 20, 20 + bytes.readUInt32LE(12)),
    );
    return extensionsUsed.includes("NEEDLE_progressive") ? "needle" : "glb";
}
