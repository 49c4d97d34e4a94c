// The page's frame: areas, connection, stop bar, notices and explanations. An area is a module with
// `show(place, visit)`, which fills the place; what it begins ends with the visit.

import { DisplayStore } from "./display_store.js";
import { Socket } from "./socket.js";
import { StopBar } from "./stop_bar.js";
import { watchTips } from "./tips.js";
import { offerTour } from "./tour.js";
import { Visit } from "./visit.js";

const AREAS = ["design", "search", "feel", "device", "study", "results", "help"];
const place = document.getElementById("area");
const connection = document.getElementById("connection");
const notice = document.getElementById("notice");
const socket = new Socket("/ws");
const page = {
  socket, notify, shared: {}, display: new DisplayStore(socket),
  stopBar: new StopBar(document.getElementById("stopbar"), socket, notify),
};
let visit = new Visit(page);

/** Say something at the top of the page, in words; empty to take it back. */
function notify(text, action = null) {
  notice.replaceChildren();
  notice.hidden = !text;
  if (!text) return;
  notice.append(text);
  const button = document.createElement("button");
  button.textContent = action ? action.label : "Close";
  button.addEventListener("click", () => {
    notify("");
    if (action) action.act();
  });
  notice.append(button);
}

async function showArea() {
  visit.leave();
  const mine = (visit = new Visit(page));
  const name = AREAS.includes(location.hash.slice(1)) ? location.hash.slice(1) : "design";
  for (const link of document.querySelectorAll("[data-area]")) {
    if (link.dataset.area === name) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  place.replaceChildren();
  place.inert = false;
  place.dataset.area = name;
  document.title = `${name} – squeezefilm lab`;
  const area = await import(`./areas/${name}.js`);
  if (!mine.signal.aborted) await area.show(place, mine);
}

socket.on("connection", ({ open, refused }) => {
  const away = refused ? "this page's session is over – open the link that the lab printed" : "the lab is not running – trying again";
  connection.textContent = open ? "connected" : away;
  connection.classList.toggle("lost", !open);
});
window.addEventListener("hashchange", showArea);
watchTips(document.getElementById("tip"));
offerTour(document.getElementById("tour"));
showArea();
