// uPlot in the lab's colours, following a dark screen and the width of its place.

import { plain } from "./numbers.js";
import uPlot from "./vendor/uPlot.js";

const colour = (role) => getComputedStyle(document.documentElement).getPropertyValue(`--${role}`).trim();

/**
 * A chart of `series` (each {label, colour, dash, width}) over one abscissa.
 * `bands` are pairs of series between which to fill; `marks` draws on the canvas after the series.
 */
export class Chart {
  constructor(place, { x, y, series, bands = [], height = 240, range = null, log = false, marks = null }) {
    this.place = place;
    this.options = { x, y, series, bands, height, range, log, marks };
    this.data = [[], ...series.map(() => [])];
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    this.redo = () => this.build();
    this.dark.addEventListener("change", this.redo);
    this.watcher = new ResizeObserver(() => this.fit());
    place.classList.add("chart");
    place.style.minHeight = `${height + 30}px`;
    this.build();
    this.watcher.observe(place);
  }

  build() {
    this.plot?.destroy();
    const { x, y, series, bands, height, range, log, marks } = this.options;
    const axis = (label) => ({
      label, stroke: colour("ink"), labelSize: 24, size: 52, font: "12px system-ui, sans-serif",
      labelFont: "13px system-ui, sans-serif", grid: { stroke: colour("grid"), width: 1 },
      ticks: { stroke: colour("grid"), width: 1 },
    });
    this.plot = new uPlot({
      width: Math.max(200, this.place.clientWidth), height,
      scales: {
        x: { time: false },
        y: { distr: log ? 3 : 1, range: range ?? undefined },
      },
      axes: [{ ...axis(x), size: 40 }, axis(y)],
      series: [
        { label: x },
        ...series.map((one) => ({
          label: one.label, stroke: colour(one.colour ?? "blue"), width: one.width ?? 2,
          dash: one.dash, points: { show: false }, value: (_, value) => plain(value),
        })),
      ],
      bands: bands.map(([high, low]) => ({ series: [high + 1, low + 1], fill: colour("plus") })),
      legend: { live: false },
      cursor: { drag: { x: false, y: false } },
      hooks: marks ? { draw: [(plot) => marks(plot, colour)] } : {},
    }, this.data, this.place);
  }

  set(data) {
    this.data = data;
    this.plot.setData(data);
  }

  fit() {
    const width = Math.max(200, this.place.clientWidth);
    if (Math.abs(width - this.plot.width) > 1) this.plot.setSize({ width, height: this.options.height });
  }

  close() {
    this.watcher.disconnect();
    this.dark.removeEventListener("change", this.redo);
    this.plot.destroy();
  }
}
