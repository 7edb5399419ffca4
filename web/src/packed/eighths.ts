/** Powers of the eighth root of 2. */

/** Returns 2^(`eighths` / 8) as all machines have it. */
export function eighthPower(eighths: number): number {
    const parts = [
        1,
        1.0905077326652577,
        1.189207115002721,
        1.2968395546510096,
        Math.SQRT2,
        1.5422108254079407,
        1.681792830507429,
        1.8340080864093424,
    ];
    const whole = Math.floor(eighths / 8);
    return 2 ** whole * parts[eighths - 8 * whole];
}
