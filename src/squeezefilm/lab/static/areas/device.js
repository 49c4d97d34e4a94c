// Device: choose a twin or a port, check it, arm it, play, watch, stop. The space bar stops.

import { displayStore } from "../display_store.js";
import { element, number, plain, quantity } from "../numbers.js";
import { Scope } from "../scope.js";

export async function show(place, lab) {
  const view = new DeviceView(place, lab, displayStore(lab));
  await view.start();
  return () => view.close();
}

class DeviceView {
  constructor(place, lab, store) {
    Object.assign(this, { place, lab, store, off: [], armed: false, running: false, clock: 0 });
  }

  async start() {
    this.build();
    const hear = (type, act) => this.off.push(this.lab.socket.on(type, act));
    hear("connection", ({ open }) => open && this.begin());
    hear("device progress", ({ text }) => this.say(`${text}…`));
    hear("device view", (view) => this.view(view));
    hear("device rows", (found) => this.rows(found));
    hear("device checked", (found) => this.checked(found));
    hear("device ended", (found) => this.ended(found));
    if (this.lab.socket.open) await this.begin();
    const frame = () => {
      for (const scope of this.scopes) scope.draw(this.clock);
      this.frame = requestAnimationFrame(frame);
    };
    frame();
    // Anywhere on this page, before any button it might press.
    this.keys = (event) => {
      if (event.code !== "Space" || event.target.matches("input[type=text]")) return;
      event.preventDefault();
      event.stopPropagation();
      this.stop();
    };
    document.addEventListener("keydown", this.keys, true);
  }

