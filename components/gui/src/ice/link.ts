// The communicator, one peer per object, and loops that outlive every loss of a peer.
/* eslint-disable @typescript-eslint/no-explicit-any */
import {avmModule, Glacier2Module, IceRuntime, jderobotModule} from "virtual:slice";
import {nowMs} from "../shared/messages";
import type {LinkInfo} from "../shared/state";

export const Ice: any = IceRuntime;
export const avm: any = avmModule;
export const jderobot: any = jderobotModule;
const Glacier2: any = Glacier2Module;

/** -1 and the smallest long, which Ice.Long takes only as words of 32 bits. */
export const minusOne = () => new Ice.Long(0xffffffff, 0xffffffff);
export const smallestLong = () => new Ice.Long(0x80000000, 0);
export function longOf(value: number): any {
  return value < 0 ? minusOne() : new Ice.Long(Math.floor(value / 4294967296), value % 4294967296 >>> 0);
}

export const sleep = (ms: number) => new Promise<void>(resolve => setTimeout(resolve, ms));

/** What an exception of a call says, for people. */
export function describe(failure: any): string {
  if (failure instanceof avm.Failure || failure instanceof Glacier2.PermissionDeniedException) return failure.reason;
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

  /** @param renew the proxy for a communicator. */
  constructor(name: string, public proxy: any, readonly renew: (communicator: any) => any, private readonly changed: () => void) {
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

function makeCommunicator(): any {
  const data = new Ice.InitializationData();
  data.properties = Ice.createProperties();
  data.properties.setProperty("Ice.MessageSizeMax", "16384");
  data.properties.setProperty("Ice.Default.InvocationTimeout", "3000");
  data.properties.setProperty("Ice.RetryIntervals", "-1");
  // A server that vanished without a word is noticed by the calls' own timeout; an idle connection is kept.
  data.properties.setProperty("Ice.ACM.Close", "0");
  return Ice.initialize(data);
}

/** Somebody who logs in at a gateway. */
export interface Login { user: string; password: string }

export const isDenied = (failure: unknown): boolean => failure instanceof Glacier2.PermissionDeniedException;

export class Link {
  readonly peers = new Map<string, Peer>();
  running = true;
  private communicator: any = makeCommunicator();

  /** @param gateway proxy of a router of Glacier2, through which all objects are reached after logIn(); empty: none. */
  constructor(private readonly changed: (links: LinkInfo[]) => void, private readonly gateway = "") {}

  /** Opens a session at the gateway, in place of one that has ended. @param ended called once this one has. */
  async logIn(login: Login, ended: () => void): Promise<void> {
    const communicator = makeCommunicator();
    try {
      const router = Glacier2.RouterPrx.uncheckedCast(communicator.stringToProxy(this.gateway));
      await router.createSession(login.user, login.password);
      const connection = router.ice_getCachedConnection();
      // The router ends a session that is silent for this long; heartbeats keep it.
      connection.setACM(await router.getACMTimeout(), Ice.ACMClose.CloseOff, Ice.ACMHeartbeat.HeartbeatAlways);
      connection.setCloseCallback(ended);
      communicator.setDefaultRouter(router);
    } catch (failure) {
      await communicator.destroy();
      throw failure;
    }
    const old = this.communicator;
    this.communicator = communicator;
    for (const peer of this.peers.values()) peer.proxy = peer.renew(communicator);
    await old.destroy();
  }

  /** @param connection a name of its own keeps an object's answers from waiting behind others of the same endpoint. A gateway's session
   *  has one connection for all. */
  add(name: string, proxyText: string, type: any, connection?: string): Peer {
    const renew = (communicator: any) => {
      const proxy = type.uncheckedCast(communicator.stringToProxy(proxyText));
      return connection && !this.gateway ? proxy.ice_connectionId(connection) : proxy;
    };
    const peer = new Peer(name, renew(this.communicator), renew, () => this.changed([...this.peers.values()].map(p => ({...p.info}))));
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
