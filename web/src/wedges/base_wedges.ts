/** The wedges of the base mesh, and what a file says of all wedges. */

import { must } from "../error.ts";
import type { Streams } from "../file/streams.ts";
import type { Model } from "../model.ts";
import { readLayers } from "./layer.ts";
import { Wedges } from "./wedges.ts";

/** Reads the wedges of the roots. */
export function readBaseWedges(model: Model, input: Streams): Wedges {
    const layers = readLayers(input);
    const materials = readNames(input);
    const objects = readNames(input);
    const pairs = input.numbers(2 * input.one());
    const isLabel = (label: number, i: number) =>
        label < ((i & 1 ? objects : materials)?.length ?? 1);
    must(pairs.length > 0 && pairs.every(isLabel), "a material or object is out of range");
    const wedges = new Wedges(layers, materials, objects, pairs);
    wedges.append(input.numbers(model.roots));
    wedges.base = input.numbers(3 * model.header.baseFaces);
    must(
        wedges.base.every((wedge) => wedge < wedges.count),
        "a wedge is out of range",
    );
    for (let column = 0; column < wedges.columns; column++) {
        let last = 0;
        input.signed(wedges.count).forEach((step, wedge) => {
            last = (last + step) | 0;
            wedges.rows[wedge * wedges.columns + column] = last;
        });
    }
    if (pairs.length > 2) wedges.labels.set(input.numbers(wedges.count));
    wedges.checkLabels(0);
    return wedges;
}

function readNames(input: Streams): string[] | null {
    const count = input.one();
    if (count === 0) return null;
    const names: string[] = [];
    while (names.length < count - 1) names.push(input.text());
    return names;
}
