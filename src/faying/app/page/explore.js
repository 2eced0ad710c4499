/* A scan as a map that zooms, with lines through it, and laws as curves that switch: our own canvas and SVG. */
import { $, ask, length, made, plain, said } from "./base.js";

const SVG = "http://www.w3.org/2000/svg";
const COLOURS = 8; // of the style sheet
const VIRIDIS = [[68, 1, 84], [71, 45, 123], [59, 82, 139], [44, 114, 142], [33, 145, 140], [40, 174, 128], [94, 201, 98], [173, 220, 48], [253, 231, 37]];
const ZOOM = 2;
const MM = 1e3;

const drawn = (name, properties, text = "") => {
  const out = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(properties)) out.setAttribute(key, value);
  out.textContent = text;
  return out;
};

/* curves */

function ticks([low, high], log) {
  if (log) {
    const out = [], few = high / low < 1e3;
    for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power += 1) {
      for (const one of few ? [1, 2, 5] : [1]) out.push(one * 10 ** power);
    }
    return out.filter((one) => one >= low * 0.999 && one <= high * 1.001);
  }
  const rough = (high - low) / 5, ten = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((one) => one * ten >= rough) * ten, out = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k += 1) out.push(k * step);
  return out;
}

/** An SVG of series {label, kind, runs: [{points, faint}]} over two axes {label, range, log}. */
export function chart({ x, y, series, label, width = 720, height = 300, band = null, dots = [] }) {
  const box = { left: 62, right: width - 12, top: 10, bottom: height - 42 };
  const scale = (axis, from, to) => {
    const change = axis.log ? Math.log10 : (v) => v, [a, b] = axis.range.map(change);
    return (v) => from + ((change(v) - a) / (b - a || 1)) * (to - from);
  };
  const px = scale(x, box.left, box.right), py = scale(y, box.bottom, box.top);
  const out = drawn("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", class: "chart" });
  out.append(drawn("title", {}, label));
  const text = (one) => { const out = String(Number(one.toPrecision(4))); return out.length > 7 ? one.toExponential(0) : out; };
  for (const one of ticks(x.range, x.log)) {
    out.append(drawn("line", { x1: px(one), x2: px(one), y1: box.top, y2: box.bottom, class: "grid" }),
      drawn("text", { x: px(one), y: box.bottom + 16, "text-anchor": "middle" }, text(one)));
  }
  for (const one of ticks(y.range, y.log)) {
    out.append(drawn("line", { x1: box.left, x2: box.right, y1: py(one), y2: py(one), class: "grid" }),
      drawn("text", { x: box.left - 6, y: py(one) + 4, "text-anchor": "end" }, text(one)));
  }
  out.append(drawn("text", { x: (box.left + box.right) / 2, y: height - 6, "text-anchor": "middle" }, x.label),
    drawn("text", { x: -(box.top + box.bottom) / 2, y: 14, transform: "rotate(-90)", "text-anchor": "middle" }, y.label));
  if (band) out.append(drawn("rect", { x: px(band[0]), width: px(band[1]) - px(band[0]), y: box.top, height: box.bottom - box.top, class: "band" }));
  const cloud = drawn("g", { class: "dots" });
  cloud.append(...dots.map(([a, b]) => drawn("circle", { cx: px(a).toFixed(1), cy: py(b).toFixed(1), r: 2 })));
  out.append(cloud);
  for (const one of series) {
    const group = drawn("g", { class: `curve c${one.kind % COLOURS}${one.kind >= COLOURS ? " dashed" : ""}` });
    group.append(drawn("title", {}, one.label));
    for (const { points, faint } of one.runs) {
      const path = points.map(([a, b], k) => `${k ? "L" : "M"}${px(a).toFixed(1)} ${py(b).toFixed(1)}`).join("");
      if (points.length) group.append(drawn("path", { d: path, class: faint ? "faint" : "" }));
    }
    out.append(group);
  }
  return out;
}

const extent = (values, log) => {
  const good = values.filter((one) => Number.isFinite(one) && (!log || one > 0));
  const low = Math.min(...good), high = Math.max(...good);
  return log ? [low / 1.1, high * 1.1] : [low - 0.04 * (high - low || 1), high + 0.04 * (high - low || 1)];
};

/* laws */

const QUANTITIES = {
  k_n: ["normal stiffness per area", "k_n [MPa/µm]", 1e-12],
  k_t: ["tangential stiffness per area", "k_t [MPa/µm]", 1e-12],
  area: ["real area over nominal area", "real area [%]", 100],
};

