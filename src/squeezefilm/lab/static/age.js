// How old the numbers of a place are, said beside them: a number without its moment is taken for now's.

import { element } from "./numbers.js";

const LOOK = 500;

export class Age {
  /** Numbers that came as `verb` says ("computed", "updated"). Older than `most` (ms), they are grey. */
  constructor(lab, verb, place = null, most = Infinity) {
    Object.assign(this, { verb, place, most, since: null });
    this.box = element("p", { class: "age muted" });
    const looking = setInterval(() => this.show(), LOOK);
    lab.keep(() => clearInterval(looking));
  }

  /** They are of now. */
  now() {
    this.since = performance.now();
    this.show();
  }

  /** There are none. */
  none() {
    this.since = null;
    this.show();
  }

  show() {
    const age = this.since === null ? null : performance.now() - this.since;
    const text = age === null ? "" : age < 1000 ? `${this.verb} just now` : `${this.verb} ${passed(age / 1e3)} ago`;
    if (this.box.textContent !== text) this.box.textContent = text;
    this.place?.classList.toggle("older", age !== null && age > this.most);
  }
}

/** A time that has passed, the coarser the longer: each new word is painted anew. */
export function passed(seconds) {
  const [step, scale, unit] = seconds < 10 ? [1, 1, "s"] : seconds < 120 ? [10, 1, "s"] : seconds < 7200 ? [1, 60, "min"] : [1, 3600, "h"];
  return `${step * Math.floor(seconds / scale / step)} ${unit}`;
}
