// Starts the page: reads what it carries, and connects the view with its controls.

import { buildPanel } from "./panel.js";
import { readPage } from "./payload.js";
import { Tools } from "./tools.js";
import { View } from "./view.js";

async function start() {
  const header = await readPage();
  const canvas = document.getElementById("canvas");
  const view = new View(canvas, header);
  const tools = new Tools(view, document.getElementById("readout"), document.getElementById("drawer"));
  buildPanel(view, tools, document.getElementById("panel"));
  listen(canvas, tools);
  tools.clear();
  document.body.classList.remove("loading");
  window.liftmesh = { view, tools }; // for scripts of whoever embeds the page
  if (view.layers.some((each) => each.style.rises)) rise(view);
}

// A press that stays where it was is a click; one that moves turns the view.
function listen(canvas, tools) {
  let began = null;
  canvas.addEventListener("pointerdown", (event) => (began = event));
  canvas.addEventListener("pointerup", (event) => {
    if (!began || event.button !== 0) return;
    if (Math.hypot(event.clientX - began.clientX, event.clientY - began.clientY) > 4) return;
    const { left, top } = canvas.getBoundingClientRect();
    tools.click(event.clientX - left, event.clientY - top);
  });
}

// The lift: heights grow from nothing.
function rise(view) {
  if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
  const began = performance.now();
  const step = (now) => {
    const share = Math.min((now - began) / 2500, 1);
    view.setStretch(Math.max(share * share * (3 - 2 * share), 1e-3) * view.usual);
    if (share < 1) requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

start().catch((error) => {
  const place = document.getElementById("readout");
  place.textContent = `This page cannot be shown: ${error.message}`;
  document.body.classList.remove("loading");
  console.error(error);
});
