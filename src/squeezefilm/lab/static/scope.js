// A strip of the last seconds: lines over time, drawn anew with every frame.

import { plain } from "./numbers.js";

export class Scope {
  constructor(canvas, lines, { seconds = 3, least = 0 } = {}) {
    Object.assign(this, { canvas, lines, seconds, least, rows: [] });
  }

  add(time, values) {
    this.rows.push([time, ...values]);
    const oldest = time - this.seconds;
    while (this.rows.length && this.rows[0][0] < oldest) this.rows.shift();
  }

  clear() {
    this.rows = [];
  }

  /** Whether what is drawn differs from one moment to the next: it scrolls until the last is out. */
  moves(now) {
    return this.rows.length > 0 && this.rows.at(-1)[0] > now - this.seconds;
  }

  draw(now) {
    const { canvas } = this, ratio = devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const style = getComputedStyle(document.documentElement), colour = (role) => style.getPropertyValue(`--${role}`).trim();
    const g = canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    const bottom = height - 22, top = 8, { low, high } = this.range();
    const at = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
    g.font = "12px system-ui, sans-serif";
    g.fillStyle = colour("ink");
    g.strokeStyle = colour("grid");
    const marks = [0, 1, 2, 3, 4].map((k) => low + ((high - low) * k) / 4);
    const left = Math.max(44, ...marks.map((value) => g.measureText(plain(value)).width + 8));
    for (const value of marks) {
      g.beginPath();
      g.moveTo(left, at(value));
      g.lineTo(width, at(value));
      g.stroke();
      g.fillText(plain(value), 2, at(value) + 4);
    }
    g.fillText(`last ${this.seconds} s`, left, height - 6);
    let beside = left + 80;
    this.lines.forEach((line, k) => {
      g.fillStyle = colour(line.colour);
      g.fillRect(beside, height - 12, 14, 3);
      g.fillStyle = colour("ink");
      g.fillText(line.label, beside + 18, height - 6);
      beside += 30 + g.measureText(line.label).width;
      g.strokeStyle = colour(line.colour);
      g.lineWidth = line.width ?? 2;
      g.setLineDash(line.dash ?? []);
      g.beginPath();
      let down = false;
      for (const row of this.rows) {
        const value = row[k + 1];
        if (value === null || !Number.isFinite(value)) {
          down = false;
          continue;
        }
        const px = width - ((now - row[0]) / this.seconds) * (width - left);
        if (px < left) continue;
        if (down) g.lineTo(px, at(value));
        else g.moveTo(px, at(value));
        down = true;
      }
      g.stroke();
      g.setLineDash([]);
    });
  }

  range() {
    let low = Infinity, high = -Infinity;
    for (const row of this.rows) {
      for (const value of row.slice(1)) {
        if (value !== null && Number.isFinite(value)) {
          low = Math.min(low, value);
          high = Math.max(high, value);
        }
      }
    }
    // With 0 always in it, what never changes has its place on the axis as well.
    low = Math.min(0, low);
    high = Math.max(high * 1.05, this.least);
    return high > low ? { low, high } : { low: 0, high: 1 };
  }
}
