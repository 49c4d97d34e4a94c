// Feel: drag over a texture at true scale; what the finger meets is rendered here, in the page.

import { Finger, frictionAt, parity } from "../finger.js";
import { gratingFields, gratingText } from "../grating.js";
import { element, fixed, number, plain, quantity } from "../numbers.js";
import { Renderer } from "../renderer.js";
import { download, saveAs, saved } from "../saving.js";
import { Scope } from "../scope.js";
import { SurfaceView } from "../surface_view.js";

const CARD_MM = 85.6;
const MOST_ROWS = 100000;
const TEXTURE = "squeezefilm texture";

export async function show(place, lab) {
  await new FeelView(place, lab, lab.display).start();
}

class FeelView {
  constructor(place, lab, store) {
    // `turn` counts what was asked to be felt: an answer to an earlier wish is not shown any more.
    Object.assign(this, { place, lab, store, turn: 0, rows: [], delays: [], pointer: null, drawn: 0 });
  }

  async start() {
    this.store.holdBack(this.place);
    this.build();
    this.redraw = this.lab.frames((now) => this.animate(now), [this.scopeCanvas]);
    this.lab.socket.on("connection", ({ open }) => open && this.begin());
    if (this.lab.socket.open) await this.begin();
  }

  async begin() {
    try {
      await this.lab.during(this.store.start(this.place));
      await this.listTextures();
      // Who was quicker than the list of textures has asked for one already.
      if (!this.ready) await (this.source ? this.reload() : this.goOn());
    } catch (error) {
      this.fail(error);
    }
  }

  /** What was felt and recorded when the area was left, the texture also before a reload. */
  async goOn() {
    this.rows = this.lab.shared.stroke ?? [];
    const kept = sessionStorage.getItem(TEXTURE);
    if (!kept) {
      await this.choose("preset:biet2008-square-4mm");
      return;
    }
    const { text, choice, source } = JSON.parse(kept);
    Object.assign(this, { source });
    this.text.value = text;
    this.choice.value = choice;
    await this.reload();
  }

