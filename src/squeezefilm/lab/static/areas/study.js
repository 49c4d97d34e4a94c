// Study, the experimenter's side: plan, participants, sittings, progress, answers as they come.

import { Age } from "../age.js";
import { element, plain } from "../numbers.js";

const FIELDS = [
  ["room", "room", "text", "like: anechoic chamber"], ["temperature", "temperature (°C)", "number", ""],
  ["relative_humidity", "relative humidity (%)", "number", ""], ["skin_moisture", "skin moisture", "number", ""],
  ["skin_moisture_method", "… measured with", "text", "instrument and unit"],
  ["finger_orientation", "finger's axis from the stroke (°)", "number", ""],
  ["normal_force_asked", "normal force asked (N)", "number", ""], ["masking_noise", "masking noise", "text", "like: pink noise, 65 dB(A)"],
  ["note", "note, without names", "text", ""],
];
const HANDS = ["", "left", "right"], FINGERS = ["", "thumb", "index", "middle", "ring", "little"];

export async function show(place, lab) {
  await new StudyView(place, lab).start();
}

class StudyView {
  constructor(place, lab) {
    // `turn` counts what was asked to be shown: an answer to an earlier wish is not shown any more.
    Object.assign(this, { place, lab, turn: 0, name: sessionStorage.getItem("squeezefilm study") });
  }

  async start() {
    this.error = element("p", { class: "error", role: "alert", hidden: true });
    this.list = element("section", { class: "card side" });
    this.main = element("div", { class: "results" });
    this.age = new Age(this.lab, "loaded");
    this.place.append(element("div", { class: "columns study" }, this.list, this.main));
    this.lab.socket.on("study changed", ({ study }) => study === this.name && this.reload(true));
    this.lab.socket.on("connection", ({ open }) => open && this.begin());
    if (this.lab.socket.open) await this.begin();
  }

  async begin() {
    await this.tried(async () => {
      this.listing = await this.lab.socket.ask("studies");
      this.showList();
      if (this.listing.studies.includes(this.name)) await this.open(this.name);
      else await this.showPlan();
    });
  }

  /** Do it, or say beside what was pressed why not. */
  async tried(work, said = this.error) {
    try {
      said.hidden = true;
      return await work();
    } catch (error) {
      said.textContent = error.message;
      said.hidden = false;
      return null;
    }
  }

  showList() {
    const { designs, studies } = this.listing;
    this.design = element("select", { id: "design", onchange: () => this.tried(() => this.showPlan()) },
      ...designs.map((one) => element("option", { value: one.name, text: one.name, title: one.title })));
    this.title = element("input", { type: "text", id: "study-name", value: "study-1", size: "14" });
    this.seed = element("input", { type: "text", id: "seed", value: String(Math.floor(Math.random() * 1e9)), size: "11" });
    const field = (text, input) => element("label", { class: "stack" }, text, input);
    this.list.replaceChildren(element("h2", { text: "Studies" }),
      studies.length ? element("ul", { class: "plain" }, ...studies.map((name) => element("li", {},
        element("button", { text: name, "aria-current": name === this.name ? "true" : null, onclick: () => this.tried(() => this.open(name)) })))) : element("p", { class: "muted", text: "There is none yet." }),
      element("h3", { text: "A new one" }), field("design", this.design), field("name of its file", this.title), field("seed of all orders", this.seed),
      element("button", { class: "main", text: "Create the study", onclick: () => this.tried(() => this.create()) }), this.error);
  }

  async showPlan() {
    const turn = ++this.turn;
    const plan = await this.lab.socket.ask("plan study", { design: this.design.value });
    if (turn !== this.turn) return;
    this.main.replaceChildren(element("section", { class: "card" }, element("h2", { text: plan.title }),
      element("p", { text: plan.note }), element("p", { text: `Asked: “${plan.question}”` }),
      element("table", {}, ...[
        ["task", plan.task], ["on", plan.displays.join(", ")], ["stimuli", plan.stimuli.join(", ")],
        ["answers", plan.answers.join(", ") || "any number"], ["trials of a participant", plan.trials],
        ["time, with breaks", `${plain(plan.duration_s / 60, 3)} min`],
      ].map(([name, value]) => element("tr", {}, element("th", { text: name }), element("td", { text: value }))))));
  }

