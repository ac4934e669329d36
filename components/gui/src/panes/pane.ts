// What every pane is.
import {effect} from "@preact/signals-core";
import type {Store} from "../state/store";
import {h} from "./dom";

export abstract class Pane {
  readonly element: HTMLElement;
  protected visible = false;
  private readonly endings: (() => void)[] = [];

  constructor(protected readonly store: Store, readonly name: string) {
    this.element = h("section", {class: `pane pane-${name}`, attrs: {"aria-label": name}});
  }

  /** Runs now and whenever a signal that it reads changes, while the pane is visible. */
  protected follow(work: () => void): void {
    this.endings.push(effect(work));
  }

  protected whenDone(ending: () => void): void { this.endings.push(ending); }

  /** The dock shows or hides the pane. */
  setVisible(visible: boolean): void {
    this.visible = visible;
    this.onVisible();
  }
  protected onVisible(): void {}

  dispose(): void {
    for (const ending of this.endings) ending();
  }
}
