// Drives the base for the page: lease, velocities, and the zero when the page lets go.
/* eslint-disable @typescript-eslint/no-explicit-any */
import {checkEveryMs, DeadMan, sendEveryMs} from "../drive/dead_man";
import {nowMs} from "../shared/messages";
import type {FromWorker} from "../shared/messages";
import type {LeaseInfo} from "../shared/state";
import {avm, describe, Ice} from "./link";
import type {Peer} from "./link";

const leaseTimeoutS = 1.5;
const priority = 10;

export class Driver {
  readonly deadMan = new DeadMan();
  /** When the last frame came [ms]; nobody drives blind. */
  lastFrame = 0;
  hasCamera = true;
  private lease: any = null;
  private outstanding = false;
  private sent = -Infinity;
  private said = "";
  private info: LeaseInfo = {held: false, client: "", priority: 0, implicit: false, remainingS: 0, mine: false};
  /** Servers before the lease refuse its operations: then commands go without. */
  private hasLease = true;

  constructor(private readonly base: Peer, private readonly client: string, private readonly publish: (message: FromWorker) => void) {
    setInterval(() => this.tick(), checkEveryMs);
  }

  private tick(): void {
    const now = nowMs();
    if (this.hasCamera && this.deadMan.isMoving && now - this.lastFrame > 500) this.deadMan.bar("the picture is older than 0.5 s");
    const action = this.deadMan.tick(now);
    if (action.kind === "send") {
      this.say(true, "");
      if (this.outstanding || now - this.sent < sendEveryMs) return;
      this.sent = now;
      void this.send(action.v, action.w);
    } else if (action.kind === "zero") {
      this.say(false, action.why);
      void this.halt();
    }
  }

  private say(active: boolean, why: string): void {
    const text = `${active} ${why}`;
    if (text === this.said) return;
    this.said = text;
    this.publish({kind: "driving", active, why});
  }

  private async acquire(): Promise<void> {
    if (!this.hasLease || this.lease) return;
    try {
      this.lease = await this.base.proxy.acquire(this.client, priority, leaseTimeoutS);
    } catch (failure) {
      if (failure instanceof Ice.OperationNotExistException) this.hasLease = false;
      else throw failure;
    }
  }

  private context(): any {
    return this.lease ? new Map([["lease", this.lease.id]]) : undefined;
  }

  private async send(v: number, w: number): Promise<void> {
    this.outstanding = true;
    try {
      await this.acquire();
      // Taking the lease may have lasted: the intent may be over.
      if (this.deadMan.isMoving) await this.base.proxy.setVelocity(v, w, this.context());
    } catch (failure) {
      if (failure instanceof avm.LeaseRefused) this.lease = null;
      this.deadMan.bar(this.refusal(failure));
    } finally {
      this.outstanding = false;
    }
  }

  private refusal(failure: any): string {
    if (failure instanceof avm.LeaseRefused && failure.holder?.held) return `${failure.holder.client} drives`;
    return describe(failure);
  }

  /** One zero, and the lease is given back. */
  private async halt(): Promise<void> {
    const context = this.context(), lease = this.lease;
    this.lease = null;
    try {
      await this.base.proxy.setVelocity(0, 0, context);
      if (lease) await this.base.proxy.release(lease.id);
    } catch {
      // The watchdog of the base stops it.
    }
  }

  /** STOP: whoever drives. */
  async stop(): Promise<string> {
    this.deadMan.bar("stopped");
    this.lease = null;
    try {
      await this.base.proxy.stop();
    } catch (failure) {
      if (!(failure instanceof Ice.OperationNotExistException)) throw failure;
      await this.base.proxy.setVelocity(0, 0);
    }
    return "stopped";
  }

  /** Who drives, once a second. */
  async look(): Promise<void> {
    if (!this.hasLease) return;
    try {
      const h = await this.base.proxy.holder();
      this.info = {held: h.held, client: h.client, priority: h.priority, implicit: h.implicit, remainingS: h.remainingS,
        mine: h.held && this.lease !== null && h.client === this.client};
      this.publish({kind: "lease", lease: this.info});
    } catch (failure) {
      if (failure instanceof Ice.OperationNotExistException) this.hasLease = false;
      else throw failure;
    }
  }
}
