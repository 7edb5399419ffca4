// Bundles the viewer of `meshlod serve` and `meshlod page` into the crate of the command, and fails
// if its code is too large. With --check: fails if the crate has other bytes.

import { readFileSync, writeFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const MOST_BYTES = 150_000;
const to = new URL("../crates/cli/src/browser/viewer/", import.meta.url);
const common = { bundle: true, minify: true, target: "es2022", write: false, logLevel: "warning" };
const text = async (options) => (await build({ ...common, ...options })).outputFiles[0].text.trim();

const style = await text({ entryPoints: ["page/page.css"] });
const code = await text({ entryPoints: ["page/main.ts"], format: "iife" });
const formats = await text({ entryPoints: ["page/formats.ts"], format: "esm" });
for (const mark of ["<!--", "</script", "<script"])
    if (code.toLowerCase().includes(mark)) throw new Error(`the script has ${mark} in it`);
const page = readFileSync("page/page.html", "utf8")
    .replace("/*style*/", () => style)
    .replace("/*code*/", () => code);
const files = { "page.html": page, "formats.js": `${formats}\n` };

for (const [name, file] of Object.entries(files)) {
    const bytes = Buffer.byteLength(file);
    console.log(`${name}: ${bytes} bytes, ${gzipSync(file, { level: 9 }).length} by gzip`);
    if (bytes > MOST_BYTES) throw new Error(`that is more than ${MOST_BYTES} bytes`);
    if (!process.argv.includes("--check")) writeFileSync(new URL(name, to), file);
    else if (readFileSync(new URL(name, to), "utf8") !== file)
        throw new Error(`crates/cli has another ${name}: run npm run page in web, and commit it`);
}
