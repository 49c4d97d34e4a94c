// A display's values as a form: a text with its unit, a slider beside it, its source on hover.

import { GLOSSARY } from "./glossary.js";
import { element, split } from "./numbers.js";

const SPAN = 3;
const STEPS = 400;

const TITLES = {
  "": "Display", actuator: "Body", "actuator.substrate": "Substrate", "actuator.ceramic": "Ceramic",
  "actuator.glue": "Glue", drive: "Drive", finger: "Finger", gas: "Gas",
};
const OPEN = new Set(["actuator", "drive", "finger"]);

/** Fill `place` from the rows of `form`; sections that were open stay open, focus stays. */
export function displayForm(place, rows, { write, forget, slide, unwritten, refused, notes }) {
  const opened = new Map([...place.querySelectorAll("details")].map((one) => [one.dataset.section, one.open]));
  const focus = document.activeElement?.dataset?.path, kind = document.activeElement?.type;
  const sections = new Map();
  for (const row of rows) {
    if (!sections.has(row.section)) sections.set(row.section, []);
    sections.get(row.section).push(row);
  }
  place.replaceChildren();
  for (const [section, members] of [...sections].sort(([a], [b]) => rank(a) - rank(b))) {
    const box = element("details", { "data-section": section, open: opened.get(section) ?? OPEN.has(section) },
      element("summary", { text: title(section, rows) }), ...members.map((row) => field(row, { write, forget, slide })));
    place.append(box);
  }
  for (const [path, note] of notes) place.querySelector(`[data-path="${CSS.escape(path)}"]`)?.closest(".field").append(note);
  // What was typed and could not be written stays, and is said.
  for (const [path, message] of [...[...unwritten.keys()].map((path) => [path, "not written yet"]), ...refused]) {
    const control = place.querySelector(`[data-path="${CSS.escape(path)}"]:not([type=range])`);
    if (!control) continue;
    if (unwritten.has(path)) control.value = unwritten.get(path);
    mark(control, document.getElementById(`${control.id}-wrong`), message);
  }
  if (focus) place.querySelector(`[data-path="${CSS.escape(focus)}"][type="${kind}"]`)?.focus();
}

function rank(section) {
  const order = ["actuator", "drive", "finger", "surfaces", "actuator.substrate", "actuator.ceramic", "gas", ""];
  const at = order.findIndex((one) => (one && section.startsWith(`${one}.`)) || section === one);
  const exact = order.indexOf(section);
  return (exact >= 0 ? exact : at >= 0 ? at + 0.5 : 99) + (section.includes("patches") ? 20 : 0);
}

function title(section, rows) {
  if (section in TITLES) return TITLES[section];
  const [, group, count] = /(\w+)\.(\d+)$/.exec(section) ?? [];
  if (group === "surfaces") return `Surface: ${rows.find((row) => row.path === `${section}.name`)?.text}`;
  if (group === "patches") return `Ceramic patch ${Number(count) + 1}`;
  return section.replace("actuator.", "").replaceAll("_", " ").replaceAll(".", " ");
}

function field(row, { write, forget, slide }) {
  const id = `f-${row.path.replaceAll(".", "-")}`;
  const mark = { assumed: " *", unstated: " ?" }[row.evidence];
  const tip = row.name in GLOSSARY || row.source ? row.name : null;
  const label = element("label", { for: id, "data-tip": tip, "data-source": row.source || null },
    row.name.replaceAll("_", " "), mark ? element("span", { class: "mark", title: `${row.evidence}: ${row.source || "no source"}`, text: mark }) : null);
  const source = row.source ? element("small", { class: "source", text: `${row.evidence}: ${row.source}` }) : null;
  if (row.name === "type") return null;
  if (row.choices) {
    const list = element("select", { id, "data-path": row.path },
      ...row.choices.map((one) => element("option", { value: one, text: one, selected: one === row.text })));
    const { wrong, commit } = committed(list, row, write, forget);
    list.addEventListener("change", commit);
    return element("div", { class: "field" }, label, list, wrong, source);
  }
  const text = element("input", { id, type: "text", value: row.text, "data-path": row.path, spellcheck: "false", autocomplete: "off" });
  const { wrong, commit } = committed(text, row, write, forget);
  text.addEventListener("change", commit);
  const parts = row.unit === null || row.whole ? null : split(row.text);
  let range = null;
  if (parts && parts.number !== 0) {
    range = element("input", { type: "range", min: -STEPS, max: STEPS, value: 0, "data-path": row.path, "aria-label": `${row.name.replaceAll("_", " ")}, a third to three times ${row.text}` });
    const shown = () => {
      const value = parts.number * SPAN ** (range.value / STEPS);
      return `${Number(value.toPrecision(4))}${parts.unit ? ` ${parts.unit}` : ""}`;
    };
    range.addEventListener("input", () => {
      text.value = shown();
      slide(row.path, text.value);
    });
    range.addEventListener("change", commit);
  }
  return element("div", { class: "field" }, label, text, range, wrong, source);
}

/** What writes a control's value, and where a refusal is said: beside it, until it holds what may be. */
function committed(control, row, write, forget) {
  const wrong = element("p", { class: "error", role: "alert", id: `${control.id}-wrong`, hidden: true });
  control.setAttribute("aria-describedby", wrong.id);
  const commit = async () => {
    const same = control.value === row.text;
    if (same) forget(row.path);
    const refused = same ? "" : await write(row.path, control.value);
    mark(control, wrong, refused);
  };
  return { wrong, commit };
}

/** Say beside a control why its value is not the display's; nothing where it is. */
function mark(control, wrong, message) {
  control.setAttribute("aria-invalid", String(message !== ""));
  wrong.textContent = message;
  wrong.hidden = message === "";
}
