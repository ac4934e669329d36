// Where the robot was in the last five minutes, as far back as the page can go: points in the order of time. No DOM.
import {spanMs} from "../state/history";

const step = 0.02;
const droppedAtOnce = 200;

export class Trail {
  private t: number[] = [];
  private x: number[] = [];
  private y: number[] = [];

  get length(): number { return this.t.length; }

  add(t: number, x: number, y: number): void {
    const n = this.t.length;
    if (n > 0 && Math.hypot(x - this.x[n - 1]!, y - this.y[n - 1]!) < step) return;
    this.t.push(t);
    this.x.push(x);
    this.y.push(y);
    if (n > droppedAtOnce && this.t[droppedAtOnce]! < t - spanMs) for (const list of [this.t, this.x, this.y]) list.splice(0, droppedAtOnce);
  }

  clear(): void { this.t = []; this.x = []; this.y = []; }

  /** Pieces between neighbours up to t; a jump of more than half a metre is no piece (kidnapping, a new winner). */
  forEachPiece(until: number, use: (ax: number, ay: number, bx: number, by: number, index: number) => void): void {
    for (let i = 1; i < this.t.length && this.t[i]! <= until; ++i) {
      if (Math.hypot(this.x[i]! - this.x[i - 1]!, this.y[i]! - this.y[i - 1]!) < 0.5) use(this.x[i - 1]!, this.y[i - 1]!, this.x[i]!, this.y[i]!, i);
    }
  }
}
