// Design: the display as a form, and what follows from it while a slider moves.

import { Age } from "../age.js";
import { AreaMap } from "../area_map.js";
import { CalibratedView, drawMeasured } from "../calibrated_view.js";
import { Chart } from "../chart.js";
import { displayForm } from "../display_form.js";
import { element, number, plain, quantity } from "../numbers.js";
import { PlanView } from "../plan_view.js";
import { download, saveAs } from "../saving.js";
import { WorkLine } from "../work_line.js";

const SETTLE = 500;
const SCREENING = "computing the screening answer…";

export async function show(place, lab) {
  await new DesignView(place, lab, lab.display).start();
}

class DesignView {
  constructor(place, lab, store) {
    Object.assign(this, { place, lab, store, asked: 0, busy: false, next: null, settled: 0, solvedAt: 0 });
  }

  async start() {
    this.store.holdBack(this.place);
    this.build();
    this.lab.keep(this.store.on(() => this.refresh()));
    this.lab.socket.on("connection", ({ open }) => open && this.begin());
    this.lab.socket.on("computing", ({ quality, share, text }) => quality === this.computing && this.work.far(share, text));
    if (this.lab.socket.open) await this.begin();
  }

  async begin() {
    try {
      await this.listDisplays();
      await this.lab.during(this.store.start(this.place));
      this.refresh();
    } catch (error) {
      this.lab.notify(error.message, { failed: true });
    }
  }

  build() {
    this.choice = element("select", { id: "display-choice", onchange: () => this.choose() });
    this.undo = element("button", { text: "Undo", title: "Ctrl+Z", onclick: () => this.tried(this.store.undo()) });
    this.redo = element("button", { text: "Redo", title: "Ctrl+Y", onclick: () => this.tried(this.store.redo()) });
    this.file = element("input", { type: "file", accept: ".toml", hidden: true, onchange: () => this.readFile() });
    this.error = element("p", { class: "error", role: "alert", hidden: true });
    this.form = element("div", { class: "form" });
    this.quality = element("p", { class: "quality", role: "status", text: "computing…" });
    this.work = new WorkLine(() => this.cancel());
    this.age = new Age(this.lab, "computed");
    this.changed = element("p", { class: "warning", role: "status", hidden: true });
    this.numbers = {
      frequency: number("resonance frequency", "resonance_frequency"),
      amplitude: number("vibration amplitude", "vibration_amplitude"),
      friction: number("relative friction", "relative_friction"),
      area: number("over the active area", "active_area"),
      reduction: number("friction reduction", "friction_reduction"),
      squeeze: number("squeeze number", "squeeze_number"),
      wave: number("half wavelength", "half_wavelength"),
      time: number("envelope time constant", "envelope_time_constant"),
      force: number("tangential force", "tangential_force"),
      current: number("drive current", "drive_current"),
      power: number("drive power", "drive_power"),
      inductor: number("matching inductor", "matching_inductor"),
    };
    this.canvas = element("canvas", { class: "plan", role: "img", "aria-label": "the display from above and from the side, with its mode", title: "The mode moves while you point at it." });
    const chart = (title, tip) => {
      const inside = element("div");
      return { inside, box: element("section", { class: "card" }, element("h2", { text: title, "data-tip": tip, tabindex: "0" }), inside) };
    };
    const friction = chart("Friction against vibration amplitude", "relative_friction");
    const response = chart("Amplitude per volt against frequency", "amplitude_per_volt");
    this.warnings = element("section", { class: "card warnings" });
    this.calibrated = new CalibratedView();
    const tools = element("div", { class: "row" },
      element("label", {}, "Display", this.choice), this.undo, this.redo);
    const files = element("div", { class: "row" },
      element("button", { text: "Open file…", onclick: () => this.file.click() }),
      element("button", { text: "Save…", onclick: () => this.save() }),
      element("button", { text: "Download", onclick: () => this.download() }), this.file);
    this.place.append(element("div", { class: "columns design" },
      element("section", { class: "card side" }, tools, files, this.error, this.form),
      this.results = element("div", { class: "results" },
        element("section", { class: "card" }, this.quality, this.work.box, this.changed, this.age.box,
          element("div", { class: "numbers" }, ...Object.values(this.numbers).map((one) => one.box))),
        element("section", { class: "card" }, this.canvas),
        this.areaCard = element("section", { class: "card", hidden: true },
          element("h2", { text: "Relative friction by the place of the finger", "data-tip": "active_area", tabindex: "0" }),
          this.areaCanvas = element("canvas", { class: "area-map", role: "img" }), this.areaSaid = element("p", { class: "muted" })),
        element("div", { class: "pair" }, friction.box, response.box), this.calibrated.box, this.warnings)));
    this.plan = new PlanView(this.canvas);
    this.areaMap = new AreaMap(this.areaCanvas);
    this.redraw = this.lab.frames((now) => this.plan.draw(now), [this.canvas]);
    for (const type of ["pointerenter", "pointerleave"]) this.canvas.addEventListener(type, () => {
      this.plan.watch(type === "pointerenter");
      this.redraw();
    });
    this.frictionChart = new Chart(friction.inside, {
      x: "vibration amplitude (µm)", y: "µ′/µ", range: [0, 1.02],
      series: [
        { label: "95 % lie below", colour: "grid", width: 1 },
        { label: "5 % lie below", colour: "grid", width: 1 },
        { label: "this display", colour: "blue", width: 2.5 },
        { label: "paper's model", colour: "orange", dash: [6, 3] },
      ],
      bands: [[0, 1]],
      marks: (plot, colour) => {
        this.drawPoint(plot, colour);
        drawMeasured(plot, colour, this.measured("frictions", (one) => ({ x: [one.vibration_amplitude_m * 1e6], y: one.relative_friction })));
      },
    });
    this.responseChart = new Chart(response.inside, {
      x: "frequency (kHz)", y: "nm per volt",
      series: [{ label: "largest interior lobe", colour: "blue", width: 2.5 }],
      marks: (plot, colour) => drawMeasured(plot, colour, this.measured("responses",
        (one) => ({ x: scaled(one.frequency_Hz, 1e-3), y: scaled(one.amplitude_per_volt_m_per_V, 1e9) }))),
    });
    document.addEventListener("keydown", (event) => this.pressed(event), { signal: this.lab.signal });
    this.lab.keep(() => clearTimeout(this.settled));
    for (const one of [this.frictionChart, this.responseChart]) this.lab.keep(() => one.close());
  }

