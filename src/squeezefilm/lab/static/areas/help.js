// Help: what the areas are for, the keys, and every quantity.

import { DISPLAY, MOTION, RESULTS, SEARCH } from "../glossary.js";
import { element } from "../numbers.js";
import { startTour } from "../tour.js";

const AREAS = [
  ["Design", "Change a display and see its mode and friction follow. While a slider moves, a plate is screened as a beam; half a second later it is solved in three dimensions. The line above the numbers says which."],
  ["Search", "Say what the finger should feel and what a display may take; a search looks for the plates that can do it. Any of them opens in Design, also while the search runs."],
  ["Feel", "Drag over the surface at true scale and see friction, amplitude, force and lag as the texture is rendered in the page."],
  ["Device", "Connect a twin or a real device, arm it, play a texture, watch it. The bar with STOP stays below every area while anything plays or may."],
  ["Study", "Plan and run a study; a participant has a page of their own."],
  ["Results", "What a study found, with intervals; export it; delete a participant."],
];

const KEYS = [
  ["Tab, Shift+Tab", "to the next or the last control; the first Tab offers to skip to the content"],
  ["Enter, Space", "press a button"],
  ["Space, while something plays", "in every area: stop it, unless a text is being typed; then it is a blank, and Escape or the STOP button stops"],
  ["Escape, while something plays", "in every area and in a field as well: stop it"],
  ["arrow keys", "move a slider by a step; on the surface in Feel, move the finger; on a point in Search, go to the next plate"],
  ["Ctrl+Z, Ctrl+Y", "in Design: undo, redo"],
  ["Escape", "close the tour or an explanation"],
  ["1 to 9", "on the participant's page: choose the answer with that number"],
  ["Enter", "on the participant's page: go on"],
];

export function show(place) {
  place.append(element("div", { class: "help" },
    element("section", { class: "card" }, element("h2", { text: "The areas" }),
      ...AREAS.map(([name, text]) => element("p", {}, element("strong", { text: `${name}. ` }), text))),
    element("section", { class: "card" }, element("h2", { text: "Keys" }),
      element("table", {}, ...KEYS.map(([keys, text]) => element("tr", {}, element("th", { scope: "row", class: "nowrap", text: keys }), element("td", { text })))),
      element("p", {}, element("button", { text: "Start the tour again", onclick: startTour }))),
    element("section", { class: "card" }, element("h2", { text: "Quantities" }),
      element("p", { text: "“Paper” is Biet, Giraud, Lemaire-Semail, The implementation of tactile feedback using squeeze film effect; its misprints are corrected, see docs/explanation/models.md." }),
      ...[["The display", DISPLAY], ["A search for plates", SEARCH], ["A finger on it", MOTION], ["What people answered", RESULTS]].flatMap(([title, quantities]) => [
        element("h3", { text: title }),
        element("dl", {}, ...Object.values(quantities).flatMap((one) => [
          element("dt", { text: one.symbol ? `${one.name}, ${one.symbol}` : one.name }),
          element("dd", {}, one.text, element("small", { text: ` Source: ${one.source}.` })),
        ])),
      ]))));
}
