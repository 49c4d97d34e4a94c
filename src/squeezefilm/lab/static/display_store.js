// The display that is being worked on, one for all areas: its text, what it says, undo and redo.
// Kept in the tab's own storage, so that a reload loses nothing: neither the steps, nor an edit that
// the lab has not answered, which is made when it answers again.

const KEY = "squeezefilm display", STEPS = "squeezefilm display steps", EDITS = "squeezefilm display edits";
const MOST_STEPS = 200, MOST_KEPT = 2e6;

export class DisplayStore {
  constructor(socket) {
    this.socket = socket;
    this.past = [];
    this.future = [];
    this.current = null;
    this.listeners = new Set();
    // Edits that are not made yet, in their order, and why the lab refused one that had to wait.
    this.edits = JSON.parse(sessionStorage.getItem(EDITS) ?? "[]");
    this.refused = new Map();
    this.last = Promise.resolve();
  }

  /** Do it when what was asked for before is done: each edit is of the text that the last one left. */
  inTurn(work) {
    const done = this.last.then(work);
    this.last = done.catch(() => {});
    return done;
  }

  on(listener) {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  /** Open a preset, a saved file or a text; forgets what could be undone. */
  open(fields) {
    return this.inTurn(async () => {
      const answer = await this.socket.ask("open display", fields);
      this.past = [];
      this.future = [];
      this.edits = [];
      this.refused.clear();
      this.take(answer);
      this.changed();
    });
  }

  /** A place whose buttons need a display: nothing in it can be pressed until there is one. */
  holdBack(place) {
    place.inert = !this.current;
  }

  /** The display of the last visit, or the paper's plate. */
  async start(place) {
    if (!this.current) {
      // Areas that are entered one after the other wait for the same.
      this.starting ??= this.restore().finally(() => {
        this.starting = null;
      });
      await this.starting;
    }
    await this.makeEdits();
    place.inert = false;
  }

  async restore() {
    const kept = sessionStorage.getItem(KEY), { edits } = this;
    const { past, future } = JSON.parse(sessionStorage.getItem(STEPS) ?? '{"past":[],"future":[]}');
    try {
      await this.open(kept ? { text: kept } : { preset: "biet2008-plate" });
      Object.assign(this, { past, future, edits });
      this.keep();
    } catch (error) {
      if (!kept || error.away) throw error;
      sessionStorage.removeItem(KEY);
      await this.open({ preset: "biet2008-plate" });
    }
  }

  /** Write one value anew; rejected, with nothing changed, where it cannot be. Where the lab does not
   * answer, the edit is kept and made when it does. */
  edit(path, value, more = {}) {
    const edit = { path, value, ...more };
    this.edits = [...this.edits.filter((one) => one.path !== path), edit];
    this.refused.delete(path);
    this.keep();
    return this.inTurn(() => this.make(edit));
  }

  /** Make an edit, unless a later one of the same value has taken its place. */
  async make(edit) {
    if (!this.edits.includes(edit)) return;
    const before = this.current.text;
    try {
      const answer = await this.socket.ask("edit display", { text: before, ...edit });
      this.edits = this.edits.filter((one) => one !== edit);
      this.past.push(before);
      if (this.past.length > MOST_STEPS) this.past.shift();
      this.future = [];
      this.take(answer);
      this.changed();
    } catch (error) {
      if (error.away) throw Object.assign(error, { message: "not written yet: kept here, and written when the lab answers again" });
      this.edits = this.edits.filter((one) => one !== edit);
      this.keep();
      throw error;
    }
  }

  /** Make the edits that had to wait; one that is refused is said beside its field. */
  async makeEdits() {
    for (const edit of this.edits) {
      await this.inTurn(() => this.make(edit)).catch((error) => {
        if (!error.away) this.refused.set(edit.path, `${edit.value} was not written: ${error.message}`);
      });
    }
  }

  undo() {
    return this.inTurn(() => this.step(this.past, this.future));
  }

  redo() {
    return this.inTurn(() => this.step(this.future, this.past));
  }

  async step(from, to) {
    if (!from.length) return;
    const answer = await this.socket.ask("open display", { text: from.at(-1) });
    from.pop();
    to.push(this.current.text);
    this.take(answer);
    this.changed();
  }

  take(answer) {
    this.current = answer;
    sessionStorage.setItem(KEY, answer.text);
    this.keep();
  }

  /** Keep steps and edits over a reload; of steps that are too much to keep, the oldest go. */
  keep() {
    sessionStorage.setItem(EDITS, JSON.stringify(this.edits));
    let { past, future } = this, text = JSON.stringify({ past, future });
    while (text.length > MOST_KEPT) {
      past = past.slice(Math.ceil(past.length / 2));
      if (!past.length) future = future.slice(Math.ceil(future.length / 2));
      text = JSON.stringify({ past, future });
    }
    sessionStorage.setItem(STEPS, text);
  }

  /** The value is to be as it is: what waited to be written is not. */
  forget(path) {
    this.edits = this.edits.filter((one) => one.path !== path);
    this.refused.delete(path);
    this.keep();
  }

  changed() {
    for (const listener of this.listeners) listener(this.current);
  }
}
