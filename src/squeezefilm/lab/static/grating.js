// A grating composed in a few fields, as the text of a texture.

import { element } from "./numbers.js";

/** The fields by name. */
export function gratingFields() {
  const text = (value, size, label) => element("input", { type: "text", value, size, "aria-label": label });
  return {
    shape: element("select", { "aria-label": "shape" }, ...["square_wave", "sine_wave", "pulse_wave"].map((one) => element("option", { value: one, text: one.replace("_wave", "") }))),
    period: text("4 mm", "7", "spatial period"),
    low: text("0.7", "4", "lowest relative friction"),
    high: text("1.0", "4", "highest relative friction"),
    angle: text("0 deg", "6", "direction"),
  };
}

/** The texture as TOML; an Error in words where a number is none. */
export function gratingText({ shape, period, low, high, angle }) {
  for (const one of [low, high]) {
    if (one.value.trim() && Number.isFinite(Number(one.value))) continue;
    throw new Error(`the ${one.getAttribute("aria-label")}, '${one.value}', is no number; write one from 0 to 1, like 0.7`);
  }
  const quoted = JSON.stringify;
  const along = /^0(\.0*)?\s*(deg|rad)?$/.test(angle.value.trim()) ? "" : `, along = { type = "direction", angle = ${quoted(angle.value)} }`;
  const title = `${shape.value.replace("_wave", "")}, ${period.value}`;
  return `title = ${quoted(title)}\n\n[texture]\ntype = "relative_friction"\nlow = ${low.value}\nhigh = ${high.value}\n`
    + `pattern = { type = "${shape.value}", spatial_period = ${quoted(period.value)}${along} }\n`;
}
