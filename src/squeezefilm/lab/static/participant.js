// The participant's page: consent, instructions, trials, breaks. Nothing on it gives an answer away.
// An answer is kept in the browser until the server says that it is on the disk; handing it in twice
// changes nothing, so a crash, a reload or a lost connection can neither lose nor double it.

import { element } from "./numbers.js";
import { Socket } from "./socket.js";

const sitting = location.hash.slice(1);
const place = document.getElementById("area");
const connection = document.getElementById("connection");
// The second tap of a double tap would answer the trial after the one it was meant for.
const TOO_SOON = 250;
const KEPT = `squeezefilm answer ${sitting}`;
const socket = new Socket("/ws/participant");
let keys = null;
let resting = null;
// Whether a device plays a surface, and which presentation what comes back belongs to.
let playing = false, turn = 0;
// What goes on when the surface that is put there by hand is in place.
let inPlace = null;

socket.on("connection", ({ open, refused }) => {
  const away = refused ? "This page's session is over. Nothing you answered is lost; please tell the experimenter." : "The connection is lost. Nothing you answered is lost; please wait.";
  connection.textContent = open ? "" : away;
  connection.classList.toggle("lost", !open);
  if (open && window.squeezefilmMine) goOn();
  if (!open) freeze();
});
socket.on("silence", ({ seconds }) => {
  connection.textContent = seconds ? "The lab does not answer. Nothing you answered is lost; please wait." : "";
  connection.classList.toggle("lost", seconds > 0);
});
socket.on("sitting ended", (message) => message.sitting === sitting && goOn());
socket.on("surface in place", (message) => message.sitting === sitting && inPlace?.());
// A key held down repeats, and must not answer the trials that follow.
document.addEventListener("keydown", (event) => {
  if ((event.key === " " || event.key === "Escape") && playing) {
    event.preventDefault();
    stopSurface();
  } else if (!event.repeat && !event.ctrlKey && !event.altKey && !event.metaKey) keys?.(event);
});
begin();

/** One tab a sitting: a second one says so and takes nothing over. */
function begin() {
  if (!sitting) return say("No sitting", "This page needs the link that the experimenter gives you.");
  if (!navigator.locks) return mine();
  navigator.locks.request(`sitting ${sitting}`, { ifAvailable: true }, (lock) => {
    if (!lock) {
      say("Open in another tab", "This sitting is open in another tab of this browser. Go on there, or close that tab and reload this one.");
      return null;
    }
    mine();
    return new Promise(() => {});
  });
  return null;
}

function mine() {
  window.squeezefilmMine = true;
  if (socket.open) goOn();
}

/** Wherever the server says we are; an answer that was not acknowledged is handed in first. */
async function goOn() {
  try {
    const kept = localStorage.getItem(KEPT);
    if (kept) await handKept(kept);
    show(await socket.ask("where", { sitting }));
  } catch (error) {
    refused(error);
  }
}

async function handKept(kept) {
  try {
    await socket.ask("respond", { sitting, ...JSON.parse(kept) });
  } catch (error) {
    // Refused, it would be refused for ever: its trial comes again. Else it is kept.
    if (!socket.open || error.again) throw error;
  }
  localStorage.removeItem(KEPT);
}

/** Say why the server refused. An answer is kept only where handing it in again can help. */
function refused(error) {
  playing = false;
  if (!socket.open) return;
  if (!error.again) localStorage.removeItem(KEPT);
  page(element("h2", { text: "This does not work" }), element("p", { text: error.message }),
    element("p", { text: "Please tell the experimenter." }), waiting("Try again", 0, goOn));
}

function freeze() {
  keys = null;
  clearInterval(resting);
  for (const one of place.querySelectorAll("button, input")) one.disabled = true;
}

function page(...children) {
  clearInterval(resting);
  keys = null;
  place.replaceChildren(element("section", { class: "card sheet" }, ...children));
  place.focus({ preventScroll: true });
}

function say(title, text) {
  page(element("h2", { text: title }), element("p", { text }));
}

