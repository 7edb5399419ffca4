/** Makes the worker that comes with this package. */

/** Address of a script that imports the worker, made once. */
let script: string | undefined;

/** Starts the worker; bundlers find its file by this expression. */
export function workerOf(): Worker {
    const url = new URL("./worker.min.js", import.meta.url);
    if (url.origin === location.origin)
        return new Worker(new URL("./worker.min.js", import.meta.url), { type: "module" });
    // Pages start no scripts of other origins, such as those that serve packages, but import them.
    const text = `import ${JSON.stringify(url.href)}`;
    script ??= URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
    return new Worker(script, { type: "module" });
}
