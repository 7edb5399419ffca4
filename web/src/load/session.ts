/** An open file: fetches what the query needs, refines the cut, and tells what has changed. */

import { MlodError } from "../error.ts";
import type { CutChange, Limits } from "../cut/meter.ts";
import type { Query } from "../cut/query.ts";
import { FieldCut } from "../field/field_cut.ts";
import { FieldModel } from "../field/field_model.ts";
import { FIELD_MAGIC, decodeField, fieldLength } from "../field/height_field.ts";
import { check, headerLength, magicOf, readHeader } from "../file/header.ts";
import type { Header, Section } from "../file/header.ts";
import { readHead, unpackResource } from "../scene/head.ts";
import type { SceneHead } from "../scene/head.ts";
import { Geometry } from "./geometry.ts";
import type { GeometryPatch, Slots } from "./geometry.ts";
import { Levels } from "./levels.ts";
import type { Event, Origin, Request, StreamLimits } from "./messages.ts";
import { FRAME, MovingGeometry } from "./morph.ts";
import { HttpSource, MemorySource } from "./source.ts";
import type { Hear, Source } from "./source.ts";
import type { Model } from "../model.ts";
import { fieldInfoOf, infoOf } from "./info.ts";
import { fieldVerticesOf, verticesOf } from "./vertices.ts";

const FIRST_BYTES = 64 << 10;
const WHOLE = 2 ** 31;
/** Greatest length of a section: a page could hardly hold more, and no writer makes such. */
const MOST_BYTES = 2 ** 29;

/** @throws MlodError if a file claims that a section is too long to be read */
function mustFit(section: string, length: number): void {
    if (length > MOST_BYTES)
        throw new MlodError(section, `its ${length} bytes are more than ${MOST_BYTES}`);
}

/** Part of the decoded bytes that must have come before more are decoded, but for the last. */
const LEAST_GROWTH = 0.25;

/** A cut of either kind. */
interface AnyCut {
    readonly triangles: Slots & { readonly count: number };
    readonly vertices: number;
    update(query: Query, limits: Limits, refined?: () => void): CutChange;
}

/** Answers the requests of one stream; `post` takes its events. */
export class Session {
    private readonly abort = new AbortController();
    private source!: Source;
    private limits: Required<StreamLimits> = {
        memory: 512 << 20,
        request: 256 << 10,
        slice: 8,
        morph: 0,
    };
    private query: Query = { focus: null, tolerance: Infinity };
    private header: Header | null = null;
    private levels: Levels | null = null;
    private cut: AnyCut | null = null;
    private geometry: Geometry | null = null;
    /** Part of the triangles of each pair of labels; by materials if it is not given. */
    private parts: readonly number[] | undefined;
    private head: SceneHead | null = null;
    private nextResource = 0;
    /** Number of bytes fetched in all, and of those fetched to open the file. */
    private bytes = 0;
    private opened = 0;
    /** Number of bytes of chunks that have been decoded. */
    private decoded = 0;
    /** What the last patch was of. */
    private shown: Geometry | null = null;
    private isStepping = false;
    private isFetching = false;
    private isAsked = false;
    private hasFailed = false;

    constructor(private readonly post: (event: Event) => void) {}

    /** True if nothing more is fetched. */
    private get isOver(): boolean {
        return this.hasFailed || this.abort.signal.aborted;
    }

    /** Takes a request. */
    receive(request: Request): void {
        if (request.kind === "close") this.abort.abort();
        else if (request.kind === "query") this.ask(request.query);
        else if (request.kind === "split") this.split(request.parts);
        else void this.guard(this.open(request.origin, request.limits));
    }

    /** Tells of an error once. Nothing more is fetched, but the levels that are there are shown. */
    private async guard(work: Promise<void>): Promise<void> {
        try {
            await work;
        } catch (error) {
            if (this.isOver) return;
            this.hasFailed = true;
            const [section, why] =
                error instanceof MlodError
                    ? [error.section, error.why]
                    : ["the stream", String(error)];
            this.post({ kind: "failed", section, why });
        }
    }

    private async open(origin: Origin, limits: StreamLimits): Promise<void> {
        this.limits = { ...this.limits, ...limits };
        this.source =
            "url" in origin
                ? new HttpSource(origin.url, this.abort.signal, origin.access)
                : new MemorySource(origin.bytes);
        const start = await this.source.start(FIRST_BYTES);
        this.bytes = this.opened = start.length;
        if (magicOf(start) === FIELD_MAGIC) await this.openField(start);
        else await this.openContractions(start);
    }

