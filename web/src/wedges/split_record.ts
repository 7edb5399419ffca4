/** Which wedges the faces around an update get, where its children have several. */

/** A child's wedge all of whose faces are gone at the split node. */
export const LOST = 65535;

/** The record of an update. */
export class SplitRecord {
    private readonly around: number;
    private readonly created: number;
    /** True if created faces continue those around, false if all wedges are listed. */
    readonly isContinued: boolean;

    /**
     * @param numbers numbers of the record
     * @param wedges number of wedges of both children
     * @param faces number of faces that the update creates
     */
    constructor(
        readonly numbers: Uint16Array,
        wedges: number,
        faces: number,
    ) {
        this.around = Math.min(wedges, numbers.length);
        const left = numbers.length - this.around;
        this.isContinued = left === faces;
        this.created = this.around + Math.max(left - (this.isContinued ? 1 : 3) * faces, 0);
    }

    /** Returns the parent of a wedge, counted from the first child's, or `LOST`. */
    parent(wedge: number): number {
        return wedge < this.around ? this.numbers[wedge] : LOST;
    }

    /** Returns true if a created face continues the one that follows its wing. */
    follows(face: number): boolean {
        return this.numbers[this.created + face] === 1;
    }

    /** Returns the wedge, among those of its child, of a face around. */
    ofFace(rank: number): number {
        const at = this.around + rank;
        return at < this.created ? this.numbers[at] : 0;
    }

    /** Returns the wedge, among those of its node, of a created face at one of its corners. */
    ofCreated(face: number, corner: number): number {
        const at = this.created + 3 * face;
        return at + 2 < this.numbers.length ? this.numbers[at + corner] : 0;
    }
}
