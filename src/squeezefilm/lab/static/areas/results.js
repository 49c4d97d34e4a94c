// Results: a study's analysis and figures, its exports, and taking a participant out of it.

import { Age } from "../age.js";
import { element } from "../numbers.js";

export async function show(place, lab) {
  await new ResultsView(place, lab).start();
}

const EXPLAINED = [
  ["Participants", "participants"], ["Proportion correct", "proportion_correct"], ["Guessing", "guessing"],
  ["p against unrelated", "permutation_p"], ["Information transfer", "information_transfer"],
  ["Weber fraction", "weber_fraction"], ["Threshold", "threshold"], ["Exponent", "exponent"], ["Drift", "drift"], ["Catch trials", "catch_trials"], ["Total sensitivity", "total_sensitivity"], ["d′", "d_prime"], ["Sensitivity d′", "d_prime"], ["Response time", "response_time"],
];

/** The glossary's entry for a row of the analysis. */
function explained(row) {
  return EXPLAINED.find(([start]) => row.startsWith(start))?.[1] ?? null;
}

function answersIn(study) {
  return study.participants.reduce((sum, one) => sum + one.answered, 0);
}

class ResultsView {
  constructor(place, lab) {
    Object.assign(this, { place, lab, name: sessionStorage.getItem("squeezefilm study") });
  }

  async start() {
    this.error = element("p", { class: "error", role: "alert", hidden: true });
    this.side = element("section", { class: "card side" });
    this.main = element("div", { class: "results" });
    this.age = new Age(this.lab, "analysed");
    this.place.append(element("div", { class: "columns study" }, this.side, this.main));
    this.lab.socket.on("study changed", ({ study }) => study === this.name && this.tried(() => this.changed()));
    this.lab.socket.on("connection", ({ open }) => open && this.begin());
    if (this.lab.socket.open) await this.begin();
  }

  begin() {
    return this.tried(async () => {
      const { studies } = await this.lab.socket.ask("studies");
      this.choice = element("select", { id: "results-study", onchange: () => this.tried(() => this.open(this.choice.value)) },
        ...studies.map((name) => element("option", { value: name, text: name })));
      this.people = element("div");
      const ask = (format) => () => this.tried(async () => {
        const { folder, zip } = await this.lab.act("export study", { study: this.name, format });
        const name = `${this.name}-${format}.zip`, bytes = Uint8Array.from(atob(zip), (one) => one.charCodeAt(0));
        const link = element("a", { href: URL.createObjectURL(new Blob([bytes], { type: "application/zip" })), download: name, text: `Download ${name}` });
        this.lab.notify(`Exported to ${folder} in the lab's folder.`, { link });
      });
      this.side.replaceChildren(element("h2", { text: "Results" }),
        element("label", { class: "stack" }, "study", this.choice), this.error,
        element("h3", { text: "Export" }),
        element("div", { class: "row" }, ...[["csv", "CSV"], ["psych-ds", "Psych-DS"]].map(([format, text]) => element("button", { text, onclick: ask(format) }))),
        element("button", { text: "Write the report", onclick: () => this.tried(async () => {
          const { pages } = await this.lab.act("report study", { study: this.name });
          this.lab.notify(`Written: ${pages.join(", ")}`);
        }) }),
        element("h3", { text: "Participants" }), this.people);
      if (!studies.length) {
        this.main.replaceChildren(element("section", { class: "card" }, element("p", { text: "There is no study yet. Create one in the Study area." })));
        return;
      }
      if (!studies.includes(this.name)) [this.name] = studies;
      this.choice.value = this.name;
      await this.open(this.name);
    });
  }

  async tried(work) {
    try {
      this.error.hidden = true;
      await work();
    } catch (error) {
      this.error.textContent = error.message;
      this.error.hidden = false;
    }
  }

  async open(name) {
    Object.assign(this, { name, analysed: null });
    sessionStorage.setItem("squeezefilm study", name);
    const study = await this.lab.socket.ask("study", { study: name });
    if (name !== this.name) return;
    this.showPeople(study);
    await this.analyse(name);
  }

  async analyse(name) {
    const card = (attributes, ...children) => this.main.replaceChildren(element("section", { class: "card" }, element("p", attributes), ...children));
    card({ class: "muted", role: "status", text: "analysing…" });
    const before = answersIn(this.study);
    try {
      const { answers, displays } = await this.lab.socket.ask("analyze study", { study: name });
      if (name !== this.name) return;
      this.analysed = answers;
      this.age.now();
      this.main.replaceChildren(this.age.box, ...displays.flatMap((one) => this.display(one)));
      if (answers > answersIn(this.study)) await this.changed();
    } catch (error) {
      if (name !== this.name) return;
      this.analysed = before;
      card({ text: error.message });
    }
    this.sayNewer();
  }