    private async openContractions(start: Uint8Array): Promise<void> {
        for (
            let needed = headerLength(start);
            needed > start.length;
            needed = headerLength(start)
        ) {
            mustFit("the header", needed);
            const longer = await this.source.start(needed);
            if (longer.length < needed)
                throw new MlodError("the header", `the file ends at byte ${longer.length}`);
            start = longer;
        }
        const header = readHeader(start);
        this.bytes = this.opened = start.length;
        const base = await this.read(header.base);
        const levels = new Levels(header, base, this.limits.memory);
        const { model } = levels.cut;
        this.post({ kind: "opened", info: infoOf(model) });
        this.header = header;
        this.levels = levels;
        this.show(levels.cut, this.geometryOf(model));
        void this.guard(this.fetch());
    }

    /** Height fields are read from their start on; a prefix is a coarser field. */
    private async openField(start: Uint8Array): Promise<void> {
        const first = decodeField(start);
        const model = new FieldModel(first);
        const length = fieldLength(start);
        this.post({ kind: "opened", info: fieldInfoOf(model, length, first.allParts) });
        this.show(new FieldCut(model), new Geometry(fieldVerticesOf(model)));
        if (first.parts === first.allParts) return;
        // One more, to see what is behind the end.
        const all = await this.source.start(Math.min(WHOLE, length + 1));
        this.bytes = all.length;
        const whole = new FieldModel(decodeField(all));
        this.show(new FieldCut(whole), new Geometry(fieldVerticesOf(whole)));
    }

    private geometryOf(model: Model): Geometry {
        const { limits, parts } = this;
        const { morph } = limits;
        const moves = morph > 0 && morph < Infinity;
        return moves
            ? new MovingGeometry(model, morph, parts)
            : new Geometry(verticesOf(model, parts));
    }

    private show(cut: AnyCut, geometry: Geometry): void {
        this.cut = cut;
        this.geometry = geometry;
        this.startStepping();
    }

    /** Shows the same cut with its triangles in other parts. */
    private split(parts: readonly number[]): void {
        this.parts = parts;
        const { levels } = this;
        if (levels) this.show(levels.cut, this.geometryOf(levels.cut.model));
    }

    private ask(query: Query): void {
        this.query = query;
        this.startStepping();
        if (this.levels) void this.guard(this.fetch());
    }

    private startStepping(wait = 0): void {
        if (this.isStepping || this.abort.signal.aborted) return;
        this.isStepping = true;
        setTimeout(() => void this.guard(this.step()), wait);
    }

    /** Changes the cut for a slice of time, and comes back if that was too little. */
    private async step(): Promise<void> {
        await Promise.resolve();
        this.isStepping = false;
        const { cut, geometry, levels } = this;
        if (!cut || !geometry || this.abort.signal.aborted) return;
        const shown = this.shown instanceof MovingGeometry ? this.shown : null;
        shown?.tick(performance.now()).forEach((patch) => this.send(patch));
        if (shown?.isHeld) return this.startStepping(FRAME);
        levels?.noteGaps(this.query);
        const done = this.change(cut, geometry, shown);
        const isMoving = this.shown instanceof MovingGeometry && this.shown.isMoving;
        this.tell(done && !isMoving);
        if (!done || isMoving) this.startStepping(done ? FRAME : 0);
    }

    /** Changes the cut for a slice of time, and sends what has changed; returns true if it is done. */
    private change(cut: AnyCut, geometry: Geometry, shown: MovingGeometry | null): boolean {
        const moving = geometry instanceof MovingGeometry ? geometry : null;
        const isStarted = !geometry.isNew;
        const refined =
            moving && isStarted ? () => this.send(moving.refine(cut.triangles)) : undefined;
        const { done } = cut.update(this.query, { time: this.limits.slice }, refined);
        // A cut that starts anew takes the place of the one before once it is as fine.
        if (!isStarted && this.shown && !done) return false;
        if (!moving) this.send(geometry.follow(cut.triangles));
        else if (isStarted) this.send(moving.coarsen(cut.triangles));
        else this.send(moving.refine(cut.triangles, shown));
        this.shown = geometry;
        return done;
    }

    private send(patch: GeometryPatch | null): void {
        if (patch) this.post({ kind: "patch", patch });
    }

