// What a click does: tell what is there, measure between two places, or cut a profile.

import { element, rounded } from "./dom.js";
import { cutFaces } from "./picking.js";

export class Tools {
  constructor(view, readout, drawer) {
    Object.assign(this, { view, readout, drawer, mode: "inspect", places: [] });
    this.size = 2 * view.radius;
  }

  choose(mode) {
    this.mode = mode;
    this.clear();
  }

  clear() {
    this.places = [];
    this.drawer.hidden = true;
    this.view.mark([]);
    const first = { inspect: "Click a place to read its coordinates.",
      measure: "Click two places to measure between them.",
      profile: "Click two places to cut a profile." };
    this.readout.replaceChildren(first[this.mode]);
  }

  click(x, y) {
    const hit = this.view.pick(x, y);
    if (!hit) return this.clear();
    if (this.mode === "inspect" || this.places.length === 2) this.places = [];
    this.places.push(hit);
    this.view.mark(this.places.map((each) => each.place));
    if (this.mode === "inspect") this.#inspect(hit);
    else if (this.places.length === 1) this.#lines([["First place", this.#coordinates(hit)]]);
    else if (this.mode === "measure") this.#measure(...this.places);
    else this.#profile(...this.places);
  }

  #lines(pairs) {
    this.readout.replaceChildren(element("dl", {}, ...pairs.flatMap(([name, value]) =>
      [element("dt", {}, name), element("dd", {}, value)])));
  }

  // Of a place on a face; all digits that mean something at this size.
  #coordinates({ place }) {
    const { origin } = this.view;
    return place.map((each, k) => rounded(each + origin[k], this.size)).join("  ");
  }

  #nearest({ layer, vertices, shares }) {
    return vertices[shares.indexOf(Math.max(...shares))];
  }

  #inspect(hit) {
    const { layer, vertices, shares } = hit;
    const vertex = this.#nearest(hit);
    const exact = Array.from(layer.points.subarray(3 * vertex, 3 * vertex + 3), String);
    const pairs = [["Row", `${layer.row(vertex)} of ${layer.name}`], ["its x y z", exact.join("  ")]];
    for (const value of layer.values) {
      const amount = layer.amount(value, vertices, shares);
      const unit = value.unit ? ` ${value.unit}` : "";
      if (value.array) pairs.push([value.name, `${Number(amount.toPrecision(7))}${unit}`]);
    }
    if (vertices.length > 1) pairs.push(["the place itself", this.#coordinates(hit)]);
    this.picked = { row: layer.row(vertex), layer: layer.name, exact };
    this.#lines(pairs);
  }

  #measure(first, second) {
    const [dx, dy, dz] = first.place.map((each, k) => second.place[k] - each);
    const planar = Math.hypot(dx, dy);
    const show = (length) => rounded(length, this.size) + this.#unit;
    this.measured = { planar, spatial: Math.hypot(planar, dz), rise: dz };
    this.#lines([["In the plane", show(planar)], ["In space", show(Math.hypot(planar, dz))],
      ["Rise", show(dz)], ["Slope", planar > 0 ? `${((100 * dz) / planar).toFixed(2)} %` : "vertical"],
      ["Steps in x, y", `${show(dx)}, ${show(dy)}`]]);
  }

  get #unit() {
    const { unit } = this.view.header;
    return unit ? ` ${unit}` : "";
  }

  #profile(first, second) {
    const layers = this.view.layers.filter((each) => each.object.visible && each.faces.length);
    const cuts = layers.map((layer) => ({ layer, ...cutFaces(layer, first.place, second.place) }))
      .filter((each) => each.pieces.length > 0);
    if (cuts.length === 0) return;
    this.profile = cuts;
    const heights = cuts.flatMap(({ pieces }) => pieces.flatMap((each) => [each[1], each[3]]));
    const z = this.view.origin[2];
    const low = heights.reduce((a, b) => Math.min(a, b)), high = heights.reduce((a, b) => Math.max(a, b));
    this.#lines([["Length", rounded(cuts[0].length, this.size) + this.#unit],
      ["Heights", `${rounded(low + z, this.size)} to ${rounded(high + z, this.size)}`]]);
    this.drawer.hidden = false;
    drawProfile(this.drawer.querySelector("canvas"), cuts, low, high, (height) =>
      rounded(height + z, 10 * (high - low)));
  }
}

const COLOURS = ["#d4351c", "#1d70b8", "#7a5c00"];

function drawProfile(canvas, cuts, low, high, shown) {
  const ratio = Math.min(window.devicePixelRatio, 2);
  const { clientWidth: width, clientHeight: height } = canvas;
  [canvas.width, canvas.height] = [width * ratio, height * ratio];
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  const style = getComputedStyle(canvas);
  const [left, right, top, bottom] = [64, 12, 12, 24];
  const { length } = cuts[0], room = high - low || 1;
  const x = (s) => left + (s / length) * (width - left - right);
  const y = (z) => height - bottom - ((z - low) / room) * (height - top - bottom);
  context.font = `12px ${style.fontFamily}`;
  context.fillStyle = style.color;
  context.strokeStyle = style.borderTopColor;
  context.textBaseline = "middle";
  for (const z of [low, (low + high) / 2, high]) {
    context.textAlign = "right";
    context.fillText(shown(z), left - 8, y(z));
    context.beginPath();
    context.moveTo(left, y(z));
    context.lineTo(width - right, y(z));
    context.stroke();
  }
  context.textAlign = "center";
  for (const s of [0, length / 2, length])
    context.fillText(rounded(s, 10 * length), Math.min(x(s), width - 28), height - 10);
  cuts.forEach(({ pieces }, k) => {
    context.strokeStyle = COLOURS[k % COLOURS.length];
    context.lineWidth = 1.5;
    context.beginPath();
    for (const [s, z, t, w] of pieces) {
      context.moveTo(x(s), y(z));
      context.lineTo(x(t), y(w));
    }
    context.stroke();
  });
}
