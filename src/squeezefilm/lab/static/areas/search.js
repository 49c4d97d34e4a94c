// Search: say what the finger should feel, watch a search for the plates that can do it, open any.

import { Age } from "../age.js";
import { FrontView } from "../front_view.js";
import { element, plain } from "../numbers.js";

const KEPT = "squeezefilm requirements";
const SETTLE = 600;
// Criteria that the glossary explains by the same key.
const EXPLAINED = ["relative_friction", "finest_period", "resonance_frequency", "temperature_rise", "made_within"];
// Beside the objectives; the others stand with the plate that the pointer or the focus is on.
const COLUMNS = ["resonance_frequency", "temperature_rise", "mass", "total_thickness"];

export async function show(place, lab) {
  await new SearchView(place, lab).start();
}

class SearchView {
  constructor(place, lab) {
    Object.assign(this, { place, lab, search: null, pointed: null, turn: 0, rows: new Map() });
  }

  async start() {
    this.build();
    const hear = this.lab.socket.on;
    hear("connection", ({ open }) => open && this.begin());
    hear("search", ({ search }) => this.take(search));
    hear("search says", ({ text }) => this.search && this.showState(Object.assign(this.search, { says: text, left: "" })));
    if (this.lab.socket.open) await this.begin();
  }

  build() {
    const count = (id, value, min, max) => element("input", { type: "number", id, value, min, max, step: 1, size: 9 });
    const field = (name, input, tip) => element("label", { class: "stack" }, tip ? element("span", { "data-tip": tip, tabindex: 0, text: name }) : name, input);
    this.choice = element("select", { id: "requirements-choice", onchange: () => this.choose() });
    this.text = element("textarea", { id: "requirements", rows: 16, spellcheck: "false", autocomplete: "off", "aria-describedby": "requirements-error", oninput: () => this.typed() });
    this.error = element("p", { class: "error", id: "requirements-error", role: "alert", hidden: true });
    this.line = element("button", { text: "", hidden: true, onclick: () => this.goToLine() });
    this.asked = element("details", { class: "asked" }, element("summary", { text: "What this asks for" }), this.askedInside = element("div"));
    this.fields = {
      screened: count("screened", 2000, 1, 1000000), solved: count("solved", 120, 0, 100000),
      seed: count("search-seed", 1, 0, 2 ** 53), jobs: count("jobs", 1, 1, 64),
    };
    this.startButton = element("button", { class: "main", text: "Start the search", onclick: () => this.begun() });
    this.startError = element("p", { class: "error", role: "alert", hidden: true });
    this.stage = element("p", { class: "stage", role: "status", text: "No search has been started. The requirements say what the finger should feel, what a display may take and what it may be built from." });
    this.time = element("p", { class: "muted" });
    this.age = new Age(this.lab, "updated");
    const bar = (text) => {
      const progress = element("progress", { max: 1, value: 0, "aria-label": `${text} so far` }), said = element("span", {});
      return { progress, said, box: element("p", { class: "far" }, said, progress) };
    };
    this.far = { screened: bar("screened"), solved: bar("solved") };
    this.stopButton = element("button", { text: "Stop", hidden: true, onclick: () => this.stop() });
    this.end = element("p", { hidden: true });
    this.front = new FrontView({ open: (name) => this.open(name), point: (name) => this.pointAt(name) });
    this.pointedBox = element("section", { class: "card" });
    this.frontNote = element("p", { class: "muted" });
    this.head = element("tr", {});
    this.body = element("tbody", {});
    this.reasons = element("div", { class: "reasons", hidden: true });
    this.foundBox = element("div", { class: "found", hidden: true },
      element("section", { class: "card" }, element("h2", { text: "The front" }), this.front.box, this.frontNote),
      this.tableCard = element("section", { class: "card" }, element("h2", { text: "Its plates" }),
        element("div", { class: "scroll", role: "region", "aria-label": "table of the plates", tabindex: 0 },
          element("table", { class: "plates" }, element("thead", {}, this.head), this.body))),
      // Below what is pointed at, which must not move.
      this.pointedBox, this.reasons);
    this.place.append(element("div", { class: "columns search" },
      element("section", { class: "card side" }, element("h2", { text: "Requirements" }),
        field("start from", this.choice), field("as TOML text", this.text), this.error, this.line, this.asked,
        element("h2", { text: "How much is looked at" }),
        element("div", { class: "counts" },
          field("designs screened", this.fields.screened, "screened_designs"), field("plates solved, at most", this.fields.solved, "solved_designs"),
          field("seed", this.fields.seed), field("processes", this.fields.jobs)),
        this.startButton, this.startError),
      element("div", { class: "results" },
        element("section", { class: "card" }, this.title = element("h2", { text: "Search" }), this.stage,
          this.farBox = element("div", { hidden: true }, this.far.screened.box, this.far.solved.box), this.time, this.age.box, this.end,
          this.stopButton),
        this.foundBox)));
    this.text.value = sessionStorage.getItem(KEPT) ?? "";
    this.fresh = !this.lab.shared.search;
    this.lab.remember("search", this.fields);
    this.lab.keep(() => clearTimeout(this.settled));
    this.lab.keep(() => clearInterval(this.ticking));
    this.lab.keep(() => this.front.close());
  }

