// One shader for faces, and a plainer one for points and lines: colour by a value or of the data,
// light of a sun, lines of equal height, and a box outside of which nothing is drawn.

import * as THREE from "three";

const BOX = `
  uniform vec3 least, greatest;
  bool isOutside(vec3 p) { return any(lessThan(p, least)) || any(greaterThan(p, greatest)); }`;

const VERTEX = `
  attribute float value;
  attribute vec3 tint;
  uniform float size;
  varying vec3 place, hue;
  varying float amount;
  void main() {
    place = position;
    hue = tint;
    amount = value;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_PointSize = size;
  }`;

const COLOUR = `
  uniform sampler2D palette;
  uniform vec2 range;
  uniform vec3 plain;
  uniform int colouring; // 0 plain, 1 by the value, 2 of the data
  varying vec3 hue;
  varying float amount;
  vec3 colour() {
    if (colouring == 2) return hue;
    if (colouring == 0) return plain;
    if (isnan(amount)) return vec3(0.5);
    float at = clamp((amount - range.x) / max(range.y - range.x, 1e-30), 0.0, 1.0);
    return texture2D(palette, vec2((at * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  }`;

const FACES = `
  varying vec3 place;
  uniform vec3 sun;
  uniform float shading, shaded, stretch, interval, base, opacity;
  uniform vec3 ink;
  ${BOX}
  ${COLOUR}
  float line(float height, float every) {
    float at = height / every, width = fwidth(at);
    float away = abs(fract(at - 0.5) - 0.5);
    return (1.0 - smoothstep(0.5 * width, 1.5 * width, away)) * (1.0 - smoothstep(0.15, 0.4, width));
  }
  void main() {
    if (isOutside(place)) discard;
    vec3 seen = vec3(1.0, 1.0, stretch);
    vec3 up = normalize(cross(dFdx(place) * seen, dFdy(place) * seen)); // towards the eye
    float light = 0.32 + 0.68 * max(dot(up, sun), 0.0) + 0.10 * up.z;
    vec3 lit = colour() * mix(1.0, light, shading * shaded);
    if (interval > 0.0) {
      lit = mix(lit, ink, 0.45 * line(place.z + base, interval));
      lit = mix(lit, ink, 0.55 * line(place.z + base, 5.0 * interval));
    }
    gl_FragColor = vec4(min(lit, 1.0), opacity);
  }`;

const REST = `
  varying vec3 place;
  uniform float opacity, round;
  ${BOX}
  ${COLOUR}
  void main() {
    if (isOutside(place)) discard;
    if (round > 0.0 && length(gl_PointCoord - 0.5) > 0.5) discard;
    gl_FragColor = vec4(colour(), opacity);
  }`;

// What all layers share, changed by the controls.
export const shared = {
  least: { value: new THREE.Vector3().setScalar(-1e30) },
  greatest: { value: new THREE.Vector3().setScalar(1e30) },
  sun: { value: new THREE.Vector3() },
  shading: { value: 1 },
  stretch: { value: 1 },
  interval: { value: 0 },
  base: { value: 0 },
  ink: { value: new THREE.Color(0.13, 0.1, 0.07) },
};

export function materialOf(kind, { color = "#888888", opacity = 1, size = 4, shade = 1 }) {
  const isFaces = kind === "faces";
  const own = {
    palette: { value: null },
    range: { value: new THREE.Vector2(0, 1) },
    colouring: { value: 0 },
    plain: { value: new THREE.Color().setStyle(color, THREE.LinearSRGBColorSpace) },
    opacity: { value: opacity },
    size: { value: size * window.devicePixelRatio },
    shaded: { value: shade },
    round: { value: kind === "points" ? 1 : 0 },
  };
  return new THREE.ShaderMaterial({
    uniforms: { ...shared, ...own },
    vertexShader: VERTEX,
    fragmentShader: isFaces ? FACES : REST,
    side: THREE.DoubleSide,
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    polygonOffset: isFaces,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
}
