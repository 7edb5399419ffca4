// Bundles the package into `dist`, and fails if what a page loads is too large.

import { readFileSync, readdirSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const MOST_BYTES = 40 << 10;
const common = { bundle: true, minify: true, format: "esm", target: "es2022", logLevel: "warning" };

await build({
    ...common,
    entryPoints: { index: "src/index.ts", "three/index": "src/three/index.ts" },
    external: ["three", "three/*"],
    splitting: true,
    outdir: "dist",
});
await build({ ...common, entryPoints: ["src/worker.ts"], outfile: "dist/worker.min.js" });

const files = ["dist", "dist/three"].flatMap((folder) =>
    readdirSync(folder)
        .filter((name) => name.endsWith(".js"))
        .map((name) => `${folder}/${name}`),
);
let all = 0;
for (const file of files) {
    const bytes = gzipSync(readFileSync(file), { level: 9 }).length;
    all += bytes;
    console.log(`${file}: ${bytes} bytes compressed by gzip`);
}
console.log(`all: ${all} bytes`);
if (all > MOST_BYTES) throw new Error(`the package is larger than ${MOST_BYTES} bytes`);
