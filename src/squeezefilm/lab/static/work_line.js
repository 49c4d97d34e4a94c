// What is being computed, how far it is, since when, and a button that ends it.

import { element } from "./numbers.js";

export class WorkLine {
  constructor(cancel) {
    this.text = element("span", { role: "status" });
    this.time = element("span", { class: "muted", "aria-hidden": "true" });
    this.bar = element("progress", { max: 1, hidden: true, "aria-label": "share done" });
    this.box = element("p", { class: "work", hidden: true }, this.text, this.bar, this.time,
      element("button", { text: "Cancel", onclick: cancel }));
  }

  /** Say what is computed now; the seconds count from here. */
  begin(what) {
    this.end();
    const began = performance.now();
    const shown = () => {
      this.time.textContent = `${Math.round((performance.now() - began) / 1e3)} s`;
      if (this.ticking && !this.box.isConnected) this.end();
    };
    this.text.textContent = what;
    this.bar.hidden = true;
    shown();
    this.ticking = setInterval(shown, 1000);
    this.box.hidden = false;
  }

  /** How far it is, where that is known: the share that is done, and in words. */
  far(share, text) {
    this.bar.hidden = false;
    this.bar.value = share;
    this.bar.title = text;
  }

  /** End it; where `what` is given, only if that is still what is computed. */
  end(what = this.text.textContent) {
    if (what !== this.text.textContent) return;
    clearInterval(this.ticking);
    this.ticking = 0;
    this.box.hidden = true;
  }
}