  build() {
    const text = (id, value, size) => element("input", { type: "text", id, value, size, autocomplete: "off" });
    this.drive = element("select", { id: "drive", onchange: () => this.disarm() }, element("option", { value: "twin", text: "twin: a simulated device and hand" }));
    this.texture = element("select", { id: "device-texture", onchange: () => this.disarm() });
    this.mode = element("select", { id: "mode", onchange: () => this.disarm() }, element("option", { value: "stream", text: "this computer renders" }), element("option", { value: "tile", text: "the device renders (tile)" }));
    this.compensation = element("select", { id: "compensation" }, ...["none", "inverse"].map((one) => element("option", { value: one, text: one })));
    this.stroke = text("stroke", "60 mm/s over 4 cm", 16);
    this.duration = text("duration", "10 s", 6);
    this.voltage = text("voltage-limit", "", 6);
    this.voltage.placeholder = "display's";
    this.error = element("p", { class: "error", role: "alert", hidden: true });
    this.checkButton = element("button", { text: "Check the device", onclick: () => this.tried(() => this.check()) });
    this.armButton = element("button", { text: "Arm", "aria-pressed": "false", onclick: () => this.arm() });
    this.playButton = element("button", { class: "main", text: "Play", disabled: true, onclick: () => this.tried(() => this.play()) });
    this.stopButton = element("button", { class: "stop", text: "STOP (space bar)", onclick: () => this.stop() });
    this.said = element("p", { class: "muted", role: "status", text: "not connected" });
    const field = (name, input) => element("label", { class: "stack" }, name, input);
    this.display = element("p", { class: "muted" });
    this.numbers = {
      state: number("state", "device_state"), position: number("position", "finger_position"), friction: number("relative friction", "relative_friction"),
      amplitude: number("vibration amplitude", "vibration_amplitude"), level: number("voltage", "voltage"), lag: number("lag", "loop_lag"), late: number("lateness of the loop", "lateness"), fault: number("fault", "fault"),
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
    this.place.append(element("div", { class: "columns device" },
      element("section", { class: "card side" }, element("h2", { text: "Device" }), this.display, field("drive", this.drive), field("texture", this.texture), field("mode", this.mode),
        field("compensation of the resonator", this.compensation), field("the twin's finger", this.stroke), field("for", this.duration), field("most voltage", this.voltage),
        this.checkButton, this.armButton, this.playButton, this.error),
      element("div", { class: "results" },
        element("section", { class: "card row stopbar" }, this.stopButton, this.said),
        element("section", { class: "card" }, element("div", { class: "numbers" }, ...Object.values(this.numbers).map((one) => one.box))),
        this.results,
        element("section", { class: "card scopes" }, ...canvases.map((one) => one.box)))));
  }

  async begin() {
    await this.tried(async () => {
      await this.store.start();
      this.display.textContent = `Display: ${this.store.current.name}, as the Design area has it.`;
      const { ports, running } = await this.lab.socket.ask("drives");
      for (const one of ports) this.drive.append(element("option", { value: one.drive, text: one.text }));
      const { presets, saved } = await this.lab.socket.ask("textures");
      this.texture.replaceChildren(...presets.map((one) => element("option", { value: one.name, text: one.title || one.name })),
        ...saved.map((name) => element("option", { value: name, text: name })));
      this.texture.value = "biet2008-square-4mm";
      this.setRunning(running);
      this.say(running ? "playing" : "ready");
    });
  }

  async tried(work) {
    try {
      this.error.hidden = true;
      await work();
    } catch (error) {
      this.error.textContent = error.message;
      this.error.hidden = false;
      if (!this.running) this.say("ready");
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

  setRunning(running) {
    this.running = running;
    this.checkButton.disabled = running;
    this.armButton.disabled = running;
    this.playButton.disabled = running || !this.armed;
  }

  say(text, failed = false) {
    this.said.textContent = text;
    this.said.classList.toggle("error", failed);
  }

  async check() {
    this.results.hidden = true;
    this.say("starting the check…");
    await this.lab.socket.ask("check device", { display: this.store.current.text, drive: this.drive.value });
    this.setRunning(true);
  }

  async play() {
    for (const scope of this.scopes) scope.clear();
    this.results.hidden = true;
    this.say("starting…");
    const fields = {
      display: this.store.current.text, drive: this.drive.value, armed: this.armed, preset: this.texture.value,
      mode: this.mode.value, stroke: this.stroke.value, duration: this.duration.value, compensation: this.compensation.value,
    };
    if (this.voltage.value.trim()) fields.voltage = this.voltage.value;
    const { folder } = await this.lab.socket.ask("play device", fields);
    this.setRunning(true);
    this.say(`starting; recorded in ${folder}`);
  }

  stop() {
    this.disarm();
    if (!this.running) return;
    this.say("stopping…");
    this.tried(() => this.lab.socket.ask("stop device"));
  }

  view(view) {
    if (!this.running) this.setRunning(true);
    const n = this.numbers;
    this.say(`playing, ${plain(view.time_s)} s`);
    n.state.value.textContent = view.state;
    n.position.value.textContent = view.x_m === null ? "not touching" : `${(view.x_m * 1e3).toFixed(2)} mm`;
    n.position.note.textContent = view.speed_m_per_s === null ? "" : `${plain(view.speed_m_per_s * 1e3)} mm/s`;
    n.friction.value.textContent = plain(view.relative_friction);
    n.amplitude.value.textContent = quantity(view.amplitude_m, "m");
    n.amplitude.note.textContent = `wanted ${quantity(view.wanted_m, "m")}`;
    n.level.value.textContent = quantity(view.level_V, "V");
    n.lag.value.textContent = view.lag_m === null ? "–" : `${plain(view.lag_m * 1e3)} mm`;
    n.late.value.textContent = quantity(view.lateness_s, "s", 2);
    n.fault.value.textContent = view.fault === "NONE" ? "none" : view.fault;
    n.fault.note.textContent = view.flags.join(", ");
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
  }

  checked({ passed, results }) {
    this.results.hidden = false;
    this.results.replaceChildren(element("h2", { text: passed ? "Every check passed" : "A check failed" }),
      element("div", { class: "scroll" }, element("table", {}, element("tr", {}, ...["", "check", "measured", "allowed"].map((one) => element("th", { text: one }))),
        ...results.map((one) => element("tr", {}, element("td", { text: one.passed ? "pass" : "FAIL", class: one.passed ? "passed" : "failed" }),
          element("td", { text: one.name }), element("td", { text: one.measured }), element("td", { text: one.passed ? one.allowed : `${one.allowed}. ${one.advice}` }))))));
  }

  ended({ failed, message, summary, folder }) {
    this.setRunning(false);
    this.disarm();
    this.say(failed ? `ended: ${message}` : (summary ? `done: ${message}; recorded in ${folder}` : message), Boolean(failed));
    if (!summary) return;
    const lines = Object.entries(summary).filter(([, value]) => typeof value === "number" || typeof value === "string").slice(0, 40);
    this.results.hidden = false;
    this.results.replaceChildren(element("h2", { text: "The session" }), element("div", { class: "scroll" }, element("table", {},
      ...lines.map(([key, value]) => element("tr", {}, element("th", { text: key.replaceAll("_", " ") }), element("td", { text: typeof value === "number" ? plain(value, 4) : value }))))));
  }

  close() {
    cancelAnimationFrame(this.frame);
    document.removeEventListener("keydown", this.keys, true);
    for (const off of this.off) off();
  }
}
