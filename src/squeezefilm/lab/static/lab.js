// The page's frame: areas, connection, notices and explanations. An area is a module with
// `show(place, lab)`, which fills the place and returns what leaves it again.

import { Socket } from "./socket.js";
import { watchTips } from "./tips.js";
import { offerTour } from "./tour.js";

const AREAS = ["design", "feel", "device", "study", "results", "help"];
const place = document.getElementById("area");
const connection = document.getElementById("connection");
const notice = document.getElementById("notice");
const lab = { socket: new Socket("/ws"), notify, shared: {} };
let leave = null;
let turn = 0;

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
  const mine = (turn += 1);
  const name = AREAS.includes(location.hash.slice(1)) ? location.hash.slice(1) : "design";
  for (const link of document.querySelectorAll("[data-area]")) {
    if (link.dataset.area === name) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  if (leave) leave();
  leave = null;
  place.replaceChildren();
  place.dataset.area = name;
  document.title = `${name} – squeezefilm lab`;
  const area = await import(`./areas/${name}.js`);
  if (mine === turn) leave = (await area.show(place, lab)) ?? null;
}

lab.socket.on("connection", ({ open, refused }) => {
  const away = refused ? "this page's session is over – open the link that the lab printed" : "the lab is not running – trying again";
  connection.textContent = open ? "connected" : away;
  connection.classList.toggle("lost", !open);
});
window.addEventListener("hashchange", showArea);
watchTips(document.getElementById("tip"));
offerTour(document.getElementById("tour"));
showArea();
