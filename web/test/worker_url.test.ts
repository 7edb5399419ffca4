import assert from "node:assert/strict";
import { resolveObjectURL } from "node:buffer";
import { test } from "node:test";
import { workerOf } from "../src/load/worker_url.ts";

/** Returns the address of the worker that a page of an origin starts. */
function addressOn(origin: string): string {
    let address = "";
    const scope = globalThis as unknown as Record<string, unknown>;
    scope.location = { origin };
    scope.Worker = function (url: string | URL) {
        address = String(url);
    };
    workerOf();
    return address;
}

test("pages of other origins start the worker by a script of their own", async () => {
    const own = addressOn(new URL(import.meta.url).origin);
    assert.match(own, /^file:.*worker\.min\.js$/);
    const other = addressOn("https://page.test");
    assert.match(other, /^blob:/);
    assert.equal(addressOn("https://page.test"), other);
    assert.equal(await resolveObjectURL(other)?.text(), `import ${JSON.stringify(own)}`);
});
