// Which speeds the held keys mean. Pure.

/** Share of the highest speed forward and of the highest turn rate to the left, each -1..1. */
export function speedsOf(held: ReadonlySet<string>): {v: number; w: number} {
  const any = (...codes: string[]) => codes.some(c => held.has(c)) ? 1 : 0;
  const v = any("KeyW", "ArrowUp") - any("KeyS", "ArrowDown"), w = any("KeyA", "ArrowLeft") - any("KeyD", "ArrowRight");
  return {v, w};
}

export const driveKeys: ReadonlySet<string> = new Set(["KeyW", "KeyA", "KeyS", "KeyD", "ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"]);
