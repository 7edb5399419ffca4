/**
 * Counts covered pixels of what a context has drawn on magenta, and background pixels all of whose
 * neighbours are covered, with the numbers of these; the rim of the picture does not count.
 */
export function look(gl, width, height) {
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const isEmpty = (i) => pixels[4 * i] > 250 && pixels[4 * i + 1] < 5 && pixels[4 * i + 2] > 250;
    let covered = 0;
    const where = [];
    for (let y = 1; y + 1 < height; y++) {
        for (let x = 1; x + 1 < width; x++) {
            const i = y * width + x;
            if (!isEmpty(i)) covered++;
            else if (![i - 1, i + 1, i - width, i + width].some(isEmpty)) where.push(i);
        }
    }
    return { covered, holes: where.length, where };
}
