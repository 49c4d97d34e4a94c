// The front of a design search: what was screened, what was solved, the display to compare with. A
// plate opens with a press; the arrow keys go from one to the next.

import { element, plain } from "./numbers.js";

const SVG = "http://www.w3.org/2000/svg";
const HEIGHT = 340, LEFT = 58, BOTTOM = 44, TOP = 14, RIGHT = 18;
const PREFIXES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"]];

export class FrontView {
  /** `open(name)` is called for a plate that is pressed, `point(name)` for one under pointer or focus. */
  constructor({ open, point }) {
    Object.assign(this, { open, point, found: null, axes: [0, 1], circles: new Map(), width: 0, current: null });
    this.grid = make("g", { "aria-hidden": "true" });
    this.screened = make("path", { class: "screened" });
    this.steps = make("path", { class: "steps" });
    this.mark = make("g", { class: "reference" });
    this.plates = make("g", { role: "group", "aria-label": "plates of the front" });
    this.svg = make("svg", { height: HEIGHT, role: "group", "aria-label": "the front" },
      this.grid, this.screened, this.steps, this.mark, this.plates);
    this.svg.addEventListener("keydown", (event) => this.pressed(event));
    this.choices = element("p", { class: "row", hidden: true });
    this.legend = element("p", { class: "row legend muted" });
    this.box = element("div", { class: "front-view" }, this.choices, this.svg, this.legend);
    this.watcher = new ResizeObserver(() => this.draw());
    this.watcher.observe(this.box);
  }

  /** `objectives` ({said, unit}), `screened` (rows), `plates` ({name, objectives, words}), `reference`, `chosen` (a name). */
  set(found) {
    const before = this.found?.objectives.length;
    this.found = found;
    if (found.objectives.length !== before) {
      this.axes = [0, 1];
      this.showChoices();
    }
    this.draw(true);
  }

  /** With three objectives two of them are drawn, and a person says which. */
  showChoices() {
    const { objectives } = this.found;
    this.choices.hidden = objectives.length < 3;
    this.choices.replaceChildren(...["across", "up"].map((way, axis) => element("label", {}, way,
      element("select", { onchange: ({ target }) => {
        this.axes[axis] = Number(target.value);
        this.draw(true);
      } }, ...objectives.map((one, k) => element("option", { value: k, text: one.said, selected: k === this.axes[axis] }))))));
  }

  draw(anew = false) {
    const width = Math.max(240, this.box.clientWidth);
    if (!this.found || (!anew && width === this.width)) return;
    this.width = width;
    this.svg.setAttribute("width", width);
    const { objectives, screened, plates, reference, chosen } = this.found;
    const rows = [...screened, ...plates.map((one) => one.objectives), ...(reference ? [reference.objectives] : [])];
    const [x, y] = this.axes.map((axis, k) => scale(rows.map((row) => row[axis]).filter(known), objectives[axis],
      k ? [HEIGHT - BOTTOM, TOP] : [LEFT, width - RIGHT], k ? 6 : width / 90));
    const at = (row) => [x.at(row[this.axes[0]]), y.at(row[this.axes[1]])];
    this.drawGrid(x, y, width);
    const inside = (row) => this.axes.every((axis) => known(row[axis]));
    this.screened.setAttribute("d", screened.filter(inside).map((row) => dot(...at(row), 3)).join(""));
    this.drawSteps(plates.filter((one) => inside(one.objectives)).map((one) => at(one.objectives)), objectives.length);
    this.drawReference(reference && inside(reference.objectives) ? reference : null, at, width);
    this.drawPlates(plates.filter((one) => inside(one.objectives)), at, chosen);
    this.showLegend(screened.length, plates.length, reference, chosen);
  }

  drawGrid(x, y, width) {
    const text = (words, where, classes = "") => Object.assign(make("text", { ...where, class: classes }), { textContent: words });
    const lines = [
      ...x.ticks.flatMap((tick) => [make("line", { x1: x.at(tick), x2: x.at(tick), y1: TOP, y2: HEIGHT - BOTTOM }),
        text(x.said(tick), { x: x.at(tick), y: HEIGHT - BOTTOM + 16, "text-anchor": "middle" })]),
      ...y.ticks.flatMap((tick) => [make("line", { x1: LEFT, x2: width - RIGHT, y1: y.at(tick), y2: y.at(tick) }),
        text(y.said(tick), { x: LEFT - 6, y: y.at(tick) + 4, "text-anchor": "end" })]),
    ];
    const middle = (TOP + HEIGHT - BOTTOM) / 2;
    this.grid.replaceChildren(...lines,
      text(x.label, { x: (LEFT + width - RIGHT) / 2, y: HEIGHT - 6, "text-anchor": "middle" }, "label"),
      text(y.label, { x: 0, y: 0, "text-anchor": "middle", transform: `translate(13 ${middle}) rotate(-90)` }, "label"));
  }

