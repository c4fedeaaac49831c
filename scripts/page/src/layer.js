// One layer of the page: faces, lines, points or tetrahedra, as an object of three.js.

import * as THREE from "three";
import { materialOf } from "./material.js";
import { palette } from "./palettes.js";

const FACETS = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

export class Layer {
  constructor(given, origin) {
    Object.assign(this, given); // name, kind, points, cells, rows, colors, values, style, note
    this.count = this.points.length / 3;
    this.positions = new Float32Array(this.points.length);
    for (let i = 0; i < this.points.length; ++i)
      this.positions[i] = this.points[i] - origin[i % 3];
    this.origin = origin;
    this.material = materialOf(this.kind === "tetrahedra" ? "faces" : this.kind, this.style);
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setAttribute("position", new THREE.BufferAttribute(this.positions, 3));
    this.object = this.#make();
    this.object.visible = this.style.visible !== false;
    this.object.renderOrder = this.kind === "faces" && this.style.opacity < 1 ? 1 : 0;
    this.colour(this.style.value ?? (this.colors ? "data" : this.values.length ? 0 : "plain"));
  }

  #make() {
    if (this.kind === "tetrahedra") this.cut(2, Infinity);
    else if (this.cells) this.#index(new Uint32Array(this.cells.buffer));
    if (this.kind === "points") return new THREE.Points(this.geometry, this.material);
    if (this.kind === "lines") return new THREE.LineSegments(this.geometry, this.material);
    return new THREE.Mesh(this.geometry, this.material);
  }

  #index(array) {
    this.geometry.setIndex(new THREE.BufferAttribute(array, 1));
  }

  // By the number of a value, by colours of the "data", or "plain".
  colour(by) {
    this.colouring = by;
    const { uniforms } = this.material;
    uniforms.colouring.value = by === "plain" ? 0 : by === "data" ? 2 : 1;
    if (by === "data") {
      this.geometry.setAttribute("tint", new THREE.BufferAttribute(this.colors, 3, true));
    } else if (by !== "plain") {
      const value = this.values[by];
      this.geometry.setAttribute("value", new THREE.BufferAttribute(this.#amounts(value), 1));
      uniforms.range.value.set(...value.range.map((each) => each - (value.base ?? 0)));
      uniforms.palette.value?.dispose();
      uniforms.palette.value = new THREE.DataTexture(palette(value.palette), 256, 1);
      uniforms.palette.value.needsUpdate = true;
    }
  }

  // Heights are not sent twice; they are relative to the origin.
  #amounts(value) {
    if (value.array) return value.array;
    value.base = this.origin[2];
    return Float32Array.from({ length: this.count }, (_, i) => this.positions[3 * i + 2]);
  }

  // What the place has of a value: with the shares of three vertices.
  amount(value, vertices, shares) {
    const at = (v) => (value.array ? value.array[v] : this.points[3 * v + 2]);
    return vertices.reduce((sum, v, i) => sum + shares[i] * at(v), 0);
  }

  row(vertex) {
    return this.rows ? this.rows[vertex] : vertex;
  }

  // Corners of all faces that are drawn.
  get faces() {
    return this.kind === "faces" || this.kind === "tetrahedra" ? this.geometry.index.array : [];
  }

  get edges() {
    this.wires ??= this.#wires();
    return this.wires;
  }

  // Each edge once: that of the lesser vertex first. Those of one face alone may run the other way.
  #wires() {
    const faces = this.faces;
    const ends = [];
    const known = new Set();
    const once = (a, b) => {
      const key = Math.min(a, b) * this.count + Math.max(a, b);
      if (known.has(key)) return known.delete(key); // no third face has it
      known.add(key);
      ends.push(a, b);
      return true;
    };
    for (let i = 0; i < faces.length; i += 3)
      for (let k = 0; k < 3; ++k) once(faces[i + k], faces[i + ((k + 1) % 3)]);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.geometry.attributes.position);
    geometry.setIndex(new THREE.BufferAttribute(Uint32Array.from(ends), 1));
    const material = materialOf("lines", { color: "#1b1b1b", opacity: 0.35 });
    return new THREE.LineSegments(geometry, material);
  }

  // Of tetrahedra: those remain whose centre is behind a plane across an axis, seen from the first
  // view: below it, or on the side of larger x or y.
  cut(axis, at) {
    const { cells, neighbors, positions } = this;
    const isKept = new Uint8Array(cells.length / 4);
    for (let t = 0; t < isKept.length; ++t) {
      let sum = 0;
      for (let k = 0; k < 4; ++k) sum += positions[3 * cells[4 * t + k] + axis];
      isKept[t] = (axis === 2 ? sum / 4 <= at : sum / 4 >= at) ? 1 : 0;
    }
    const corners = [];
    for (let t = 0; t < isKept.length; ++t)
      for (let k = 0; isKept[t] && k < 4; ++k) {
        const other = neighbors[4 * t + k];
        if (other < 0 || !isKept[other]) for (const j of FACETS[k]) corners.push(cells[4 * t + j]);
      }
    this.#index(Uint32Array.from(corners));
    if (!this.wires) return;
    this.wires.removeFromParent();
    this.wires.geometry.dispose();
    this.wires = undefined;
  }
}