  /** Points of a calibrated display's record. */
  measured(which, point) {
    return (this.store.current?.calibration?.[which] ?? []).map(point);
  }

  async listDisplays() {
    const { presets, saved } = await this.lab.socket.ask("displays");
    const group = (label, names, kind) => element("optgroup", { label },
      ...names.map((name) => element("option", { value: `${kind}:${name}`, text: name })));
    this.choice.replaceChildren(element("option", { value: "", text: "choose…" }), group("presets", presets, "preset"),
      ...(saved.length ? [group("saved here", saved, "file")] : []));
  }

  async choose() {
    const [kind, name] = this.choice.value.split(/:(.*)/);
    if (kind) await this.tried(this.store.open({ [kind]: name }));
  }

  refresh() {
    const { current } = this.store;
    if (!current) return;
    this.error.hidden = true;
    this.undo.disabled = !this.store.past.length;
    this.redo.disabled = !this.store.future.length;
    const named = [...this.choice.options].find((one) => one.value.endsWith(`:${current.name}`));
    this.choice.options[0].textContent = named ? "choose…" : current.name;
    this.choice.value = named ? named.value : "";
    displayForm(this.form, current.form, {
      write: (path, value) => refusal(this.store.edit(path, value)),
      forget: (path) => this.store.forget(path),
      unwritten: new Map(this.store.edits.map((one) => [one.path, one.value])),
      refused: this.store.refused,
      notes: Object.entries(current.covered).map(([path, said]) => [path, this.bare(path, said)]),
      slide: (path, value) => this.compute({ path, value }),
    });
    this.calibrated.set(current.calibration);
    this.compute({});
  }

  /** That ceramics stay where they are while the plate grows, and a button that stretches them. */
  bare(path, said) {
    return element("p", { class: "warning" }, `${said} `,
      element("button", { text: "Stretch them", onclick: () => this.tried(this.store.edit(path, "stretch the ceramics")) }));
  }

  async tried(work) {
    try {
      this.error.hidden = true;
      await work;
      return true;
    } catch (error) {
      this.error.textContent = error.message;
      this.error.hidden = false;
      return false;
    }
  }

  /** The screening answer at once; the solved one when nothing has moved for half a second. */
  compute(change) {
    this.asked += 1;
    clearTimeout(this.settled);
    this.next = change;
    this.older(true);
    this.computing = "screening";
    this.work.begin(SCREENING);
    this.pump();
    const mine = this.asked;
    this.settled = setTimeout(() => this.solve(mine, change), SETTLE);
  }

