/** The geometry that shows a stream, changed where its patches say. */

import { Box3, BufferAttribute, BufferGeometry, Sphere, Vector3 } from "three";
import type { FileInfo, GeometryPatch, LayerInfo } from "../index.ts";
import { attributeName } from "./attribute_name.ts";

/** Number of ranges that are uploaded by themselves; more become one. */
const MOST_RANGES = 32;
const MOST_WAITING = 1024;
const LEAST_CAPACITY = 256;

/** An attribute of the geometry, and its place among the numbers of a vertex. */
interface Column {
    name: string;
    width: number;
    start: number;
    /** True for texture coordinates, whose second one grows upwards in files. */
    isUv: boolean;
}

/** Geometry of a stream, with a group for each material. */
export class StreamGeometry extends BufferGeometry {
    private readonly columns: Column[];
    private readonly width: number;

    constructor({ layers, center, diagonal }: FileInfo) {
        super();
        this.columns = columnsOf(layers);
        this.width = 3 + layers.reduce((sum, layer) => sum + layer.width, 0);
        // The finest mesh fits, and levels stay within their errors of it.
        this.boundingSphere = new Sphere(new Vector3(...center), 0.75 * diagonal);
        this.setIndex(new BufferAttribute(new Uint32Array(0), 1));
        for (const { name, width } of this.columns)
            this.setAttribute(name, new BufferAttribute(new Float32Array(0), width));
    }

    /** The bounds of the finest mesh, whatever is shown. */
    override computeBoundingSphere(): void {}

    /** Finds the bounds of what is shown: the buffers have room for more. */
    override computeBoundingBox(): void {
        const box = (this.boundingBox ??= new Box3()).makeEmpty();
        const { index, groups } = this;
        const { array } = this.getAttribute("position");
        const point = new Vector3();
        for (const { start, count } of groups) {
            for (let at = start; index && at < start + count; at++)
                box.expandByPoint(point.fromArray(array, 3 * index.array[at]));
        }
    }

    /** Changes what a patch says. */
    apply(patch: GeometryPatch): void {
        this.boundingBox = null;
        for (const column of this.columns) this.write(column, patch);
        this.writeIndex(patch);
        this.clearGroups();
        patch.parts.forEach(({ start, count }, part) => {
            if (count > 0) this.addGroup(3 * start, 3 * count, part);
        });
    }

    private write(
        { name, width, start, isUv }: Column,
        { capacity, vertices, values }: GeometryPatch,
    ): void {
        const attribute = this.roomy(this.getAttribute(name) as BufferAttribute, capacity);
        if (attribute !== this.getAttribute(name)) this.setAttribute(name, attribute);
        const { array } = attribute;
        vertices.forEach((vertex, i) => {
            const from = i * this.width + start;
            let sum = 0;
            for (let k = 0; k < width; k++) sum += values[from + k];
            // Skins need weights that add up to 1, and those of files may not.
            const scale = name === "skinWeight" && sum > 0 ? 1 / sum : 1;
            for (let k = 0; k < width; k++) array[vertex * width + k] = values[from + k] * scale;
            if (isUv) array[vertex * width + 1] = 1 - values[from + 1];
        });
        markRanges(attribute, vertices, width);
    }

    private writeIndex({ triangles, places, index }: GeometryPatch): void {
        const attribute = this.roomy(this.index as BufferAttribute, 3 * triangles);
        if (attribute !== this.index) this.setIndex(attribute);
        places.forEach((place, i) => {
            for (let k = 0; k < 3; k++) attribute.array[3 * place + k] = index[3 * i + k];
        });
        markRanges(attribute, places, 3);
    }

    /** Returns an attribute with room for a number of elements. */
    private roomy(attribute: BufferAttribute, count: number): BufferAttribute {
        if (attribute.count >= count) return attribute;
        const capacity = Math.max(LEAST_CAPACITY, Math.ceil(1.5 * count)) * attribute.itemSize;
        const isIndex = attribute.array instanceof Uint32Array;
        const array = isIndex ? new Uint32Array(capacity) : new Float32Array(capacity);
        array.set(attribute.array);
        return new BufferAttribute(array, attribute.itemSize);
    }
}

/** Notes which elements are uploaded, in ranges that follow one another. */
function markRanges(attribute: BufferAttribute, elements: Uint32Array, width: number): void {
    if (elements.length === 0) return;
    const sorted = elements.slice().sort();
    const ranges: [number, number][] = [];
    for (const at of sorted) {
        const last = ranges[ranges.length - 1];
        if (last !== undefined && at <= last[1]) last[1] = at + 1;
        else ranges.push([at, at + 1]);
    }
    const all: [number, number][] = [[sorted[0], sorted[sorted.length - 1] + 1]];
    for (const [from, to] of ranges.length > MOST_RANGES ? all : ranges) {
        attribute.addUpdateRange(from * width, (to - from) * width);
    }
    // What is not drawn for long is uploaded as a whole. No ranges would say so, too, but not once
    // the next patch has added its own.
    if (attribute.updateRanges.length > MOST_WAITING) {
        attribute.clearUpdateRanges();
        attribute.addUpdateRange(0, attribute.array.length);
    }
    attribute.needsUpdate = true;
}

function columnsOf(layers: readonly LayerInfo[]): Column[] {
    const columns: Column[] = [{ name: "position", width: 3, start: 0, isUv: false }];
    let start = 3;
    for (const { kind, set, width } of layers) {
        const name = attributeName(kind, set);
        if (name !== null) columns.push({ name, width, start, isUv: kind === "uv" });
        start += width;
    }
    return columns;
}
