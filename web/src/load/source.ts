/** Where the bytes of a file come from: a server with ranges, one without, or memory. */

import { MlodError } from "../error.ts";

/** Bytes of one file, any part of which can be read. */
export interface Source {
    /** Returns some of the first bytes: at least as many as asked for, or the whole file. */
    start(count: number): Promise<Uint8Array>;
    /**
     * Returns a part of the file. `hear` is told what has come so far, but for all, from the start
     * of the part on; after another try it is told less than before.
     */
    read(at: number, length: number, hear?: Hear): Promise<Uint8Array>;
}

/** Hears the first bytes of a part; what it throws ends the reading. */
export type Hear = (bytes: Uint8Array) => void;

/** What a server may ask for before it sends a file. */
export interface Access {
    /** Headers of each request. */
    headers?: Record<string, string>;
    /** Whether cookies go along; only to the same origin by default. */
    credentials?: RequestCredentials;
}

/** A file in memory. */
export class MemorySource implements Source {
    constructor(private readonly bytes: Uint8Array) {}

    start(): Promise<Uint8Array> {
        return Promise.resolve(this.bytes);
    }

    read(at: number, length: number): Promise<Uint8Array> {
        if (at + length > this.bytes.length)
            return Promise.reject(endsBefore(at + length, this.bytes.length));
        return Promise.resolve(this.bytes.subarray(at, at + length));
    }
}

/** Milliseconds before each further try of a request, on an average. */
const WAITS = [500, 1000, 2000];
/** Longest wait that a server may ask for, in milliseconds. */
const MOST_WAIT = 10_000;

/** A server that may answer later. */
class BusyError extends MlodError {
    /** @param wait milliseconds that it asks for */
    constructor(
        why: string,
        readonly wait: number,
    ) {
        super("the file", why);
    }
}

function endsBefore(needed: number, length: number): MlodError {
    return new MlodError("the file", `it ends at byte ${length}, before byte ${needed}`);
}

/**
 * A file on a server, of which only the parts that are needed are fetched. Connections that break and
 * servers that are busy are tried again.
 */
export class HttpSource implements Source {
    private first = new Uint8Array(0);
    private length = Infinity;
    /** What tells whether the file is still the same: its entity tag, or when it was changed. */
    private validator: string | null = null;
    /** The whole file as it comes, from a server without ranges. */
    private whole: WholeBody | null = null;

    constructor(
        private readonly url: string,
        private readonly signal: AbortSignal,
        private readonly access: Access = {},
        private readonly get: typeof fetch = (url, options) => fetch(url, options),
        private readonly waits: readonly number[] = WAITS,
    ) {}

    async start(count: number): Promise<Uint8Array> {
        if (this.whole) return this.whole.upTo(count);
        if (this.first.length >= Math.min(count, this.length)) return this.first;
        if (this.first.length > 0) {
            const rest = await this.read(
                this.first.length,
                Math.min(count, this.length) - this.first.length,
            );
            this.first = joined([this.first, rest]);
            return this.first;
        }
        return this.patiently(() => this.fetchStart(count));
    }

    private async fetchStart(count: number): Promise<Uint8Array> {
        // What a cache has may be old: parts of it would not go with what the server sends.
        const response = await this.request(0, count, "no-cache");
        this.validator = validatorOf(response);
        if (response.status === 200) {
            this.whole = new WholeBody(response);
            return this.whole.upTo(count);
        }
        const { at, total } = rangeOf(response);
        this.length = total;
        const bytes = new Uint8Array(Math.min(count, total));
        const isWhole = await readBody(response, bytes, () => undefined);
        if (at !== 0 || !isWhole) throw lied(this.url);
        this.first = bytes;
        return bytes;
    }

    async read(at: number, length: number, hear?: Hear): Promise<Uint8Array> {
        if (this.whole) return this.whole.part(at, length);
        if (at + length > this.length) throw endsBefore(at + length, this.length);
        const known = this.first.subarray(at, at + length);
        if (known.length === length) return known;
        const all = new Uint8Array(length);
        all.set(known);
        const tell = (count: number) => hear?.(all.subarray(0, known.length + count));
        tell(0);
        await this.patiently(() => this.fetch(at + known.length, all.subarray(known.length), tell));
        return all;
    }

    private async fetch(at: number, to: Uint8Array, tell: (count: number) => void): Promise<void> {
        const { length } = to;
        const response = await this.request(at, length);
        const isSame = validatorOf(response) === this.validator;
        if (response.status === 200 || !isSame) {
            await response.body?.cancel();
            throw new MlodError("the file", `it has changed on the server: ${this.url}`);
        }
        const { at: from, total } = rangeOf(response);
        const isWhole = await readBody(response, to, tell);
        if (from !== at || total !== this.length || !isWhole) throw lied(this.url);
    }

