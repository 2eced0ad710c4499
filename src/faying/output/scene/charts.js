/* Curves that zoom, as SVG.
 *
 *   const found = chart(element, { x, series: [{ name, y, marks }], xlabel, ylabel, log, logX, title, range, onRange })
 *
 * x and y are arrays of numbers, x rising; marks draws y as points; log and logX draw an axis logarithmically. Drag across to zoom, double-click or Escape to see all;
 * with the keyboard: plus and minus zoom, the arrows move along. found.show([low, high] | null) sets what is seen of x.
 */
const CURVES = 7; // colours that stay apart for colour-blind readers, after Okabe and Ito
const DASHES = ["", "6 3", "2 2", "8 3 2 3"];
const CHART_STYLE = `
.fc{--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#b5588c;--c4:#3a9fdc;--c5:#9a7400;--c6:#6d6d6d}
@media (prefers-color-scheme:dark){.fc{--c0:#56b4e9;--c1:#f0883e;--c2:#2fc79a;--c3:#e39bc4;--c4:#8ab4ff;--c5:#e6c229;
  --c6:#b9b9b9}}
.fc{position:relative;font:13px/1.4 system-ui,sans-serif;color:var(--ink,#1c2733);margin:.4rem 0}
.fc svg{display:block;width:100%;touch-action:pan-y;cursor:crosshair}
.fc svg:focus-visible{outline:2px solid var(--accent,#0a63b0)}
.fc text{font:12px system-ui,sans-serif;fill:var(--soft,#52616f);font-variant-numeric:tabular-nums}
.fc .grid{stroke:var(--line,#cfd7df);stroke-width:1}.fc .frame{fill:none;stroke:var(--soft,#52616f)}
.fc .band{fill:var(--accent,#0a63b0);opacity:.15}.fc .cross{stroke:var(--soft,#52616f);stroke-dasharray:3 3}
.fc path{fill:none;stroke-width:1.6;stroke-linejoin:round}
.fc-key{display:flex;flex-wrap:wrap;gap:.1rem 1rem;font-size:.92em;min-height:1.5em}
.fc-key span{display:inline-flex;align-items:center;gap:.35em;font-variant-numeric:tabular-nums;white-space:nowrap}
.fc-key svg{width:22px;height:8px;flex:none}
`;
let chartStyled = null;

function ticks(low, high, count) {
  const raw = (high - low) / count || 1, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((k) => k * power >= raw);
  const out = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k++) out.push(k * step);
  return out;
}

/** Places of 1, 2, 5, 10, ... within a range of decadic logarithms; powers of 10 alone where the others have no room. */
function decadesOf([low, high], most) {
  for (const steps of [[1, 2, 5], [1, 3], [1]]) {
    const out = [];
    for (let k = Math.floor(low); k <= high; k++) for (const step of steps) out.push(k + Math.log10(step));
    const seen = out.filter((t) => t >= low - 1e-6 && t <= high + 1e-6);
    if (seen.length > 1 && seen.length <= most) return seen;
  }
  return ticks(low, high, most / 2);
}

function svg(tag, given = {}, ...children) {
  const found = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(given)) found.setAttribute(key, String(value));
  found.append(...children);
  return found;
}

const short = (v) => (Math.abs(v) >= 1e6 || (v !== 0 && Math.abs(v) < 1e-3) ? v.toExponential(0).replace("e+", "e") : String(Number(v.toPrecision(5))));
const look = (k) => ({ stroke: `var(--c${k % CURVES})`, "stroke-dasharray": DASHES[Math.floor(k / CURVES) % DASHES.length] });

