// In Chromium: files of one model, each by its own loader, look alike.
// Usage: node test/same.mjs FILE FILE... [--time SECONDS] [--chromium CHROMIUM]; after `npm run build`.
// With a time they are in a pose of their first animation.

import assert from "node:assert/strict";
import { basename } from "node:path";
import { parseArgs } from "node:util";
import { launch, resultOf, serve } from "./chromium.mjs";

const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: { chromium: { type: "string" }, time: { type: "string" } },
});
const paths = positionals.map((file) => `/files/${basename(file)}`);
const server = await serve(
    "/test/same.js",
    Object.fromEntries(paths.map((path, i) => [path, positionals[i]])),
);
const browser = await launch(values.chromium);
try {
    for (const path of paths.slice(1)) {
        const time = values.time === undefined ? {} : { time: values.time };
        const query = new URLSearchParams({ a: paths[0], b: path, ...time });
        const { result, errors } = await resultOf(browser, `${server.address}/?${query}`);
        console.log(`${basename(path)}: ${JSON.stringify(result)}`);
        assert.deepEqual(errors, []);
        assert.equal(result.error, null);
        assert.ok(result.covered > 4000, "something is drawn");
        assert.ok(result.other < 0.01 * result.covered, `${path} looks like ${paths[0]}`);
    }
} finally {
    await browser.close();
    server.close();
}
