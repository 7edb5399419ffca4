/** The page: its files, its figures, and the model that it shows. */

import { control } from "./controls.ts";
import { openLevels, showWhole } from "./model.ts";
import type { Model, Watcher } from "./model.ts";
import { Orbit } from "./orbit.ts";
import { Renderer } from "./renderer.ts";
import { FORMATS, addressOf, listFiles, modelInPage, size } from "./source.ts";

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

/** Starts the page that this script is in. */
export function startPage(): void {
    const canvas = element<HTMLCanvasElement>("view");
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true });
    if (!gl) return fail("this browser has no WebGL 2, by which models are drawn");
    try {
        new Page(canvas, gl).start();
    } catch (error) {
        fail(error);
    }
}

/** Says what went wrong; the picture stays. */
function fail(error: unknown): void {
    const line = element("error");
    line.textContent = error instanceof Error ? error.message : String(error);
    line.hidden = false;
    document.documentElement.dataset.state = "failed";
}

/** Starts a worker with the script of this page. */
function workerOf(): Worker {
    const text = element("code").textContent ?? "";
    const url = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
    const worker = new Worker(url);
    URL.revokeObjectURL(url);
    return worker;
}

class Page {
    private readonly orbit = new Orbit();
    private renderer: Renderer;
    private model: Model | null = null;
    private abort = new AbortController();
    private isAsked = false;
    private lastQuery = "";
    private pixels = 1;
    private hasWorkers = true;

    constructor(
        private readonly canvas: HTMLCanvasElement,
        private readonly gl: WebGL2RenderingContext,
    ) {
        this.renderer = new Renderer(gl);
    }

    start(): void {
        const redraw = () => this.redraw();
        control(this.canvas, this.orbit, redraw);
        new ResizeObserver(redraw).observe(this.canvas);
        this.canvas.addEventListener("webglcontextlost", () =>
            fail("the GPU has been lost; load the page again"),
        );
        const pixels = element<HTMLInputElement>("pixels");
        pixels.addEventListener("input", () => {
            this.pixels = 2 ** Number(pixels.value);
            element("allowed").textContent = `${Number(this.pixels.toPrecision(2))} px`;
            redraw();
        });
        element("up").addEventListener("click", () => this.turnUp());
        element("home").addEventListener("click", () => this.frame());
        document.addEventListener("keydown", ({ key, ctrlKey, metaKey, altKey }) => {
            if (ctrlKey || metaKey || altKey) return;
            if (key === "0") this.frame();
            if (key === "u") this.turnUp();
        });
        const inPage = modelInPage();
        if (inPage) void this.show(inPage.name, inPage.bytes);
        else this.startList().catch(fail);
    }

    private turnUp(): void {
        const up = this.orbit.up === "y" ? "z" : "y";
        this.orbit.up = up;
        element("up").textContent = `${up} up`;
        this.frame();
    }

    private frame(): void {
        const { clientWidth, clientHeight } = this.canvas;
        if (this.model) this.orbit.frame(this.model, clientWidth / Math.max(1, clientHeight));
        this.redraw();
    }

    /** Shows the files of the folder, and the one that the address names. */
    private async startList(): Promise<void> {
        const list = element("files");
        const files = await listFiles();
        list.hidden = false;
        if (files.length === 0) {
            const hint = document.createElement("p");
            hint.textContent = "No models here: meshlod build MESH model.mlod makes one.";
            return list.append(hint);
        }
        for (const { path, bytes } of files) {
            const link = document.createElement("a");
            link.href = `#${encodeURIComponent(path)}`;
            link.dataset.path = path;
            const length = document.createElement("small");
            length.textContent = size(bytes);
            link.append(path, length);
            list.append(link);
        }
        const go = () => {
            const path = decodeURIComponent(location.hash.slice(1)) || files[0].path;
            for (const link of list.querySelectorAll("a"))
                link.toggleAttribute("aria-current", link.dataset.path === path);
            void this.show(path, addressOf(path));
        };
        addEventListener("hashchange", go);
        go();
    }

    /** Shows a model in place of the one before, which stays until this one is there. */
    private async show(name: string, file: string | Uint8Array): Promise<void> {
        this.abort.abort();
        const { signal } = (this.abort = new AbortController());
        element("error").hidden = true;
        document.documentElement.dataset.state = "loading";
        try {
            const model = await this.open(name, file, signal);
            if (signal.aborted) return model.dispose();
            this.model?.dispose();
            this.model = model;
            this.lastQuery = "";
            document.title = `${name.split("/").pop()} – meshlod`;
            this.frame();
        } catch (error) {
            if (!signal.aborted) fail(error);
        }
    }

    private async open(
        name: string,
        file: string | Uint8Array,
        signal: AbortSignal,
    ): Promise<Model> {
        const watcher: Watcher = {
            changed: () => this.redraw(),
            failed: fail,
            worker: this.hasWorkers ? workerOf : undefined,
            signal,
        };
        const suffix = /\.ml[qz]$/i.exec(name)?.[0].toLowerCase();
        if (suffix && typeof file === "string") {
            const response = await fetch(file, { signal });
            if (!response.ok) throw new Error(`the server answers ${response.status}: ${file}`);
            const bytes = new Uint8Array(await response.arrayBuffer());
            const url = addressOf(FORMATS);
            const formats = (await import(url)) as typeof import("./formats.ts");
            const mesh = formats.decodePacked(bytes, suffix === ".mlq");
            return showWhole(this.gl, mesh, bytes.length, watcher);
        }
        try {
            return await openLevels(this.gl, file, watcher);
        } catch (error) {
            // Where a page may start no worker, this thread does its work.
            const isOfWorker = !(error instanceof Error) || /worker/i.test(error.message);
            if (!isOfWorker || !this.hasWorkers || signal.aborted) throw error;
            this.hasWorkers = false;
            return this.open(name, file, signal);
        }
    }

    private redraw(): void {
        if (this.isAsked) return;
        this.isAsked = true;
        requestAnimationFrame(() => {
            this.isAsked = false;
            this.draw();
        });
    }

    private draw(): void {
        const { canvas, model, orbit } = this;
        const start = performance.now();
        const ratio = Math.min(2, devicePixelRatio);
        const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) =>
            Math.max(1, Math.round(side * ratio)),
        );
        if (canvas.width !== width || canvas.height !== height)
            Object.assign(canvas, { width, height });
        if (model) {
            const camera = orbit.camera(width, height);
            const query = { focus: null, tolerance: { pixels: this.pixels, camera } };
            const key = JSON.stringify(query);
            if (key !== this.lastQuery) {
                model.ask(query);
                model.figures.done = model.isWhole;
            }
            this.lastQuery = key;
        }
        this.renderer.draw(model?.drawn ?? null, orbit);
        if (model) tell(model, performance.now() - start);
    }
}

/** Shows figures: bytes, faces, triangles that changed for this frame, and how long it took. */
function tell(model: Model, drawing: number): void {
    const { bytes, length, faces, done } = model.figures;
    const time = (drawing + model.writing).toFixed(1);
    element("figures").textContent =
        `${size(bytes)} of ${size(length)} · ${faces.toLocaleString("en")} faces · ` +
        `${model.written.toLocaleString("en")} changed · ${time} ms`;
    model.written = model.writing = 0;
    const { dataset } = document.documentElement;
    if (faces > 0 && dataset.state !== "failed") dataset.state = done ? "shown" : "coming";
    dataset.faces = String(faces);
}
