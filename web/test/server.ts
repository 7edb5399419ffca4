/** A server for tests. */

import { createServer } from "node:http";
import type { IncomingMessage, ServerResponse } from "node:http";
import type { AddressInfo } from "node:net";

/** A file of a thousand bytes. */
export const file = Buffer.from(Array.from({ length: 1000 }, (_, i) => (i * 7) & 255));

/** Runs a test against a server. */
export async function serving(
    answer: (request: IncomingMessage, response: ServerResponse) => void,
    run: (url: string) => Promise<void>,
): Promise<void> {
    const server = createServer(answer);
    await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
    try {
        await run(`http://127.0.0.1:${(server.address() as AddressInfo).port}/`);
    } finally {
        server.closeAllConnections();
        server.close();
    }
}

/** Answers a request for a range as servers do. */
export function sendRange(
    body: Buffer,
    request: IncomingMessage,
    response: ServerResponse,
    tag = '"1"',
): void {
    const match = /bytes=(\d+)-(\d+)/.exec(request.headers.range ?? "");
    const isSame = (request.headers["if-range"] ?? tag) === tag;
    if (!match || !isSame) {
        response.writeHead(200, { ETag: tag }).end(body);
        return;
    }
    const [at, end] = [Number(match[1]), Math.min(Number(match[2]) + 1, body.length)];
    const range = `bytes ${at}-${end - 1}/${body.length}`;
    response.writeHead(206, { "Content-Range": range, ETag: tag }).end(body.subarray(at, end));
}

/** A signal that nobody gives. */
export const never = new AbortController().signal;