  async begin() {
    try {
      this.take((await this.lab.socket.ask("what searches")).search);
      if (this.fresh && this.search) for (const [name, field] of Object.entries(this.fields)) field.value = this.search.asked[name];
      this.fresh = false;
      const { presets, saved } = await this.lab.socket.ask("requirements");
      const group = (label, names, kind) => element("optgroup", { label }, ...names.map((name) => element("option", { value: `${kind}:${name}`, text: name })));
      this.choice.replaceChildren(element("option", { value: "", text: "choose…" }), group("presets", presets, "preset"),
        ...(saved.length ? [group("searched here", saved, "file")] : []));
      if (this.text.value) await this.check();
      else {
        this.choice.value = `preset:${presets[0]}`;
        await this.choose();
      }
    } catch (error) {
      this.lab.notify(error.message, { failed: true });
    }
  }

  async choose() {
    const [kind, name] = this.choice.value.split(/:(.*)/);
    if (kind) await this.load({ [kind]: name });
  }

  async load(which) {
    try {
      this.text.value = (await this.lab.socket.ask("requirements text", which)).text;
      this.text.scrollTop = 0;
      sessionStorage.setItem(KEPT, this.text.value);
      await this.check();
    } catch (error) {
      this.refuse(error.message);
    }
  }

  typed() {
    sessionStorage.setItem(KEPT, this.text.value);
    this.choice.value = "";
    clearTimeout(this.settled);
    this.settled = setTimeout(() => this.check(), SETTLE);
  }

  /** What the text asks for, or what is wrong with it and in which line. */
  async check() {
    const turn = ++this.turn;
    try {
      const asked = await this.lab.socket.ask("check requirements", { text: this.text.value });
      if (turn !== this.turn) return;
      this.refuse("");
      this.showAsked(asked);
    } catch (error) {
      if (turn === this.turn && this.lab.socket.open && !error.message.startsWith("newer work")) this.refuse(error.message);
    }
  }

  refuse(message) {
    this.error.textContent = message;
    this.error.hidden = !message;
    this.text.setAttribute("aria-invalid", String(Boolean(message)));
    this.wrongLine = Number(/\bline (\d+)/.exec(message)?.[1] ?? 0);
    this.line.hidden = !this.wrongLine;
    this.line.textContent = `Go to line ${this.wrongLine}`;
    if (message) this.asked.hidden = true;
  }

  goToLine() {
    const lines = this.text.value.split("\n"), at = this.wrongLine - 1;
    const from = lines.slice(0, at).join("\n").length + (at > 0);
    this.text.focus();
    this.text.setSelectionRange(from, from + (lines[at] ?? "").length);
    this.text.scrollTop = Math.max(0, at - 4) * (this.text.scrollHeight / lines.length);
  }

  showAsked(asked) {
    this.asked.hidden = false;
    const list = (title, rows) => (rows.length ? [element("h3", { text: title }), element("ul", {}, ...rows.map((text) => element("li", { text })))] : []);
    this.askedInside.replaceChildren(element("p", {}, element("strong", { text: asked.title })), ...(asked.note ? [element("p", { text: asked.note })] : []),
      ...list("Made small", asked.objectives.map((one) => one.said)),
      ...list("Limits", asked.limits),
      ...list("Chosen freely", asked.shapes.map((one) => `${one.name.replaceAll("_", " ")}: ${one.chosen.join(", ") || "nothing"}`)),
      element("p", { class: "muted", text: `It starts from ${asked.start_from}${asked.compare_with ? ` and is set beside ${asked.compare_with}` : ""}.` }),
      ...list("Assumed", asked.assumed));
  }

  /** Start; everything that is wrong is said first. */
  async begun() {
    this.startError.hidden = true;
    this.startButton.disabled = true;
    try {
      const counts = Object.fromEntries(Object.entries(this.fields).map(([name, field]) => [name, wholeNumber(field)]));
      await this.lab.act("start search", { text: this.text.value, ...counts });
      this.refuse("");
    } catch (error) {
      if (/\bline \d+/.test(error.message)) this.refuse(error.message);
      this.startError.textContent = error.message;
      this.startError.hidden = false;
    }
    this.startButton.disabled = this.runs;
  }

  async stop() {
    try {
      await this.lab.act("stop search");
    } catch (error) {
      this.lab.notify(error.message, { failed: true });
    }
  }

