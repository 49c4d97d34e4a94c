// The stop bar: in every area while anything plays or may, and the keys that stop. Space stops what
// plays unless a text is being typed; Escape stops it there as well. Where nothing plays both keys do
// what they do on any page.

import { element, plain } from "./numbers.js";

const NO_TEXT = "button, checkbox, color, file, image, radio, range, reset, submit".split(", ");

/** Whether keys typed at this element become text. */
function takesText(target) {
  if (target.matches?.("input")) return !NO_TEXT.includes(target.type);
  return target.isContentEditable || Boolean(target.matches?.("textarea"));
}

export class StopBar {
  constructor(place, socket, notify) {
    Object.assign(this, { place, socket, notify, now: [], begun: false, always: false, taken: false });
    this.said = element("p", { class: "muted", role: "status", text: "not connected" });
    this.others = element("p", { class: "muted" });
    place.append(element("button", { class: "stop", text: "STOP (Space or Escape)", onclick: () => this.stop() }), this.said, this.others);
    socket.on("connection", ({ open }) => (open ? this.learn() : this.lost()));
    socket.on("silence", ({ seconds }) => this.silent(seconds));
    socket.on("playing", ({ now }) => this.take(now));
    socket.on("device progress", ({ text }) => this.say(`${text}…`));
    socket.on("device view", (view) => this.say(`playing, ${plain(view.time_s)} s`));
    socket.on("device ended", (found) => this.ended(found));
    // Before any button, list or area that the key might mean.
    for (const type of ["keydown", "keyup"]) document.addEventListener(type, (event) => this.pressed(event), true);
    this.show();
  }

  /** Whether something plays, or begins to. */
  get plays() {
    return this.begun || this.now.some((one) => one.plays);
  }

  async learn() {
    try {
      this.take((await this.socket.ask("what plays")).now);
      if (!this.plays) this.say("ready");
    } catch {
      // The connection went again; the next one asks anew.
    }
  }

  lost() {
    if (this.plays) this.say("the lab is not running; a device that played is stopped by its own watchdog", true);
    this.begun = false;
    this.take([]);
  }

  /** A lab that is held up cannot stop anything, and the process that plays goes on without it. */
  silent(seconds) {
    if (!this.plays) return;
    if (seconds) this.say(`no answer for ${Math.round(seconds)} s: what plays may go on, and STOP is heard only when the lab answers; switch the amplifier off by hand`, true);
    else this.say("playing");
  }

  take(now) {
    this.now = now;
    if (now.some((one) => one.key === "device")) this.begun = false;
    const others = now.filter((one) => one.key !== "device");
    this.others.textContent = others.map((one) => `${one.text}: ${one.plays ? "playing" : "silent"}`).join("; ");
    this.show();
  }

  /** Ask for something that plays; from now on a stop stops it. Rejected where it did not begin. */
  async begin(text, type, fields) {
    this.begun = true;
    this.say(text);
    this.show();
    try {
      await this.socket.ask(type, fields);
    } catch (error) {
      this.begun = false;
      if (!this.plays) this.say("ready");
      if (!this.always) this.notify(error.message, { failed: true });
      this.show();
      throw error;
    }
  }

  ended({ failed, message, summary, folder }) {
    const text = failed ? `ended: ${message}` : (summary ? `done: ${message}; recorded in ${folder}` : message);
    this.begun = false;
    this.say(text, Boolean(failed));
    // Where the bar goes with what played, a failure is still said.
    if (failed && !this.always) this.notify(`The device's session ${text}.`, { failed: true });
    this.show();
  }

  say(text, failed = false) {
    this.said.textContent = text;
    this.said.classList.toggle("error", failed);
  }

  /** An area where a device may be begun shows the bar all the time; it cannot jump under a finger. */
  stay(signal) {
    this.always = true;
    signal.addEventListener("abort", () => {
      this.always = false;
      this.show();
    }, { once: true });
    this.show();
  }

  show() {
    this.place.hidden = !this.always && !this.plays && !this.now.length;
  }

  stop() {
    if (this.plays) this.say("stopping…");
    this.place.dispatchEvent(new CustomEvent("stopped"));
    this.socket.ask("stop everything").catch((error) => this.say(error.message, true));
  }

  pressed(event) {
    if (event.code !== "Space" && event.key !== "Escape") return;
    const pressed = event.type === "keydown" && !event.repeat;
    if (pressed) this.taken = this.plays && (event.key === "Escape" || !takesText(event.target));
    if (!this.taken) return;
    // The key that stopped presses nothing else, however long it is held.
    event.preventDefault();
    event.stopPropagation();
    if (pressed) this.stop();
    if (event.type === "keyup") this.taken = false;
  }
}
