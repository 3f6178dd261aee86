// Parts of the page, made and found.

export const at = (id) => document.getElementById(id);

export function cell(text, kind = "", tag = "td") {
  const made = document.createElement(tag);
  if (text instanceof Node) made.append(text); else made.textContent = text;
  if (kind) made.className = kind;
  if (tag === "th") made.scope = "row";
  return made;
}

export function row(...cells) {
  const made = document.createElement("tr");
  made.append(...cells);
  return made;
}

export function badge(verdict) {
  const made = document.createElement("span");
  made.className = `verdict ${verdict}`;
  made.textContent = verdict.replaceAll("_", " ");
  return made;
}

export function said(text, kind = "") {
  const made = document.createElement("p");
  made.textContent = text;
  made.className = kind;
  return made;
}

// Options of a list, keeping what is chosen where it is still there: [value, text] each.
export function offer(select, options) {
  const before = select.value;
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
  if (options.some(([value]) => String(value) === before)) select.value = before;
}

// What is below a heading is filled when it is opened for the first time.
export function whenOpened(details, work) {
  const look = () => { if (details.open) { details.removeEventListener("toggle", look); work(); } };
  details.addEventListener("toggle", look);
  look();
}

// Charts are drawn again when the window or its colours change.
export function redrawn(draw) {
  window.addEventListener("resize", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
}