/** Curves of laws {pressure, laws}: a quantity to choose, a box for each law. */
export function showLaws(place, facts) {
  const pressure = facts.pressure.values.map((one) => one / 1e6), names = Object.keys(facts.laws);
  const pick = made("select"), boxes = new Map(), figure = made("div"), legend = made("div", "", { className: "row legend" });
  pick.append(...Object.entries(QUANTITIES).map(([key, [words]]) => new Option(words, key)));
  const draw = () => {
    const [words, label, factor] = QUANTITIES[pick.value];
    const series = [];
    for (const [kind, name] of names.entries()) {
      const law = facts.laws[name], values = law[pick.value]?.values, box = boxes.get(name);
      box.disabled = !values?.some((one) => one > 0);
      if (box.disabled || !box.checked) continue;
      const runs = [];
      for (const [k, value] of values.entries()) {
        const faint = !law.valid[k], last = runs.at(-1), point = [pressure[k], value * factor];
        if (!(value > 0)) continue;
        if (last && last.end === k - 1 && last.faint === faint) Object.assign(last, { end: k, points: [...last.points, point] });
        else runs.push({ faint, end: k, points: last?.end === k - 1 ? [last.points.at(-1), point] : [point] });
      }
      series.push({ label: name, kind, runs });
    }
    const every = series.flatMap((one) => one.runs.flatMap((run) => run.points.map(([, b]) => b)));
    figure.replaceChildren(every.length ? chart({ x: { label: "contact pressure [MPa]", range: extent(pressure, true), log: true },
      y: { label, range: extent(every, true), log: true }, series, label: `${words} of ${series.map((one) => one.label).join(", ")} against pressure` })
      : made("p", "No law is chosen that has this.", { className: "hint" }));
  };
  for (const [kind, name] of names.entries()) {
    const box = made("input", "", { type: "checkbox", checked: true }), item = made("label", "", { className: `key c${kind % COLOURS}${kind >= COLOURS ? " dashed" : ""}` });
    box.addEventListener("change", draw);
    boxes.set(name, box);
    item.append(box, made("i"), name);
    legend.append(item);
  }
  const all = made("button", "All", { type: "button" }), none = made("button", "None", { type: "button" });
  for (const [button, on] of [[all, true], [none, false]]) {
    button.addEventListener("click", () => { for (const box of boxes.values()) box.checked = on; draw(); });
  }
  legend.append(all, none);
  const label = made("label", "Show ");
  label.append(pick);
  pick.addEventListener("change", draw);
  place.replaceChildren(label, legend, figure, made("p", "Faint: outside the validity range of the law.", { className: "hint" }));
  draw();
}

/* the map of a scan */

const view = { query: null, window: [0, 0, 1, 1], map: null, along: "x", at: 0.5, drag: null, number: 0, lines: 0 };

/** Show the map of a scan; the query names the file and its units. */
export async function showMap(query) {
  view.lines += 1; // answers on the scan before come too late
  spectrum.number += 1;
  Object.assign(view, { query, window: [0, 0, 1, 1], at: 0.5 });
  await load();
  await fit();
}

/* the spectrum, and the band over which a power law is fitted */

const spectrum = { limits: [1, 1], number: 0 };
const toShare = (wave) => Math.log(wave / spectrum.limits[0]) / Math.log(spectrum.limits[1] / spectrum.limits[0]);
const toWave = (share) => spectrum.limits[0] * (spectrum.limits[1] / spectrum.limits[0]) ** share;

