/** Why a file cannot be read: its section that is damaged, and how. */
export class MlodError extends Error {
    override readonly name = "MlodError";

    /**
     * @param section what is damaged, such as "chunk 3"
     * @param why what is wrong with it
     */
    constructor(
        readonly section: string,
        readonly why: string,
    ) {
        super(`${section}: ${why}`);
    }
}

/** Runs a reader of a section, and names the section in what it throws. */
export function within<T>(section: string, read: () => T): T {
    try {
        return read();
    } catch (error) {
        if (error instanceof Damage) throw new MlodError(section, error.message);
        throw error;
    }
}

/** Damage found by code that does not know which section it reads; `within` adds that. */
export class Damage extends Error {}

/** Throws damage unless something holds. */
export function must(holds: boolean, why: string): asserts holds {
    if (!holds) throw new Damage(why);
}