  build() {
    this.choice = element("select", { id: "texture-choice", onchange: () => this.choose(this.choice.value) });
    this.error = element("p", { class: "error", role: "alert", hidden: true });
    this.text = element("textarea", { id: "texture-text", rows: "12", spellcheck: "false", "aria-label": "the texture as TOML", onchange: () => this.useText() });
    this.grating = gratingFields();
    const g = this.grating;
    const compose = element("details", {}, element("summary", { text: "Compose a grating" }),
      element("div", { class: "row" }, element("label", {}, "shape", g.shape), element("label", {}, "period", g.period)),
      element("div", { class: "row" }, element("label", {}, "friction from", g.low), element("label", {}, "to", g.high), element("label", {}, "towards", g.angle)),
      element("button", { text: "Use this grating", onclick: () => this.compose() }));
    this.pixel = element("input", { type: "text", value: "0.2 mm", size: "7", id: "pixel" });
    this.picture = element("input", { type: "file", accept: "image/png, image/jpeg", hidden: true, onchange: () => this.readPicture(this.picture.files[0]) });
    this.drop = element("button", { class: "drop", text: "Drop a PNG or JPEG here, or choose one…", onclick: () => this.picture.click() });
    this.drop.addEventListener("dragover", (event) => event.preventDefault());
    this.drop.addEventListener("drop", (event) => {
      event.preventDefault();
      this.readPicture(event.dataTransfer.files[0]);
    });
    const editor = element("details", {}, element("summary", { text: "The texture's text" }), this.text,
      element("button", { text: "Save the texture…", onclick: () => this.saveTexture() }));
    const tick = (label, change, tip = null) => {
      const box = element("input", { type: "checkbox", onchange: (event) => change(event.target.checked) });
      return { box, label: element("label", { title: tip }, box, label) };
    };
    this.wave = tick("the standing wave is felt", (on) => {
      this.view.showWave = on;
      if (this.finger) this.finger.wave = on;
      this.view.draw();
    });
    this.sound = tick("sound of the skin's vibration", (on) => this.setSound(on));
    this.illusion = tick("pseudo-haptic cursor", (on) => {
      this.note.hidden = !on;
      if (!on) this.view.shift = 0;
    });
    this.note = element("p", { class: "warning", hidden: true, text: "The cursor lags where friction is high. That is a visual illusion: your finger feels this screen's glass, nothing else." });
    this.solved = tick("with the plate solved in three dimensions", () => this.reload());
    this.parityLine = element("p", { class: "muted parity", role: "status", text: "" });
    const scale = element("input", { type: "range", min: "2", max: "12", step: "0.02", id: "scale", "aria-label": "pixels per millimetre" });
    this.card = element("div", { class: "card-bar", text: "85.6 mm" });
    const calibrate = element("details", {}, element("summary", { text: "True scale" }),
      element("p", { class: "muted", text: "Move the slider until the bar is as long as a bank card (85.6 mm)." }), scale, this.card);
    this.canvas = element("canvas", { class: "surface", tabindex: "0", role: "img", "aria-label": "the surface; drag over it with mouse, pen or touch, or use the arrow keys" });
    this.numbers = {
      friction: number("relative friction", "relative_friction"), amplitude: number("vibration amplitude", "vibration_amplitude"),
      force: number("tangential force", "tangential_force"), lag: number("lag", "lag"), speed: number("speed", "finger_speed"), delay: number("event → friction", "event_delay"),
    };
    this.numbers.lag.note.textContent = "of the vibration behind the finger";
    this.scopeCanvas = element("canvas", { class: "scope", role: "img", "aria-label": "relative friction wanted and met over the last seconds" });
    this.record = element("button", { text: "Record", "aria-pressed": "false", onclick: () => this.toggleRecord() });
    this.replay = element("button", { text: "Replay", disabled: true, onclick: () => this.startReplay() });
    this.save = element("button", { text: "Save the stroke…", disabled: true, onclick: () => this.saveStroke() });
    this.download = element("button", { text: "Download CSV", disabled: true, onclick: () => this.downloadStroke() });
    this.rate = element("small", { class: "muted" });
    this.heading = element("h2", { text: "…" });
    this.under = element("p", { class: "muted" });
    this.place.append(element("div", { class: "columns feel" },
      element("section", { class: "card side" }, element("h2", { text: "Texture" }), element("label", {}, "Choose", this.choice), this.error,
        compose, element("div", { class: "row" }, this.drop, element("label", {}, "side of a pixel", this.pixel)), this.picture, editor,
        element("h3", { text: "How" }), this.wave.label, this.sound.label, this.illusion.label, this.note, this.solved.label, calibrate, this.parityLine),
      element("div", { class: "results" },
        element("section", { class: "card" }, this.heading, this.under, element("div", { class: "scroll" }, this.canvas)),
        element("section", { class: "card" }, element("div", { class: "numbers" }, ...Object.values(this.numbers).map((one) => one.box))),
        element("section", { class: "card" }, this.scopeCanvas,
          element("div", { class: "row" }, this.record, this.replay, this.save, this.download, this.rate)))));
    this.view = new SurfaceView(this.canvas);
    scale.value = this.view.perMm;
    const resize = () => {
      this.card.style.width = `${CARD_MM * scale.value}px`;
    };
    scale.addEventListener("input", () => {
      this.view.setScale(Number(scale.value));
      resize();
    });
    resize();
    this.scope = new Scope(this.scopeCanvas, [
      { label: "friction wanted", colour: "orange", dash: [5, 3] }, { label: "friction met", colour: "blue" },
    ], { least: 1 });
    this.lab.remember("feel", { ...this.grating, pixel: this.pixel, wave: this.wave.box, solved: this.solved.box });
    this.view.showWave = this.wave.box.checked;
    this.listen();
  }

