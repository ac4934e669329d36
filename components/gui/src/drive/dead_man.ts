// When a robot may move: pure, the time is passed in.
//
// The page says "held" while a key, the stick or a trigger is held. The worker, whose timer neither a hidden tab nor a page that hangs slows
// down, sends velocities only while the page's last word is fresh; then one zero, and silence: idle zeros would fight another operator.

export const sendEveryMs = 80;
export const checkEveryMs = 20;
export const freshMs = 200;
export const commandTooOldMs = 150;

export interface DriveIntent { held: boolean; v: number; w: number; at: number }
export type DriveAction = {kind: "send"; v: number; w: number} | {kind: "zero"; why: string} | {kind: "none"};

export class DeadMan {
  private intent: DriveIntent = {held: false, v: 0, w: 0, at: -Infinity};
  private moving = false;
  private barred = "";

  get isMoving(): boolean { return this.moving; }

  /** @param at when the page said so; @param now when it came. One that travelled too long counts as a release. */
  report(intent: DriveIntent, now: number): void {
    const late = now - intent.at > commandTooOldMs;
    this.intent = {...intent, held: intent.held && !late, at: now};
    if (!intent.held) this.barred = "";
  }

  /** No motion until the page has released and pressed again. */
  bar(why: string): void {
    if (this.intent.held || this.moving) this.barred = why;
  }

  tick(now: number): DriveAction {
    const stale = now - this.intent.at > freshMs;
    if (this.intent.held && stale) this.barred = "the page said nothing for 0.2 s";
    if (this.intent.held && !stale && !this.barred) {
      this.moving = true;
      return {kind: "send", v: this.intent.v, w: this.intent.w};
    }
    if (!this.moving) return {kind: "none"};
    this.moving = false;
    return {kind: "zero", why: this.barred || "released"};
  }
}
