/** Makes the worker that comes with this package. */

/** Returns a function that starts the worker; bundlers find its file by this expression. */
export function workerOf(): Worker {
    return new Worker(new URL("./worker.min.js", import.meta.url), { type: "module" });
}