  get runs() {
    return Boolean(this.search && !this.search.end);
  }

  take(search) {
    this.search = search;
    this.startButton.disabled = this.runs;
    clearInterval(this.ticking);
    if (!search) return;
    this.heard = performance.now();
    this.age.now();
    if (this.runs) this.ticking = setInterval(() => this.tick(), 1000);
    this.showState(search);
    this.showFound(search);
    this.showReasons(search);
  }

  showState(search) {
    const { asked, end, stopping } = search;
    this.title.textContent = asked.title || asked.name;
    const stage = search.stage && search.says.startsWith(search.stage) ? search.stage : search.says;
    this.stage.textContent = end ? (end.failed ? "The search failed." : `The search is ${end.message.startsWith("stopped") ? "stopped" : "finished"}.`)
      : stopping ? "Stopping: what is being computed is finished first…" : `${capital(stage)}.`;
    this.farBox.hidden = false;
    for (const [name, most] of [["screened", asked.screened], ["solved", asked.solved]]) {
      const { progress, said } = this.far[name], done = search[name] ?? 0;
      progress.value = most ? Math.min(1, done / most) : 1;
      said.textContent = name === "screened" ? `${done > most ? done : `${done} of ${most}`} designs screened` : `${done} of at most ${most} plates solved`;
    }
    this.end.hidden = !end || (!end.failed && ["finished", "stopped"].includes(end.message));
    this.end.className = end?.failed ? "error" : "muted";
    this.end.textContent = end ? (end.failed ? end.message : `${capital(end.message.replace("stopped; ", ""))}.`) : "";
    this.stopButton.hidden = Boolean(end);
    this.stopButton.textContent = stopping ? "End it at once" : "Stop";
    this.tick();
  }

  tick() {
    const { search } = this;
    const seconds = search.seconds + (search.end ? 0 : (performance.now() - this.heard) / 1e3);
    const left = search.left && !search.end ? `; ${search.left} left of this step` : "";
    this.time.textContent = `${search.end ? "It took" : "So far"} ${time(seconds)}${left}. Seed ${search.asked.seed}. Every design is kept in ${search.asked.folder}: the same requirements, started again, go on from there.`;
  }

  showFound(search) {
    const plates = search.front ?? [], screened = search.screened_front ?? [];
    this.foundBox.hidden = !(plates.length || screened.length || search.reference);
    if (this.foundBox.hidden) return;
    const { objectives } = search.asked;
    // What is not finite comes as null, and has no place in the figure.
    const reference = search.reference?.objectives.every((one) => one !== null) ? search.reference : null;
    this.front.set({ objectives, screened, plates, reference, chosen: search.chosen });
    this.frontNote.textContent = plates.length ? "Less is better in both directions. Press a point to open that plate in Design."
      : search.end ? "No solved plate meets all limits." : "Less is better in both directions. No plate has been solved yet that meets all limits.";
    this.showRows(plates, search);
    if (!plates.some((one) => one.name === this.pointed)) this.pointed = null;
    this.pointAt(this.pointed ?? search.chosen ?? null);
  }

  showRows(plates, search) {
    this.tableCard.hidden = !plates.length;
    const { objectives } = search.asked, shapes = new Set(plates.map((one) => one.shape)).size > 1;
    const made = plates.some((one) => one.yield !== null);
    const others = COLUMNS.filter((key) => objectives.every((one) => one.key !== key));
    const cell = (name, key) => element("th", { scope: "col" }, EXPLAINED.includes(key) ? element("span", { "data-tip": key, tabindex: 0, text: name }) : name);
    const heads = [["plate", ""], ...(shapes ? [["shape", ""]] : []), ...objectives.map((one) => [one.said, one.key]),
      ...others.map((key) => [plates[0]?.numbers.find(([one]) => one === key)?.[1] ?? key, key]),
      ...(made ? [["made within the limits", "made_within"]] : []), ["chosen freely", ""]];
    const headed = heads.map(([name]) => name).join();
    if (headed !== this.headed) this.head.replaceChildren(...heads.map(([name, key]) => cell(name, key)));
    this.headed = headed;
    // Rows are kept, so that a button that has the focus keeps it.
    const rows = plates.map((one) => {
      const kept = this.rows.get(one.name);
      const row = kept ?? element("tr", { "data-plate": one.name, onclick: () => this.open(one.name), onpointerenter: () => this.pointAt(one.name) });
      const button = row.querySelector("button") ?? element("button", { text: one.name, title: "open in Design", onfocus: () => this.pointAt(one.name) });
      const number = (key) => one.numbers.find(([name]) => name === key)?.[2] ?? "–";
      const best = one.name === search.chosen;
      row.classList.toggle("chosen", best);
      const first = row.firstChild ?? element("th", { scope: "row" }, button);
      const beats = search.beats?.includes(one.name) ? `beats ${search.reference.name}` : "";
      first.replaceChildren(button, ...[best ? "the one to build" : "", beats].filter(Boolean).map((text) => element("small", { text })));
      const cells = [...(shapes ? [one.shape.replaceAll("_", " ")] : []), ...one.words, ...others.map(number),
        ...(made ? [one.yield === null ? "–" : `${plain(100 * one.yield, 3)} %`] : [])];
      if (row.firstChild !== first) row.prepend(first);
      while (row.children.length > 1) row.lastChild.remove();
      row.append(...cells.map((text) => element("td", { text })), element("td", { class: "free", text: freely(one, search) }));
      return row;
    });
    this.rows = new Map(rows.map((row) => [row.dataset.plate, row]));
    for (const row of [...this.body.children]) if (!rows.includes(row)) row.remove();
    rows.forEach((row, k) => this.body.children[k] !== row && this.body.insertBefore(row, this.body.children[k] ?? null));
  }

