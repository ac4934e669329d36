// Where the robot was: points in the order of time, bounded. No DOM.

const most = 6000;
const step = 0.02;

export class Trail {
  private t: number[] = [];
  private x: number[] = [];
  private y: number[] = [];

  add(t: number, x: number, y: number): void {
    const n = this.t.length;
    if (n > 0 && Math.hypot(x - this.x[n - 1]!, y - this.y[n - 1]!) < step) return;
    this.t.push(t);
    this.x.push(x);
    this.y.push(y);
    if (n > most) for (const list of [this.t, this.x, this.y]) list.splice(0, 1000);
  }

  clear(): void { this.t = []; this.x = []; this.y = []; }

  /** Pieces between neighbours up to t; a jump of more than half a metre is no piece (kidnapping, a new winner). */
  forEachPiece(until: number, use: (ax: number, ay: number, bx: number, by: number, index: number) => void): void {
    for (let i = 1; i < this.t.length && this.t[i]! <= until; ++i) {
      if (Math.hypot(this.x[i]! - this.x[i - 1]!, this.y[i]! - this.y[i - 1]!) < 0.5) use(this.x[i - 1]!, this.y[i - 1]!, this.x[i]!, this.y[i]!, i);
    }
  }
}