function show(found) {
  playing = false;
  if (found.state === "consent") return consent(found);
  if (found.state === "finished") return say("Thank you", "You have answered every trial. Please tell the experimenter.");
  if (found.state === "ended") return say("This sitting has ended", "Please tell the experimenter.");
  if (found.state === "display changes") return say("Thank you", "This part is done. The experimenter will prepare the next display.");
  if (found.state === "trial") return trial(found);
  return ready(found);
}

function consent(found) {
  const box = element("input", { type: "checkbox", id: "consent", onchange: () => { go.disabled = !box.checked; } });
  const go = element("button", { class: "main", text: "Begin", disabled: true, onclick: () => ask("consent") });
  page(element("h2", { text: "Before we begin" }), ...found.consent.split("\n").map((text) => element("p", { text })),
    element("p", {}, element("label", {}, box, "I have read this and consent.")), go);
}

function ready(found) {
  page(element("h2", { text: "Ready" }), element("p", { text: found.question }),
    element("p", { class: "muted", text: `${found.remaining} to go. Choose with the mouse, by touch, or with the number keys; Enter goes on.` }),
    next("Next"));
}

function next(text) {
  return waiting(text, 0, () => ask("next"));
}

/** A button that can be pressed, or Enter, when the rest is over. */
function waiting(text, rest, go) {
  const button = element("button", { class: "main", text, onclick: go });
  const until = performance.now() + rest * 1000;
  const tick = () => {
    const left = Math.ceil((until - performance.now()) / 1000);
    button.disabled = left > 0;
    button.textContent = left > 0 ? `Please rest: ${left} s` : text;
    if (left <= 0) clearInterval(resting);
  };
  // The page that this button comes into clears what was there; so start after it.
  queueMicrotask(() => {
    keys = (event) => event.key === "Enter" && !button.disabled && document.activeElement !== button && button.click();
    if (rest > 0) resting = setInterval(tick, 250);
    tick();
  });
  return button;
}

async function ask(type, fields = {}) {
  freeze();
  try {
    show(await socket.ask(type, { sitting, ...fields }));
  } catch (error) {
    refused(error);
  }
}

function trial(found) {
  if (found.pause_s > 0) {
    page(element("h2", { text: "A break" }), element("p", { text: "Please rest your finger." }),
      pauseThen(found));
    return;
  }
  feel(found, 0);
}

/** A surface is played by a device, put there by hand, or lies there; the answer's time runs from then,
 * or from the end of the last one. */
async function feel(found, number) {
  const mine = (turn += 1);
  const which = found.surfaces === 1 ? "surface" : `${["first", "second", "third", "fourth", "fifth"][number]} surface`;
  const there = new Promise((resolve) => { inPlace = resolve; });
  playing = found.plays;
  if (found.plays) page(element("h2", { text: "One moment" }), element("p", { role: "status", text: `The ${which} is being prepared.` }), stopper());
  else freeze();
  try {
    const answer = await socket.ask("feel", { sitting, token: found.token, place: number });
    if (mine !== turn) return;
    if (answer.type === "waiting") {
      putInPlace(which);
      await there;
      inPlace = null;
      if (mine !== turn) return;
    }
    if (found.surfaces === 1) {
      questions(found);
      if (found.plays) place.querySelector("section").append(stopper());
      return;
    }
    page(element("h2", { text: `Feel the ${which}` }), waiting("Done", 0, () => feltOne(found, number)), found.plays ? stopper() : "");
  } catch (error) {
    if (mine === turn) refused(error);
  }
}

/** Fingers off until somebody says, here or on the experimenter's page, that the surface is in place. */
function putInPlace(which) {
  const mine = turn;
  const said = async () => {
    freeze();
    try {
      await socket.ask("surface in place", { sitting });
    } catch (error) {
      // Said on the other page at the same moment: then we have gone on already.
      if (inPlace && mine === turn) refused(error);
    }
  };
  page(element("h2", { text: "Fingers off, please" }),
    element("p", { role: "status", text: `The experimenter puts the ${which} in place, and says so here or on their own page.` }),
    waiting("The surface is in place", 0, said));
}

async function feltOne(found, number) {
  if (number + 1 < found.surfaces) {
    feel(found, number + 1);
    return;
  }
  if (!found.plays) {
    turn += 1;
    questions(found);
    return;
  }
  const mine = turn;
  freeze();
  try {
    await socket.ask("felt", { sitting, token: found.token });
    if (mine !== turn) return;
    playing = false;
    questions(found);
  } catch (error) {
    if (mine === turn) refused(error);
  }
}