  async create() {
    const typed = this.seed.value.trim(), seed = Number(typed);
    if (!/^\d+$/.test(typed) || !Number.isSafeInteger(seed)) throw new Error(`the seed '${typed}' is no whole number from 0 on, of at most 15 digits; type one`);
    const turn = ++this.turn;
    const made = await this.lab.act("create study", { design: this.design.value, study: this.title.value, seed });
    this.listing = await this.lab.socket.ask("studies");
    if (turn === this.turn) this.name = made.name;
    this.showList();
    if (turn === this.turn) this.take(made);
  }

  async open(name) {
    const turn = ++this.turn;
    this.name = name;
    const study = await this.lab.socket.ask("study", { study: name });
    if (turn !== this.turn) return;
    this.take(study);
    for (const button of this.list.querySelectorAll("li button")) {
      if (button.textContent === name) button.setAttribute("aria-current", "true");
      else button.removeAttribute("aria-current");
    }
  }

  async reload(quietly = false) {
    if (!this.name || (quietly && this.main.querySelector("form"))) {
      // A form is being filled in: the numbers beside it may wait.
      return;
    }
    await this.tried(async () => {
      const { name } = this, found = await this.lab.socket.ask("study", { study: name });
      if (name !== this.name || (quietly && this.main.querySelector("form"))) return;
      if (!quietly || !this.progress(found)) this.take(found);
    });
  }

  /** Numbers of a study that is shown already, without replacing what a hand or the focus is on;
   * whether that was enough. */
  progress(study) {
    const shape = (one) => JSON.stringify([one.name, one.sittings.map(({ by_hand: _, waits_for: __, ...rest }) => rest), one.participants.map((each) => [each.pseudonym, each.display, each.answered === each.planned])]);
    if (!this.study || shape(study) !== shape(this.study)) return false;
    for (const one of study.participants) {
      const row = this.main.querySelector(`tr[data-participant="${CSS.escape(one.pseudonym)}"]`);
      if (!row) return false;
      row.querySelector("progress").value = one.answered;
      row.querySelector(".count").textContent = ` ${one.answered} of ${one.planned}`;
      const cell = row.querySelector(".byhand"), { activeElement } = document;
      // Who says with the keyboard that surfaces are in place goes on doing so at the next one.
      if (cell.contains(activeElement)) this.placing = one.pseudonym;
      else if (activeElement !== document.body && activeElement) this.placing = null;
      cell.replaceChildren(...this.byHand(study, one.pseudonym));
      if (this.placing === one.pseudonym) cell.querySelector("button")?.focus({ preventScroll: true });
    }
    this.study = study;
    this.age.now();
    return true;
  }

  take(study) {
    this.study = study;
    this.name = study.name;
    sessionStorage.setItem("squeezefilm study", study.name);
    const rows = study.participants.map((one) => this.participant(one));
    this.age.now();
    this.redraw(
      element("section", { class: "card" }, element("h2", { text: study.name }),
        element("p", { class: "muted", text: `${study.title}. Seed ${study.seed}.` }), this.age.box,
        element("div", { class: "scroll" }, element("table", { class: "participants" },
          element("tr", {}, ...["participant", "answered", "now on", "sitting", ""].map((text) => element("th", { text }))), ...rows)),
        this.rehearsal(), element("button", { class: "main", text: "Enrol a participant", onclick: () => this.tried(async () => this.take(await this.lab.act("enrol", { study: study.name }))) })));
  }