  /** The border of what is reached, where two objectives are all that there are. */
  drawSteps(points, objectives) {
    const sorted = objectives === 2 ? [...points].sort((a, b) => a[0] - b[0]) : [];
    this.steps.setAttribute("d", sorted.map(([x, y], k) => (k ? `H${x}V${y}` : `M${x} ${y}`)).join(""));
  }

  drawReference(reference, at, width) {
    if (!reference) {
      this.mark.replaceChildren();
      return;
    }
    const [x, y] = at(reference.objectives), right = x > width / 2;
    const name = make("text", { x: x + (right ? -11 : 11), y: y + 4, "text-anchor": right ? "end" : "start" });
    name.textContent = reference.name;
    this.mark.replaceChildren(make("path", { d: `M${x - 7} ${y}L${x} ${y - 7}L${x + 7} ${y}L${x} ${y + 7}Z` }), name);
  }

  /** Each plate keeps its circle, and with it the focus, while others come and go. */
  drawPlates(plates, at, chosen) {
    const names = new Set(plates.map((one) => one.name));
    for (const [name, circle] of this.circles) {
      if (names.has(name)) continue;
      circle.remove();
      this.circles.delete(name);
    }
    for (const one of plates) {
      const [x, y] = at(one.objectives);
      let circle = this.circles.get(one.name);
      if (!circle) {
        circle = make("circle", { r: 7, role: "button", "data-plate": one.name });
        circle.addEventListener("click", () => this.open(one.name));
        circle.addEventListener("pointerenter", () => this.point(one.name));
        circle.addEventListener("focus", () => this.reach(one.name));
        this.circles.set(one.name, circle);
        this.plates.append(circle);
      }
      circle.setAttribute("cx", x);
      circle.setAttribute("cy", y);
      circle.classList.toggle("chosen", one.name === chosen);
      circle.setAttribute("aria-label", `plate ${one.name}${one.name === chosen ? ", chosen" : ""}: ${this.said(one)}; opens in Design`);
    }
    this.order = plates.map((one) => one.name);
    if (!names.has(this.current)) this.current = this.order[0] ?? null;
    for (const [name, circle] of this.circles) circle.setAttribute("tabindex", name === this.current ? 0 : -1);
  }

  /** A plate's objectives in words. */
  said(one) {
    return this.found.objectives.map(({ said }, k) => `${said} ${one.words[k]}`).join(", ");
  }

  reach(name) {
    this.circles.get(this.current)?.setAttribute("tabindex", -1);
    this.current = name;
    this.circles.get(name)?.setAttribute("tabindex", 0);
    this.point(name);
  }

  pressed(event) {
    const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    const at = this.order?.indexOf(event.target.dataset?.plate) ?? -1;
    if (at < 0) return;
    if (by) this.circles.get(this.order[(at + by + this.order.length) % this.order.length]).focus();
    else if (event.key === "Enter" || event.key === " ") this.open(this.order[at]);
    else return;
    event.preventDefault();
  }

  showLegend(screened, solved, reference, chosen) {
    const entry = (shape, text) => element("span", { class: "entry" }, make("svg", { width: 18, height: 16, "aria-hidden": "true" }, shape), text);
    this.legend.replaceChildren(
      entry(make("path", { class: "screened", d: dot(9, 8, 3) }), `the front as screened (${screened})`),
      entry(make("circle", { class: "plate", cx: 9, cy: 8, r: 6 }), `the front as solved (${solved})`),
      ...(chosen ? [entry(make("circle", { class: "plate chosen", cx: 9, cy: 8, r: 6 }), "the one to build")] : []),
      ...(reference ? [entry(make("path", { class: "diamond", d: "M2 8L9 1L16 8L9 15Z" }), `${reference.name}, to compare with`)] : []));
  }

  close() {
    this.watcher.disconnect();
  }
}

function make(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const known = (value) => value !== null && Number.isFinite(value);
const dot = (x, y, r) => `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;

/** Where values of a quantity lie between two pixels, with round ticks in a unit that fits. */
function scale(values, { said, unit }, [from, to], most) {
  let low = Math.min(...values), high = Math.max(...values);
  if (!values.length) [low, high] = [0, 1];
  const pad = 0.08 * (high - low) || 0.1 * Math.abs(high) || 1;
  [low, high] = [Math.max(low - pad, low >= 0 ? 0 : -Infinity), high + pad];
  const rough = (high - low) / Math.max(2, Math.min(most, 7)), power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((one) => one * power >= rough);
  const ticks = [];
  for (let tick = Math.ceil(low / step) * step; tick <= high; tick += step) ticks.push(tick);
  // A kilogram has its prefix already.
  const whole = unit === "kg" ? 1e-3 : 1, name = unit === "kg" ? "g" : unit;
  const [times, prefix] = unit ? PREFIXES.find(([one]) => high >= whole * one) ?? PREFIXES.at(-1) : [1, ""];
  const factor = whole * times;
  return {
    ticks,
    at: (value) => Math.round(10 * (from + ((value - low) / (high - low)) * (to - from))) / 10,
    said: (tick) => plain(tick / factor, 3),
    label: unit ? `${said} (${prefix}${name})` : said,
  };
}
