// In Chromium: instances of a file look like copies of it, by fewer calls.
// Usage: node test/instances.mjs FILE.mlod [CHROMIUM]; after `npm run build`.

import assert from "node:assert/strict";
import { launch, resultOf, serve } from "./chromium.mjs";

const [file, chromium] = process.argv.slice(2);
const server = await serve("/test/instances.js", { "/model.mlod": file });
const browser = await launch(chromium);
try {
    const { result, errors } = await resultOf(browser, `${server.address}/`);
    console.log(JSON.stringify(result));
    assert.deepEqual(errors, []);
    assert.equal(result.error, null);
    assert.ok(result.covered > 500 && result.hits.includes(2), "they are drawn, and rays hit them");
    assert.ok(result.other < 0.005 * result.covered, "instances look like copies");
    assert.equal(result.faces[0], result.faces[1], "both are at one level");
    assert.equal(5 * result.calls[0], result.calls[1], "one call draws all instances");
} finally {
    await browser.close();
    server.close();
}