async function fit(band = null) {
  const number = (spectrum.number += 1);
  let found;
  try {
    found = await ask("GET", "spectrum", band ? { ...view.query, band: band.join() } : view.query);
    if (number === spectrum.number) said("band-fault", null);
  } catch (fault) {
    if (number === spectrum.number && !$("map").hidden) said("band-fault", fault);
    return;
  }
  if (number !== spectrum.number) return; // a later one is under way
  const { wavelength, density, fit: law, limits } = found, UM = 1e6;
  spectrum.limits = limits;
  $("band").hidden = false;
  for (const [id, wave] of [["band-from", law.band[0]], ["band-to", law.band[1]]]) {
    $(id).value = toShare(wave);
    $(id).setAttribute("aria-valuetext", length(wave));
  }
  const dots = wavelength.map((one, k) => [one * UM, density[k]]), ends = law.law.every((one) => one > 0);
  const line = ends ? [{ label: "fit", kind: 0, runs: [{ points: law.band.map((one, k) => [one * UM, law.law[k]]), faint: false }] }] : [];
  const label = `Power of the heights against wavelength, with the law over ${length(law.band[0])} to ${length(law.band[1])}`;
  $("band-chart").replaceChildren(chart({ x: { label: "wavelength [µm]", range: extent(dots.map(([a]) => a), true), log: true },
    y: { label: "power per frequency [m³]", range: extent([...density, ...(ends ? law.law : [])], true), log: true }, series: line, dots, band: law.band.map((one) => one * UM), label }));
  const range = (ends, show) => ends.map(show).join(" to ");
  $("band-says").textContent = `${length(law.band[0])} to ${length(law.band[1])}: D = ${plain(law.D)} (${range(law.D_interval, (one) => plain(one))}), `
    + `G = ${length(law.G)} (${range(law.G_interval, length)}), 95 % intervals.`;
  $("band-warns").replaceChildren(...law.warnings.map((one) => made("p", one, { className: "hint" })));
}

for (const id of ["band-from", "band-to"]) {
  $(id).addEventListener("input", () => $(id).setAttribute("aria-valuetext", length(toWave(Number($(id).value)))));
  $(id).addEventListener("change", () => fit([toWave(Number($("band-from").value)), toWave(Number($("band-to").value))]));
}
$("band-auto").addEventListener("click", () => fit());

async function load() {
  const number = (view.number += 1), query = { ...view.query, window: view.window.join() };
  try {
    const map = await ask("GET", "map", query);
    if (number !== view.number) return;
    view.map = map;
    $("map").hidden = false;
    said("map-fault", null);
    paint();
    await trace();
  } catch (fault) {
    if (number !== view.number) return;
    $("map").hidden = !view.map || !/window/.test(fault.message);
    said("map-fault", /line scan/.test(fault.message) ? null : fault);
  }
}

const colour = (level) => {
  const at = (level / 254) * (VIRIDIS.length - 1), k = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return VIRIDIS[k].map((one, c) => Math.round(one + (VIRIDIS[k + 1][c] - one) * (at - k)));
};

function paint() {
  const { width, height, data, window: ends, low, high } = view.map, levels = atob(data), canvas = $("map-canvas");
  const image = new ImageData(width, height);
  for (let k = 0; k < levels.length; k += 1) {
    const level = levels.charCodeAt(k), to = 4 * ((height - 1 - Math.floor(k / width)) * width + (k % width)); // y upwards
    image.data.set(level === 255 ? [128, 128, 128, 90] : [...colour(level), 255], to);
  }
  const small = Object.assign(document.createElement("canvas"), { width, height });
  small.getContext("2d").putImageData(image, 0, 0);
  const ratio = (ends[3] - ends[1]) / (ends[2] - ends[0]);
  canvas.width = 720;
  canvas.height = Math.round(Math.min(Math.max(720 * ratio, 60), 720));
  const pen = canvas.getContext("2d");
  pen.imageSmoothingEnabled = false;
  pen.drawImage(small, 0, 0, canvas.width, canvas.height);
  const at = (view.at - view.window[view.along === "x" ? 1 : 0]) / (view.along === "x" ? view.window[3] - view.window[1] : view.window[2] - view.window[0]);
  if (at >= 0 && at <= 1) {
    for (const [style, line] of [["#000", 3], ["#fff", 1.5]]) {
      pen.strokeStyle = style;
      pen.lineWidth = line;
      pen.beginPath();
      if (view.along === "x") { pen.moveTo(0, (1 - at) * canvas.height); pen.lineTo(canvas.width, (1 - at) * canvas.height); }
      else { pen.moveTo(at * canvas.width, 0); pen.lineTo(at * canvas.width, canvas.height); }
      pen.stroke();
    }
  }
  const mm = (one) => plain(one * MM, 4);
  $("map-says").textContent = `x ${mm(ends[0])} to ${mm(ends[2])} mm, y ${mm(ends[1])} to ${mm(ends[3])} mm; colours from ${length(low)} to ${length(high)}`;
  canvas.setAttribute("aria-label", `Map of heights, ${$("map-says").textContent}`);
  for (const [id, off] of [["map-out", view.window.join() === "0,0,1,1"], ["map-whole", view.window.join() === "0,0,1,1"]]) $(id).disabled = off;
}

