// The wizard's page: what the server says of the steps, the step that is looked at, and what its run says.
import {commandLine, drawForm, element, entries, given, isFilledIn, missing, words} from "./form.js";
import {drawChanges, drawResults, failureOf, lineOf, sorted, wantsApply} from "./results.js";

const $ = id => document.getElementById(id);
const SIGNS = {done: "✓", old: "↻", none: "–", any: "•", on: "●", "-": "", runs: "▶"};
const WORDS = {done: "done", old: "to be repeated", none: "not needed", any: "at any time", on: "runs", "-": "not done yet", runs: "runs"};
const KINDS = {none: "no setup yet", own: "a robot of your own", simulated: "a simulated robot", uncalibrated: "a simulated robot, not calibrated"};
const SHORT = 12;  // lines that need no click to be seen
let state = null, selected = null, ahead_s = 0, note = "";
/** Lines of the newest run of each step: {number, lines}. */
const outputs = new Map();
/** What is drawn already, so that nothing is drawn anew below the fingers. */
const drawn = {};

const stepOf = name => state.steps.find(step => step.name === name);
const isRunning = step => state.running?.step === step.name;
const stateOf = step => isRunning(step) ? "runs" : step.state;
const changed = (what, value) => {
  const text = JSON.stringify(value);
  if (drawn[what] === text) return false;
  drawn[what] = text;
  return true;
};

function duration(seconds) {
  const whole = Math.max(0, Math.round(seconds));
  return whole < 100 ? `${whole} s` : `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")} min`;
}

async function ask(what, order) {
  note = "";
  try {
    const answer = await fetch(what, {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(order)});
    const said = await answer.json();
    if (!answer.ok && answer.status !== 409) note = said.error;  // what runs is shown anyway
    return answer.ok ? said : null;
  } catch (error) {
    note = `The page's server does not answer (${error.message}).`;
    return null;
  } finally {
    drawRun();
  }
}

async function send(file) {
  const name = file.name.normalize("NFKD").replace(/[^\w. -]+/g, "").replace(/^[^\w]+/, "").slice(-100);  // such as "place (1).clicks"
  const said = await ask("file", {name: name || "file", text: await file.text()});
  return said?.path;
}

/** Steps. */

const wordFor = (word, isNext) => isNext && word !== "runs" ? "next" : WORDS[word];

function drawSteps() {
  const rows = state.steps.map(step => [step.name, step.title, stateOf(step), state.next === step.name, selected === step.name]);
  if (!changed("steps", rows)) return;
  const focused = document.activeElement?.dataset?.step;
  $("steps").replaceChildren(...rows.map(([name, title, word, isNext, isSelected]) => {
    const sign = element("span", {className: "sign", textContent: SIGNS[word] || (isNext ? "→" : "○"), ariaHidden: "true"});
    const button = element("button", {type: "button"}, sign, words("span", "title", title), words("span", "word", wordFor(word, isNext)));
    Object.assign(button.dataset, {step: name, state: word, next: isNext});
    if (isSelected) button.setAttribute("aria-current", "step");
    button.onclick = () => select(name);
    return element("li", {}, button);
  }));
  if (focused) $("steps").querySelector(`[data-step="${focused}"]`)?.focus();
  $("steps").querySelector("[aria-current]")?.scrollIntoView({block: "nearest", inline: "nearest"});
}

function select(name) {
  if (selected !== name) {
    note = "";
    scrollTo({top: 0});
  }
  selected = name;
  history.replaceState(null, "", `#${name}`);
  draw();
}

/** By a button that is gone then. */
function follow(name) {
  select(name);
  $("detail").focus();
}

/** The step that is looked at. */

function goTo(name) {
  const button = element("button", {type: "button", className: "button", textContent: stepOf(name).title});
  button.onclick = () => follow(name);
  return button;
}

