// The view: camera, layers, and what is drawn over them. It draws when something has changed.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Layer } from "./layer.js";
import { shared } from "./material.js";
import { hitFace, hitPoint } from "./picking.js";

const MARK = new THREE.Color().setStyle("#d4351c", THREE.LinearSRGBColorSpace);

export class View {
  constructor(canvas, header) {
    this.header = header;
    this.origin = header.origin;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // colours are as they are given
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.camera = new THREE.PerspectiveCamera(40, 1, 1, 10);
    this.camera.up.set(0, 0, 1);
    this.root = new THREE.Scene();
    this.model = new THREE.Group(); // stretched along z
    this.root.add(this.model);
    this.layers = header.layers.map((each) => new Layer(each, this.origin));
    this.model.add(...this.layers.map((each) => each.object));
    this.marks = new THREE.Group();
    this.model.add(this.marks);
    this.bounds = this.#boundsOf();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.screenSpacePanning = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.draw());
    this.controls.listenToKeyEvents(canvas);
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement);
    this.setSun(315, 40);
    const first = this.layers.map((each) => each.style);
    this.usual = first.find((each) => each.stretch)?.stretch ?? 1;
    this.setStretch(this.usual);
    if (first.some((each) => each.wires)) this.setWires(true);
    this.#resize();
    this.lookFirst();
  }

  // What lies in a plane is seen from above.
  lookFirst() {
    if (this.layers.every((each) => each.style.above)) this.look(180, 90);
    else this.look();
  }

  #boundsOf() {
    const box = new THREE.Box3();
    for (const { positions } of this.layers) {
      for (let i = 0; i < positions.length; i += 3) {
        const [x, y, z] = positions.subarray(i, i + 3);
        box.min.set(Math.min(box.min.x, x), Math.min(box.min.y, y), Math.min(box.min.z, z));
        box.max.set(Math.max(box.max.x, x), Math.max(box.max.y, y), Math.max(box.max.z, z));
      }
    }
    return box;
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement.parentElement;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  get radius() {
    const size = this.bounds.getSize(new THREE.Vector3());
    return size.set(size.x, size.y, size.z * this.stretch).length() / 2 || 1;
  }

  get centre() {
    const centre = this.bounds.getCenter(new THREE.Vector3());
    return centre.setZ(centre.z * this.stretch);
  }

  // From a direction: where from in degrees from north, and how high.
  look(azimuth = 205, altitude = 38) {
    const [turn, tilt] = [azimuth, Math.min(altitude, 89.9)].map((each) => (each * Math.PI) / 180);
    const towards = new THREE.Vector3(
      Math.sin(turn) * Math.cos(tilt), Math.cos(turn) * Math.cos(tilt), Math.sin(tilt));
    const angle = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(this.camera.aspect, 1);
    const distance = (0.92 * this.radius) / Math.sin(Math.atan(Math.tan(angle) * narrow));
    this.controls.target.copy(this.centre);
    this.camera.position.copy(this.centre).addScaledVector(towards, distance);
    this.controls.minDistance = this.radius * 1e-4;
    this.controls.maxDistance = this.radius * 50;
    this.controls.update();
    this.draw();
  }

  setStretch(stretch) {
    const before = this.stretch ?? stretch;
    this.stretch = stretch;
    this.model.scale.z = Math.max(stretch, 1e-9);
    shared.stretch.value = stretch;
    if (before > 0) this.controls.target.z *= stretch / before;
    this.draw();
  }

  setSun(azimuth, altitude) {
    const [turn, tilt] = [azimuth, altitude].map((each) => (each * Math.PI) / 180);
    shared.sun.value.set(
      Math.sin(turn) * Math.cos(tilt), Math.cos(turn) * Math.cos(tilt), Math.sin(tilt));
    this.draw();
  }

  // Lines at multiples of the interval; none at 0.
  setContours(interval) {
    shared.interval.value = interval;
    shared.base.value = interval > 0 ? this.origin[2] % (5 * interval) : 0;
    this.draw();
  }

  // Shares of the bounds from 0 to 1, two for each axis.
  setBox(shares) {
    const { min, max } = this.bounds;
    ["x", "y", "z"].forEach((axis, k) => {
      const size = max[axis] - min[axis], edge = 1e-6 * (size + 1);
      shared.least.value[axis] = min[axis] + shares[2 * k] * size - edge;
      shared.greatest.value[axis] = min[axis] + shares[2 * k + 1] * size + edge;
    });
    this.draw();
  }

  setWires(isOn) {
    this.hasWires = isOn;
    for (const layer of this.layers) {
      if (layer.faces.length === 0 || layer.style.wires === false) continue;
      if (isOn) layer.object.add(layer.edges);
      else layer.wires?.removeFromParent();
    }
    this.draw();
  }

  // Takes a share of the tetrahedra away, from the side of the first view.
  setCut(axis, share) {
    const { min, max } = this.bounds;
    const from = axis === 2 ? max : min, to = axis === 2 ? min : max;
    const [first, last] = [from, to].map((each) => each.getComponent(axis));
    const at = first + share * (last - first) + (share === 0 ? (first - last) : 0);
    for (const layer of this.layers) if (layer.kind === "tetrahedra") layer.cut(axis, at);
    this.setWires(this.hasWires);
  }

  draw() {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.isAsked = false;
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(distance - 3 * this.radius, distance / 1000);
    this.camera.far = distance + 4 * this.radius;
    this.camera.updateProjectionMatrix();
    for (const mark of this.marks.children) this.#keepSize(mark);
    for (const layer of this.layers) this.#fadeWires(layer, distance);
    this.renderer.render(this.root, this.camera);
    this.frames = (this.frames ?? 0) + 1;
  }

  // Edges of small triangles would cover all colours.
  #fadeWires(layer, distance) {
    if (!layer.wires) return;
    const size = (2 * this.radius) / Math.sqrt(layer.faces.length / 6 + 1);
    const height = this.renderer.domElement.clientHeight;
    const pixels = (size * height) / (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360));
    layer.wires.material.uniforms.opacity.value = Math.min(Math.max(pixels / 20, 0.04), 0.5);
  }

  #keepSize(mark) {
    if (!mark.isMesh) return;
    const away = this.camera.position.distanceTo(mark.getWorldPosition(new THREE.Vector3()));
    const size = 0.006 * away;
    mark.scale.set(size, size, size / this.model.scale.z);
  }

  // What is at a place of the canvas in CSS pixels; null if nothing is.
  pick(x, y) {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement;
    const ray = new THREE.Raycaster();
    this.camera.updateMatrixWorld();
    ray.setFromCamera(new THREE.Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.camera);
    const from = ray.ray.origin, along = ray.ray.direction;
    const scale = this.model.scale.z;
    from.z /= scale;
    along.z /= scale;
    along.normalize();
    const pixels = (8 * Math.tan((this.camera.fov * Math.PI) / 360)) / height;
    const isVisible = (place) => this.#isInBox(place);
    const hits = this.layers.filter((each) => each.object.visible && each.style.pick !== false)
      .map((layer) => {
        if (layer.kind === "points") return hitPoint(layer, from, along, 2 * pixels, isVisible);
        return hitFace(layer, from, along, isVisible);
      });
    return hits.filter(Boolean).sort((a, b) => a.distance - b.distance)[0] ?? null;
  }

  #isInBox(place) {
    const { least, greatest } = shared;
    return place.every((each, k) => each >= least.value.getComponent(k) &&
      each <= greatest.value.getComponent(k));
  }

  // Where a place of the data is on the canvas, in CSS pixels.
  project(place) {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement;
    this.camera.updateMatrixWorld();
    const [x, y, z] = place.map((each, k) => each - this.origin[k]);
    const at = new THREE.Vector3(x, y, z * this.model.scale.z).project(this.camera);
    return [((at.x + 1) / 2) * width, ((1 - at.y) / 2) * height];
  }

  // A ball at each place, and lines between them.
  mark(places, isClosed = true) {
    for (const mark of this.marks.children) mark.geometry.dispose();
    this.marks.clear();
    for (const place of places) {
      const ball = new THREE.Mesh(new THREE.SphereGeometry(1, 16, 12),
        new THREE.MeshBasicMaterial({ color: MARK, depthTest: false }));
      ball.position.set(...place);
      ball.renderOrder = 3;
      this.marks.add(ball);
    }
    if (places.length > 1 && isClosed) {
      const geometry = new THREE.BufferGeometry().setFromPoints(
        places.map((place) => new THREE.Vector3(...place)));
      const line = new THREE.Line(geometry,
        new THREE.LineBasicMaterial({ color: MARK, depthTest: false }));
      line.renderOrder = 2;
      this.marks.add(line);
    }
    this.draw();
  }

  // The view as a PNG, before the colour of the page.
  async picture(background) {
    this.drawNow();
    const source = this.renderer.domElement;
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [source.width, source.height];
    const context = canvas.getContext("2d");
    context.fillStyle = background;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(source, 0, 0);
    return new Promise((done) => canvas.toBlob(done, "image/png"));
  }
}
