// Part of a picture that is not background, which is black.
export function shown(canvas) {
    const copy = Object.assign(document.createElement('canvas'), { width: 128, height: 128 });
    const context = copy.getContext('2d', { willReadFrequently: true });
    context.drawImage(canvas, 0, 0, 128, 128);
    const { data } = context.getImageData(0, 0, 128, 128);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) count += data[i] + data[i + 1] + data[i + 2] > 0;
    return count / (128 * 128);
}

// Calls `draw` frame by frame until it was true for some frames on end; throws after two minutes.
export async function settle(draw) {
    const last = performance.now() + 120_000;
    for (let still = 0; still < 8; ) {
        if (performance.now() > last) throw new Error('tiles are missing after two minutes');
        await new Promise(requestAnimationFrame);
        still = draw() ? still + 1 : 0;
    }
}