  listen() {
    const { canvas } = this;
    // Raw events come some milliseconds before the frame's; other browsers have only the latter.
    const raw = "onpointerrawupdate" in window ? "pointerrawupdate" : "pointermove";
    canvas.addEventListener("pointerdown", (event) => {
      // One finger strokes: places of two in turn would be a speed that no finger has.
      if (this.pointer !== null) return;
      canvas.setPointerCapture(event.pointerId);
      this.pointer = event.pointerId;
      this.lift();
      this.box = canvas.getBoundingClientRect();
      this.sample(event);
    });
    canvas.addEventListener(raw, (event) => {
      if (event.pointerId === this.pointer) this.sample(event);
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) canvas.addEventListener(end, (event) => {
      if (event.pointerId === this.pointer) this.pointer = null;
    });
    canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!step || !this.finger) return;
      event.preventDefault();
      const last = this.view.finger ?? { x: this.ready.width_m / 2, y: this.ready.height_m / 2 };
      this.meet(clamp(last.x + step[0] * 2e-4, this.ready.width_m), clamp(last.y + step[1] * 2e-4, this.ready.height_m), event.timeStamp);
    });
  }

  sample(event) {
    if (!this.finger || this.replaying) return;
    const [x, y] = this.view.place(event.clientX - this.box.left, event.clientY - this.box.top);
    this.meet(clamp(x, this.ready.width_m), clamp(y, this.ready.height_m), event.timeStamp);
  }

  /** One sample of the finger; everything that must be quick happens here, drawing in `animate`. */
  meet(x, y, stamp) {
    const met = this.finger.move(x, y, stamp / 1e3);
    this.delays.push(performance.now() - stamp);
    if (this.delays.length > 500) this.delays.shift();
    this.met = met;
    this.scope.add(stamp / 1e3, [met.frictionWanted, met.friction]);
    this.redraw();
    if (this.recording && this.rows.length < MOST_ROWS) {
      this.rows.push([stamp / 1e3 - this.began, x, y, met.speed, met.wanted, met.amplitude, met.friction, met.force]);
    }
    this.port?.postMessage({ place: { x, y, velocity: this.finger.velocity } });
  }

  lift() {
    this.finger?.reset();
    this.view.trail = [];
  }

  /** Draw the moment, and say whether the next one looks different. */
  animate(now) {
    this.drawn += 1;
    if (this.replaying) this.stepReplay(now);
    const { met, numbers: n } = this;
    if (met) {
      this.view.finger = met;
      this.view.trail.push(this.view.pixel(met.x, met.y));
      if (this.view.trail.length > 400) this.view.trail.shift();
      this.view.shift = this.illusion.box.checked ? -met.force * 40 : 0;
      this.view.draw();
      const moving = now / 1e3 - this.finger.time < 0.1;
      n.friction.value.textContent = plain(met.friction);
      n.friction.note.textContent = this.ready.finger_speed_m_per_s.length > 1 ? `at ${plain(met.pace * 1e3)} mm/s` : "";
      n.amplitude.value.textContent = quantity(met.amplitude, "m");
      n.amplitude.note.textContent = `wanted ${quantity(met.wanted, "m")}`;
      n.force.value.textContent = quantity(moving ? Math.abs(met.force) : 0, "N");
      n.lag.value.textContent = `${plain((moving ? met.lag : 0) * 1e3)} mm`;
      n.speed.value.textContent = `${plain((moving ? met.speed : 0) * 1e3)} mm/s`;
      if (this.drawn % 15 === 0 && this.delays.length) {
        const sorted = [...this.delays].sort((a, b) => a - b);
        n.delay.value.textContent = `${fixed(sorted[Math.floor(sorted.length / 2)], 2)} ms`;
        n.delay.note.textContent = `95 %: ${fixed(sorted[Math.floor(sorted.length * 0.95)], 2)} ms`;
      }
    }
    this.scope.draw(now / 1e3);
    return Boolean(this.replaying) || this.scope.moves(now / 1e3);
  }

  async listTextures() {
    const { presets, saved } = await this.lab.socket.ask("textures");
    const group = (label, names) => element("optgroup", { label }, ...names);
    this.choice.replaceChildren(group("presets", presets.map((one) => element("option", { value: `preset:${one.name}`, text: one.title || one.name }))),
      ...(saved.length ? [group("saved here", saved.map((name) => element("option", { value: `file:${name}`, text: name })))] : []),
      element("option", { value: "own", text: "your own text", hidden: true }));
  }

  async choose(value) {
    const [kind, name] = value.split(/:(.*)/);
    if (kind === "own") return;
    const turn = ++this.turn;
    try {
      const { text } = await this.lab.socket.ask("texture text", { [kind]: name });
      if (turn !== this.turn) return;
      this.text.value = text;
      this.choice.value = value;
      this.source = kind === "preset" ? { preset: name } : { texture: text };
      await this.reload();
    } catch (error) {
      this.fail(error);
    }
  }

  async useText() {
    this.choice.value = "own";
    this.source = { texture: this.text.value };
    await this.reload();
  }

  async compose() {
    try {
      this.text.value = gratingText(this.grating);
    } catch (error) {
      this.fail(error);
      return;
    }
    await this.useText();
  }

  async reload() {
    if (!this.source) return;
    const turn = ++this.turn;
    // Not when it is there: what went wrong meanwhile stays to be read.
    this.error.hidden = true;
    const asked = { display: this.store.current.text, quality: this.solved.box.checked ? "solved" : "screening", ...this.source };
    try {
      this.heading.textContent = "preparing…";
      const ready = await this.lab.socket.ask("load texture", asked);
      if (turn !== this.turn) return;
      sessionStorage.setItem(TEXTURE, JSON.stringify({ text: this.text.value, choice: this.choice.value, source: this.source }));
      this.take(ready);
      const samples = await this.lab.socket.ask("parity", asked);
      if (turn !== this.turn) return;
      const { ticks, worst } = parity(ready.program, samples);
      const same = worst <= 1e-12 * ready.largest_amplitude_m;
      this.parityLine.textContent = `Page and compiled loop: ${ticks} ticks ${same ? "agree" : "DIFFER"}, greatest difference ${quantity(worst, "m", 2)}.`;
      this.parityLine.classList.toggle("error", !same);
    } catch (error) {
      if (turn === this.turn) this.fail(error);
    }
  }

  take(ready) {
    this.ready = ready;
    this.finger = new Finger(ready, { wave: this.wave.box.checked });
    this.met = null;
    this.wave.box.disabled = !ready.wave;
    this.heading.textContent = `${ready.title}, on ${ready.display}`;
    this.under.textContent = `${plain(ready.width_m * 1e3)} mm × ${plain(ready.height_m * 1e3)} mm at true scale; blue is slippery. Friction µ = ${plain(ready.friction_coefficient)}, from ${plain(frictionAt(ready, ready.largest_amplitude_m))} to 1 of it at ${quantity(ready.voltage_V, "V")} and ${quantity(ready.nominal_finger_speed_m_per_s, "m/s")}; ${ready.vibration_model.replaceAll("_", " ")}, ${ready.friction_model}.`;
    const renderer = new Renderer(ready.program);
    const friction = {
      amplitude: (v) => frictionAt(ready, v),
      relative_friction: (v) => v,
      friction_reduction: (v) => 1 - v / ready.friction_coefficient,
    }[ready.quantity];
    this.view.set(ready, (x, y) => friction(renderer.value(x, y, ready.nominal_finger_speed_m_per_s, 0)));
    this.port?.postMessage({ ready });
    this.scope.clear();
    this.redraw();
    this.showStroke();
  }

  async setSound(on) {
    if (!on) {
      await this.audio?.suspend();
      return;
    }
    if (!this.audio) {
      this.audio = new AudioContext();
      this.lab.keep(() => this.audio.close());
      await this.lab.during(this.audio.audioWorklet.addModule("/static/skin_sound.js"));
      const node = new AudioWorkletNode(this.audio, "skin-sound", { outputChannelCount: [1] });
      node.connect(this.audio.destination);
      this.port = node.port;
      if (this.ready) this.port.postMessage({ ready: this.ready });
    }
    await this.audio.resume();
  }

  toggleRecord() {
    this.recording = !this.recording;
    this.record.setAttribute("aria-pressed", String(this.recording));
    this.record.textContent = this.recording ? "Stop recording" : "Record";
    if (this.recording) {
      this.rows = this.lab.shared.stroke = [];
      this.began = performance.now() / 1e3;
    }
    this.showStroke();
  }

  /** What may be done with the stroke that was recorded, and how long it is. */
  showStroke() {
    const some = !this.recording && this.rows.length > 0;
    for (const button of [this.replay, this.save, this.download]) button.disabled = !some;
    this.rate.textContent = some ? `${this.rows.length} samples, ${plain(this.rows.at(-1)[0] - this.rows[0][0])} s` : "";
  }

  startReplay() {
    this.lift();
    this.replaying = { at: 0, began: performance.now() };
    this.redraw();
  }

  stepReplay(now) {
    const { replaying, rows } = this, first = rows[0][0];
    while (replaying.at < rows.length && rows[replaying.at][0] - first <= (now - replaying.began) / 1e3) {
      const [time, x, y] = rows[replaying.at];
      this.met = this.finger.move(x, y, replaying.began / 1e3 + time - first);
      this.scope.add(replaying.began / 1e3 + time - first, [this.met.frictionWanted, this.met.friction]);
      replaying.at += 1;
    }
    if (replaying.at >= rows.length) this.replaying = null;
  }

  async saveStroke() {
    try {
      await saveAs(this.lab, "the stroke", "stroke", "save stroke", { rows: this.rows });
    } catch (error) {
      this.fail(error);
    }
  }

  downloadStroke() {
    const head = "time_s,x_m,y_m,speed_m_per_s,wanted_amplitude_m,amplitude_m,relative_friction,tangential_force_N";
    const text = [head, ...this.rows.map((row) => row.join(","))].join("\n");
    download(`${text}\n`, "text/csv", "stroke.csv");
  }

  async readPicture(file) {
    if (!file) return;
    try {
      if (file.size > 5e6) throw new Error(`${file.name} has ${plain(file.size / 1e6)} MB; at most 5 MB are taken`);
      const bytes = new Uint8Array(await file.arrayBuffer());
      let text = "";
      for (let k = 0; k < bytes.length; k += 8192) text += String.fromCharCode(...bytes.subarray(k, k + 8192));
      const name = file.name.replace(/\.[a-z]+$/i, "").replace(/[^A-Za-z0-9_-]+/g, "-");
      const found = await saved(this.lab, "add picture", { name, data: btoa(text), pixel: this.pixel.value });
      if (!found) return;
      if (found.note) this.lab.notify(found.note);
      this.text.value = found.text;
      await this.useText();
    } catch (error) {
      this.fail(error);
    }
  }

  async saveTexture() {
    try {
      if (await saveAs(this.lab, "the texture", "texture", "save texture", { text: this.text.value })) await this.listTextures();
    } catch (error) {
      this.fail(error);
    }
  }

  fail(error) {
    this.error.textContent = error.message;
    this.error.hidden = false;
    this.heading.textContent = this.ready ? this.heading.textContent.replace("preparing…", this.ready.title) : "no texture";
  }
}

function clamp(value, high) {
  return Math.max(0, Math.min(high, value));
}
