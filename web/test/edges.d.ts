import type { Model } from "../src/model.ts";

/** Vertices of triangles that are drawn: a range of an index, in corners. */
export interface DrawnRange {
    start: number;
    count: number;
}

/**
 * Returns the open edges of triangles, each as the two vertices that it goes between: edges without
 * an opposite one, where vertices at one place count as one.
 */
export function openEdges(
    index: ArrayLike<number>,
    ranges: readonly DrawnRange[],
    positions: ArrayLike<number>,
): [number, number][];

/** Returns the place of a vertex as a text, in the precision of GPUs. */
export function placeOf(positions: ArrayLike<number>, at: number): string;

/**
 * Returns the places at which a level may be open: of vertices whose finest ones are at a border.
 * The triangles are those of the finest level.
 */
export function borderOf(
    model: Model,
    triangles: { readonly nodes: Uint32Array; readonly slots: number },
): Set<string>;