function drawAbout(step) {
  const word = stateOf(step), before = missing(step);
  const robot = step.wants_robot.includes(entries(step).chosen) && step.state !== "none" ? stepOf("robot") : null;
  if (!changed("about", [robot?.how, step.name, step.title, step.does, step.needs, step.how, step.notes, word, state.next === step.name, before])) return;
  const rows = [["needs", step.needs], [step.state === "none" ? "why" : step.name === "robot" ? "runs" : "how", step.how]].filter(([, text]) => text);
  if (word === "old") rows.push(["why", `what it was made from is newer: ${step.after.map(name => stepOf(name).title).join(" or ")}`]);
  $("about").replaceChildren(
    element("h1", {}, step.title, " ", words("span", "badge", wordFor(word, state.next === step.name))),
    element("p", {textContent: sentence(step.does)}),
    element("dl", {}, ...rows.flatMap(([name, text]) => [element("dt", {textContent: name}), element("dd", {textContent: text})])));
  $("about").querySelector(".badge").dataset.state = word;
  if (robot) {
    const said = robot.state === "on" ? ["The robot runs: ", robot.how, ". "] : ["Nothing of the robot runs. To start it: "];
    $("about").append(element("p", {className: robot.state === "on" ? "" : "first"}, ...said, goTo("robot")));
  }
  if (step.notes && word !== "none") $("about").append(element("pre", {className: "notes", textContent: step.notes}));
  if (before.length > 0 && word !== "none") {
    $("about").append(element("p", {className: "first"}, "Comes first: ", ...before.map(goTo)));
  }
}

/** Whether it can be run: not what is not needed, and some things only once. */
const isOffered = step => step.state !== "none" && !(step.is_once && step.state === "done");
const sentence = text => text ? text[0].toUpperCase() + text.slice(1) + "." : "";

function drawStepForm(step, isOther = false) {
  const isNeeded = isOffered(step);
  if (isOther || changed("form", [step.name, step.arguments, step.otherwise, isNeeded])) {
    const focused = document.activeElement?.id;
    $("form").replaceChildren();
    if (isNeeded) drawForm($("form"), step, also => { drawStepForm(stepOf(step.name), also === true); drawAbout(stepOf(step.name)); drawRun(); }, send);
    $("form").append(element("p", {className: "command"}, element("code", {id: "command"})));
    $("form").append(element("p", {className: "buttons", id: "buttons"}));
    drawn.buttons = null;
    if (isOther) $("form").querySelector("input[type=radio]:checked")?.focus();
    else if (focused) $(focused)?.focus();
  }
  $("command").textContent = isNeeded ? commandLine(state.name, stepOf(step.name)) : "";
}

/** A button; one that is off keeps the focus. A double click counts once. */
function pressable(id, text, isPrimary, isOff, press) {
  const button = element("button", {type: "button", id, className: isPrimary ? "button primary" : "button", textContent: text, ariaDisabled: String(isOff)});
  button.onclick = async () => {
    if (isOff) return;
    isOff = true;
    await press();
    isOff = false;
  };
  return button;
}

function drawButtons(step, lines) {
  const isBusy = state.running !== null, before = missing(step), wasRun = step.last !== null;
  const apply = step.apply && wasRun && step.last.code === 0 && !isRunning(step) && wantsApply(lines);
  const shown = [step.name, step.state, isBusy, before, step.last?.code, apply, state.next, step.leads_to];
  if (!changed("buttons", shown)) return;
  const focused = document.activeElement?.id;
  const isThrough = step.state === "done" || (step.name !== "robot" && step.state === "any" && step.last?.code === 0);
  const following = isThrough && state.next ? step.leads_to || state.next : step.name, goesOn = following !== step.name;
  const start = pressable("start", ["done", "old"].includes(step.state) ? "Repeat this step" : "Run this step", !goesOn && !apply,
    isBusy || before.length > 0, () => isFilledIn($("form")) && ask("run", {step: step.name, arguments: given(step)}));
  $("buttons").replaceChildren(...isOffered(step) ? [start] : []);
  if (apply) {
    const {"--again": _, ...same} = given(step);  // of the same views
    $("buttons").append(pressable("apply", "Apply these changes", true, isBusy, () => ask("run", {step: step.name, arguments: {...same, [step.apply]: true}})));
  }
  if (goesOn) $("buttons").append(pressable("next", `Next: ${stepOf(following).title} →`, !apply, false, () => follow(following)));
  if (!state.next && step.name === "localize")
    $("buttons").append(element("span", {}, "All is done. The robot with its map, in a terminal: ", element("code", {textContent: state.next_command})));
  if (isBusy && !isRunning(step)) $("buttons").append(words("span", "dim", `${stepOf(state.running.step).title} runs: one step at a time.`));
  if (focused) $(focused)?.focus();
}

