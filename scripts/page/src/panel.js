// The controls beside the view, and the keys that do the same.

import { choice, element, labelled, rounded, slider, toggle } from "./dom.js";
import { gradient } from "./palettes.js";
import { shared } from "./material.js";

const KEYS = [
  ["drag, one finger", "turn"], ["right button, two fingers", "move"], ["wheel, pinch", "zoom"],
  ["click, tap", "read, measure or cut"], ["I M P", "inspect, measure, profile"],
  ["W", "edges of faces"], ["C", "contour lines"], ["+ −", "heights up or down"],
  ["T N R", "from above, from the north, first view"], ["B", "clipping box"],
  ["S", "save a picture"], ["D", "dark or light"], ["H", "hide the panel"], ["?", "these keys"],
];

export function buildPanel(view, tools, place) {
  const { header } = view;
  const keys = {};
  const on = (key, action) => (keys[key] = action);
  const panel = element("div", { className: "sections" },
    summaryOf(header), layersOf(view), toolsOf(tools, on), lookOf(view, on), lightOf(view),
    boxOf(view, on));
  if (header.layers.some((each) => each.kind === "tetrahedra")) panel.append(cutOf(view));
  panel.append(buttonsOf(view, on));
  place.append(panel);
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (/^(INPUT|SELECT)$/.test(event.target.tagName) && event.target.type !== "range" &&
        event.target.type !== "checkbox") return;
    keys[event.key.toLowerCase()]?.();
  });
}

function section(title, isOpen, ...children) {
  return element("details", { open: isOpen }, element("summary", {}, title), ...children);
}

function summaryOf(header) {
  return element("div", { className: "summary" },
    element("h1", {}, header.title),
    ...header.notes.map((note) => element("p", {}, note)));
}

function layersOf(view) {
  return section("Layers", true, ...view.layers.map((layer) => {
    const legend = element("div", { className: "legend" });
    const show = (by) => {
      layer.colour(by);
      fillLegend(legend, layer);
      view.draw();
    };
    const options = [...layer.values.map((value, i) => [String(i), value.name])];
    if (layer.colors) options.push(["data", "own colours"]);
    options.push(["plain", "one colour"]);
    const pick = choice("", options, String(layer.colouring), (key) =>
      show(/^\d+$/.test(key) ? Number(key) : key));
    pick.ariaLabel = `colour of ${layer.name}`;
    fillLegend(legend, layer);
    const shown = toggle(layer.name, layer.object.visible, (isOn) => {
      layer.object.visible = isOn;
      view.draw();
    });
    const note = layer.note ? element("p", {}, layer.note) : undefined;
    return element("div", { className: "layer" }, shown, options.length > 1 ? pick : undefined, legend, note);
  }));
}

function fillLegend(place, layer) {
  const value = layer.values[layer.colouring];
  place.replaceChildren();
  if (!value) return;
  const [low, high] = value.range;
  const bar = element("div", { className: "bar" });
  bar.style.background = gradient(value.palette);
  const unit = value.unit ? ` ${value.unit}` : "";
  place.append(bar, element("span", {}, rounded(low, high - low)),
    element("span", {}, rounded(high, high - low) + unit));
}

function toolsOf(tools, on) {
  const modes = [["inspect", "i", "Inspect"], ["measure", "m", "Measure"], ["profile", "p", "Profile"]];
  const buttons = modes.map(([mode, key, text]) => {
    const choose = () => {
      tools.choose(mode);
      buttons.forEach((each) => (each.ariaPressed = String(each === button)));
    };
    const button = element("button", { type: "button", onclick: choose, title: `key ${key.toUpperCase()}` }, text);
    button.ariaPressed = String(mode === "inspect");
    on(key, choose);
    return button;
  });
  return element("div", { className: "row", role: "group", ariaLabel: "what a click does" }, ...buttons);
}

