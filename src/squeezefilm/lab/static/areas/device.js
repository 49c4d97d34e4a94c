// Device: choose a twin or a port, check it, arm it, play, watch. The page's stop bar stops.

import { Age } from "../age.js";
import { element, fixed, number, plain, quantity } from "../numbers.js";
import { Scope } from "../scope.js";

export async function show(place, lab) {
  await new DeviceView(place, lab, lab.display).start();
}

// After so long (ms) without a word from what plays, what is shown is old.
const SILENT = 1000;
// What is known of the device's state after a session ended so.
const AFTER = { DURATION: "STOPPED", INTERRUPTED: "STOPPED", FAULT: "FAULT" };

class DeviceView {
  constructor(place, lab, store) {
    Object.assign(this, { place, lab, store, armed: false, running: false, clock: 0 });
  }

  async start() {
    this.store.holdBack(this.place);
    this.build();
    const hear = this.lab.socket.on;
    hear("connection", ({ open }) => (open ? this.begin() : this.lost()));
    hear("playing", ({ now }) => this.take(now));
    hear("device view", (view) => this.view(view));
    hear("device rows", (found) => this.rows(found));
    hear("device checked", (found) => this.checked(found));
    hear("device ended", (found) => this.ended(found));
    const bar = this.lab.stopBar;
    bar.stay(this.lab.signal);
    bar.place.addEventListener("stopped", () => this.disarm(), { signal: this.lab.signal });
    this.redraw = this.lab.frames(() => this.draw(), this.scopes.map((one) => one.canvas));
    if (this.lab.socket.open) await this.begin();
  }

  draw() {
    for (const scope of this.scopes) scope.draw(this.clock);
  }

  build() {
    const text = (id, value, size) => element("input", { type: "text", id, value, size, autocomplete: "off" });
    this.drive = element("select", { id: "drive", onchange: () => this.disarm() }, element("option", { value: "twin", text: "twin: a simulated device and hand" }));
    this.texture = element("select", { id: "device-texture", onchange: () => this.disarm() });
    this.mode = element("select", { id: "mode", onchange: () => this.disarm() }, element("option", { value: "stream", text: "this computer renders" }), element("option", { value: "tile", text: "the device renders (tile)" }));
    this.compensation = element("select", { id: "compensation" }, ...["none", "inverse"].map((one) => element("option", { value: one, text: one })));
    this.hold = element("input", { type: "checkbox", id: "hold" });
    this.stroke = text("stroke", "60 mm/s over 4 cm", 16);
    this.duration = text("duration", "10 s", 6);
    this.voltage = text("voltage-limit", "", 6);
    this.voltage.placeholder = "display's";
    this.error = element("p", { class: "error", role: "alert", hidden: true });
    this.checkButton = element("button", { text: "Check the device", onclick: () => this.tried(() => this.check()) });
    this.armButton = element("button", { text: "Arm", "aria-pressed": "false", onclick: () => this.arm() });
    this.playButton = element("button", { class: "main", text: "Play", disabled: true, onclick: () => this.tried(() => this.play()) });
    const field = (name, input) => element("label", { class: "stack" }, name, input);
    this.display = element("p", { class: "muted" });
    this.numbers = {
      state: number("state", "device_state"), position: number("position", "finger_position"), friction: number("relative friction", "relative_friction"),
      amplitude: number("vibration amplitude", "vibration_amplitude"), level: number("voltage", "voltage"), lag: number("lag", "loop_lag"), late: number("lateness of the loop", "lateness"), fault: number("fault", "fault"),
      loops: number("loops", "device_loops"),
    };
    const canvases = ["position (mm)", "command and level (V)", "amplitude wanted and measured (µm)", "lateness (µs)"].map((name) => {
      const canvas = element("canvas", { class: "scope small", role: "img", "aria-label": name });
      return { canvas, box: element("div", {}, element("h3", { text: name }), canvas) };
    });
    this.scopes = [
      new Scope(canvases[0].canvas, [{ label: "position", colour: "blue" }]),
      new Scope(canvases[1].canvas, [{ label: "command", colour: "orange", dash: [5, 3] }, { label: "level", colour: "blue" }]),
      new Scope(canvases[2].canvas, [{ label: "wanted", colour: "orange", dash: [5, 3] }, { label: "measured", colour: "blue" }]),
      new Scope(canvases[3].canvas, [{ label: "lateness", colour: "purple" }], { least: 1 }),
    ];
    this.results = element("section", { class: "card", hidden: true });
    this.age = new Age(this.lab, "updated");
    this.place.append(element("div", { class: "columns device" },
      element("section", { class: "card side" }, element("h2", { text: "Device" }), this.display, field("drive", this.drive), field("texture", this.texture), field("mode", this.mode),
        field("compensation of the resonator", this.compensation), field("hold resonance and amplitude", this.hold), field("the twin's finger", this.stroke), field("for", this.duration), field("most voltage", this.voltage),
        this.checkButton, this.armButton, this.playButton, this.error),
      this.moment = element("div", { class: "results" },
        element("section", { class: "card" }, this.age.box, element("div", { class: "numbers" }, ...Object.values(this.numbers).map((one) => one.box))),
        this.results,
        element("section", { class: "card scopes" }, ...canvases.map((one) => one.box)))));
    Object.assign(this.age, { place: this.moment, most: SILENT });
    const { mode, compensation, stroke, duration, voltage } = this;
    this.lab.remember("device", { mode, compensation, stroke, duration, voltage });
  }

