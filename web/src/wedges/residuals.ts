/** Residuals of attribute values, by wedge and then by column. */

import { NEAR, NumberModels, ROLES, SIZES, classOf } from "../file/number_models.ts";
import type { RangeDecoder } from "../file/range_coder.ts";
import { DIFFERENCE, PARENT } from "./family.ts";
import type { Layer } from "./layer.ts";

/** Models of all columns of a chunk. */
export class ResidualModels {
    /** Columns of a layer share their models, but for tangents. */
    private readonly models: NumberModels[];
    /** Class of the last number in each role, by column. */
    private readonly last: Uint8Array;

    constructor(layers: readonly Layer[]) {
        this.models = layers.flatMap((layer) => {
            const shared = new NumberModels();
            const ofColumn = () => (layer.kind === "tangent" ? new NumberModels() : shared);
            return Array.from({ length: layer.columns }, ofColumn);
        });
        this.last = new Uint8Array(ROLES * this.models.length);
    }

    /** Decodes the residuals of a wedge into its row. */
    decode(decoder: RangeDecoder, role: number, size: number, rows: Int32Array, at: number): void {
        const { models, last } = this;
        const first = Math.min(size, SIZES - 1);
        let beside = -1;
        for (let column = 0; column < models.length; column++) {
            const before = last[ROLES * column + (role === PARENT ? DIFFERENCE : role)];
            const near = beside < 0 ? before : Math.floor((before + 2 * beside + 1) / 3);
            const number = models[column].decode(decoder, role, first, Math.min(near, NEAR - 1));
            rows[at + column] = number;
            beside = classOf(number);
            last[ROLES * column + role] = beside;
        }
    }
}
