// The touched surface at true scale: the texture's friction as shades, the standing wave's
// antinodes, the finger's contact and what it has crossed.

const CSS_PER_MM = 96 / 25.4;
const COLUMNS = 360;

export class SurfaceView {
  constructor(canvas) {
    this.canvas = canvas;
    this.ready = null;
    this.finger = null;
    this.trail = [];
    this.perMm = Number(localStorage.getItem("squeezefilm px per mm")) || CSS_PER_MM;
  }

  setScale(perMm) {
    this.perMm = perMm;
    localStorage.setItem("squeezefilm px per mm", perMm);
    this.layout();
  }

  set(ready, frictionAt) {
    this.ready = ready;
    this.frictionAt = frictionAt;
    this.layout();
  }

  layout() {
    if (!this.ready) return;
    const { canvas, ready } = this, ratio = devicePixelRatio || 1;
    this.width = ready.width_m * 1e3 * this.perMm;
    this.height = Math.max(90, ready.height_m * 1e3 * this.perMm);
    canvas.style.width = `${this.width}px`;
    canvas.style.height = `${this.height}px`;
    canvas.width = Math.round(this.width * ratio);
    canvas.height = Math.round(this.height * ratio);
    this.paint();
  }

  /** Metres on the surface of a place in the canvas (CSS pixels); y goes up. */
  place(px, py) {
    const { width_m: w, height_m: h } = this.ready;
    return [(px / this.width) * w, (1 - py / this.height) * h];
  }

  pixel(x, y) {
    return [(x / this.ready.width_m) * this.width, (1 - y / this.ready.height_m) * this.height];
  }

  paint() {
    const { ready } = this, rows = Math.max(2, Math.round((COLUMNS * this.height) / this.width));
    const picture = document.createElement("canvas");
    picture.width = COLUMNS;
    picture.height = rows;
    const g = picture.getContext("2d"), image = g.createImageData(COLUMNS, rows);
    const style = getComputedStyle(document.documentElement);
    const rgb = (role) => [1, 3, 5].map((at) => parseInt(style.getPropertyValue(`--${role}`).trim().slice(at, at + 2), 16));
    const sticky = rgb("metal"), slippery = rgb("blue");
    for (let j = 0; j < rows; j += 1) {
      const y = (1 - (j + 0.5) / rows) * ready.height_m;
      for (let i = 0; i < COLUMNS; i += 1) {
        const f = this.frictionAt(((i + 0.5) / COLUMNS) * ready.width_m, y);
        const share = Math.max(0, Math.min(1, f)), at = 4 * (j * COLUMNS + i);
        for (let k = 0; k < 3; k += 1) image.data[at + k] = slippery[k] + share * (sticky[k] - slippery[k]);
        image.data[at + 3] = 255;
      }
    }
    g.putImageData(image, 0, 0);
    this.picture = picture;
    this.draw();
  }

  draw() {
    if (!this.picture) return;
    const { canvas, ready, finger } = this, g = canvas.getContext("2d"), ratio = devicePixelRatio || 1;
    const style = getComputedStyle(document.documentElement), colour = (role) => style.getPropertyValue(`--${role}`).trim();
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.imageSmoothingEnabled = false;
    g.drawImage(this.picture, 0, 0, this.width, this.height);
    if (this.showWave && ready.wave) this.drawWave(g, colour);
    if (this.trail.length > 1) {
      g.strokeStyle = colour("orange");
      g.lineWidth = 1.5;
      g.beginPath();
      this.trail.forEach(([x, y], k) => (k ? g.lineTo(x, y) : g.moveTo(x, y)));
      g.stroke();
    }
    if (finger) {
      const [px, py] = this.pixel(finger.x, finger.y), half = (ready.contact_length_m * 500) * this.perMm;
      g.fillStyle = colour("skin");
      g.globalAlpha = 0.65;
      g.beginPath();
      g.ellipse(px + (this.shift ?? 0), py, half, half * 1.2, 0, 0, 2 * Math.PI);
      g.fill();
      g.globalAlpha = 1;
      g.strokeStyle = colour("ink");
      g.stroke();
    }
  }

  drawWave(g, colour) {
    const { wave } = this.ready, across = wave.along === "y";
    const length = across ? this.ready.height_m : this.ready.width_m;
    g.strokeStyle = colour("paper");
    g.setLineDash([2, 5]);
    for (let node = wave.period_m / 4; node < length; node += wave.period_m / 2) {
      const [px, py] = across ? this.pixel(0, node) : this.pixel(node, 0);
      g.beginPath();
      if (across) {
        g.moveTo(0, py);
        g.lineTo(this.width, py);
      } else {
        g.moveTo(px, 0);
        g.lineTo(px, this.height);
      }
      g.stroke();
    }
    g.setLineDash([]);
  }
}
