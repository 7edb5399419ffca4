/** Vertices of a model as numbers: the position in the model, and then the attributes. */

import type { FieldModel } from "../field/field_model.ts";
import type { Model } from "../model.ts";
import type { LayerInfo } from "./messages.ts";
import type { Vertices } from "./geometry.ts";

/** Vertices of contractions; the parts are material labels. */
export function verticesOf(model: Model): Vertices {
    const { wedges } = model;
    return {
        width: 3 + (wedges?.width ?? 0),
        write(node, key, to, at) {
            model.position(node, to, at);
            wedges?.values(key, to, at + 3);
        },
        partOf: (key) => wedges?.materialOf(key) ?? 0,
    };
}

/** Vertices of a height field. */
export function fieldVerticesOf(model: FieldModel): Vertices {
    return { width: 3, write: (node, _, to, at) => model.position(node, to, at), partOf: () => 0 };
}

/** Returns the layers of a model's vertices. */
export function layersOf({ wedges }: Model): LayerInfo[] {
    return wedges?.layers.map(({ kind, set, name, width }) => ({ kind, set, name, width })) ?? [];
}
