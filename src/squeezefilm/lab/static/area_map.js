// Relative friction over the active area, by the place of the finger's centre: a small map.

import { plain } from "./numbers.js";

// From little friction to much, told apart in grey too: cividis, every eighth of the way.
const SHADES = [
  [0, 34, 78], [26, 56, 111], [67, 78, 108], [98, 101, 112], [125, 124, 120],
  [155, 149, 118], [188, 175, 105], [222, 203, 80], [254, 232, 56],
];

export class AreaMap {
  constructor(canvas) {
    this.canvas = canvas;
  }

  /** What there is to draw, or nothing: `area` as the lab's answer has it. */
  set(area) {
    const { canvas } = this;
    canvas.hidden = !area?.map;
    if (canvas.hidden) return;
    const { columns, rows, relative_friction: values } = area.map;
    const { best, worst } = area.relative_friction;
    canvas.width = columns;
    canvas.height = rows;
    canvas.style.aspectRatio = `${Math.max(area.x_m[1] - area.x_m[0], 1e-6)} / ${Math.max(area.y_m[1] - area.y_m[0], 1e-6)}`;
    canvas.setAttribute("aria-label", `relative friction over the active area, from ${plain(best)} to ${plain(worst)}`);
    const picture = new ImageData(columns, rows);
    values.forEach((value, at) => {
      // The first row of values is the one at the plate's front, which is drawn at the bottom.
      const to = 4 * ((rows - 1 - Math.floor(at / columns)) * columns + (at % columns));
      if (value === null) return;
      picture.data.set([...shade((value - best) / Math.max(worst - best, 1e-9)), 255], to);
    });
    canvas.getContext("2d").putImageData(picture, 0, 0);
  }
}

function shade(share) {
  const at = Math.min(Math.max(share, 0), 1) * (SHADES.length - 1);
  const low = Math.min(Math.floor(at), SHADES.length - 2);
  return SHADES[low].map((one, k) => Math.round(one + (at - low) * (SHADES[low + 1][k] - one)));
}
