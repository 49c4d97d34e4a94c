// A first-run tour of four steps, above the area and not over it: nothing is covered, and whoever
// wants none goes on working. Where it was dismissed is remembered in this browser.

import { element } from "./numbers.js";

const KEPT = "squeezefilm tour";
const STEPS = [
  ["design", "Design a display", "Drag a slider and see the mode, the amplitude and the friction follow. The line above the numbers says which model gave them. Save… writes a file that the command line reads as well."],
  ["feel", "Feel a texture", "Drag over the surface with mouse, pen or touch, or with the arrow keys: friction, amplitude and force are shown as the texture is rendered. Record keeps a stroke."],
  ["study", "Run a study", "Create one, enrol a participant, prepare a sitting. The participant has a page of their own, here or at another station, and answers are on the disk before the next trial."],
  ["help", "Find out more", "Rest the pointer on, or tab to, a dotted word to have a quantity explained. Help lists the keys and every quantity with its source, and starts this tour again."],
];

/** Show the tour in its place unless it was dismissed in this browser. */
export function offerTour(place) {
  place.addEventListener("keydown", (event) => event.key === "Escape" && end(place));
  if (!remembered()) step(place, 0, false);
}

/** Show it again, from its first step. */
export function startTour() {
  step(document.getElementById("tour"), 0, true);
}

function step(place, k, moving) {
  const [area, title, text] = STEPS[k];
  if (moving) location.hash = area;
  const last = k === STEPS.length - 1;
  const next = element("button", { class: "main", text: last ? "Done" : "Next", onclick: () => (last ? end(place) : step(place, k + 1, true)) });
  place.replaceChildren(
    element("p", {}, element("strong", { text: `${k + 1} of ${STEPS.length}. ${title}. ` }), text),
    element("div", { class: "row" },
      k > 0 ? element("button", { text: "Back", onclick: () => step(place, k - 1, true) }) : null,
      next, last ? null : element("button", { text: "No tour", onclick: () => end(place) })));
  place.hidden = false;
  if (moving) next.focus({ preventScroll: true });
}

function end(place) {
  place.hidden = true;
  place.replaceChildren();
  document.getElementById("area").focus({ preventScroll: true });
  try {
    localStorage.setItem(KEPT, "done");
  } catch {
    // A browser that keeps nothing offers the tour again next time.
  }
}

function remembered() {
  try {
    return localStorage.getItem(KEPT) === "done";
  } catch {
    return false;
  }
}
