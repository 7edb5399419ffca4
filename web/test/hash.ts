/** Hash of words, as the conformance files have it: FNV-1a with words in place of bytes. */
export class Hash {
    value = 0x811c9dc5;

    add(word: number): void {
        this.value = Math.imul(this.value ^ word, 0x01000193) >>> 0;
    }

    addAll(words: ArrayLike<number>): void {
        for (let i = 0; i < words.length; i++) this.add(words[i]);
    }
}
