// Bundles the package into `dist`, and fails if what a page loads is too large.

import { copyFileSync, readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";
import { localNames } from "./mangle.mjs";

const MOST_BYTES = 40 << 10;
const common = { bundle: true, minify: true, format: "esm", target: "es2022", logLevel: "warning" };

const { metafile } = await build({
    ...common,
    entryPoints: {
        index: "src/index.ts",
        "three/index": "src/three/index.ts",
        "mlq/index": "src/mlq/index.ts",
        "mlz/index": "src/mlz/index.ts",
    },
    external: ["three", "three/*"],
    splitting: true,
    metafile: true,
    outdir: "dist",
});
const mangleProps = new RegExp(`^(?:${localNames(import.meta.dirname).join("|")})$`);
await build({
    ...common,
    entryPoints: ["src/worker.ts"],
    mangleProps,
    outfile: "dist/worker.min.js",
});
// The package has the licences of the project.
for (const name of ["LICENSE-APACHE", "LICENSE-MIT"]) copyFileSync(`../${name}`, name);

/** Adds a file and those that it imports at once; what is imported later counts when it is. */
function addImports(file, files) {
    if (files.has(file)) return files;
    files.add(file);
    for (const { path, kind } of metafile.outputs[file].imports) {
        if (kind === "import-statement" && path.startsWith("dist/")) addImports(path, files);
    }
    return files;
}

for (const format of ["mlq", "mlz"]) {
    let bytes = 0;
    for (const file of addImports(`dist/${format}/index.js`, new Set()))
        bytes += gzipSync(readFileSync(file), { level: 9 }).length;
    console.log(`the decoder of .${format}: ${bytes} bytes compressed by gzip`);
}

let all = 0;
for (const file of [...addImports("dist/three/index.js", new Set()), "dist/worker.min.js"]) {
    const bytes = gzipSync(readFileSync(file), { level: 9 }).length;
    all += bytes;
    console.log(`${file}: ${bytes} bytes compressed by gzip`);
}
console.log(`a page with three.js loads ${all} bytes of this package`);
if (all > MOST_BYTES) throw new Error(`that is more than ${MOST_BYTES} bytes`);