function verdictOf(step, lines) {
  const {code, seconds, began} = step.last, when = new Date(1000 * began).toLocaleString();
  if (code === 0) return element("p", {className: "verdict", role: "status"}, `Succeeded in ${duration(seconds)} (${when}).`);
  const said = failureOf(lines), isStopped = code === 130 || code < 0;
  const box = element("div", {className: "verdict", role: "alert"}, element("b", {textContent: isStopped ? "Stopped" : "Did not succeed"}),
    ` after ${duration(seconds)} (${when}), exit code ${code}.`);
  box.dataset.level = isStopped ? "warning" : "bad";
  for (const line of said) box.append(words("div", "said", line));
  return box;
}

function drawRun() {
  const step = stepOf(selected), output = outputs.get(step.name), lines = output?.lines ?? [];
  drawButtons(step, lines);
  const run = $("run"), isNow = isRunning(step);
  if ([changed("note", note), changed("run", [step.name, step.last, isNow, output?.number])].includes(true)) {
    run.replaceChildren();
    run.append(element("div", {id: "note", role: "alert", className: note ? "verdict" : "hidden", textContent: note}));
    $("note").dataset.level = "bad";
    const bar = element("progress", {id: "bar", max: 1, ariaLabel: step.title});
    if (isNow) run.append(element("div", {className: "progress"}, bar, element("span", {id: "progress"})));
    else if (step.last && !note && output?.number === step.last.number) run.append(verdictOf(step, lines));
    run.append(element("p", {id: "pages"}));
    drawn.pages = null;
    const isOpen = isNow || (step.last !== null && step.last.code !== 0) || sorted(lines).said.length <= SHORT;
    $("said").replaceChildren(element("div", {id: "changes"}), element("details", {id: "log-box", className: "log", open: isOpen},
      element("summary", {textContent: "what it said"}), element("div", {id: "log", tabIndex: 0, role: "log"})));
    drawn.changes = null;
    drawn.lines = 0;
  }
  if (isNow) drawProgress();
  const pages = step.last?.code ? [] : lines.map(line => /^page (http:\S+)$/.exec(line)?.[1]).filter(Boolean).slice(-1);
  const linkOf = href => element("a", {href, target: "_blank", rel: "noopener", className: "button", textContent: `The robot's page: ${href}`});
  if (changed("pages", pages)) $("pages").replaceChildren(...pages.map(linkOf));
  const {said, changes} = sorted(lines);
  if (changed("changes", [step.name, changes])) drawChanges($("changes"), changes);
  appendLines(said);
}

function appendLines(said) {
  const log = $("log"), isAtEnd = log.scrollTop + log.clientHeight > log.scrollHeight - 30;
  if (said.length < drawn.lines) log.replaceChildren();
  log.append(...said.slice(said.length < drawn.lines ? 0 : drawn.lines).map(lineOf));
  drawn.lines = said.length;
  $("log-box").classList.toggle("hidden", said.length === 0);
  if (isAtEnd) log.scrollTop = log.scrollHeight;
}

