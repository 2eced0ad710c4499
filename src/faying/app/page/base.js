/* What every part of the page needs: elements, and questions to the server behind the page's own address alone. */

export const $ = (id) => document.getElementById(id);

export async function ask(method, path, query = {}, body = undefined) {
  const address = `api/${path}?${new URLSearchParams(query)}`;
  let answer;
  try {
    answer = await fetch(address, { method, body });
  } catch (fault) {
    $("lost").hidden = false;
    throw new Error("the server does not answer", { cause: fault });
  }
  $("lost").hidden = true;
  const kind = answer.headers.get("Content-Type") || "";
  const found = kind.startsWith("application/json") ? await answer.json() : { fault: await answer.text() };
  if (found.fault || !answer.ok) throw new Error(found.fault || `${answer.status}`);
  return found;
}

/** An element with text; what is told by the server goes into the page as text, never as HTML. */
export function made(name, text = "", properties = {}) {
  const element = Object.assign(document.createElement(name), properties);
  element.textContent = text;
  return element;
}

export function table(rows) {
  const out = made("table");
  rows.forEach((row, k) => {
    const line = out.appendChild(made("tr"));
    for (const cell of row) line.append(made(k ? "td" : "th", cell));
  });
  return out;
}

export function said(id, fault) {
  $(id).textContent = fault ? fault.message || String(fault) : "";
  $(id).hidden = !fault;
}

export async function busy(button, words, work) {
  const label = button.textContent;
  button.textContent = words;
  button.disabled = true;
  try {
    return await work();
  } finally {
    button.textContent = label;
    button.disabled = false;
  }
}

export const length = (metres) => {
  if (metres === null || metres === undefined) return "-";
  const size = Math.abs(metres);
  const [factor, unit] = size >= 1e-3 ? [1e3, "mm"] : size >= 1e-6 ? [1e6, "µm"] : size >= 1e-9 ? [1e9, "nm"] : [1, "m"];
  return `${Number((metres * factor).toPrecision(4))} ${unit}`;
};
export const plain = (value, digits = 4) => (value === null || value === undefined ? "-" : String(Number(value.toPrecision(digits))));
