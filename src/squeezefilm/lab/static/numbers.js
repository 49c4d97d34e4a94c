// Numbers as people read them: three or four digits, a prefix that fits, the unit always.

const PREFIXES = [
  [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"], [1e-12, "p"],
];

/** A quantity in SI units as text, with the prefix that leaves one to three digits before the point. */
export function quantity(value, unit, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (unit === "" || unit === "1") return plain(value, digits);
  if (Math.abs(value) < 1e-13) return `0 ${unit}`;
  // Rounded first: 999.6 mV in three digits are 1 V.
  const size = Number(Math.abs(value).toPrecision(digits));
  const [scale, prefix] = PREFIXES.find(([one]) => size >= one) ?? PREFIXES.at(-1);
  return `${plain(value / scale, digits)} ${prefix}${unit}`;
}

/** A number without a unit, to so many digits. */
export function plain(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  return Number(value.toPrecision(digits)).toString().replaceAll("-", "−");
}

/** A number with so many decimals, for what changes many times a second and must not jump. */
export function fixed(value, decimals) {
  return value.toFixed(decimals).replace("-", "−");
}

/** "2.5 mm" as its number and what stands behind it; null where it is no quantity. */
export function split(text) {
  const found = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*(.*)$/i.exec(text);
  return found ? { number: Number(found[1]), unit: found[2].trim() } : null;
}

/** An element with attributes and children; texts stay texts. */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key === "text") made.textContent = value;
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

/** One big number with its name, explained on hover. */
export function number(name, tip = null) {
  const value = element("b", { text: "–" });
  const label = element("span", { text: name, tabindex: tip ? "0" : null, "data-tip": tip });
  const note = element("small", {});
  return { box: element("div", { class: "number" }, label, value, note), value, note };
}
