// One stay in an area. Whatever an area hears, draws or asks goes through its visit and ends when the
// area is left, also what it would only have begun after that; so no area keeps a list of its own.

export class Visit {
  /** Of a page: {socket, notify, shared, display, stopBar}. */
  constructor(page) {
    const { socket } = page, leaving = new AbortController();
    this.page = page;
    this.signal = leaving.signal;
    this.leave = () => leaving.abort();
    Object.assign(this, { notify: page.notify, shared: page.shared, display: page.display, stopBar: page.stopBar });
    this.socket = {
      ask: (type, fields) => (this.signal.aborted ? never() : this.during(socket.ask(type, fields))),
      on: (type, listener) => this.keep(socket.on(type, listener)),
      get open() {
        return socket.open;
      },
    };
  }

  /** Do this on leaving; at once where the area was left already. */
  keep(undo) {
    if (this.signal.aborted) undo();
    else this.signal.addEventListener("abort", undo, { once: true });
  }

  /** What a promise comes to, while somebody is here; after that it never comes to anything. */
  during(promise) {
    return new Promise((resolve, reject) => {
      const here = (act) => (value) => this.signal.aborted || act(value);
      promise.then(here(resolve), here(reject));
    });
  }

  /** Ask for something to be done and said to its end, also where the area was left meanwhile. */
  async act(type, fields) {
    try {
      return await this.page.socket.ask(type, fields);
    } catch (error) {
      if (!this.signal.aborted) throw error;
      this.notify(error.message, { failed: true });
      return never();
    }
  }

  /** Draw with the frames of the screen for as long as `draw` says that more is to come. What this
   * returns draws again; so does another size of one of the canvases, and another colour scheme. */
  frames(draw, canvases = []) {
    let next = 0;
    const step = (now) => {
      next = 0;
      if (draw(now)) wake();
    };
    const wake = () => {
      if (!next && !this.signal.aborted) next = requestAnimationFrame(step);
    };
    const sizes = new ResizeObserver(wake), dark = matchMedia("(prefers-color-scheme: dark)");
    for (const canvas of canvases) sizes.observe(canvas);
    dark.addEventListener("change", wake, { signal: this.signal });
    this.keep(() => {
      sizes.disconnect();
      cancelAnimationFrame(next);
    });
    return wake;
  }

  /** Fields have again what was in them when an area of this name was left. */
  remember(area, fields) {
    const kept = (this.shared[area] ??= {});
    for (const [name, field] of Object.entries(fields)) {
      const value = field.type === "checkbox" ? "checked" : "value";
      if (name in kept) field[value] = kept[name];
      this.keep(() => {
        kept[name] = field[value];
      });
    }
  }
}

function never() {
  return new Promise(() => {});
}
