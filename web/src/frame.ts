/** Model coordinates and units: a unit is a power of two, so that nothing is rounded by it. */

/** Origin and unit of a model. */
export interface Frame {
    origin: readonly [number, number, number];
    unit: number;
}

/** A point or a direction. */
export type Vector = readonly [number, number, number];

/** Returns a point of the model in units from the origin. */
export function toUnits({ origin, unit }: Frame, [x, y, z]: Vector): [number, number, number] {
    const scale = 1 / unit;
    return [(x - origin[0]) * scale, (y - origin[1]) * scale, (z - origin[2]) * scale];
}

/** Returns true if a number can be the unit of a frame. */
export function isUnit(unit: number): boolean {
    const inNormalRange = unit >= 2 ** -1022 && unit <= 2 ** 1022;
    return inNormalRange && Number.isInteger(Math.log2(unit)) && 2 ** Math.log2(unit) === unit;
}
