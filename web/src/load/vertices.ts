/** Vertices of a model as numbers: the position in the model, and then the attributes. */

import type { FieldModel } from "../field/field_model.ts";
import type { Model } from "../model.ts";
import type { Vertices } from "./geometry.ts";

/** Vertices of contractions; the parts are material labels, or those of the pairs of labels. */
export function verticesOf(model: Model, parts?: readonly number[]): Vertices {
    const { wedges } = model;
    return {
        width: 3 + (wedges?.width ?? 0),
        write(node, key, to, at) {
            model.position(node, to, at);
            wedges?.values(key, to, at + 3);
        },
        partOf: (key) => (parts ? parts[wedges?.labelOf(key) ?? 0] : wedges?.materialOf(key)) ?? 0,
    };
}

/** Vertices of a height field. */
export function fieldVerticesOf(model: FieldModel): Vertices {
    return { width: 3, write: (node, _, to, at) => model.position(node, to, at), partOf: () => 0 };
}
