/** Wedges of all nodes: vertices with one set of attributes, of one material and object. */

import { must } from "../error.ts";
import { grown } from "../model.ts";
import type { Layer } from "./layer.ts";
import type { SplitRecord } from "./split_record.ts";

/** Wedges as far as chunks have been read, numbered by node. */
export class Wedges {
    /** Number of integers of a wedge. */
    readonly columns: number;
    /** Number of values of a wedge: the widths of all layers. */
    readonly width: number;
    /** First wedge of each node, and at the end the number of wedges. */
    first = new Uint32Array(1);
    private nodes = 0;

    /** Wedges at the corners of the faces of the base mesh. */
    base: Uint32Array = new Uint32Array(0);
    readonly records = new Map<number, SplitRecord>();
    /** Pair of material and object of each wedge; all are of the first pair if it is empty. */
    labels = new Uint32Array(0);
    /** Integers of each wedge: residuals until the values are restored. */
    rows = new Int32Array(0);
    /** Integers whose values have been restored are those of wedges below this number. */
    restored = 0;

    constructor(
        readonly layers: readonly Layer[],
        /** Names of materials, and of objects; null if there are none. */
        readonly materials: readonly string[] | null,
        readonly objects: readonly string[] | null,
        /** A material and an object for each pair. */
        readonly pairs: Uint32Array,
    ) {
        this.columns = layers.reduce((sum, layer) => sum + layer.columns, 0);
        this.width = layers.reduce((sum, layer) => sum + layer.width, 0);
    }

    /** Number of wedges so far. */
    get count(): number {
        return this.first[this.nodes];
    }

    /** Appends nodes with these numbers of wedges. */
    append(counts: Uint32Array): void {
        this.first = grown(this.first, this.nodes + counts.length + 1);
        let end = this.count;
        for (let i = 0; i < counts.length; i++) {
            must(counts[i] >= 1 && counts[i] < 65535, "a vertex has no wedge, or too many");
            end += counts[i];
            must(end < 2 ** 31, "it has too many wedges");
            this.first[++this.nodes] = end;
        }
        this.rows = grown(this.rows, end * this.columns);
        if (this.pairs.length > 2) this.labels = grown(this.labels, end);
    }

    /** Returns the number of wedges of a node. */
    countOf(node: number): number {
        return this.first[node + 1] - this.first[node];
    }

    /** Returns a wedge of a node by its number there. */
    at(node: number, local: number): number {
        return this.first[node] + Math.min(local, this.countOf(node) - 1);
    }

    /** Returns the material of a wedge; 0 if there are none. */
    materialOf(wedge: number): number {
        return this.pairs[2 * this.labelOf(wedge)];
    }

    /** Returns the object of a wedge; 0 if there are none. */
    objectOf(wedge: number): number {
        return this.pairs[2 * this.labelOf(wedge) + 1];
    }

    /** Returns the number of the pair of material and object of a wedge. */
    labelOf(wedge: number): number {
        return this.labels.length > 0 ? this.labels[wedge] : 0;
    }

    /** Writes the values of a wedge, layer after layer; false if one is not finite. */
    values(wedge: number, to: Float32Array, at: number): boolean {
        let areFinite = true;
        for (const layer of this.layers) {
            const isFinite = layer.decode(this.rows, wedge * this.columns + layer.start, to, at);
            areFinite &&= isFinite;
            at += layer.width;
        }
        return areFinite;
    }

    /** Throws damage unless the pairs of wedges are there. */
    checkLabels(from: number): void {
        const pairs = this.pairs.length / 2;
        for (let wedge = from; wedge < this.count && this.labels.length > 0; wedge++) {
            must(this.labels[wedge] < pairs, "a material or object is out of range");
        }
    }
}