async function trace() {
  const number = (view.lines += 1), along = view.along;
  const found = await ask("GET", "line", { ...view.query, window: view.window.join(), along, at: view.at });
  if (number !== view.lines) return; // a later one is under way
  const heights = found.heights.map((one) => (one === null ? NaN : one * 1e6));
  const places = found.along.map((one) => one * MM), runs = [];
  for (const [k, height] of heights.entries()) {
    if (!Number.isFinite(height)) continue;
    if (k && Number.isFinite(heights[k - 1]) && runs.length) runs.at(-1).points.push([places[k], height]);
    else runs.push({ points: [[places[k], height]], faint: false });
  }
  const other = along === "x" ? "y" : "x", label = `Heights along ${along} at ${other} = ${plain(found.at * MM, 4)} mm`;
  $("map-line").replaceChildren(runs.length ? chart({ height: 220, x: { label: `${along} [mm]`, range: [places[0], places.at(-1)] },
    y: { label: "height [µm]", range: extent(heights) }, series: [{ label, kind: 0, runs }], label }) : made("p", "All points of this line are missing.", { className: "hint" }));
  $("map-at").value = view.at;
  $("map-at").setAttribute("aria-valuetext", label);
}

/** Zoom about a point of the window, or move it; shares of the window. */
function zoom(factor, cx = 0.5, cy = 0.5, dx = 0, dy = 0) {
  const [x0, y0, x1, y1] = view.window, out = [];
  for (const [low, high, c, d] of [[x0, x1, cx, dx], [y0, y1, cy, dy]]) {
    const span = Math.min((high - low) / factor, 1), at = low + c * (high - low) - c * span + d * span;
    const first = Math.min(Math.max(at, 0), 1 - span);
    out.push([first, first + span]);
  }
  if (out[0][1] - out[0][0] < 0.004 && factor > 1) return;
  view.window = [out[0][0], out[1][0], out[0][1], Math.min(out[1][1], 1)];
  view.window[2] = Math.min(view.window[2], 1);
  load();
}

const share = (event) => {
  const box = $("map-canvas").getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height];
};

function line(at) {
  view.at = Math.min(Math.max(at, 0), 1);
  paint();
  trace().catch((fault) => said("map-fault", fault));
}

$("map-in").addEventListener("click", () => zoom(ZOOM));
$("map-out").addEventListener("click", () => zoom(1 / ZOOM));
$("map-whole").addEventListener("click", () => { view.window = [0, 0, 1, 1]; load(); });
$("map-along").addEventListener("change", () => { view.along = $("map-along").value; line(view.at); });
$("map-at").addEventListener("input", () => line(Number($("map-at").value)));
$("map-canvas").addEventListener("wheel", (event) => {
  event.preventDefault();
  zoom(event.deltaY < 0 ? ZOOM : 1 / ZOOM, ...share(event));
}, { passive: false });
$("map-canvas").addEventListener("pointerdown", (event) => {
  $("map-canvas").setPointerCapture(event.pointerId);
  view.drag = share(event);
});
$("map-canvas").addEventListener("pointerup", (event) => {
  if (!view.drag) return;
  const [ax, ay] = view.drag, [bx, by] = share(event).map((one) => Math.min(Math.max(one, 0), 1)), [x0, y0, x1, y1] = view.window;
  view.drag = null;
  const wide = Math.abs(bx - ax), tall = Math.abs(by - ay);
  if (wide < 0.02 || tall < 0.02) line(view.along === "x" ? y0 + by * (y1 - y0) : x0 + bx * (x1 - x0));
  else {
    view.window = [x0 + Math.min(ax, bx) * (x1 - x0), y0 + Math.min(ay, by) * (y1 - y0), x0 + Math.max(ax, bx) * (x1 - x0), y0 + Math.max(ay, by) * (y1 - y0)];
    load();
  }
});
$("map-canvas").addEventListener("keydown", (event) => {
  const step = { ArrowLeft: [-0.25, 0], ArrowRight: [0.25, 0], ArrowUp: [0, 0.25], ArrowDown: [0, -0.25] }[event.key];
  if (step) zoom(1, 0.5, 0.5, ...step);
  else if (event.key === "+" || event.key === "=") zoom(ZOOM);
  else if (event.key === "-") zoom(1 / ZOOM);
  else return;
  event.preventDefault();
});
