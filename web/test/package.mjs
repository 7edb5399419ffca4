// Builds a page with the packed package, by Vite and by webpack: each has to find the worker. Then
// checks the types, as the most careful compiler options do.
// Usage: node test/package.mjs; packs the package first, which builds it.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import {
    copyFileSync,
    mkdtempSync,
    readFileSync,
    readdirSync,
    rmSync,
    writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const web = join(import.meta.dirname, "..");
const folder = mkdtempSync(join(tmpdir(), "meshlod-package-"));
const run = (program, ...args) => execFileSync(program, args, { cwd: folder, encoding: "utf8" });
const MAIN = `import { MlodLoader } from "meshlod/three";
import { MlzLoader } from "meshlod/three";
import { decode } from "meshlod";
window.all = [MlodLoader, MlzLoader, decode];`;

try {
    const packed = execFileSync("npm", ["pack", "--json", "--pack-destination", folder], {
        cwd: web,
        encoding: "utf8",
    });
    const [{ filename, files }] = JSON.parse(packed.slice(packed.lastIndexOf("\n[") + 1));
    const names = files.map(({ path }) => path);
    for (const name of [
        "LICENSE-APACHE",
        "LICENSE-MIT",
        "README.md",
        "dist/three/index.d.ts",
        "examples/view.js",
    ])
        assert.ok(names.includes(name), `${name} is in the package`);
    const manifest = { private: true, type: "module" };
    writeFileSync(join(folder, "package.json"), JSON.stringify(manifest));
    writeFileSync(join(folder, "main.js"), MAIN);
    writeFileSync(join(folder, "index.html"), '<script type="module" src="main.js"></script>');
    const three = JSON.parse(readFileSync(join(web, "package.json"), "utf8")).devDependencies.three;
    const types = [`@types/three@${three}`, "typescript@5"];
    const others = [`three@${three}`, ...types, "vite@6", "webpack@5", "webpack-cli@6"];
    run("npm", "install", "--no-audit", "--no-fund", "--silent", `./${filename}`, ...others);
    run("npx", "vite", "build", "--outDir", "by-vite", "--logLevel", "error");
    run("npx", "webpack", "--mode", "production", "--entry", "./main.js", "-o", "by-webpack");
    copyFileSync(join(web, "test/stranger.ts.txt"), join(folder, "stranger.ts"));
    for (const resolution of ["bundler", "node16"]) {
        const kind = resolution === "bundler" ? "esnext" : "node16";
        const how = ["--module", kind, "--moduleResolution", resolution, "--skipLibCheck"];
        const strict = ["--strict", "--exactOptionalPropertyTypes", "--noUncheckedIndexedAccess"];
        const target = ["--target", "es2022", "--lib", "es2022,dom,dom.iterable", "--noEmit"];
        run("npx", "tsc", ...how, ...strict, ...target, "stranger.ts");
    }
    const worker = readFileSync(join(web, "dist/worker.min.js"), "utf8");
    for (const built of ["by-vite/assets", "by-webpack"]) {
        const scripts = readdirSync(join(folder, built)).filter((name) => name.endsWith(".js"));
        const texts = scripts.map((name) => readFileSync(join(folder, built, name), "utf8"));
        const hasWorker = texts.some((text) => Math.abs(text.length / worker.length - 1) < 0.2);
        assert.ok(hasWorker && scripts.length > 1, `${built} has the worker: ${scripts.join(" ")}`);
    }
} finally {
    rmSync(folder, { recursive: true, force: true });
}
