// Lines whose buffers are updated in place: a new buffer for each moment would leak on the graphics card.
import {
  BufferAttribute, BufferGeometry, DynamicDrawUsage, InstancedInterleavedBuffer, InterleavedBufferAttribute, LineBasicMaterial, LineSegments,
} from "three";
import {LineMaterial} from "three/addons/lines/LineMaterial.js";
import {LineSegments2} from "three/addons/lines/LineSegments2.js";
import {LineSegmentsGeometry} from "three/addons/lines/LineSegmentsGeometry.js";

/** Collects segments with a colour each. */
export class LineBuilder {
  positions: number[] = [];
  colours: number[] = [];

  add(ax: number, ay: number, az: number, bx: number, by: number, bz: number, c: readonly [number, number, number]): void {
    this.positions.push(ax, ay, az, bx, by, bz);
    this.colours.push(c[0], c[1], c[2], c[0], c[1], c[2]);
  }

  /** A closed or open chain at one height. */
  chain(points: readonly {x: number; y: number}[], z: number, c: readonly [number, number, number], closed: boolean): void {
    const n = points.length;
    for (let i = 0; i + (closed ? 0 : 1) < n; ++i) {
      const a = points[i]!, b = points[(i + 1) % n]!;
      this.add(a.x, a.y, z, b.x, b.y, z, c);
    }
  }

  get count(): number { return this.positions.length / 6; }
}

/** Segments one pixel wide. */
export class ThinLines extends LineSegments<BufferGeometry, LineBasicMaterial> {
  private capacity = 0;

  constructor(opacity = 1) {
    super(new BufferGeometry(), new LineBasicMaterial({vertexColors: true, transparent: opacity < 1, opacity}));
    this.frustumCulled = false;
  }

  set(lines: LineBuilder): void {
    const n = lines.count * 2;
    if (n > this.capacity) {
      this.capacity = Math.max(64, n * 2);
      this.geometry.dispose();
      this.geometry = new BufferGeometry();
      for (const name of ["position", "color"])
        this.geometry.setAttribute(name, new BufferAttribute(new Float32Array(this.capacity * 3), 3).setUsage(DynamicDrawUsage));
    }
    this.visible = n > 0;
    if (n === 0) return;
    const position = this.geometry.getAttribute("position") as BufferAttribute, colour = this.geometry.getAttribute("color") as BufferAttribute;
    (position.array as Float32Array).set(lines.positions);
    (colour.array as Float32Array).set(lines.colours);
    for (const attribute of [position, colour]) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, n * 3);
      attribute.needsUpdate = true;
    }
    this.geometry.setDrawRange(0, n);
  }
}

/** Segments some pixels wide, solid or dashed (dashes in metres). */
export class WideLines extends LineSegments2 {
  private capacity = 0;
  private readonly dashed: boolean;

  constructor(width: number, dash?: {on: number; off: number}) {
    super(new LineSegmentsGeometry(), new LineMaterial({
      linewidth: width, vertexColors: true, dashed: dash !== undefined, dashSize: dash?.on ?? 1, gapSize: dash?.off ?? 0, worldUnits: false,
    }));
    this.dashed = dash !== undefined;
    this.frustumCulled = false;
    this.visible = false;
  }

  set(lines: LineBuilder): void {
    const n = lines.count;
    if (n > this.capacity) this.grow(Math.max(64, n * 2));
    this.visible = n > 0;
    this.geometry.instanceCount = n;
    if (n === 0) return;
    this.write("instanceStart", lines.positions);
    this.write("instanceColorStart", lines.colours);
    if (!this.dashed) return;
    const distances: number[] = [], p = lines.positions;
    for (let i = 0; i < n; ++i) distances.push(0, Math.hypot(p[6 * i + 3]! - p[6 * i]!, p[6 * i + 4]! - p[6 * i + 1]!, p[6 * i + 5]! - p[6 * i + 2]!));
    this.write("instanceDistanceStart", distances);
  }

  private write(name: string, values: number[]): void {
    const data = (this.geometry.getAttribute(name) as InterleavedBufferAttribute).data as InstancedInterleavedBuffer;
    (data.array as Float32Array).set(values);
    data.clearUpdateRanges();
    data.addUpdateRange(0, values.length);
    data.needsUpdate = true;
  }

  private grow(capacity: number): void {
    this.capacity = capacity;
    this.geometry.dispose();
    this.geometry = new LineSegmentsGeometry();
    this.geometry.setPositions(new Float32Array(capacity * 6));
    this.geometry.setColors(new Float32Array(capacity * 6));
    if (!this.dashed) return;
    const data = new InstancedInterleavedBuffer(new Float32Array(capacity * 2), 2, 1);
    this.geometry.setAttribute("instanceDistanceStart", new InterleavedBufferAttribute(data, 1, 0));
    this.geometry.setAttribute("instanceDistanceEnd", new InterleavedBufferAttribute(data, 1, 1));
  }
}
