// The display that is being worked on, one for all areas: its text, what it says, undo and redo.
// Kept in the tab's own storage, so that a reload loses nothing.

const KEY = "squeezefilm display";
const MOST_STEPS = 200;

export class DisplayStore {
  constructor(socket) {
    this.socket = socket;
    this.past = [];
    this.future = [];
    this.current = null;
    this.listeners = new Set();
  }

  on(listener) {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  /** Open a preset, a saved file or a text; forgets what could be undone. */
  async open(fields) {
    this.take(await this.socket.ask("open display", fields));
    this.past = [];
    this.future = [];
    this.changed();
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
    place.inert = false;
  }

  async restore() {
    const kept = sessionStorage.getItem(KEY);
    try {
      await this.open(kept ? { text: kept } : { preset: "biet2008-plate" });
    } catch (error) {
      if (!kept) throw error;
      sessionStorage.removeItem(KEY);
      await this.open({ preset: "biet2008-plate" });
    }
  }

  /** Write one value anew; rejected, with nothing changed, where it cannot be. */
  async edit(path, value) {
    const before = this.current.text;
    const answer = await this.socket.ask("edit display", { text: before, path, value });
    this.past.push(before);
    if (this.past.length > MOST_STEPS) this.past.shift();
    this.future = [];
    this.take(answer);
    this.changed();
  }

  async undo() {
    await this.step(this.past, this.future);
  }

  async redo() {
    await this.step(this.future, this.past);
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
  }

  changed() {
    for (const listener of this.listeners) listener(this.current);
  }
}
