// The body from above and from the side, its ceramics, its nodal lines, and the mode in motion.

import { plain } from "./numbers.js";

const PLAN = 0.62;
// A cycle takes two seconds here and thirty microseconds there.
const CYCLE = 2000;
// How many cycles are shown of a new mode. A mode that moved for ever would keep the computer busy.
const CYCLES = 3;

export class PlanView {
  constructor(canvas) {
    this.canvas = canvas;
    this.outline = null;
    this.line = null;
    this.shape = null;
    this.began = this.until = 0;
    this.watched = false;
    this.still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  }

  set(outline, line, shape) {
    Object.assign(this, { outline, line, shape });
    this.picture = null;
    this.move(CYCLES);
  }

  /** Let the mode move for so many cycles from now, the one that has begun included. */
  move(cycles) {
    const now = performance.now();
    if (now > this.until) this.began = this.until = now;
    this.until = Math.max(this.until, this.began + (Math.floor((now - this.began) / CYCLE) + cycles) * CYCLE);
  }

  /** Let it move for as long as somebody points at it, and to the end of the cycle. */
  watch(is) {
    this.watched = is;
    this.move(1);
  }

  colours() {
    const style = getComputedStyle(document.documentElement);
    return Object.fromEntries(
      ["ink", "muted", "grid", "metal", "plus", "minus", "blue", "orange", "paper"]
        .map((role) => [role, style.getPropertyValue(`--${role}`).trim()]),
    );
  }

