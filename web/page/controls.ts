/** Pointers, wheel and keys that move the camera. */

import type { Orbit } from "./orbit.ts";

/** Radians by which a drag across the height of the picture turns. */
const TURN = 4;
const KEY_TURN = 0.1;
const KEY_PAN = 0.05;
const KEY_ZOOM = 1.15;

interface Point {
    x: number;
    y: number;
}

/** Moves `orbit` as a user does on `canvas`; `moved` hears of it. */
export function control(canvas: HTMLCanvasElement, orbit: Orbit, moved: () => void): void {
    const pointers = new Map<number, Point>();
    canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    for (const kind of ["pointerup", "pointercancel"] as const)
        canvas.addEventListener(kind, (event) => void pointers.delete(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
        if (!pointers.has(event.pointerId)) return;
        const before = [...pointers.values()].map((point) => ({ ...point }));
        pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        drag(orbit, before, [...pointers.values()], canvas.clientHeight, event);
        moved();
    });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener(
        "wheel",
        (event) => {
            event.preventDefault();
            const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
            orbit.zoom(Math.exp(Math.max(-200, Math.min(200, event.deltaY * lines)) * 0.002));
            moved();
        },
        { passive: false },
    );
    canvas.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || !press(orbit, event)) return;
        event.preventDefault();
        moved();
    });
}

/** One pointer turns, or moves with shift or another button; two move and change the distance. */
function drag(
    orbit: Orbit,
    before: Point[],
    after: Point[],
    height: number,
    { buttons, shiftKey }: PointerEvent,
): void {
    const [from, to] = [middle(before), middle(after)];
    const [right, down] = [(to.x - from.x) / height, (to.y - from.y) / height];
    const isPan = before.length > 1 || shiftKey || (buttons & 1) === 0;
    if (isPan) orbit.pan(-right, down);
    else orbit.turn(-TURN * right, TURN * down);
    if (before.length > 1) orbit.zoom(spread(before) / Math.max(1, spread(after)));
}

function middle(points: Point[]): Point {
    const sum = points.reduce((a, b) => ({ x: a.x + b.x, y: a.y + b.y }));
    return { x: sum.x / points.length, y: sum.y / points.length };
}

function spread([a, b]: Point[]): number {
    return Math.max(1, Math.hypot(a.x - b.x, a.y - b.y));
}

/** Returns true if a key moves the camera. */
function press(orbit: Orbit, { key, shiftKey }: KeyboardEvent): boolean {
    const ways: Record<string, [number, number]> = {
        ArrowLeft: [-1, 0],
        ArrowRight: [1, 0],
        ArrowUp: [0, 1],
        ArrowDown: [0, -1],
    };
    const way = ways[key];
    if (way && shiftKey) orbit.pan(-KEY_PAN * way[0], -KEY_PAN * way[1]);
    else if (way) orbit.turn(KEY_TURN * way[0], KEY_TURN * way[1]);
    else if (key === "+" || key === "=") orbit.zoom(1 / KEY_ZOOM);
    else if (key === "-") orbit.zoom(KEY_ZOOM);
    else return false;
    return true;
}