  async pump() {
    if (this.busy || !this.next) return;
    const change = this.next, mine = this.asked;
    this.next = null;
    this.busy = true;
    try {
      const answer = await this.lab.socket.ask("compute design", { text: this.store.current.text, quality: "screening", ...change });
      // A busy computer may have solved it by now.
      if (mine > this.solvedAt) this.present(answer);
      if (mine === this.asked) this.work.end(SCREENING);
      this.older(mine !== this.asked);
      this.error.hidden = true;
    } catch (error) {
      // Work that was ended for newer work says nothing.
      if (mine === this.asked) {
        this.work.end(SCREENING);
        this.error.textContent = error.message;
        this.error.hidden = false;
      }
    }
    this.busy = false;
    this.pump();
  }

  async solve(mine, change) {
    const { text } = this.store.current;
    const current = () => mine === this.asked && this.plan.outline !== undefined;
    const { kind } = this.store.current.outline;
    try {
      this.computing = "solved";
      this.work.begin(kind === "plate" ? "solving the plate in three dimensions…" : `solving the ${kind} and its drive…`);
      const answer = await this.lab.socket.ask("compute design", { text, quality: "solved", ...change });
      if (!current()) return;
      this.solvedAt = mine;
      this.present(answer);
      this.older(false);
      this.computing = "band";
      this.work.begin("computing the band of what is uncertain…");
      const band = await this.lab.socket.ask("compute design", { text, quality: "band", of: "solved", ...change });
      if (current()) {
        this.work.end();
        this.presentBand(band);
      }
    } catch (error) {
      if (current()) {
        this.work.end();
        this.quality.textContent = `not solved: ${error.message}`;
      }
    }
  }

  /** Grey what is shown while it belongs to an older design than the form. */
  older(is) {
    this.results.classList.toggle("older", is);
    this.results.setAttribute("aria-busy", String(is));
  }

  /** End what is computed; what is shown stays, grey if it is of an older design. */
  async cancel() {
    // What is on its way already is not shown either.
    this.asked += 1;
    this.solvedAt = this.asked;
    this.next = null;
    clearTimeout(this.settled);
    this.work.end();
    this.quality.textContent = this.results.classList.contains("older")
      ? "cancelled: the numbers are of an older design; change a value to compute again"
      : `cancelled: ${this.quality.textContent}`;
    await this.tried(this.lab.socket.ask("cancel design"));
  }

  present(found) {
    this.found = found;
    this.age.now();
    const n = this.numbers;
    const say = (one, text, note = "") => {
      one.value.textContent = text;
      one.note.textContent = note;
    };
    const error = found.resonance_frequency_error_Hz;
    say(n.frequency, quantity(found.resonance_frequency_Hz, "Hz", 5), error ? `± ${quantity(error, "Hz", 2)} of the solver` : `mode ${found.mode}`);
    say(n.amplitude, quantity(found.vibration_amplitude_m, "m"), `${quantity(found.free_amplitude_m, "m")} without finger`);
    const pace = `at ${plain(found.finger_speed_m_per_s * 1e3)} mm/s`;
    say(n.friction, plain(found.relative_friction), `µ′/µ, 1 = no effect; ${pace}, ${found.place.is_best_of_area ? "at the best place of the active area" : found.place.said}`);
    const area = found.active_area, range = area?.relative_friction;
    say(n.area, range ? `${plain(range.best)} to ${plain(range.worst)}` : "–",
      range ? `below 0.70 on ${plain(100 * area.share_below["0.70"])} % of it` : "known when the plate is solved");
    this.areaMap.set(area);
    this.areaCard.hidden = !area;
    this.areaSaid.textContent = area ? `Dark is where the finger slides most easily. ${area.said}` : "";
    say(n.reduction, plain(found.friction_reduction), `of µ = ${plain(found.friction_coefficient)} on ${found.surface}`);
    say(n.squeeze, plain(found.squeeze_number), found.squeeze_number > 10 ? "" : "below the paper's 10");
    say(n.wave, quantity(found.half_wavelength_m, "m"));
    say(n.time, quantity(found.envelope_time_constant_s, "s"), `Q = ${plain(found.quality_factor)}`);
    say(n.force, quantity(found.tangential_force_N, "N"), `at ${quantity(found.normal_force_N, "N")}`);
    // The screening has no admittance: dashes.
    const load = found.drive_electronics ?? {};
    const able = load.amplifiers?.filter((one) => one.suffices).map((one) => one.kind);
    say(n.current, quantity(load.current_A, "A"), load.channels ? `peak, without a finger; ${load.channels > 1 ? `${load.channels} driven ceramics, ` : ""}${quantity(load.capacitance_F, "F")}${load.assumed ? `; ${load.assumed}` : ""}` : "of the solved plate");
    say(n.power, quantity(load.real_power_W, "W"), load.channels ? `of ${plain(load.apparent_power_VA)} VA, ${plain(load.slew_rate_V_per_s / 1e6)} V/µs; enough: ${able.join(", ") || "none of three classes"}` : "");
    say(n.inductor, quantity(load.parallel_inductance_V_s_per_A, "H"), load.series_inductance_V_s_per_A ? `parallel; ${quantity(load.series_inductance_V_s_per_A, "H")} in series` : "");
    const model = found.vibration_model.replaceAll("_", " ");
    this.quality.textContent = `${found.quality === "solved" ? "solved" : "screening"}: vibration by ${model}, friction by ${found.friction_model} under a finger ${pace}; ${quantity(found.voltage_V, "V")} at resonance`;
    this.quality.dataset.quality = found.quality;
    this.changed.textContent = found.since_screening;
    this.changed.hidden = !found.since_screening;
    this.plan.set(this.store.current.outline, found.line, found.shape);
    this.redraw();
    const micro = (values) => values.map((value) => (value === null ? null : value * 1e6));
    const curve = found.friction_curve;
    const empty = curve.amplitude_m.map(() => null);
    this.curve = curve;
    this.frictionChart.set([micro(curve.amplitude_m), empty, empty, curve.relative_friction, curve.paper2008]);
    const { frequency_Hz: f, amplitude_per_volt_m_per_V: a } = found.response;
    this.responseChart.set([f.map((one) => one / 1e3), a.map((one) => one * 1e9)]);
    this.warnings.replaceChildren(element("h2", { text: "What to know" }),
      ...(found.warnings.length ? found.warnings.map((text) => element("p", { class: "warning", text })) : [element("p", { class: "muted", text: "No warnings." })]));
  }

