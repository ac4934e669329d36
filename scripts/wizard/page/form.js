// The form of a step, made from the arguments that its table declares, and the command line that it stands for.
export const element = (kind, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
};

export const words = (kind, className, textContent) => element(kind, {className, textContent});

/** What was typed so far: step to {chosen, values}. */
const typed = new Map();

const firstOf = names => ("" in names ? "" : Object.keys(names)[0] ?? "");

export function entries(step) {
  const kept = typed.get(step.name) ?? {values: {}, defaults: {}};
  if (!(kept.chosen in step.otherwise)) kept.chosen = firstOf(step.otherwise);
  for (const one of step.arguments) {
    const value = one.kind === "flag" ? false : one.default ?? "";
    // What nobody changed follows the default, such as a key of the setup.
    if (!(one.name in kept.values) || kept.values[one.name] === kept.defaults[one.name]) kept.values[one.name] = value;
    kept.defaults[one.name] = value;
  }
  typed.set(step.name, kept);
  return kept;
}

/** Whether every field holds what it may; says where not. */
export function isFilledIn(host) {
  const wrong = host.querySelector("input:invalid");
  wrong?.closest("details")?.setAttribute("open", "");
  wrong?.reportValidity();
  return !wrong;
}

const isShown = (one, step, chosen) =>
  one.name in step.otherwise ? one.name === chosen : one.goes_with.length === 0 || one.goes_with.includes(chosen);

/** The arguments as the server takes them: what is left at the command line's default is not sent. */
export function given(step) {
  const {chosen, values} = entries(step), sent = {};
  for (const one of step.arguments) {
    if (!isShown(one, step, chosen)) continue;
    const value = one.kind === "flag" && one.name in step.otherwise ? true : values[one.name];
    const isNamed = one.name.startsWith("--");
    if (value === "" || value === false) continue;
    if (isNamed && !(one.name in step.otherwise) && one.is_default && String(value) === String(one.default)) continue;
    sent[one.name] = value;
  }
  return sent;
}

const quoted = word => /^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;

export function commandLine(robot, step, sent = given(step)) {
  const line = Object.entries(sent).map(([name, value]) => value === true ? name : name.startsWith("--") ? `${name}=${value}` : value);
  return ["scripts/own_robot", robot, step.name, ...line].map(word => quoted(String(word))).join(" ");
}

/** Whether the steps before matter, as the form stands. */
export const missing = step => step.unless.some(name => name in given(step)) ? [] : step.missing;

function field(one, step, changed, send) {
  const {values} = entries(step), id = `${step.name}${one.name}`;
  const keep = value => { values[one.name] = value; changed(); };
  if (one.kind === "flag") {
    const box = element("input", {type: "checkbox", id, checked: values[one.name]});
    box.onchange = () => keep(box.checked);
    return element("label", {className: "field check"}, box, element("span", {}, element("b", {textContent: one.name.replace(/^--/, "")}), ` ${one.about}`));
  }
  const number = one.kind === "whole" || one.kind === "number";
  let input;
  if (one.kind === "choice") {
    input = element("select", {id});
    if (one.default === null) input.append(element("option", {value: "", textContent: "-"}));
    input.append(...one.choices.map(choice => element("option", {value: choice, textContent: choice})));
    input.value = values[one.name];
    input.onchange = () => keep(input.value);
  } else {
    input = element("input", {id, type: number ? "number" : "text", value: values[one.name], autocomplete: "off", spellcheck: false});
    if (number) Object.assign(input, {min: 0, step: one.kind === "whole" ? 1 : "any", required: !one.name.startsWith("--")});
    else if (one.kind === "path" || one.kind === "file") input.placeholder = "path, from the project's folder or from /";
    input.oninput = () => keep(input.value.trim());
  }
  const row = element("span", {className: "entry"}, input);
  const possible = one.kind === "choice" ? [] : [...one.choices, ...one.found];
  if (possible.length > 0) {
    const list = element("datalist", {id: `${id}-found`}, ...possible.map(value => element("option", {value})));
    input.setAttribute("list", list.id);
    row.append(list);
  }
  if (one.kind === "file") {
    const pick = element("input", {type: "file", className: "hidden", id: `${id}-pick`});
    const button = element("button", {type: "button", className: "button", textContent: "choose a file ..."});
    button.onclick = () => pick.click();
    pick.onchange = async () => {
      if (pick.files.length === 0) return;
      const path = await send(pick.files[0]);
      if (path) { input.value = path; keep(path); }
      pick.value = "";
    };
    row.append(button, pick);
  }
  const label = one.label || one.name.replace(/^--/, "").replaceAll(".", ".\u200b");
  return element("label", {className: "field", htmlFor: id}, element("b", {textContent: label}), row, words("span", "dim", one.about));
}

function alternatives(step, changed) {
  const names = Object.entries(step.otherwise), state = entries(step);
  if (names.length < 2) return [];
  const box = element("fieldset", {className: "alternatives"}, element("legend", {className: "only-read", textContent: "which"}));
  for (const [name, meaning] of names) {
    const radio = element("input", {type: "radio", name: `${step.name}-which`, value: name, checked: name === state.chosen});
    radio.onchange = () => { state.chosen = name; changed(true); };
    box.append(element("label", {className: "alternative"}, radio, element("span", {textContent: meaning})));
  }
  return [box];
}

/** @param changed(isOther): a value changed, or (true) which fields there are. @param send(file): resolves to its path. */
export function drawForm(host, step, changed, send) {
  const shown = step.arguments.filter(one => isShown(one, step, entries(step).chosen) && one.name !== step.apply);
  const fields = shown.filter(one => !(one.kind === "flag" && one.name in step.otherwise));
  const isMinor = one => one.minor && one.kind !== "key";
  const major = fields.filter(one => !isMinor(one)).map(one => field(one, step, changed, send));
  const minor = fields.filter(isMinor);
  const kept = entries(step);
  kept.isOpen ??= minor.some(one => String(one.default ?? "") !== "" && !one.is_default);
  host.replaceChildren(...alternatives(step, changed), ...major);
  if (minor.length > 0) {
    const rows = minor.map(one => field(one, step, changed, send));
    const more = element("details", {className: "more", open: kept.isOpen}, element("summary", {textContent: "more"}), ...rows);
    more.ontoggle = () => { kept.isOpen = more.open; };
    host.append(more);
  }
}