  /** All numbers of the plate that the pointer or the focus is on. */
  pointAt(name) {
    this.pointed = name;
    const one = this.search?.front?.find((each) => each.name === name);
    for (const [each, row] of this.rows) row.classList.toggle("pointed", each === name);
    this.pointedBox.hidden = !one;
    if (!one) return;
    const pair = ([said, value]) => element("div", {}, element("dt", { text: said }), element("dd", { text: value }));
    this.pointedBox.replaceChildren(element("h2", { text: `Plate ${name}${name === this.search.chosen ? ", the one to build" : ""}` }),
      element("dl", { class: "pairs" }, ...one.chosen.map(pair), ...one.numbers.map(([, said, value]) => pair([said, value]))),
      ...one.warnings.map((text) => element("p", { class: "warning", text })));
  }

  /** The plate as a display in Design, which analyses it as any. */
  async open(name) {
    try {
      const { text } = await this.lab.socket.ask("open found", { name });
      await this.lab.during(this.lab.display.open({ text }));
      location.hash = "design";
    } catch (error) {
      this.lab.notify(error.message, { failed: true });
    }
  }

  showReasons(search) {
    const { end } = search;
    this.reasons.hidden = !end || !search.limits;
    if (this.reasons.hidden) return;
    const list = (title, rows, none, tip = null) => element("section", { class: "card" }, element("h2", { text: title, "data-tip": tip, tabindex: tip ? 0 : null }),
      rows.length ? element("ul", {}, ...rows.map((text) => element("li", { text: sentence(text) }))) : element("p", { class: "muted", text: none }));
    const ranks = Object.entries(search.ranks).map(([name, value]) => `${name}: ${plain(value, 2)}`).join("; ");
    const facts = [`${search.screened} designs screened, ${search.solved} solved; ${search.computed} answers computed, ${search.kept} known from before`,
      `The front dominates ${plain(100 * search.hypervolume, 3)} % of the box of all objectives, from nothing to its worst corner: to compare searches for the same requirements by`,
      ...(search.reference?.reason ? [`${search.reference.name} could not be judged: ${search.reference.reason}`] : search.reference ? [search.plates_better ? `${search.plates_better} of its plates ${search.plates_better === 1 ? "beats" : "beat"} ${search.reference.name} by the same questions` : `None of its plates beats ${search.reference.name} by the same questions`,
        ...search.reference.breaks.map((text) => `${search.reference.name} itself breaks a limit: ${text}`)] : []),
      ...(ranks ? [`Screened and solved plates have the same order with a rank correlation of ${ranks}`] : [])];
    this.reasons.replaceChildren(list("In short", facts, ""), list("What each limit costs", search.limits, "No limit was broken."),
      list("Empty corners", search.corners, "Every part of the space with enough designs has feasible ones.", "empty_corners"),
      list("What this rests on and nobody measured", search.assumed, ""));
  }
}

function wholeNumber(field) {
  const name = field.closest("label").firstChild.textContent, value = Number(field.value);
  if (field.value !== "" && Number.isInteger(value) && value >= Number(field.min) && value <= Number(field.max)) return value;
  throw new Error(`${name}: a whole number from ${field.min} to ${field.max} is wanted`);
}

/** What the search chose for a plate, in words. */
function freely(one, search) {
  const free = search.asked.shapes.find((each) => each.name === one.shape).chosen;
  return one.chosen.filter(([name]) => free.includes(name)).map(([name, value]) => `${name} ${value}`).join(", ");
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
const sentence = (text) => (text.endsWith(".") ? text : `${text}.`);

function time(seconds) {
  if (seconds < 120) return `${Math.round(seconds)} s`;
  return seconds < 7200 ? `${Math.round(seconds / 60)} min` : `${plain(seconds / 3600, 2)} h`;
}