function drawProgress() {
  const {progress, began} = state.running, bar = $("bar");
  if (progress?.all) { bar.max = progress.all; bar.value = progress.done; } else bar.removeAttribute("value");
  $("progress").textContent = `${progress?.text ?? "under way"} (for ${duration(Date.now() / 1000 + ahead_s - began)})`;
}

async function fetchOutput(step) {
  if (!step.last || outputs.get(step.name)?.number === step.last.number) return;
  const said = await (await fetch(`output/${step.name}`)).json();
  const held = outputs.get(step.name);
  if (said && !(held?.number === said.number && held.lines.length > said.lines.length)) outputs.set(step.name, {number: said.number, lines: said.lines});
  drawn.run = null;
  draw();
}

/** The whole page. */

function drawBar() {
  const steps = state.steps.filter(step => !["none", "any", "on"].includes(step.state));
  $("robot").textContent = state.name;
  $("kind").textContent = KINDS[state.kind];
  $("count").textContent = `${steps.filter(step => step.state === "done").length} of ${steps.length} done`;
  const running = state.running, step = running && stepOf(running.step);
  $("runs").textContent = running ? `${step.title} runs, ${duration(Date.now() / 1000 + ahead_s - running.began)}` : "";
  const share = running?.progress?.all ? `${Math.floor(100 * running.progress.done / running.progress.all)} % ` : "";
  document.title = running ? `${share}${step.title}: ${state.name}` : `${state.name}: own robot`;  // also seen from another tab
  $("stop").classList.toggle("hidden", !running);
  if (running) {
    const texts = [step.ctrl_c === "stop" ? "STOP" : `STOP: ${step.ctrl_c}`, "STOP at once", "KILL: what it started may go on"];
    $("stop").textContent = texts[Math.min(running.stops, 2)];
    if (running.stops > 0) $("runs").textContent += ", it is being stopped";
  }
}

function draw() {
  if (!state) return;
  const step = stepOf(selected) ?? stepOf(selected = stepOf(location.hash.slice(1))?.name ?? state.running?.step ?? state.next ?? "localize");
  drawBar();
  drawSteps();
  drawAbout(step);
  drawStepForm(step);
  drawRun();
  if (changed("results", [step.name, step.results])) drawResults($("results"), step);
  $("detail").classList.toggle("alone", step.results.length === 0);
  fetchOutput(step).catch(() => {});
}

function warn(text) {
  $("gone").textContent = text;
  $("gone").classList.remove("hidden");
}

function listen() {
  const events = new EventSource("events");
  events.addEventListener("state", event => {
    state = JSON.parse(event.data);
    ahead_s = state.now - Date.now() / 1000;
    $("gone").classList.add("hidden");
    draw();
  });
  events.addEventListener("elsewhere", () => {
    events.close();
    warn("This page was opened again elsewhere, too many times to show them all: reload it to go on here.");
  });
  events.addEventListener("trouble", event => warn(JSON.parse(event.data).text));
  events.addEventListener("lines", event => {
    const {number, step, from, lines} = JSON.parse(event.data);
    const held = outputs.get(step), before = held?.number === number ? held.lines.slice(0, from) : [];
    outputs.set(step, {number, lines: [...before, ...lines]});
    if (state && step === selected) drawRun();
  });
  events.onerror = () => {
    const again = `scripts/own_robot ${state?.name ?? "NAME"} page`;
    warn(`The page's server has ended or does not answer. ${again} starts it again, with a new address.`);
  };
}

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  localStorage.setItem("theme", theme);
}

setTheme(localStorage.getItem("theme") ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark"));
$("theme").onclick = () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
$("stop").onclick = () => ask("stop", {});
addEventListener("hashchange", () => { if (state && stepOf(location.hash.slice(1))) select(location.hash.slice(1)); });
setInterval(() => { if (state?.running) { drawBar(); if (isRunning(stepOf(selected))) drawProgress(); } }, 1000);
listen();