  presentBand(band) {
    const micro = band.amplitude_m.map((value) => value * 1e6);
    const between = (values) => this.curve.amplitude_m.map((at) => interpolate(micro, values, at * 1e6));
    this.frictionChart.set([this.curve.amplitude_m.map((one) => one * 1e6), between(band.high), between(band.low),
      this.curve.relative_friction, this.curve.paper2008]);
  }

  drawPoint(plot, colour) {
    if (!this.found) return;
    const x = plot.valToPos(this.found.vibration_amplitude_m * 1e6, "x", true);
    const y = plot.valToPos(this.found.relative_friction, "y", true);
    const g = plot.ctx;
    g.save();
    g.fillStyle = colour("blue");
    g.beginPath();
    g.arc(x, y, 5 * devicePixelRatio, 0, 2 * Math.PI);
    g.fill();
    g.restore();
  }

  async readFile() {
    const [file] = this.file.files;
    this.file.value = "";
    if (!file) return;
    if (file.size > 400000) {
      this.tried(Promise.reject(new Error(`${file.name} has ${file.size} bytes; a display's file has a few thousand`)));
      return;
    }
    await this.tried(this.store.open({ text: await file.text() }));
  }

  /** The display's name as a file may have it. */
  fileName() {
    return this.store.current.name.replace(/[^A-Za-z0-9._-]+/g, "-");
  }

  async save() {
    const { text } = this.store.current, name = this.fileName();
    if (await this.tried(saveAs(this.lab, "the display", name, "save display", { text }))) await this.listDisplays();
  }

  download() {
    const { text } = this.store.current, name = this.fileName();
    download(text, "text/plain", `${name}.toml`);
  }

  pressed(event) {
    if (!(event.ctrlKey || event.metaKey) || event.target.matches("input[type=text]")) return;
    if (event.key === "z" && !event.shiftKey) this.tried(this.store.undo());
    else if (event.key === "y" || (event.key === "z" && event.shiftKey)) this.tried(this.store.redo());
    else return;
    event.preventDefault();
  }
}

/** Why something was refused, in words; empty where it was not. */
async function refusal(work) {
  try {
    await work;
    return "";
  } catch (error) {
    return error.message;
  }
}

const scaled = (values, by) => values.map((one) => (one === null ? null : one * by));

function interpolate(x, y, at) {
  const k = x.findIndex((one) => one >= at);
  if (k <= 0) return k === 0 ? y[0] : null;
  if (y[k] === null || y[k - 1] === null) return null;
  return y[k - 1] + ((at - x[k - 1]) / (x[k] - x[k - 1])) * (y[k] - y[k - 1]);
}
