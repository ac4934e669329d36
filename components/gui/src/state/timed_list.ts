// Values in the order of their time, dropped from the front. No DOM.

export interface Timed { t: number }

export class TimedList<T extends Timed> {
  private items: T[] = [];
  private head = 0;

  get length(): number { return this.items.length - this.head; }
  get first(): T | undefined { return this.items[this.head]; }
  get last(): T | undefined { return this.length > 0 ? this.items[this.items.length - 1] : undefined; }
  at(index: number): T | undefined { return this.items[this.head + index]; }

  push(item: T): void { this.items.push(item); }

  shift(): T | undefined {
    if (this.length === 0) return undefined;
    const item = this.items[this.head];
    (this.items as (T | undefined)[])[this.head++] = undefined;
    if (this.head > 256 && this.head * 2 > this.items.length) {
      this.items = this.items.slice(this.head);
      this.head = 0;
    }
    return item;
  }

  dropBefore(t: number): void {
    while (this.first && this.first.t < t) this.shift();
  }

  /** Keeps the items for which `keep` holds. */
  filter(keep: (item: T) => boolean): void {
    this.items = this.items.slice(this.head).filter(keep);
    this.head = 0;
  }

  /** Index of the last item at or before t; -1 when all are later. */
  indexAt(t: number): number {
    let low = this.head, high = this.items.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.items[middle]!.t <= t) low = middle + 1;
      else high = middle;
    }
    return low - 1 - this.head;
  }

  before(t: number): T | undefined {
    const index = this.indexAt(t);
    return index < 0 ? undefined : this.at(index);
  }

  clear(): void { this.items = []; this.head = 0; }

  *[Symbol.iterator](): Iterator<T> {
    for (let i = this.head; i < this.items.length; ++i) yield this.items[i]!;
  }
}