  /** People and what they answered go on while somebody reads; a hand that deletes is left alone. */
  async changed() {
    const { name } = this, study = await this.lab.socket.ask("study", { study: name });
    if (name !== this.name) return;
    if (this.people.querySelector(".confirm")) this.study = study;
    else this.showPeople(study);
    this.sayNewer();
  }

  /** What was analysed is of one moment; say where there are answers of a later one. */
  sayNewer() {
    this.main.querySelector(".newer")?.remove();
    const newer = answersIn(this.study) - (this.analysed ?? Infinity);
    if (!(newer > 0)) return;
    this.main.prepend(element("section", { class: "card row newer" },
      element("p", { text: `${newer} ${newer === 1 ? "answer" : "answers"} came since what is shown here was computed.` }),
      element("button", { text: "Analyse again", onclick: () => this.tried(() => this.analyse(this.name)) })));
  }

  display(one) {
    const first = element("section", { class: "card first" }, element("h2", { text: `Read first, ${one.display}` }),
      element("ul", {}, ...one.first.map((text) => element("li", { text }))));
    const tables = one.tables.map(({ title, head, rows }) => element("section", { class: "card" }, element("h2", { text: `${title}, ${one.display}` }),
      element("div", { class: "scroll" }, element("table", {}, element("tr", {}, ...head.map((text) => element("th", { text }))),
        ...rows.map((row) => element("tr", {}, ...row.map((text, place) => element(place ? "td" : "th", { text }))))))));
    if (one.confusion) tables.push(confusionCard(one.confusion));
    const methods = one.methods ? [element("section", { class: "card" }, element("h2", { text: "Methods, for a paper" }), element("p", { text: one.methods }))] : [];
    return [first, ...tables,
      element("section", { class: "card" }, element("h2", { text: `Numbers, ${one.display}` }),
        element("div", { class: "scroll" }, element("table", {}, ...one.numbers.map(([name, value, note]) => element("tr", {},
          element("th", { text: name, tabindex: "0", "data-tip": explained(name) }), element("td", { text: value }), element("td", { class: "muted", text: note }))))),
        ...one.notes.map((text) => element("p", { class: "warning", text }))),
      element("section", { class: "card figures" }, element("h2", { text: `Figures, ${one.display}` }),
        ...one.figures.map(({ title, png }) => element("figure", {}, element("img", { src: `data:image/png;base64,${png}`, alt: title }), element("figcaption", { text: title })))), ...methods];
  }

  showPeople(study) {
    this.study = study;
    this.people.replaceChildren(...study.participants.map((one) => {
      const box = element("div", { class: "person" }, element("code", { text: one.pseudonym }), element("small", { text: ` ${one.answered} of ${one.planned}` }));
      const start = element("button", { text: "Delete…", onclick: () => {
        const typed = element("input", { type: "text", size: "18", "aria-label": `type ${one.pseudonym} to delete` });
        const go = element("button", { class: "stop", text: "Delete for good", onclick: () => this.tried(async () => {
          const found = await this.lab.act("delete participant", { study: this.name, participant: one.pseudonym, confirm: typed.value });
          this.lab.notify(`Deleted: ${found.deleted.answers} answers, ${found.deleted.traces} traces; ${found.deleted.searched} files searched, nothing left.`);
          await this.open(this.name);
        }) });
        start.replaceWith(element("div", { class: "confirm" }, element("p", { text: `This cannot be undone. Type ${one.pseudonym}:` }), typed, go,
          element("button", { text: "Keep", onclick: () => this.showPeople(this.study) })));
        typed.focus();
      } });
      box.append(start);
      return box;
    }));
    if (!study.participants.length) this.people.append(element("p", { class: "muted", text: "nobody yet" }));
  }
}

/** A confusion table in the paper's layout: rows the gratings chosen, columns what was presented. */
function confusionCard({ display, rows, columns, counts }) {
  const sums = columns.map((_, j) => counts.reduce((sum, row) => sum + row[j], 0));
  const total = sums.reduce((a, b) => a + b, 0);
  const body = rows.map((name, i) => element("tr", {}, element("th", { scope: "row", text: name }), ...columns.map((column, j) => {
    const share = sums[j] ? counts[i][j] / sums[j] : null;
    const cell = element("td", { text: share === null ? "–" : `${Math.round(100 * share)} %`, title: `${counts[i][j]} of ${sums[j]}` });
    if (share !== null) cell.style.setProperty("--share", `${Math.round(share * 100)}%`);
    cell.className = name === column ? "cell right" : "cell";
    return cell;
  })));
  return element("section", { class: "card confusion" }, element("h2", { text: `Confusions, ${display}` }),
    element("p", { class: "muted", text: `Rows: grating chosen. Columns: period presented. ${total} answers.` }),
    element("div", { class: "scroll" }, element("table", {},
      element("tr", {}, element("td", {}), ...columns.map((name) => element("th", { scope: "col", text: name }))), ...body)));
}
