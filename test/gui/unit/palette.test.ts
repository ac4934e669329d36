// Colours that are drawn in one view with one form: their difference (CIEDE2000) for the three kinds of dichromats and for all others.
import assert from "node:assert/strict";
import {test} from "node:test";
import {colour, rgb} from "@gui/shared/palette";
import type {ColourName, Theme} from "@gui/shared/palette";

/** Machado, Oliveira and Fernandes 2009, severity 1, on linear RGB. */
const vision: Record<string, number[]> = {
  normal: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900],
};

function lab(hex: string, m: number[]): [number, number, number] {
  const l = rgb(hex).map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  const [r, g, b] = [0, 3, 6].map(k => Math.min(1, Math.max(0, m[k]! * l[0]! + m[k + 1]! * l[1]! + m[k + 2]! * l[2]!))) as [number, number, number];
  const f = (t: number) => t > 216 / 24389 ? Math.cbrt(t) : (24389 / 27 * t + 16) / 116;
  const x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047), y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b), z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

function ciede2000([l1, a1, b1]: [number, number, number], [l2, a2, b2]: [number, number, number]): number {
  const deg = Math.PI / 180, cm = (Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2, g = 0.5 * (1 - Math.sqrt(cm ** 7 / (cm ** 7 + 25 ** 7)));
  const p1 = a1 * (1 + g), p2 = a2 * (1 + g), c1 = Math.hypot(p1, b1), c2 = Math.hypot(p2, b2);
  const hue = (a: number, b: number) => (Math.atan2(b, a) / deg + 360) % 360, h1 = hue(p1, b1), h2 = hue(p2, b2);
  let dh = h2 - h1;
  if (c1 * c2 === 0) dh = 0;
  else if (dh > 180) dh -= 360;
  else if (dh < -180) dh += 360;
  let hm = (h1 + h2) / 2;
  if (c1 * c2 === 0) hm = h1 + h2;
  else if (Math.abs(h1 - h2) > 180) hm += h1 + h2 < 360 ? 180 : -180;
  const dl = l2 - l1, dc = c2 - c1, dH = 2 * Math.sqrt(c1 * c2) * Math.sin(dh / 2 * deg), lm = (l1 + l2) / 2, cmp = (c1 + c2) / 2;
  const t = 1 - 0.17 * Math.cos((hm - 30) * deg) + 0.24 * Math.cos(2 * hm * deg) + 0.32 * Math.cos((3 * hm + 6) * deg) - 0.2 * Math.cos((4 * hm - 63) * deg);
  const sl = 1 + 0.015 * (lm - 50) ** 2 / Math.sqrt(20 + (lm - 50) ** 2), sc = 1 + 0.045 * cmp, sh = 1 + 0.015 * cmp * t;
  const rt = -2 * Math.sqrt(cmp ** 7 / (cmp ** 7 + 25 ** 7)) * Math.sin(60 * Math.exp(-(((hm - 275) / 25) ** 2)) * deg);
  return Math.sqrt((dl / sl) ** 2 + (dc / sc) ** 2 + (dH / sh) ** 2 + rt * dc / sc * dH / sh);
}

test("CIEDE2000 of a pair of Sharma's table", () => {
  assert.ok(Math.abs(ciede2000([50, 2.6772, -79.7751], [50, 0, -82.7485]) - 2.0425) < 1e-4);
  assert.ok(Math.abs(ciede2000([50, -1.3802, -84.2814], [50, 0, -82.7485]) - 1.0) < 1e-4);
});

const views: Record<string, ColourName[]> = {
  "solid trajectories and symbols": ["estimate", "truth"], "lines of the scene": ["memory", "map", "primitive", "selection"], "overlays": ["observed", "predicted", "matched"],
};

for (const [view, names] of Object.entries(views)) {
  test(`${view} differ by 10 or more for everybody`, () => {
    for (const theme of (view === "overlays" ? ["dark"] : ["dark", "light"]) as Theme[]) {
      for (const [kind, matrix] of Object.entries(vision)) {
        names.forEach((a, i) => names.slice(i + 1).forEach(b => {
          const d = ciede2000(lab(colour(a, theme), matrix), lab(colour(b, theme), matrix));
          assert.ok(d >= 10, `${a} and ${b}, ${theme}, ${kind}: ${d.toFixed(1)}`);
        }));
      }
    }
  });
}
