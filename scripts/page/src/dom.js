// Small helpers to make elements. Text of the data is only ever set as text.

export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children.filter((each) => each !== undefined));
  return made;
}

export const labelled = (text, input) => element("label", {}, element("span", {}, text), input);

export function slider(text, { min, max, step, value, shown = String }, change) {
  const output = element("output", {}, shown(value));
  const input = element("input", {
    type: "range", min, max, step, value,
    oninput: () => {
      output.textContent = shown(input.valueAsNumber);
      change(input.valueAsNumber);
    },
  });
  const made = element("label", { className: "slider" }, element("span", {}, text), output, input);
  made.set = (to) => {
    input.value = to;
    input.dispatchEvent(new Event("input"));
  };
  made.input = input;
  return made;
}

export function toggle(text, isOn, change) {
  const input = element("input", {
    type: "checkbox", checked: isOn, onchange: () => change(input.checked),
  });
  const made = element("label", { className: "toggle" }, input, element("span", {}, text));
  made.flip = () => input.click();
  return made;
}

export function choice(text, options, value, change) {
  const select = element("select", { onchange: () => change(select.value) },
    ...options.map(([key, shown]) => element("option", { value: key }, shown)));
  select.value = value;
  return text ? labelled(text, select) : select;
}

// Digits enough for a length of such a size.
export function rounded(number, size) {
  if (!Number.isFinite(number)) return "none";
  const digits = Math.min(Math.max(4 - Math.floor(Math.log10(size || 1)), 0), 12);
  return number.toFixed(digits);
}
