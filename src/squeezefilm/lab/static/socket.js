// One websocket to the lab: requests with answers, messages nobody asked for, and coming back after
// the server was away. Requests that were on the way when it went are refused, never sent twice.
// The lab says twice a second that it is alive; where it says nothing, what is shown may be old.

const FIRST_WAIT = 250, LONGEST_WAIT = 4000;
const LOOK = 250, SILENT = 1500;

export class Socket {
  constructor(path) {
    this.path = path;
    this.waiting = new Map();
    this.listeners = new Map();
    this.number = 0;
    this.wait = FIRST_WAIT;
    this.open = this.silent = false;
    this.heard = 0;
    this.connect();
    setInterval(() => this.listen(), LOOK);
  }

  /** Say while nothing is heard over an open connection for how long that is (s), and 0 when it ends. */
  listen() {
    const silence = performance.now() - this.heard, was = this.silent;
    this.silent = this.open && silence > SILENT;
    if (this.silent || was) this.emit("silence", { seconds: this.silent ? silence / 1e3 : 0 });
  }

  connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}${this.path}`);
    this.socket = socket;
    socket.addEventListener("open", () => {
      this.open = true;
      this.heard = performance.now();
      this.wait = FIRST_WAIT;
      this.emit("connection", { open: true });
    });
    socket.addEventListener("message", (event) => {
      this.heard = performance.now();
      if (this.silent) this.listen();
      const message = JSON.parse(event.data);
      const asked = this.waiting.get(message.id);
      if (asked) {
        this.waiting.delete(message.id);
        if (message.type === "error") asked.reject(Object.assign(new Error(message.message), { again: message.again === true }));
        else asked.resolve(message);
      } else this.emit(message.type, message);
    });
    socket.addEventListener("close", () => {
      const was = this.open;
      this.open = false;
      for (const asked of this.waiting.values()) asked.reject(away("the lab went away"));
      this.waiting.clear();
      if (was) this.emit("connection", { open: false, refused: false });
      else this.askWhy();
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    });
  }

  /** A browser does not tell a page why its websocket was refused; a request's status does. */
  async askWhy() {
    try {
      const answer = await fetch("/static/numbers.js", { method: "HEAD" });
      if (answer.status === 401 || answer.status === 403) this.emit("connection", { open: false, refused: true });
    } catch {
      // The server is not there; the next try says more.
    }
  }

  /** The answer to a request; rejected with the server's words, or when the connection is lost. */
  ask(type, fields = {}) {
    return new Promise((resolve, reject) => {
      if (!this.open) {
        reject(away("the lab is not connected"));
        return;
      }
      const id = (this.number += 1);
      this.waiting.set(id, { resolve, reject });
      this.socket.send(JSON.stringify({ id, type, ...fields }));
    });
  }

  /** Hear messages of a type; returns what stops hearing them. */
  on(type, listener) {
    if (!this.listeners.has(type)) this.listeners.set(type, new Set());
    this.listeners.get(type).add(listener);
    return () => this.listeners.get(type).delete(listener);
  }

  emit(type, message) {
    for (const listener of this.listeners.get(type) ?? []) listener(message);
  }
}

/** An error that says nothing of what was asked, only that nobody answered. */
function away(message) {
  return Object.assign(new Error(message), { away: true });
}
