// Colours of values, from low to high. They differ in lightness, so that they can be told apart
// without seeing hue, and mix in Oklab, so that no band stands out.

const STOPS = {
  terrain: ["#1d4e58", "#2f7262", "#5c9160", "#99a962", "#cdbb79", "#e3cfa3", "#f1e6d3", "#ffffff"],
  values: ["#2b1b4d", "#3b3f7c", "#33698d", "#2c8f8b", "#54b37a", "#a4cf63", "#f2e267"],
  difference: ["#0b3c6f", "#2f74b5", "#8cb8dc", "#f4f2ee", "#eba277", "#c55a2b", "#7a2407"],
};

const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const encoded = (c) => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);

function oklab(hex) {
  const [r, g, b] = [1, 3, 5].map((i) => linear(parseInt(hex.slice(i, i + 2), 16) / 255));
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function rgb([lightness, a, b]) {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ].map((c) => Math.round(255 * encoded(Math.min(Math.max(c, 0), 1))));
}

// 256 colours as RGBA bytes.
export function palette(name) {
  const stops = STOPS[name].map(oklab);
  const bytes = new Uint8Array(4 * 256).fill(255);
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (stops.length - 1);
    const k = Math.min(Math.floor(at), stops.length - 2);
    const mixed = stops[k].map((c, j) => c + (at - k) * (stops[k + 1][j] - c));
    bytes.set(rgb(mixed), 4 * i);
  }
  return bytes;
}

export function gradient(name) {
  const bytes = palette(name);
  const at = (i) => `rgb(${bytes[4 * i]} ${bytes[4 * i + 1]} ${bytes[4 * i + 2]})`;
  return `linear-gradient(to right, ${[...Array(17).keys()].map((k) => at(Math.min(16 * k, 255)))})`;
}