  /** The main part drawn anew. Focus and a number half typed stay where they were: it is a participant,
   * by beginning or by the last answer, who has it drawn anew under the experimenter's hand. */
  redraw(...cards) {
    const name = (one) => [one.closest("tr")?.dataset.participant, one.tagName, one.ariaLabel ?? one.textContent].join("|");
    // Not ":focus", which is nothing while another window is in front.
    const before = this.main.contains(document.activeElement) ? document.activeElement : null, key = before && name(before);
    this.main.replaceChildren(...cards);
    const same = before && [...this.main.querySelectorAll("button, input")].find((one) => name(one) === key);
    if (same?.tagName === "INPUT") same.value = before.value;
    same?.focus();
  }

  /** Simulated people may do a study that nobody took part in. */
  rehearsal() {
    if (!["nobody", "simulated participants"].includes(this.study.origin)) return null;
    const count = element("input", { type: "text", value: "3", size: "3", "aria-label": "how many simulated participants" });
    const button = element("button", { text: "Rehearse with simulated participants", onclick: () => this.tried(async () => {
      const participants = Number(count.value);
      if (!(Number.isInteger(participants) && participants > 0)) throw new Error(`'${count.value}' is no number of participants`);
      button.disabled = true;
      button.textContent = "simulating…";
      try {
        await this.lab.act("rehearse study", { study: this.study.name, participants });
      } finally {
        await this.reload();
      }
    }) });
    const said = this.study.origin === "simulated participants" ? element("p", { class: "warning", text: "Every answer in this file is simulated." }) : null;
    return element("div", {}, said, element("div", { class: "row" }, count, button));
  }

  participant(one) {
    const sitting = this.study.sittings.find((found) => found.participant === one.pseudonym);
    const done = one.answered === one.planned;
    const actions = element("div", { class: "row" });
    if (!done) actions.append(element("button", { text: "Prepare a sitting…", onclick: () => this.tried(() => this.prepare(one)) }));
    if (sitting) {
      actions.append(
        element("button", { text: "Open here", onclick: () => window.open(`/participant#${sitting.id}`, "_blank") }),
        element("button", { text: "Link for another station", onclick: () => this.tried(() => this.link(sitting)) }),
        this.listing.tablets ? element("button", { text: "Code for a tablet", onclick: () => this.tried(() => this.code(sitting)) }) : "",
        element("button", { text: "End the sitting", onclick: () => this.tried(() => this.end(sitting)) }));
    }
    return element("tr", { "data-participant": one.pseudonym }, element("td", {}, element("code", { text: one.pseudonym })),
      element("td", { class: "nowrap" }, element("progress", { value: one.answered, max: one.planned, "aria-label": "answered" }), element("span", { class: "count", text: ` ${one.answered} of ${one.planned}` })),
      element("td", { text: one.display ?? "finished" }), element("td", {}, sitting ? (sitting.begun ? "running" : "prepared") : "–",
        sitting?.begun_again ? element("p", { class: "warning", text: sitting.begun_again }) : "",
        element("div", { class: "byhand" }, ...this.byHand(this.study, one.pseudonym))), element("td", {}, actions));
  }

  /** What the experimenter has to put before a participant who has no device, and the button that
   * starts the participant's clock. */
  byHand(study, pseudonym) {
    const sitting = study.sittings.find((found) => found.participant === pseudonym), names = sitting?.by_hand ?? [];
    if (!names.length) return [];
    const now = sitting.waits_for, shown = names.flatMap((name, k) => [k ? ", then " : "", element(k === (now ?? 0) ? "strong" : "span", { text: name })]);
    if (now === null) return ["this trial: ", ...shown];
    return ["present now: ", ...shown, element("p", {}, element("button", { class: "main", text: "Surface is in place",
      onclick: () => this.tried(() => this.lab.socket.ask("surface in place", { sitting: sitting.id })) }))];
  }

  async link(sitting) {
    const { path } = await this.lab.socket.ask("station link", { sitting: sitting.id });
    this.lab.notify(`For ${sitting.participant}, once, in another browser: ${location.origin}${path}`);
  }

