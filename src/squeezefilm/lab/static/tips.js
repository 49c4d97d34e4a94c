// Explanations on hover and on focus: whatever has `data-tip` names an entry of the glossary.

import { GLOSSARY } from "./glossary.js";

export function watchTips(box) {
  let shown = null;

  function show(target) {
    const found = GLOSSARY[target.dataset.tip];
    const entry = found ?? { name: target.dataset.tip.replaceAll("_", " "), text: "" };
    const own = target.dataset.source;
    if (!found && !own) return;
    shown = target;
    box.replaceChildren();
    const head = document.createElement("strong");
    head.textContent = entry.symbol ? `${entry.name}, ${entry.symbol}` : entry.name;
    const body = document.createElement("div");
    body.textContent = entry.text;
    box.append(head, body);
    for (const [what, source] of [["Source", entry.source], ["This value", own]]) {
      if (!source) continue;
      const from = document.createElement("div");
      from.textContent = `${what}: ${source}`;
      box.append(from);
    }
    box.hidden = false;
    target.setAttribute("aria-describedby", "tip");
    const at = target.getBoundingClientRect(), size = box.getBoundingClientRect();
    const left = Math.min(at.left, innerWidth - size.width - 8);
    const below = at.bottom + 6;
    box.style.left = `${Math.max(8, left)}px`;
    box.style.top = `${below + size.height > innerHeight ? at.top - size.height - 6 : below}px`;
  }

  function hide() {
    if (shown) shown.removeAttribute("aria-describedby");
    shown = null;
    box.hidden = true;
  }

  for (const event of ["pointerover", "focusin"]) {
    document.addEventListener(event, ({ target }) => {
      const tipped = target.closest?.("[data-tip]");
      if (tipped) show(tipped);
      else hide();
    });
  }
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") hide();
  });
}
