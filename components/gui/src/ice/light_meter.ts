// How bright the picture is: a covered lens and a plain wall give no lines alike, but only one of them is black.

const columns = 16;
const rows = 12;
const everyMs = 400;

export class LightMeter {
  /** Mean of red, green and blue [0..255]; null: no picture was measured. */
  brightness: number | null = null;
  private readonly context = new OffscreenCanvas(columns, rows).getContext("2d", {willReadFrequently: true});
  private last = -Infinity;

  /** @param now [ms] */
  look(picture: ImageBitmap, now: number): void {
    if (!this.context || now - this.last < everyMs) return;
    this.last = now;
    this.context.drawImage(picture, 0, 0, columns, rows);
    const {data} = this.context.getImageData(0, 0, columns, rows);
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) sum += data[i]! + data[i + 1]! + data[i + 2]!;
    this.brightness = sum / (3 * columns * rows);
  }
}
