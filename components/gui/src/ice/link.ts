// The communicator, one peer per object, and loops that outlive every loss of a peer.
/* eslint-disable @typescript-eslint/no-explicit-any */
import {avmModule, IceRuntime, jderobotModule} from "virtual:slice";
import {nowMs} from "../shared/messages";
import type {LinkInfo} from "../shared/state";

export const Ice: any = IceRuntime;
export const avm: any = avmModule;
export const jderobot: any = jderobotModule;

/** -1 and the smallest long, which Ice.Long takes only as words of 32 bits. */
export const minusOne = () => new Ice.Long(0xffffffff, 0xffffffff);
export const smallestLong = () => new Ice.Long(0x80000000, 0);
export function longOf(value: number): any {
  return value < 0 ? minusOne() : new Ice.Long(Math.floor(value / 4294967296), value % 4294967296 >>> 0);
}

export const sleep = (ms: number) => new Promise<void>(resolve => setTimeout(resolve, ms));

/** What an exception of a call says, for people. */
export function describe(failure: any): string {
  if (failure instanceof avm.Failure) return failure.reason;
  if (failure instanceof Ice.ConnectionRefusedException || failure instanceof Ice.ConnectFailedException) return "connection refused";
  if (failure instanceof Ice.InvocationTimeoutException) return "no answer in time";
  if (failure instanceof Ice.OperationNotExistException) return `not allowed or not known: ${failure.operation ?? "operation"}`;
  if (failure instanceof Ice.ObjectNotExistException) return "the server has no such object";
  if (failure instanceof Ice.ConnectionLostException || failure instanceof Ice.CloseConnectionException) return "connection lost";
  const name = failure?.ice_name ? failure.ice_name().replace(/^::Ice::/, "") : failure?.message;
  return String(name || failure);
}

const pauses = [200, 500, 1000];

/** One object of the robot, and whether it answers. */
export class Peer {
  readonly info: LinkInfo;
  private failures = 0;

  constructor(name: string, readonly proxy: any, private readonly changed: () => void) {
    this.info = {name, connected: false, message: "not yet", since: nowMs()};
  }

  good(): void {
    this.failures = 0;
    if (this.info.connected) return;
    Object.assign(this.info, {connected: true, message: "", since: nowMs()});
    this.changed();
  }

  /** Notes a failed call. @return how long to wait before the next one [ms]. */
  bad(failure: unknown): number {
    const message = describe(failure);
    if (this.info.connected || this.info.message !== message) {
      Object.assign(this.info, {since: this.info.connected || this.failures === 0 ? nowMs() : this.info.since, connected: false, message});
      this.changed();
    }
    const pause = pauses[Math.min(this.failures++, pauses.length - 1)]!;
    return pause * (0.8 + 0.4 * Math.random());
  }
}

export class Link {
  readonly peers = new Map<string, Peer>();
  running = true;
  private readonly communicator: any;

  constructor(private readonly changed: (links: LinkInfo[]) => void) {
    const data = new Ice.InitializationData();
    data.properties = Ice.createProperties();
    data.properties.setProperty("Ice.MessageSizeMax", "16384");
    data.properties.setProperty("Ice.Default.InvocationTimeout", "3000");
    data.properties.setProperty("Ice.RetryIntervals", "-1");
    // A server that vanished without a word is noticed by the calls' own timeout; an idle connection is kept.
    data.properties.setProperty("Ice.ACM.Close", "0");
    this.communicator = Ice.initialize(data);
  }

  /** @param connection a name of its own keeps an object's answers from waiting behind others of the same endpoint. */
  add(name: string, proxyText: string, type: any, connection?: string): Peer {
    let proxy = type.uncheckedCast(this.communicator.stringToProxy(proxyText));
    if (connection) proxy = proxy.ice_connectionId(connection);
    const peer = new Peer(name, proxy, () => this.changed([...this.peers.values()].map(p => ({...p.info}))));
    this.peers.set(name, peer);
    return peer;
  }

  /** Calls `step` again and again; a failure is noted and followed by a pause. */
  async loop(peer: Peer, step: () => Promise<void>): Promise<void> {
    while (this.running) {
      try {
        await step();
        peer.good();
      } catch (failure) {
        if (!(failure instanceof Ice.Exception || failure instanceof avm.Failure)) console.error("stream", peer.info.name, failure);
        await sleep(peer.bad(failure));
      }
    }
  }

  async close(): Promise<void> {
    this.running = false;
    await this.communicator.destroy();
  }
}
