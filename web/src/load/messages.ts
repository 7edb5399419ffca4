/** What a stream and its worker tell each other. */

import type { Query } from "../cut/query.ts";
import type { LayerKind } from "../wedges/layer.ts";
import type { GeometryPatch } from "./geometry.ts";
import type { SceneHead, ScenePart } from "../scene/head.ts";
import type { Access } from "./source.ts";

/** A file to open: its address, or its bytes. */
export type Origin = { url: string; access: Access } | { bytes: Uint8Array };

/** Limits that hold while a file is open. */
export interface StreamLimits {
    /** Greatest number of bytes that decoded levels may take; 512 MiB by default. */
    memory?: number;
    /** Greatest number of bytes of one request; 256 KiB by default. */
    request?: number;
    /** Milliseconds of work between two looks at what is asked; 8 by default. */
    slice?: number;
    /**
     * Milliseconds for which vertices move where the level changes; 0 by default: changes are seen
     * at once. Height fields do not move.
     */
    morph?: number;
}

/** To the worker. */
export type Request =
    | { kind: "open"; origin: Origin; limits: StreamLimits }
    | { kind: "query"; query: Query }
    | { kind: "split"; parts: readonly number[] }
    | { kind: "close" };

/** A layer of a vertex, as patches have it behind the position. */
export interface LayerInfo {
    kind: LayerKind;
    set: number;
    name: string;
    width: number;
}

/** What is known once a file has been opened. */
export interface FileInfo {
    kind: "contractions" | "height field";
    /** Middle and diagonal of the finest mesh, in model units. */
    center: [number, number, number];
    diagonal: number;
    /** Length of the file, and its number of chunks or parts. */
    length: number;
    chunks: number;
    /** True if there are nodes, materials or images. */
    hasScene: boolean;
    layers: LayerInfo[];
    /** Names of material labels, by which patches have their parts. */
    materials: readonly string[] | null;
    /** Material and object of each pair of labels that a vertex may have, two numbers each. */
    pairs: Uint32Array | null;
}

/** The scene of a file, if it has one. */
export type SceneInfo = SceneHead;

/** How far a stream has come. */
export interface Progress {
    /** Bytes fetched so far, chunks in memory, and chunks that the query still needs. */
    bytes: number;
    chunks: number;
    missing: number;
    faces: number;
    vertices: number;
    /** True if the cut satisfies the query, as far as chunks are there. */
    done: boolean;
}

/** From the worker. */
export type Event =
    | { kind: "opened"; info: FileInfo }
    | { kind: "scene"; scene: SceneInfo }
    | { kind: "part"; part: ScenePart; bytes: Uint8Array }
    | { kind: "patch"; patch: GeometryPatch }
    | { kind: "progress"; progress: Progress }
    | { kind: "failed"; section: string; why: string };