    /** Tries again what failed by the network alone, a few times. */
    private async patiently<T>(attempt: () => Promise<T>): Promise<T> {
        for (let tries = 0; ; tries++) {
            try {
                return await attempt();
            } catch (error) {
                const isBusy = error instanceof BusyError;
                if (this.signal.aborted || (error instanceof MlodError && !isBusy)) throw error;
                if (this.whole || tries === this.waits.length)
                    throw isBusy
                        ? error
                        : new MlodError("the file", `${String(error)}: ${this.url}`);
                const asked = isBusy ? Math.min(error.wait, MOST_WAIT) : 0;
                await pause(
                    Math.max(asked, this.waits[tries] * (0.75 + 0.5 * Math.random())),
                    this.signal,
                );
            }
        }
    }

    private async request(
        at: number,
        length: number,
        cache: RequestCache = "default",
    ): Promise<Response> {
        // Nothing but a range, so that other origins are not asked for leave first: not `If-Range`.
        const headers = { ...this.access.headers, Range: `bytes=${at}-${at + length - 1}` };
        const { signal, access } = this;
        const credentials = access.credentials ?? "same-origin";
        const response = await this.get(this.url, { headers, signal, credentials, cache });
        if (response.status !== 206 && response.status !== 200) {
            await response.body?.cancel();
            const { status } = response;
            const why = `the server answers ${status}: ${this.url}`;
            if (status < 500 && status !== 429 && status !== 408)
                throw new MlodError("the file", why);
            throw new BusyError(why, 1000 * (Number(response.headers.get("Retry-After")) || 0));
        }
        return response;
    }
}

/** Waits, unless that is ended before. */
function pause(time: number, signal: AbortSignal): Promise<void> {
    return new Promise((resolve, reject) => {
        const end = () => {
            clearTimeout(timer);
            reject(signal.reason as Error);
        };
        const timer = setTimeout(() => {
            signal.removeEventListener("abort", end);
            resolve();
        }, time);
        signal.addEventListener("abort", end);
    });
}

function lied(url: string): MlodError {
    return new MlodError("the file", `the server sends other bytes than it was asked for: ${url}`);
}

/** A weak tag says nothing of bytes. */
function validatorOf({ headers }: Response): string | null {
    const tag = headers.get("ETag");
    return tag !== null && !tag.startsWith("W/") ? tag : headers.get("Last-Modified");
}

function rangeOf({ headers, url }: Response): { at: number; total: number } {
    const range = headers.get("Content-Range");
    if (range === null) {
        const why =
            "the server does not say which bytes it sends; to pages of other origins it must";
        throw new MlodError("the file", `${why} expose Content-Range: ${url}`);
    }
    const match = /^bytes (\d+)-\d+\/(\d+)$/.exec(range);
    if (!match) throw lied(url);
    return { at: Number(match[1]), total: Number(match[2]) };
}

/** Reads a body; returns false if it has another length, of which no more is read. */
async function readBody(
    { body }: Response,
    to: Uint8Array,
    tell: (count: number) => void,
): Promise<boolean> {
    const reader = body?.getReader();
    let count = 0;
    try {
        for (let read; reader && !(read = await reader.read()).done;) {
            const { value } = read;
            if (count + value.length > to.length) return false;
            to.set(value, count);
            count += value.length;
            if (count < to.length) tell(count);
        }
    } finally {
        await reader?.cancel();
    }
    return count === to.length;
}

/** A response body, of which parts can be read as they come. */
class WholeBody {
    private readonly parts: Uint8Array[] = [];
    private length = 0;
    private isDone = false;
    private waiting: Promise<unknown> = Promise.resolve();
    private readonly reader: ReadableStreamDefaultReader<Uint8Array> | undefined;

    constructor(response: Response) {
        this.reader = response.body?.getReader();
        this.isDone = this.reader === undefined;
    }

    /** Returns the first bytes, once so many are there or all. */
    async upTo(count: number): Promise<Uint8Array> {
        const turn = this.waiting.then(() => this.fill(count));
        this.waiting = turn.catch(() => undefined);
        await turn;
        if (this.parts.length > 1) this.parts.splice(0, this.parts.length, joined(this.parts));
        return this.parts[0] ?? new Uint8Array(0);
    }

    private async fill(count: number): Promise<void> {
        while (!this.isDone && this.length < count) {
            const read = await this.reader?.read();
            if (!read || read.done) this.isDone = true;
            else {
                this.parts.push(read.value);
                this.length += read.value.length;
            }
        }
    }

    async part(at: number, length: number): Promise<Uint8Array> {
        const bytes = await this.upTo(at + length);
        if (bytes.length < at + length) throw endsBefore(at + length, bytes.length);
        return bytes.subarray(at, at + length);
    }
}

function joined(parts: readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
    const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
    let at = 0;
    for (const part of parts) {
        all.set(part, at);
        at += part.length;
    }
    return all;
}