function stopper() {
  return element("p", {}, element("button", { class: "stop", text: "Stop (space bar)", onclick: stopSurface }));
}

/** Silence at once. The trial was not answered; it comes again. */
async function stopSurface() {
  turn += 1;
  playing = false;
  freeze();
  try {
    await socket.ask("stop surface", { sitting });
    page(element("h2", { text: "Stopped" }), element("p", { text: "The surface was stopped, and nothing was recorded. It is presented again when you go on." }), next("Go on"));
  } catch (error) {
    refused(error);
  }
}

function questions(found) {
  const began = performance.now() + TOO_SOON;
  const answer = (fields) => performance.now() >= began && hand(found, began, fields);
  const head = { familiarisation: `Feel the grating ${found.named}`, practice: "Practice", main: "" }[found.phase];
  const title = element("h2", { text: head || found.question });
  const left = element("p", { class: "muted", text: `${found.remaining} to go` });
  if (found.phase === "familiarisation") {
    page(title, element("p", { text: "Stroke it as long as you like. No answer is asked." }), felt(() => answer({})), left);
    return;
  }
  const parts = [title];
  if (head) parts.push(element("p", { text: found.question }));
  if (found.interrupted) parts.push(element("p", { class: "muted", text: "This one was interrupted; it is presented again." }));
  if (found.numeric) parts.push(estimate(answer));
  else parts.push(choices(found, answer));
  parts.push(left);
  page(...parts);
  if (found.numeric) place.querySelector("#estimate").focus();
  else keys = numberKeys(found, answer);
}

function pauseThen(found) {
  return waiting("Go on", found.pause_s, () => trial({ ...found, pause_s: 0 }));
}

function felt(done) {
  return waiting("Done", 0, done);
}

function choices(found, answer) {
  return element("div", { class: "choices", role: "group", "aria-label": found.question },
    ...found.alternatives.map((name, k) => element("button", { class: "choice", onclick: () => answer({ choice: name }) },
      element("small", { text: String(k + 1), "aria-hidden": "true" }), name)));
}

function estimate(answer) {
  const number = element("input", { type: "text", inputmode: "decimal", id: "estimate", size: "8", "aria-label": "your number" });
  const wrong = element("span", { role: "alert", class: "mark" });
  const give = () => {
    const value = Number(number.value.trim().replace(",", "."));
    if (value > 0 && Number.isFinite(value)) return answer({ estimate: value });
    number.setAttribute("aria-invalid", "true");
    wrong.textContent = "Any number above 0, please.";
    return null;
  };
  number.addEventListener("keydown", (event) => event.key === "Enter" && !event.repeat && give());
  return element("p", { class: "row" }, number, element("button", { class: "main", text: "Give this number", onclick: give }), wrong);
}

function numberKeys(found, answer) {
  return (event) => {
    const k = Number(event.key) - 1;
    if (Number.isInteger(k) && k >= 0 && k < found.alternatives.length) answer({ choice: found.alternatives[k] });
  };
}

async function hand(found, began, fields) {
  const ended = performance.now();
  turn += 1;
  playing = false;
  const answer = {
    token: found.token, ...fields, response_time: (ended - began) / 1e3,
    started_monotonic: began / 1e3, ended_monotonic: ended / 1e3,
  };
  localStorage.setItem(KEPT, JSON.stringify(answer));
  freeze();
  try {
    const told = await socket.ask("respond", { sitting, ...answer });
    localStorage.removeItem(KEPT);
    after(told);
  } catch (error) {
    refused(error);
  }
}

function after(told) {
  const known = told.correct !== null && told.correct !== undefined;
  const said = [told.spoiled && `This one comes again later: ${told.spoiled}.`, told.practice && `${told.practice}.`].filter(Boolean);
  if (!known && !said.length) {
    ask("next");
    return;
  }
  const head = known ? (told.correct ? "Right" : `It was ${told.right}`) : "One more thing";
  page(element("h2", { text: head }), ...said.map((text) => element("p", { role: "status", text })), next("Next"));
}
