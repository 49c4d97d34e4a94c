// A calibrated display: on what, when, and every measured number beside the model before and after.

import { element, plain } from "./numbers.js";

const SVG = "http://www.w3.org/2000/svg";
const FINE = 1e-3; // up to which a difference is drawn in proportion, beyond it by its logarithm
const FAR = 1;
const TICKS = [[-0.1, "−10 %"], [-0.001, "−0.1 %"], [0, "0"], [0.001, "+0.1 %"], [0.1, "+10 %"]];

export class CalibratedView {
  constructor() {
    this.said = element("p", { class: "calibrated" });
    this.table = element("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "every measured number beside the model" });
    this.more = element("details", {});
    this.box = element("section", { class: "card", hidden: true },
      element("h2", { text: "Predicted against measured", "data-tip": "calibration", tabindex: "0" }), this.said, this.table, this.more);
  }

  /** The record of a display's calibration, or nothing. */
  set(found) {
    this.box.hidden = !found;
    if (!found) return;
    this.said.classList.toggle("error", !found.fits);
    this.said.textContent = `${found.sentence} As the file says it: what is changed in the form does not move it.`;
    this.table.replaceChildren(element("table", { class: "compared" },
      element("thead", {}, element("tr", {},
        ...["measured", "value", "model less measured"].map((text) => element("th", { scope: "col", text })))),
      element("tbody", {}, scale(), ...found.compared.map(row))));
    this.more.replaceChildren(element("summary", { text: "What came out, and of which recordings" }),
      ...found.said.map((text) => element("p", { text })),
      ...found.recordings.map((one) => element("p", { class: "muted", text: recording(one) })));
  }
}

function recording({ file, kind, who, when, instrument, origin, sha256 }) {
  return [file, kind, who && `by ${who}`, when, instrument, origin, sha256 && `SHA-256 ${sha256.slice(0, 12)}…`].filter(Boolean).join(", ");
}

function row({ said, recording: file, measured, error, before, after }) {
  const words = after.length
    ? `${change(after[1])} (${change(after[0])} to ${change(after[2])})${before.length ? `; before ${change(before[0])} to ${change(before[2])}` : ""}`
    : "the model has none";
  const bar = drawing(words);
  if (before.length) line(bar, "before", before[0] - 1, before[2] - 1, 10);
  if (after.length) line(bar, "after", after[0] - 1, after[2] - 1, 10);
  line(bar, "measured", -error, error, 10);
  line(bar, "measured", 0, 0, 4, 16);
  return element("tr", {},
    element("th", { scope: "row" }, said, file ? element("small", { text: file }) : null),
    element("td", {}, measured, element("small", { text: `±\u00a0${plain(100 * error, 2)}\u00a0%` })),
    element("td", { class: "range" }, bar, element("small", { text: words })));
}

function change(share) {
  const off = 100 * (share - 1);
  return `${off >= 0 ? "+" : "−"}${plain(Math.abs(off), 2)}\u00a0%`;
}

/** The row that says what the bars are drawn on. */
function scale() {
  const bar = drawing("the scale of the bars below");
  for (const [value, text] of TICKS) {
    const label = document.createElementNS(SVG, "text");
    label.setAttribute("x", place(value));
    label.setAttribute("y", 14);
    label.textContent = text;
    bar.append(label);
  }
  const said = element("small", { text: "grey: before, blue: calibrated (90 %), orange: measured ± one standard error" });
  return element("tr", {}, element("td", { colspan: "2" }, said), element("td", { class: "range" }, bar));
}

function drawing(words) {
  const made = document.createElementNS(SVG, "svg");
  made.setAttribute("viewBox", "0 0 300 20");
  made.setAttribute("role", "img");
  made.setAttribute("aria-label", words);
  return made;
}

function line(bar, kind, from, to, y, end = y) {
  const made = document.createElementNS(SVG, "line");
  for (const [key, value] of [["class", kind], ["x1", place(from)], ["x2", place(to)], ["y1", y], ["y2", end]]) made.setAttribute(key, value);
  bar.append(made);
}

/** Where a difference stands, from 0 to 300: in proportion up to FINE, then by its logarithm. */
function place(off) {
  const size = Math.min(Math.abs(off), FAR) / FINE;
  const reach = size <= 1 ? size : 1 + Math.log10(size);
  return 150 + Math.sign(off) * 150 * reach / (1 + Math.log10(FAR / FINE));
}

/** Measured points on a chart, with the calibrated model's interval through each. */
export function drawMeasured(plot, colour, points) {
  const g = plot.ctx, size = 5 * devicePixelRatio;
  const x = (value) => plot.valToPos(value, "x", true), y = (value) => plot.valToPos(value, "y", true);
  g.save();
  g.beginPath();
  g.rect(plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height);
  g.clip();
  for (const point of points) {
    const at = [x(point.x[0]), y(point.y[0])];
    g.setLineDash([]);
    g.strokeStyle = colour("blue");
    g.lineWidth = 4 * devicePixelRatio;
    g.beginPath();
    if (point.x[1] !== undefined && point.x[1] !== null) {
      g.moveTo(x(point.x[1]), at[1]);
      g.lineTo(x(point.x[2]), at[1]);
    }
    if (point.y[1] !== null) {
      g.moveTo(at[0], y(point.y[1]));
      g.lineTo(at[0], y(point.y[2]));
    }
    g.stroke();
    g.fillStyle = colour("orange");
    g.beginPath();
    g.moveTo(at[0], at[1] - size);
    g.lineTo(at[0] + size, at[1]);
    g.lineTo(at[0], at[1] + size);
    g.lineTo(at[0] - size, at[1]);
    g.fill();
  }
  g.restore();
}
