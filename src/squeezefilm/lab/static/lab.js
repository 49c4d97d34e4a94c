// The page's frame: areas, connection, stop bar, notices and explanations. An area is a module with
// `show(place, visit)`, which fills the place; what it begins ends with the visit.

import { DisplayStore } from "./display_store.js";
import { element } from "./numbers.js";
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

/** Say what was done at the top of the page, or with `failed` what could not be; with a link, if
 * there is something to take away. */
function notify(text, { failed = false, link = null } = {}) {
  notice.classList.toggle("failed", failed);
  notice.hidden = false;
  notice.replaceChildren(text, ...(link ? [link] : []), element("button", { text: "Close", onclick: () => {
    notice.hidden = true;
  } }));
}

/** Say how it stands with the lab; while it does not answer, what it told before is grey. */
function state(text, here) {
  if (connection.textContent !== text) connection.textContent = text;
  connection.classList.toggle("lost", !here);
  document.body.classList.toggle("away", !here);
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
  state(open ? "connected" : away, open);
});
socket.on("silence", ({ seconds }) => state(seconds ? `the lab has not answered for ${Math.round(seconds)} s` : "connected", !seconds));
window.addEventListener("hashchange", showArea);
watchTips(document.getElementById("tip"));
offerTour(document.getElementById("tour"));
showArea();