    private tell(done: boolean): void {
        const { cut, levels } = this;
        if (!cut) return;
        const missing = levels?.wanted(this.query).length ?? 0;
        const chunks = levels?.count ?? 0;
        const { vertices, triangles } = cut;
        this.post({
            kind: "progress",
            progress: {
                bytes: this.bytes,
                chunks,
                missing,
                faces: triangles.count,
                vertices,
                done,
            },
        });
    }

    /** Fetches what the query needs, piece after piece, until nothing is missing. */
    private async fetch(): Promise<void> {
        this.isAsked = true;
        if (this.isFetching) return;
        this.isFetching = true;
        try {
            // Another query may come just when nothing is missing any more.
            while (this.isAsked && !this.isOver) {
                this.isAsked = false;
                while ((await this.fetchResource()) || (await this.fetchChunks()));
            }
        } finally {
            this.isFetching = false;
        }
    }

    /** Fetches the chunks of one request; returns false if none is missing. */
    private async fetchChunks(): Promise<boolean> {
        const { levels, header } = this;
        if (!levels || !header || this.isOver) return false;
        const run = this.runOf(levels.wanted(this.query), header);
        if (run.length === 0) return false;
        const sections = run.map((number) => header.chunks[number]);
        const [first, last] = [sections[0], sections[sections.length - 1]];
        mustFit(first.name, first.length);
        let taken = 0;
        const take = (bytes: Uint8Array, least: number) => {
            let [end, count] = [taken, 0];
            for (; end < run.length; count += sections[end++].length)
                if (sections[end].at + sections[end].length > first.at + bytes.length) break;
            if (end === taken || count < least) return;
            const part = (section: Section) =>
                bytes.slice(section.at - first.at, section.at - first.at + section.length);
            const chunks = run.slice(taken, end);
            this.add(
                levels,
                chunks.map((number, i) => [number, part(sections[taken + i])] as const),
            );
            taken = end;
            this.decoded += count;
        };
        // What comes in between is not decoded by pieces, as each would decode all anew.
        const isBehind = run[0] >= levels.reached;
        const hear = (bytes: Uint8Array) => isBehind && take(bytes, this.decoded * LEAST_GROWTH);
        take(await this.readBytes(first.at, last.at + last.length - first.at, hear), 0);
        return true;
    }

    private add(levels: Levels, chunks: (readonly [number, Uint8Array])[]): void {
        try {
            levels.add(chunks, this.query);
        } finally {
            // The levels before are another cut, too, if a chunk has been damaged.
            const { cut } = levels;
            if (cut !== this.cut) this.show(cut, this.geometryOf(cut.model));
            else this.startStepping();
        }
    }

    /** Returns the first chunks that lie close together, as far as one request goes. */
    private runOf(wanted: number[], { chunks }: Header): number[] {
        const run: number[] = [];
        for (const number of wanted) {
            if (run.length > 0) {
                const [first, last] = [chunks[run[0]], chunks[run[run.length - 1]]];
                const end = chunks[number].at + chunks[number].length;
                const gap = chunks[number].at - last.at - last.length;
                if (end - first.at > this.limits.request || gap > this.limits.request / 8) break;
            }
            run.push(number);
        }
        return run;
    }

    /** Fetches the next resource whose place in the file has come; returns false if none has. */
    private async fetchResource(): Promise<boolean> {
        const { header, levels } = this;
        const entry = header?.resources[this.nextResource];
        if (!header || !levels || !entry || this.isOver) return false;
        if (entry.after > levels.reached && levels.wanted(this.query).length > 0) return false;
        const bytes = unpackResource(entry.name, await this.read(entry));
        const number = this.nextResource++;
        if (number === 0) {
            this.head = readHead(bytes);
            this.post({ kind: "scene", scene: this.head });
        } else {
            const part = this.head?.parts[number - 1];
            if (part) this.post({ kind: "part", part, bytes });
        }
        return true;
    }

    private async read(section: Section): Promise<Uint8Array> {
        mustFit(section.name, section.length);
        const bytes = await this.readBytes(section.at, section.length);
        check(section, bytes);
        return bytes;
    }

    private async readBytes(at: number, length: number, hear?: Hear): Promise<Uint8Array> {
        const bytes = await this.source.read(at, length, hear);
        this.bytes += Math.max(0, Math.min(length, at + length - this.opened));
        return bytes;
    }
}
