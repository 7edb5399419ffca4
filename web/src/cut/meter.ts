/** Work done by an update of a cut, counted against its limits. */

/** Limits on the work of one update. */
export interface Limits {
    /** Greatest number of splits and merges. */
    changes?: number;
    /** Milliseconds after which no further one is begun; inspections stop after half of them. */
    time?: number;
}

/** What one update has done. */
export interface CutChange {
    splits: number;
    merges: number;
    /** Number of updates that were checked against the query. */
    inspected: number;
    /** True if the cut satisfies the query, false if a limit was reached first. */
    done: boolean;
}

/** Number of inspections between two readings of the clock. */
const INSPECTIONS_PER_CLOCK = 256;

/** Counts work against limits. */
export class Meter {
    readonly change: CutChange = { splits: 0, merges: 0, inspected: 0, done: false };
    private readonly most: number;
    private readonly until: number;
    private readonly inspectUntil: number;

    constructor({ changes = Infinity, time = Infinity }: Limits) {
        const now = performance.now();
        this.most = changes;
        this.until = now + time;
        this.inspectUntil = now + time / 2;
    }

    mayChangeMore(): boolean {
        const { change, most, until } = this;
        return (
            change.splits + change.merges < most &&
            (until === Infinity || performance.now() < until)
        );
    }

    /** Counts an inspection; returns true if another one is allowed. */
    mayInspectMore(): boolean {
        const count = ++this.change.inspected;
        return (
            count % INSPECTIONS_PER_CLOCK !== 0 ||
            this.inspectUntil === Infinity ||
            performance.now() < this.inspectUntil
        );
    }
}