function lookOf(view, on) {
  const { bounds } = view;
  const size = bounds.max.z - bounds.min.z;
  const stretch = slider("Heights ×", { min: 0, max: 10, step: 0.05, value: 1,
    shown: (value) => value.toFixed(2) }, (value) => view.setStretch(value * view.usual));
  const usual = niceStep(size / 20);
  const interval = element("input", { type: "number", min: 0, step: "any", value: usual });
  let hasLines = false;
  const change = () => view.setContours(hasLines && interval.valueAsNumber > 0 ? interval.valueAsNumber : 0);
  interval.addEventListener("input", change);
  const lines = toggle("Contour lines every", false, (isOn) => {
    hasLines = isOn;
    change();
  });
  const wires = toggle("Edges", view.hasWires === true, (isOn) => view.setWires(isOn));
  on("w", () => wires.flip());
  on("c", () => lines.flip());
  const step = (factor) => stretch.set(Math.max(view.stretch / view.usual, 0.1) * factor);
  for (const key of ["+", "="]) on(key, () => step(1.25));
  for (const key of ["-", "−"]) on(key, () => step(0.8));
  return section("Shape", true, stretch, element("div", { className: "row" }, lines, interval), wires);
}

function niceStep(size) {
  if (!(size > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(size));
  return [1, 2, 5, 10].map((each) => each * power).find((each) => each >= size);
}

function lightOf(view) {
  const sun = { azimuth: 315, altitude: 40 };
  const turn = (name) => (value) => {
    sun[name] = value;
    view.setSun(sun.azimuth, sun.altitude);
  };
  const degrees = (value) => `${value}°`;
  return section("Light", false,
    slider("Sun from", { min: 0, max: 359, step: 1, value: 315, shown: degrees }, turn("azimuth")),
    slider("Sun above", { min: 1, max: 90, step: 1, value: 40, shown: degrees }, turn("altitude")),
    slider("Shade", { min: 0, max: 1, step: 0.05, value: 1, shown: (value) => `${Math.round(100 * value)} %` },
      (value) => {
        shared.shading.value = value;
        view.draw();
      }));
}

function boxOf(view, on) {
  const shares = [0, 1, 0, 1, 0, 1];
  const names = ["from west", "from east", "from south", "from north", "from below", "from above"];
  const sliders = names.map((name, k) => slider(name,
    { min: 0, max: 1, step: 0.005, value: shares[k], shown: (value) => `${Math.round(100 * value)} %` },
    (value) => {
      shares[k] = value;
      view.setBox(shares);
    }));
  const made = section("Clipping box", false, ...sliders,
    element("button", { type: "button", onclick: () => sliders.forEach((each, k) => each.set(k % 2)) },
      "Show all"));
  on("b", () => (made.open = !made.open));
  return made;
}

function cutOf(view) {
  const cut = { axis: 1, share: 0 };
  const apply = () => view.setCut(cut.axis, cut.share);
  return section("Cut", true,
    choice("Across", [["0", "x"], ["1", "y"], ["2", "z"]], "1", (axis) => {
      cut.axis = Number(axis);
      apply();
    }),
    slider("Taken away", { min: 0, max: 1, step: 0.005, value: 0, shown: (value) => `${Math.round(100 * value)} %` },
      (share) => {
        cut.share = share;
        apply();
      }));
}

function buttonsOf(view, on) {
  const help = document.getElementById("help");
  help.querySelector("dl").append(...KEYS.flatMap(([key, what]) =>
    [element("dt", {}, key), element("dd", {}, what)]));
  const actions = [
    ["First view", "r", () => view.lookFirst()], ["From above", "t", () => view.look(180, 90)],
    ["From the north", "n", () => view.look(0, 30)], ["Picture", "s", () => savePicture(view)],
    ["Dark or light", "d", () => switchTheme(view)], ["Keys", "?", () => help.showModal()],
  ];
  on("h", () => document.body.classList.toggle("bare"));
  return element("div", { className: "row buttons" }, ...actions.map(([text, key, action]) => {
    on(key, action);
    return element("button", { type: "button", onclick: action, title: `key ${key.toUpperCase()}` }, text);
  }));
}

function switchTheme(view) {
  const root = document.documentElement;
  const isDark = getComputedStyle(root).colorScheme === "dark";
  root.dataset.theme = isDark ? "light" : "dark";
  view.draw();
}

async function savePicture(view) {
  const background = getComputedStyle(document.body).backgroundColor;
  const url = URL.createObjectURL(await view.picture(background));
  element("a", { href: url, download: "view.png" }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
