// The form in front of a gateway: a user and a password, until the session is open.
import {effect} from "@preact/signals-core";
import {h, say} from "../panes/dom";
import type {Store} from "../state/store";

const words: Record<string, string> = {trying: "Logging in ...", away: "The gateway does not answer; trying again", needed: "", open: "", none: ""};

export function makeLogin(store: Store): HTMLElement {
  const user = h("input", {attrs: {type: "text", name: "user", autocomplete: "username", required: "", "aria-label": "user"}});
  const password = h("input", {attrs: {type: "password", name: "password", autocomplete: "current-password", required: "", "aria-label": "password"}});
  const enter = h("button", {class: "button", text: "log in", attrs: {type: "submit"}});
  const message = h("p", {attrs: {role: "status", "aria-live": "polite"}});
  const form = h("form", {class: "login", attrs: {"aria-label": "log in"}},
    h("h1", {text: store.config.robot || store.config.setup || "robot"}),
    h("p", {text: store.config.viewer ? "as a viewer: you see everything and change nothing" : "as an operator"}),
    user, password, enter, message);
  form.addEventListener("submit", event => {
    event.preventDefault();
    store.send({kind: "logIn", user: user.value, password: password.value});
    password.value = "";
  });
  let opened = false;
  effect(() => {
    const {state, message: why} = store.session.value;
    opened ||= state === "open";
    // A session that is lost later is opened again without the form.
    form.classList.toggle("hidden", state === "none" || opened && state !== "needed");
    enter.disabled = state === "trying" || state === "away";
    say(message, [words[state], why].filter(text => text).join(": "));
  });
  return form;
}