  async code(sitting) {
    const { code, link, fingerprint, life_s: life } = await this.lab.socket.ask("pairing code", { sitting: sitting.id });
    this.lab.notify(`For ${sitting.participant}: on the tablet open ${link} and type ${code.slice(0, 3)} ${code.slice(3)} within ${life / 60} minutes. Its browser warns of the certificate; go on only if its SHA-256 fingerprint is ${fingerprint}`);
  }

  async end(sitting) {
    const found = await this.lab.act("end sitting", { sitting: sitting.id });
    this.take(found);
    const { problems } = found, failed = problems.length > 0;
    this.lab.notify(failed ? `The device is off after the session: ${problems.join("; ")}` : "The sitting has ended.", { failed });
  }

  async prepare(one) {
    const inputs = {};
    const rows = FIELDS.map(([key, text, type, hint]) => {
      inputs[key] = element("input", { type: "text", inputmode: type === "number" ? "decimal" : null, placeholder: hint, id: `c-${key}` });
      return element("label", { class: "stack" }, text, inputs[key]);
    });
    const list = (key, values) => {
      inputs[key] = element("select", { id: `c-${key}` }, ...values.map((value) => element("option", { value, text: value || "not noted" })));
      return element("label", { class: "stack" }, key, inputs[key]);
    };
    const consent = element("textarea", { rows: "6", id: "consent-text" });
    consent.value = this.study.consent;
    const device = element("select", { id: "sitting-device", onchange: () => {
      acknowledge.hidden = device.value === "none";
      this.exposure(one, device.value, warned, box);
    } },
      element("option", { value: "none", text: "by hand: no device is driven" }),
      ...(this.study.devices ?? []).map((name) => element("option", { value: name, text: name })));
    const warned = element("p", { class: "warning", hidden: true });
    const box = element("input", { type: "checkbox", id: "acknowledged" });
    const acknowledge = element("label", { hidden: true }, box, "The exposure to airborne ultrasound was read and accepted");
    const wrong = element("p", { class: "error", role: "alert", hidden: true });
    const form = element("form", { class: "sitting" }, element("h2", { text: `A sitting of ${one.pseudonym}` }),
      element("div", { class: "fields" }, ...rows, list("hand", HANDS), list("finger", FINGERS)),
      element("label", { class: "stack" }, "consent, as the participant reads it", consent),
      element("label", { class: "stack" }, "device", device), warned, acknowledge,
      wrong, element("div", { class: "row" }, element("button", { class: "main", type: "submit", text: "Ready for the participant" }),
        element("button", { type: "button", text: "Cancel", onclick: () => { card.remove(); this.reload(); } })));
    const card = element("section", { class: "card" }, form);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.tried(async () => {
        const found = await this.lab.act("prepare sitting", {
          study: this.study.name, participant: one.pseudonym, device: device.value, consent: consent.value,
          conditions: conditionsOf(inputs), acknowledged: box.checked,
        });
        card.remove();
        this.take(found);
      }, wrong);
    });
    this.main.querySelector("form")?.closest("section").remove();
    this.main.prepend(card);
    inputs.room.focus();
  }

  async exposure(one, device, warned, box) {
    warned.hidden = device === "none";
    box.checked = false;
    if (device === "none") return;
    warned.textContent = "computing the sound that the display radiates…";
    await this.tried(async () => {
      const found = await this.lab.socket.ask("exposure", { study: this.study.name, participant: one.pseudonym });
      warned.textContent = found.statement;
    });
  }
}

function conditionsOf(inputs) {
  const found = {};
  const units = { temperature: " degC", relative_humidity: " %", finger_orientation: " deg" };
  for (const [key, , type] of FIELDS) {
    const text = inputs[key].value.trim();
    if (!text) continue;
    if (type === "number") {
      const value = Number(text.replace(",", "."));
      if (!Number.isFinite(value)) throw new Error(`${key.replaceAll("_", " ")}: '${text}' is no number`);
      // The lab reads the unit, and refuses in it.
      found[key] = key in units ? `${value}${units[key]}` : value;
    } else found[key] = text;
  }
  for (const key of ["hand", "finger"]) if (inputs[key].value) found[key] = inputs[key].value;
  return found;
}