  /** Draw the moment, and say whether the next one looks different. */
  draw(now) {
    const { canvas, outline } = this;
    const width = canvas.clientWidth, height = canvas.clientHeight, ratio = devicePixelRatio || 1;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      this.picture = null;
    }
    const g = canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    const box = { left: 14, top: 22, width: width - 28, height: height * PLAN - 30 };
    // A canvas not laid out yet, or folded away, has no room inside its margins: nothing can be drawn to scale.
    if (!outline || !this.line || box.width <= 0 || box.height <= 0) return false;
    const c = this.colours();
    if (this.watched) this.move(1);
    const moves = !this.still && now < this.until;
    const phase = moves ? Math.cos((2 * Math.PI * (now - this.began)) / CYCLE) : 1;
    g.font = "13px system-ui, sans-serif";
    const across = this.drawPlan(g, box, c, phase);
    const side = { left: across.left, width: across.width, top: height * PLAN + 8, height: height * (1 - PLAN) - 30 };
    this.drawSide(g, side, c, phase);
    return moves;
  }

  drawPlan(g, box, c, phase) {
    const { outline } = this;
    const size = outline.kind === "plate"
      ? [outline.length_m, outline.width_m]
      : [outline.diameter_m + (outline.radial_width_m ?? 0), outline.diameter_m + (outline.radial_width_m ?? 0)];
    const scale = Math.min(box.width / size[0], box.height / size[1]);
    const w = size[0] * scale, h = size[1] * scale;
    const left = box.left + (box.width - w) / 2, top = box.top + (box.height - h) / 2;
    g.fillStyle = c.ink;
    const mm = (metres) => `${plain(metres * 1e3, 4)} mm`;
    if (outline.kind !== "plate") return this.drawRound(g, left, top, scale, w, h, c, phase, box);
    const above = outline.patches.some((patch) => patch.face === "top");
    const ceramics = above ? "ceramics below dashed, above solid (second sign)" : "ceramics dashed";
    g.fillText(`from above, ${mm(size[0])} × ${mm(size[1])}; ${ceramics}, nodal lines dotted`, box.left, 14);
    g.fillStyle = c.metal;
    g.fillRect(left, top, w, h);
    if (this.shape) this.drawSurface(g, left, top, w, h, c, phase);
    g.save();
    g.setLineDash([5, 3]);
    g.strokeStyle = c.ink;
    for (const patch of outline.patches) {
      // What lies on the upper face is seen, what lies below is hidden by the plate.
      g.setLineDash(patch.face === "top" ? [] : [5, 3]);
      g.strokeRect(left + patch.x_m * scale, top + h - (patch.y_m + patch.width_m) * scale, patch.length_m * scale, patch.width_m * scale);
      g.fillStyle = c.ink;
      g.fillText(patch.polarity > 0 ? "+" : "−", left + (patch.x_m + patch.length_m / 2) * scale - 4, top + (patch.face === "top" ? 28 : 14));
    }
    g.setLineDash([2, 4]);
    g.strokeStyle = c.blue;
    for (const at of this.shape ? [] : this.line.nodal_positions_m) {
      g.beginPath();
      if (this.line.along === "y") {
        g.moveTo(left, top + h - at * scale);
        g.lineTo(left + w, top + h - at * scale);
      } else {
        g.moveTo(left + at * scale, top);
        g.lineTo(left + at * scale, top + h);
      }
      g.stroke();
    }
    g.restore();
    g.strokeStyle = c.ink;
    g.strokeRect(left, top, w, h);
    return { left, width: w };
  }

  drawRound(g, left, top, scale, w, h, c, phase, box) {
    const { outline, line } = this;
    const x = left + w / 2, y = top + h / 2;
    const mm = `${plain(outline.diameter_m * 1e3, 4)} mm`;
    if (outline.kind === "ring") {
      g.fillText(`from above, mean diameter ${mm}; up in blue, down in red`, box.left, 14);
      const r = (outline.diameter_m / 2) * scale, thick = outline.radial_width_m * scale;
      const end = line.position_m.at(-1);
      for (let k = 0; k + 1 < line.position_m.length; k += 1) {
        const from = (line.position_m[k] / end) * 2 * Math.PI, to = (line.position_m[k + 1] / end) * 2 * Math.PI;
        const value = line.deflection[k] * phase;
        g.globalAlpha = Math.min(1, Math.abs(value));
        g.strokeStyle = value > 0 ? c.blue : c.orange;
        g.lineWidth = thick;
        g.beginPath();
        g.arc(x, y, r, from, to + 0.01);
        g.stroke();
      }
      g.globalAlpha = 1;
      g.lineWidth = 1;
      g.strokeStyle = c.ink;
      for (const radius of [r - thick / 2, r + thick / 2]) {
        g.beginPath();
        g.arc(x, y, radius, 0, 2 * Math.PI);
        g.stroke();
      }
    } else {
      g.fillText(`from above, diameter ${mm}; nodal circles dotted`, box.left, 14);
      g.fillStyle = c.metal;
      g.strokeStyle = c.ink;
      g.beginPath();
      g.arc(x, y, (outline.diameter_m / 2) * scale, 0, 2 * Math.PI);
      g.fill();
      g.stroke();
      g.save();
      g.setLineDash([2, 4]);
      g.strokeStyle = c.blue;
      for (const at of line.nodal_positions_m.filter((one) => one > 0)) {
        g.beginPath();
        g.arc(x, y, at * scale, 0, 2 * Math.PI);
        g.stroke();
      }
      g.restore();
    }
    return { left: box.left, width: box.width };
  }

  drawSurface(g, left, top, w, h, c, phase) {
    const { columns, rows, deflection } = this.shape;
    if (!this.picture) {
      this.picture = document.createElement("canvas");
      this.picture.width = columns;
      this.picture.height = rows;
      this.pixels = this.picture.getContext("2d").createImageData(columns, rows);
    }
    const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
    const up = rgb(c.blue), down = rgb(c.orange), flat = rgb(c.paper);
    const { data } = this.pixels;
    for (let row = 0; row < rows; row += 1) {
      for (let column = 0; column < columns; column += 1) {
        const value = deflection[row * columns + column] * phase;
        const share = Math.min(1, Math.abs(value) * 1.4), to = value > 0 ? up : down;
        const at = 4 * ((rows - 1 - row) * columns + column);
        for (let k = 0; k < 3; k += 1) data[at + k] = flat[k] + share * (to[k] - flat[k]);
        data[at + 3] = 255;
      }
    }
    this.picture.getContext("2d").putImageData(this.pixels, 0, 0);
    g.imageSmoothingEnabled = true;
    g.drawImage(this.picture, left, top, w, h);
  }

  drawSide(g, box, c, phase) {
    const { position_m: x, deflection: w } = this.line;
    const first = x[0], span = x.at(-1) - first;
    const largest = Math.max(...w.map(Math.abs));
    const middle = box.top + box.height / 2 + 6, high = box.height / 2 - 10;
    g.fillStyle = c.ink;
    const plate = this.line.along === "y" ? "across the plate" : "along the plate";
    const what = { plate, disc: "along a diameter", ring: "along the circumference" };
    g.fillText(`from the side, ${what[this.outline.kind]}; deflection drawn larger`, 14, box.top + 4);
    g.strokeStyle = c.grid;
    g.beginPath();
    g.moveTo(box.left, middle);
    g.lineTo(box.left + box.width, middle);
    g.stroke();
    g.strokeStyle = c.blue;
    g.lineWidth = 2.5;
    g.beginPath();
    for (let k = 0; k < x.length; k += 1) {
      const px = box.left + ((x[k] - first) / span) * box.width;
      const py = middle - (w[k] / largest) * high * phase;
      if (k) g.lineTo(px, py);
      else g.moveTo(px, py);
    }
    g.stroke();
    g.lineWidth = 1;
    g.fillStyle = c.ink;
    for (const at of this.line.nodal_positions_m) {
      g.beginPath();
      g.arc(box.left + ((at - first) / span) * box.width, middle, 2.5, 0, 2 * Math.PI);
      g.fill();
    }
  }
}
