// What a step said and made: its lines, changed files, pictures and figures.
import {element, words} from "./form.js";

const ADDRESS = /(http:\/\/127\.0\.0\.1:\d+\/\S*)/;

/** Differences of files as blocks of their own, other lines as they came. */
export function sorted(lines) {
  const said = [], changes = [];
  let block = null;
  for (const line of lines) {
    const begins = /^\+\+\+ (\S+)/.exec(line) ?? /^Changes of (\S+):$/.exec(line);
    if (begins) {
      block = {file: begins[1], lines: []};
      changes.push(block);
    } else if (/^--- \S+/.test(line)) {
      block = null;
    } else if (block && /^[-+@ ]/.test(line)) {
      block.lines.push(line);
    } else {
      block = null;
      said.push(line);
    }
  }
  return {said, changes};
}

export const wantsApply = lines => lines.some(line => line.startsWith("Nothing was written: add --write"));

/** The program's own words on why it failed. */
export function failureOf(lines) {
  const said = lines.filter(line => line.trim() && !line.startsWith("{"));
  const own = said.filter(line => /^own_robot: |: error: /.test(line));
  const before = said.filter(line => !own.includes(line) && !/^(usage: |next: | )/.test(line)).slice(-3);
  return own.length > 0 ? (own.at(-1).match(/see above/) ? [...before, ...own.slice(-1)] : own.slice(-1)) : before;
}

export function lineOf(text) {
  if (/^\{.*\}$/.test(text)) {
    const box = element("details", {className: "json"}, element("summary", {textContent: "figures as JSON"}));
    try {
      box.append(element("pre", {textContent: JSON.stringify(JSON.parse(text), null, 1)}));
      return box;
    } catch { /* a line like any other */ }
  }
  const parts = text.split(ADDRESS).map(part => ADDRESS.test(part) ? element("a", {href: part, target: "_blank", rel: "noopener", textContent: part}) : part);
  const kind = /^(own_robot: |.*\berror: )/.test(text) ? " bad" : /^(warning|Note)\b/.test(text) ? " warning" : "";
  return element("div", {className: `line${kind}`}, ...parts);
}

export function drawChanges(host, changes) {
  host.replaceChildren(...changes.map(({file, lines}) => {
    const count = lines.filter(line => /^[-+]/.test(line)).length;
    const rows = lines.map(line => words("div", {"+": "added", "-": "removed"}[line[0]] ?? "dim", line || " "));
    const summary = element("summary", {}, element("b", {textContent: file}), ` ${count} ${count === 1 ? "line" : "lines"}`);
    return element("details", {className: "change", open: changes.length < 3}, summary,
      element("div", {className: "difference", tabIndex: 0, role: "group", ariaLabel: file}, ...rows));
  }));
}

const rounded = value => typeof value !== "number" ? String(value) : Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(4)));

/** A quantity to two digits of its standard deviation. */
function measured({value, sigma, unit}) {
  const decimals = sigma > 0 ? Math.min(7, Math.max(0, 1 - Math.floor(Math.log10(sigma)))) : 3;
  return `${value.toFixed(decimals)} ± ${sigma.toFixed(decimals)} ${unit}`;
}

/** Rows of a report: plain values, and quantities {value, sigma, unit}; lists of numbers are left to the file. */
export function rowsOf(report) {
  const rows = [];
  for (const [name, value] of Object.entries(report)) {
    const [, title, unit] = /^(.*?)(?:_(m|mm|deg|s|px))?$/.exec(name).map(part => (part ?? "").replaceAll("_", " "));
    if (value !== null && typeof value === "object" && "unit" in value)
      rows.push([name, value.observable === false ? "not observable" : measured(value)]);
    else if (Array.isArray(value)) {
      if (value.length > 0 && value.every(one => typeof one === "string")) rows.push([title, value.join("; ")]);
    } else if (value !== null && typeof value === "object") rows.push([title, null], ...rowsOf(value));
    else rows.push([title, `${rounded(value)} ${unit}`.trim()]);
  }
  return rows.filter(([, value], index) => value !== null || rows[index + 1]?.[1] !== null && index + 1 < rows.length);
}

async function figures(address, caption) {
  const report = await (await fetch(address)).json();
  const rows = rowsOf(report).map(([name, value]) => value === null
    ? element("tr", {}, element("th", {colSpan: 2, className: "part", textContent: name}))
    : element("tr", {}, element("th", {textContent: name}), element("td", {textContent: value === "true" ? "yes" : value === "false" ? "no" : value})));
  return element("figure", {}, element("figcaption", {}, element("a", {href: address, target: "_blank", rel: "noopener", textContent: caption})),
    element("table", {className: "facts"}, ...rows));
}

async function resultOf(step, result) {
  const address = `result/${step.name}/${result.number}/${result.name}?at=${result.at}`;
  const link = element("a", {href: address, target: "_blank", rel: "noopener"});
  if (result.name.endsWith(".png")) {
    link.append(element("img", {src: address, alt: result.caption}));
    return element("figure", {}, link, element("figcaption", {textContent: result.caption}));
  }
  if (result.name === "report.json" || result.name === "verdict.json") return figures(address, `${result.caption}: ${result.name}`);
  link.append(element("b", {textContent: result.caption}), ` ${result.path}`);
  return element("p", {className: "file"}, link);
}

/** Files first, then pictures, then figures. */
export async function drawResults(host, step) {
  const made = await Promise.all(step.results.map(result => resultOf(step, result).catch(error => words("p", "bad", `${result.path}: ${error}`))));
  const order = node => node.tagName === "P" ? 0 : node.querySelector("img") ? 1 : 2;
  made.filter(node => order(node) === 1).slice(1).forEach(node => node.classList.add("further"));
  host.replaceChildren(...made.sort((a, b) => order(a) - order(b)));
}