  async begin() {
    await this.tried(async () => {
      await this.lab.during(this.store.start(this.place));
      this.display.textContent = `Display: ${this.store.current.name}, as the Design area has it.`;
      this.take((await this.lab.socket.ask("what plays")).now);
      const { ports } = await this.lab.socket.ask("drives"), [twin] = this.drive.options, chosen = this.drive.value;
      this.drive.replaceChildren(twin, ...ports.map((one) => element("option", { value: one.drive, text: one.text })));
      this.drive.value = ports.some((one) => one.drive === chosen) ? chosen : "twin";
      const { presets, saved } = await this.lab.socket.ask("textures"), played = this.texture.value;
      this.texture.replaceChildren(...presets.map((one) => element("option", { value: one.name, text: one.title || one.name })),
        ...saved.map((name) => element("option", { value: name, text: name })));
      this.texture.value = played || "biet2008-square-4mm";
      if (!played) this.lab.remember("device", { drive: this.drive, texture: this.texture });
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

  arm() {
    this.armed = !this.armed;
    this.armButton.setAttribute("aria-pressed", String(this.armed));
    this.armButton.textContent = this.armed ? "Armed – press to disarm" : "Arm";
    this.playButton.disabled = !this.armed || this.running;
  }

  disarm() {
    if (this.armed) this.arm();
  }

  take(now) {
    this.setRunning(now.some((one) => one.key === "device"));
  }

  /** The server went away, and with it whatever was known. */
  lost() {
    this.blank("not known");
    this.setRunning(false);
  }

  setRunning(running) {
    this.running = running;
    this.checkButton.disabled = running;
    this.armButton.disabled = running;
    this.playButton.disabled = running || !this.armed;
  }

  async check() {
    this.results.hidden = true;
    const fields = { display: this.store.current.text, drive: this.drive.value };
    await this.lab.during(this.lab.stopBar.begin("starting the check…", "check device", fields));
  }

  async play() {
    for (const scope of this.scopes) scope.clear();
    this.redraw();
    this.results.hidden = true;
    const fields = {
      display: this.store.current.text, drive: this.drive.value, armed: this.armed, preset: this.texture.value,
      mode: this.mode.value, stroke: this.stroke.value, duration: this.duration.value, compensation: this.compensation.value, hold: this.hold.checked,
    };
    if (this.voltage.value.trim()) fields.voltage = this.voltage.value;
    await this.lab.during(this.lab.stopBar.begin("starting…", "play device", fields));
  }

  view(view) {
    const n = this.numbers;
    this.age.now();
    n.state.value.textContent = view.state;
    n.position.value.textContent = view.x_m === null ? "not touching" : `${fixed(view.x_m * 1e3, 2)} mm`;
    n.position.note.textContent = view.speed_m_per_s === null ? "" : `${plain(view.speed_m_per_s * 1e3)} mm/s`;
    n.friction.value.textContent = plain(view.relative_friction);
    n.amplitude.value.textContent = quantity(view.amplitude_m, "m");
    n.amplitude.note.textContent = `wanted ${quantity(view.wanted_m, "m")}`;
    n.level.value.textContent = quantity(view.level_V, "V");
    n.lag.value.textContent = view.lag_m === null ? "–" : `${plain(view.lag_m * 1e3)} mm`;
    n.late.value.textContent = quantity(view.lateness_s, "s", 2);
    n.fault.value.textContent = view.fault === "NONE" ? "none" : view.fault;
    n.fault.note.textContent = view.flags.join(", ");
    n.loops.value.textContent = view.held === null ? "off" : view.held.mode;
    n.loops.note.textContent = view.loops;
  }

  rows({ columns, rows }) {
    const at = Object.fromEntries(columns.map((name, k) => [name, k]));
    const scaled = (row, name, factor) => (row[at[name]] === null ? null : row[at[name]] * factor);
    for (const row of rows) {
      const time = row[at.time_s];
      this.clock = Math.max(this.clock, time);
      this.scopes[0].add(time, [scaled(row, "x_m", 1e3)]);
      this.scopes[1].add(time, [scaled(row, "command_V", 1), scaled(row, "device_level_V", 1)]);
      this.scopes[2].add(time, [scaled(row, "wanted_amplitude_m", 1e6), scaled(row, "amplitude_m", 1e6)]);
      this.scopes[3].add(time, [scaled(row, "lateness_s", 1e6)]);
    }
    if (rows.length && rows[0][at.time_s] < this.clock - 60) this.clock = rows.at(-1)[at.time_s];
    this.redraw();
  }

  checked({ passed, results }) {
    this.results.hidden = false;
    this.results.replaceChildren(element("h2", { text: !passed ? "A check failed" : results.some((one) => one.doubt) ? "No check failed; some are in doubt" : "Every check passed" }),
      element("div", { class: "scroll" }, element("table", {}, element("tr", {}, ...["", "check", "measured", "allowed"].map((one) => element("th", { text: one }))),
        ...results.map((one) => element("tr", {}, element("td", { text: one.passed ? "pass" : one.doubt ? "doubt" : "FAIL", class: one.passed ? "passed" : one.doubt ? "doubted" : "failed" }),
          element("td", { text: one.name }), element("td", { text: one.measured }), element("td", { text: one.passed ? one.allowed : `${one.allowed}. ${one.doubt || one.advice}` }))))));
  }

  /** Numbers of a moment that is over would be taken for those of now. */
  blank(state, fault = "–", why = "") {
    this.age.none();
    for (const one of Object.values(this.numbers)) {
      one.value.textContent = "–";
      one.note.textContent = "";
    }
    this.numbers.state.value.textContent = state;
    this.numbers.fault.value.textContent = fault;
    this.numbers.fault.note.textContent = why;
  }

  ended({ failed, ending, message, summary }) {
    this.disarm();
    const unknown = failed ? "not known" : "–";
    this.blank(AFTER[ending] ?? unknown, ending === "FAULT" ? "yes" : unknown, failed ? message : "");
    if (!summary) return;
    const lines = Object.entries(summary).filter(([, value]) => typeof value === "number" || typeof value === "string").slice(0, 40);
    this.results.hidden = false;
    this.results.replaceChildren(element("h2", { text: "The session" }), element("div", { class: "scroll" }, element("table", {},
      ...lines.map(([key, value]) => element("tr", {}, element("th", { text: key.replaceAll("_", " ") }), element("td", { text: typeof value === "number" ? plain(value, 4) : value }))))));
  }
}