export function chart(element, { x: given, series, xlabel, ylabel, title, log = false, logX = false, limits = null, height = 260, onRange }) {
  if (chartStyled === null) {
    chartStyled = new CSSStyleSheet();
    chartStyled.replaceSync(CHART_STYLE);
    document.adoptedStyleSheets = [...document.adoptedStyleSheets, chartStyled];
  }
  const x = logX ? Array.from(given, Math.log10) : given, shownX = logX ? (v) => 10 ** v : (v) => v;
  const all = [x[0], x[x.length - 1]], edge = { left: 62, right: 12, top: 10, bottom: 38 };
  let range = all, width = 600, drag = null, at = null;
  const box = document.createElement("div"), key = document.createElement("div");
  box.className = "fc";
  key.className = "fc-key";
  const face = svg("svg", { tabindex: 0, role: "img", "aria-label": `${title}. Plus and minus zoom, arrows move, Escape shows all.` });
  box.append(face, key);
  element.append(box);
  const values = series.map((one, k) => {
    const span = document.createElement("span"), text = document.createElement("span");
    const sample = one.marks ? "M8 4a3 3 0 1 0 6 0a3 3 0 1 0 -6 0" : "M0 4H22";
    span.append(svg("svg", { viewBox: "0 0 22 8", "aria-hidden": "true" }, svg("path", { d: sample, ...look(k) })), text);
    key.append(span);
    return text;
  });

  const toX = (v) => edge.left + ((v - range[0]) / (range[1] - range[0])) * (width - edge.left - edge.right);
  const fromX = (p) => range[0] + ((p - edge.left) / (width - edge.left - edge.right)) * (range[1] - range[0]);
  const index = (v) => {
    let [a, b] = [0, x.length - 1];
    while (b - a > 1) x[(a + b) >> 1] < v ? (a = (a + b) >> 1) : (b = (a + b) >> 1);
    return v - x[a] < x[b] - v ? a : b;
  };

  function bounds(first, last) {
    if (limits) return limits;
    let [low, high] = [Infinity, -Infinity];
    for (const { y } of series)
      for (let k = first; k <= last; k++) {
        if (!Number.isFinite(y[k]) || (log && y[k] <= 0)) continue;
        low = Math.min(low, y[k]);
        high = Math.max(high, y[k]);
      }
    if (!(low <= high)) return log ? [0.1, 1] : [0, 1];
    if (log) return [low / 1.25, high * 1.25];
    const pad = 0.06 * (high - low || Math.abs(high) || 1);
    return [low - pad, high + pad];
  }

  function draw() {
    width = Math.max(280, element.clientWidth);
    face.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const first = Math.max(0, index(range[0]) - 1), last = Math.min(x.length - 1, index(range[1]) + 1);
    const [low, high] = bounds(first, last), bottom = height - edge.bottom, scale = log ? Math.log10 : (v) => v;
    const toY = (v) => bottom - ((scale(v) - scale(low)) / (scale(high) - scale(low))) * (bottom - edge.top);
    const right = width - edge.right, parts = [];
    for (const t of logX ? decadesOf(range, width / 70) : ticks(range[0], range[1], width / 110)) {
      parts.push(svg("line", { class: "grid", x1: toX(t), x2: toX(t), y1: edge.top, y2: bottom }));
      parts.push(svg("text", { x: toX(t), y: bottom + 16, "text-anchor": "middle" }, short(Number(shownX(t).toPrecision(6)))));
    }
    const decades = log ? ticks(Math.log10(low), Math.log10(high), 5).filter((t) => Math.abs(t - Math.round(t)) < 1e-6).map((t) => 10 ** Math.round(t)) : [];
    for (const t of log && decades.length > 1 ? decades : log ? ticks(low, high, 4).filter((v) => v > 0) : ticks(low, high, 5)) {
      if (t < low || t > high) continue;
      parts.push(svg("line", { class: "grid", x1: edge.left, x2: right, y1: toY(t), y2: toY(t) }));
      parts.push(svg("text", { x: edge.left - 6, y: toY(t) + 4, "text-anchor": "end" }, short(t)));
    }
    parts.push(svg("text", { x: (edge.left + right) / 2, y: height - 5, "text-anchor": "middle" }, xlabel));
    parts.push(svg("text", { x: 0, y: 0, "text-anchor": "middle", transform: `translate(13 ${(edge.top + bottom) / 2}) rotate(-90)` }, ylabel));
    const clip = svg("svg", { x: edge.left, y: edge.top, width: right - edge.left, height: bottom - edge.top, viewBox: `${edge.left} ${edge.top} ${right - edge.left} ${bottom - edge.top}` });
    series.forEach(({ y, wraps, marks }, k) => {
      let d = "", pen = false;
      for (let j = first; j <= last; j++) {
        const seen = Number.isFinite(y[j]) && (!log || y[j] > 0);
        if (seen && pen && wraps && Math.abs(y[j] - y[j - 1]) > wraps) pen = false;
        if (seen && marks) d += `M${toX(x[j]).toFixed(1)} ${toY(y[j]).toFixed(1)}m-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0`;
        else if (seen) d += `${pen ? "L" : "M"}${toX(x[j]).toFixed(1)} ${toY(y[j]).toFixed(1)}`;
        pen = seen && !marks;
      }
      clip.append(svg("path", { d, ...look(k) }));
    });
    parts.push(clip, svg("rect", { class: "frame", x: edge.left, y: edge.top, width: right - edge.left, height: bottom - edge.top }));
    if (drag) parts.push(svg("rect", { class: "band", x: Math.min(drag[0], drag[1]), y: edge.top, width: Math.abs(drag[1] - drag[0]), height: bottom - edge.top }));
    if (at !== null) parts.push(svg("line", { class: "cross", x1: toX(x[at]), x2: toX(x[at]), y1: edge.top, y2: bottom }));
    face.replaceChildren(...parts);
    series.forEach(({ name, y }, k) => {
      values[k].textContent = at === null || !Number.isFinite(y[at]) ? name : `${name}: ${Number(y[at].toPrecision(4))} at ${Number(shownX(x[at]).toPrecision(logX ? 4 : 6))}`;
    });
  }

  function show(wanted, silent = false) {
    let [low, high] = wanted ?? all;
    const least = (all[1] - all[0]) / 2000, span = Math.min(Math.max(high - low, least), all[1] - all[0]);
    low = Math.min(Math.max(low, all[0]), all[1] - span);
    range = [low, low + span];
    draw();
    if (!silent) onRange?.(wanted === null ? null : range); // in the decadic logarithm of x under logX
  }

  const place = (event) => {
    const box = face.getBoundingClientRect();
    const p = ((event.clientX - box.left) / box.width) * width;
    return Math.min(Math.max(p, edge.left), width - edge.right);
  };
  face.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    face.setPointerCapture(event.pointerId);
    drag = [place(event), place(event)];
  });
  face.addEventListener("pointermove", (event) => {
    if (drag) drag[1] = place(event);
    at = index(fromX(place(event)));
    draw();
  });
  face.addEventListener("pointerup", () => {
    const [a, b] = drag ?? [0, 0];
    const wanted = [fromX(Math.min(a, b)), fromX(Math.max(a, b))];
    drag = null;
    if (Math.abs(a - b) > 6) show(wanted);
    else draw();
  });
  face.addEventListener("pointerleave", () => {
    if (drag) return;
    at = null;
    draw();
  });
  face.addEventListener("dblclick", () => show(null));
  face.addEventListener("keydown", (event) => {
    const span = range[1] - range[0], middle = (range[0] + range[1]) / 2;
    const acts = {
      "+": () => show([middle - span / 4, middle + span / 4]), "=": () => show([middle - span / 4, middle + span / 4]),
      "-": () => show([middle - span, middle + span]), Escape: () => show(null), 0: () => show(null),
      ArrowLeft: () => show([range[0] - span / 5, range[1] - span / 5]), ArrowRight: () => show([range[0] + span / 5, range[1] + span / 5]),
    };
    if (!acts[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    acts[event.key]();
    event.preventDefault();
  });
  new ResizeObserver(draw).observe(element);
  draw();
  return { show: (wanted) => show(wanted, true), get range() { return range; } };
}
