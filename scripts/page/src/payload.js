// What the page carries: a header as JSON, and arrays as deflated bytes in base64. Bytes of equal
// weight lie together, which deflates better, and whole numbers are given as steps.

const TYPES = { f8: Float64Array, f4: Float32Array, i4: Int32Array, u1: Uint8Array };

export async function readPage() {
  const header = JSON.parse(document.getElementById("header").textContent);
  const element = document.getElementById("arrays");
  const bytes = bytesOf(element.textContent.trim());
  element.remove();
  const arrays = await Promise.all(header.arrays.map((each) => readArray(each, bytes)));
  for (const layer of header.layers) {
    for (const name of ["points", "cells", "rows", "colors", "neighbors"])
      if (layer[name] !== undefined) layer[name] = arrays[layer[name]];
    for (const value of layer.values) value.array = arrays[value.array];
  }
  return header;
}

function bytesOf(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function readArray({ type, length, first, last }, bytes) {
  const stream = new Blob([bytes.subarray(first, last)]).stream();
  const inflated = stream.pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(inflated).arrayBuffer());
  const array = new TYPES[type](length);
  const width = array.BYTES_PER_ELEMENT;
  const target = new Uint8Array(array.buffer);
  for (let k = 0; k < width; ++k)
    for (let i = 0, at = k * length; i < length; ++i) target[i * width + k] = planes[at + i];
  if (type === "i4") for (let i = 1; i < length; ++i) array[i] += array[i - 1];
  return array;
}
