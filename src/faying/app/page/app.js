/* The page of `faying app`: files, scan, structure, study, run, result. It asks the server behind its own address alone,
 * and puts what it is told into the page as text, never as HTML. */
import { mount } from "./viewer.js";
import { $, ask, busy, length, made, plain, said, table } from "./base.js";
import { showLaws, showMap } from "./explore.js";
import { mountForm } from "./form.js";
import { showRuns } from "./runs.js";

const SAVE_AFTER = 700; // ms without a key
const READ_AFTER = 200; // the same, for faults of the text alone
const POLL = 600; // ms between two looks at a job
const PICTURES = ["prediction.svg", "tornado.svg", "identification.svg", "backbone.svg"];
const MM = 1e3;

const state = { project: null, view: null, picks: [], saved: "", timer: 0, shown: "", scan: "", job: null, checks: 0,
  tab: "", looked: Promise.resolve() };

/* tabs */

const TABS = ["steps", "surface", "structure", "form", "run", "result"];

function open(name) {
  for (const one of TABS) {
    const tab = $(`tab-${one}`);
    tab.setAttribute("aria-selected", String(one === name));
    tab.tabIndex = one === name ? 0 : -1;
    $(one).hidden = one !== name;
  }
  state.tab = name;
  if (name === "structure") showShape();
  if (name === "surface") showScan();
  if (name === "result") showResult();
}

for (const [number, name] of TABS.entries()) {
  $(`tab-${name}`).addEventListener("click", () => open(name));
  $(`tab-${name}`).addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const next = TABS[(number + step + TABS.length) % TABS.length];
    open(next);
    $(`tab-${next}`).focus();
  });
}

/* the project */

function fill(select, entries, wanted) {
  select.replaceChildren(...entries.map(([value, text]) => new Option(text, value)));
  select.disabled = !entries.length;
  if (entries.some(([value]) => value === wanted)) select.value = wanted;
}

function look() { // one after the other: an answer that comes late must not stand over a newer one
  return (state.looked = state.looked.catch(() => {}).then(read));
}

async function read() {
  const project = await ask("GET", "project");
  state.project = project;
  $("folder").textContent = project.folder;
  $("study-name").textContent = project.study;
  const of = (kind) => project.files.filter((file) => file.kinds.includes(kind)).map((file) => [file.name, file.name]);
  fill($("scans"), of("scan"), $("scans").value || state.scan);
  const shapes = [...of("geometry"), ...of("mesh")];
  if (project.text) shapes.unshift(["study", "the study"]);
  fill($("shapes"), shapes, $("shapes").value);
  proposable();
  $("example").hidden = $("offer").hidden = project.text !== null;
  steps();
  if (project.text !== null && project.text !== state.saved && $("text").value === state.saved) {
    $("text").value = state.saved = project.text;
    draw();
    explain();
    check();
    glance();
  }
  if (project.job) job(project.job);
  return project;
}

/* files */

for (const button of document.querySelectorAll(".add")) button.addEventListener("click", () => $("file").click());
$("file").addEventListener("change", () => upload([...$("file").files]));

async function upload(files) {
  let last = null;
  for (const file of files) {
    try {
      $("status").textContent = `reading ${file.name} …`;
      const study = file.name === state.project?.study && state.project.text !== null;
      const replaces = study || state.project?.files.some((one) => one.name === file.name);
      if (replaces && !confirm(`Replace ${file.name}? Its ${study ? "text" : "content"} is lost.`)) continue;
      await ask("POST", "file", replaces ? { name: file.name, replace: "yes" } : { name: file.name }, file);
      last = file.name;
    } catch (fault) {
      $("status").textContent = "";
      said(state.tab === "structure" ? "shape-fault" : "scan-fault", fault);
      return;
    }
  }
  $("status").textContent = "";
  $("file").value = "";
  const project = await look();
  const kinds = project.files.find((file) => file.name === last)?.kinds || [];
  if (kinds.includes("geometry") || kinds.includes("mesh")) {
    $("shapes").value = last;
    state.shown = "";
    open("structure");
  } else if (kinds.includes("scan")) {
    $("scans").value = last;
    state.scan = "";
    open("surface");
  }
}

let depth = 0;
addEventListener("dragenter", (event) => { event.preventDefault(); depth += 1; $("drop").hidden = false; });
addEventListener("dragleave", () => { depth -= 1; $("drop").hidden = depth > 0; });
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
  event.preventDefault();
  depth = 0;
  $("drop").hidden = true;
  upload([...event.dataTransfer.files]);
});

/* surface */

async function showScan(again = false) {
  const name = $("scans").value;
  $("show-laws").disabled = !name;
  $("scan-hint").hidden = Boolean(name);
  if (!name || (name === state.scan && !again)) return;
  state.scan = name;
  for (const id of ["scan-picture", "map", "map-fault", "band"]) $(id).hidden = true;
  for (const id of ["laws-table", "laws-curves"]) $(id).replaceChildren();
  $("scan-facts").replaceChildren(made("p", "reading the scan …", { className: "hint" }));
  const query = scanQuery();
  try {
    const { facts, picture } = await ask("GET", "scan", query);
    said("scan-fault", null);
    $("scan-facts").replaceChildren(...scanTable(facts), fitTable(facts), ...warnings(facts));
    $("scan-picture").firstElementChild.src = `data:image/png;base64,${picture}`;
    $("scan-picture").hidden = false;
    if (facts.points.length === 2) showMap(query);
  } catch (fault) {
    $("scan-facts").replaceChildren();
    said("scan-fault", fault);
    $("scan-units").hidden = !/unit|size|spacing|channel/.test(fault.message);
  }
}

/** The scan with what the fields say of how it is read. */
function scanQuery() {
  const query = { name: $("scans").value };
  for (const input of $("scan-units").querySelectorAll("input")) {
    if (input.value.trim()) query[input.name] = input.value.trim();
  }
  return query;
}

function scanTable(facts) {
  const r = facts.roughness;
  const shape = facts.points.length === 2 ? `${facts.points[1]} x ${facts.points[0]}` : `${facts.points[0]}`;
  const grid = [["points", "size", "spacing", "missing", "spikes"],
    [shape, facts.size.map(length).join(" x "), facts.spacing.map(length).join(" x "), String(facts.missing),
      String(facts.spikes)]];
  const heights = [["rms height", "mean deviation", "peak to valley", "rms slope"],
    [length(r.Rq), length(r.Ra), length(r.Rz), plain(r.Rdq)]];
  return [table(grid), table(heights)];
}

function fitTable(facts) {
  const rows = [["estimator", "D", "95 % interval", "G", "95 % interval"]];
  for (const [name, fit] of Object.entries(facts.fits)) {
    if (fit.error) rows.push([name, fit.error, "", "", ""]);
    else rows.push([name, plain(fit.D), fit.D_interval.map((v) => plain(v)).join(" to "), length(fit.G),
      fit.G_interval.map(length).join(" to ")]);
  }
  return table(rows);
}

function warnings(facts) {
  const lines = Object.values(facts.fits).flatMap((fit) => fit.warnings || []);
  return lines.map((line) => made("p", line, { className: "hint" }));
}

$("scans").addEventListener("change", () => showScan());
$("scan-again").addEventListener("click", () => showScan(true));
$("show-laws").addEventListener("click", (event) => busy(event.target, "solving the contact …", async () => {
  try {
    const { facts } = await ask("GET", "laws", scanQuery());
    const marks = "* outside the validity range of the law; - outside what it covers, or without a stiffness of its own";
    $("laws-table").replaceChildren(lawTable(facts), made("p", marks, { className: "hint" }));
    showLaws($("laws-curves"), facts);
    said("scan-fault", null);
  } catch (fault) {
    said("scan-fault", fault);
  }
}));

function lawTable(facts) {
  const pressures = facts.pressure.values;
  const chosen = [0, Math.floor(pressures.length / 2), pressures.length - 1];
  const heads = chosen.map((k) => `k_n at ${plain(pressures[k] / 1e6, 3)} MPa [MPa/µm]`);
  const rows = [["law", ...heads]];
  for (const [name, law] of Object.entries(facts.laws)) {
    const value = (k) => law.k_n?.values[k] ?? null;
    const cell = (k) => (value(k) === null ? "-" : plain(value(k) / 1e12, 3) + (law.valid[k] ? "" : " *"));
    rows.push([name, ...chosen.map(cell)]);
  }
  return table(rows);
}

/* structure */

function proposable() {
  const name = $("shapes").value;
  const file = state.project?.files.find((one) => one.name === name);
  $("propose").disabled = !file?.kinds.includes("geometry");
  $("shape-hint").hidden = Boolean($("shapes").value);
}

function meshed(name) {
  return Boolean(state.project?.files.find((one) => one.name === name)?.kinds.includes("mesh"));
}

async function showShape(again = false) {
  const name = $("shapes").value;
  proposable();
  const unit = meshed(name) ? $("unit").value : "";
  $("shape-unit").hidden = !meshed(name);
  if (meshed(name) && !unit) {
    said("shape-fault", new Error("A mesh file does not say its unit. Choose it above."));
    state.view?.dispose();
    state.view = state.shown = null;
    return;
  }
  const mark = name === "study" ? `study\n${state.saved}` : `${name} ${unit}`;
  if (!name || (mark === state.shown && !again)) return;
  state.shown = mark;
  said("shape-fault", null);
  state.view?.dispose();
  state.view = null;
  $("view").replaceChildren(made("p", "reading the geometry …", { className: "hint" }));
  try {
    const scene = await ask("GET", "scene", unit ? { of: name, unit } : { of: name });
    $("view").replaceChildren();
    state.view = await mount($("view"), scene, { onPick: pick });
    window.fayingView = state.view;
  } catch (fault) {
    $("view").replaceChildren();
    said("shape-fault", fault);
  }
  clearPicks();
}

function pick(face) {
  if (!face) return;
  const same = (one) => one.part === face.part && one.number === face.number;
  state.picks = state.picks.some(same) ? state.picks.filter((one) => !same(one)) : [...state.picks, face].slice(-2);
  drawPicks();
}

function clearPicks() {
  state.picks = [];
  drawPicks();
}

function drawPicks() {
  $("picks").replaceChildren(...state.picks.map((face) => {
    const item = made("li");
    const where = face.centre ? face.centre.map((x) => plain(x * MM, 4)).join(", ") : "";
    item.append(made("code", selector(face)), ` ${plain((face.area || 0) * MM * MM, 4)} mm² about (${where}) mm`);
    return item;
  }));
  state.view?.highlight(state.picks.map(({ part, number }) => ({ part, number })));
  const two = state.picks.length === 2;
  $("make-joint").disabled = $("make-bolt").disabled = !two;
  $("clear-picks").disabled = !state.picks.length;
}

const quoted = (text) => JSON.stringify(text);
const selector = (face) => (face.name ? quoted(face.name) : `{part = ${quoted(face.part)}, number = ${face.number}}`);

function insert(block) {
  const area = $("text");
  area.value = `${area.value.replace(/\s*$/, "")}\n\n${block}`;
  area.scrollTop = area.scrollHeight;
  typed();
}

function count(kind) {
  return ($("text").value.match(new RegExp(`^\\s*\\[\\[${kind}\\]\\]`, "gm")) || []).length + 1;
}

$("make-joint").addEventListener("click", () => {
  insert(`[[joint]]\nname = "joint ${count("joint")}"\nfaces = [${state.picks.map(selector).join(", ")}]\n`);
  clearPicks();
});
$("make-bolt").addEventListener("click", () => {
  insert(`[[bolt]]\nname = "bolt ${count("bolt")}"\nfaces = [${state.picks.map(selector).join(", ")}]\n` +
    'preload = "10 kN"             # fill in: this is not a proposal\n');
  clearPicks();
});
$("clear-picks").addEventListener("click", clearPicks);
for (const id of ["shapes", "unit"]) $(id).addEventListener("change", () => showShape());
$("propose").addEventListener("click", (event) => busy(event.target, "reading the faces …", async () => {
  const query = { geometry: $("shapes").value };
  if ($("scans").value) query.scan = $("scans").value;
  if (state.project.text) {
    if (!confirm(`Replace ${state.project.study}? Its text is lost.`)) return;
    query.replace = "yes";
  }
  await written("new", query);
}));
$("example").addEventListener("click", (event) => busy(event.target, "writing …", () => written("example", {})));

async function written(path, query) {
  try {
    await ask("POST", path, query);
    said("shape-fault", null);
    $("text").value = state.saved;
    await look();
    $("shapes").value = "study";
    await showShape(true);
  } catch (fault) {
    said("shape-fault", fault);
  }
}

$("try").addEventListener("click", (event) => busy(event.target, "writing …", async () => {
  open("structure");
  await written("example", {});
}));

/* steps */

const step = (name, text, mark) => {
  $(`step-${name}`).className = mark;
  $(`step-${name}`).querySelector("p").textContent = text;
};

/** What each step has, what is missing, and what comes next. */
function steps() {
  const project = state.project;
  if (!project) return;
  const of = (kind) => project.files.filter((file) => file.kinds.includes(kind)).map((file) => file.name);
  const text = project.text, scans = of("scan"), shapes = [...of("geometry"), ...of("mesh")];
  const known = text !== null && /^\s*(D|G|C)\s*=/m.test(text), surface = scans.length > 0 || known;
  const faults = state.faults ?? 0, ready = text !== null && faults === 0, ran = project.results.includes("result.nc");
  step("surface", scans.length ? scans.join(", ") : known ? "D and G, or a law's own numbers, stand in the study."
    : "Missing: a scan of one face (X3P, an instrument's file, or x, y, z text).", surface ? "done" : "now");
  step("structure", text === null ? (shapes.length ? `${shapes.join(", ")}. Missing: a study of it.` : "Missing: a STEP file or a mesh of the bolted parts.")
    : faults ? `${project.study} has ${faults} fault${faults > 1 ? "s" : ""}; they stand below its text.` : `${project.study} is ready.`,
  ready ? "done" : surface ? "now" : "");
  step("run", ran ? "There is a result." : ready ? "Not run yet." : "Needs the two steps before.", ran ? "done" : ready ? "now" : "");
  $("next").textContent = ran ? "Next: look at the result, or change the study and run it again."
    : ready ? "Next: run the study." : text !== null ? "Next: correct the faults of the study."
    : shapes.length ? "Next: open Structure and press “New study from it”."
    : surface ? "Next: add the STEP file of the parts, or a mesh." : "Next: add a scan, or open the small example.";
}

for (const button of document.querySelectorAll("[data-open]")) button.addEventListener("click", () => open(button.dataset.open));

/* what the keys mean: the schema of a study */

const schema = { root: null };

/** The tables of a path of names in the schema, through lists, choices and names of the user's own. */
function node(path) {
  let at = [schema.root];
  const flat = (one) => !one ? [] : one.$ref ? flat(one.$ref.split("/").slice(1).reduce((found, name) => found?.[name], schema.root))
    : [one, ...(one.anyOf || one.oneOf || []).flatMap(flat), ...(one.items ? flat(one.items) : [])];
  for (const name of path) {
    at = at.flatMap(flat).flatMap((one) => one.properties?.[name] ? [one.properties[name]]
      : typeof one.additionalProperties === "object" ? [one.additionalProperties] : Object.values(one.patternProperties || {}));
  }
  return at.flatMap(flat);
}

const names = (text) => [...text.matchAll(/"((?:[^"\\]|\\.)*)"|'([^']*)'|([\w-]+)/g)].map((found) => found[1] ?? found[2] ?? found[3]);

/** The table and the key at the caret, and the keys that this table has already. */
function where() {
  const area = $("text"), lines = area.value.split("\n");
  const line = area.value.slice(0, area.selectionStart).split("\n").length - 1;
  let table = [], start = -1;
  for (let k = line; k >= 0 && start < 0; k -= 1) {
    const head = /^\s*\[{1,2}([^\]]+)\]/.exec(lines[k]);
    if (head) { table = names(head[1]); start = k; }
  }
  let end = lines.findIndex((text, k) => k > Math.max(line, start) && /^\s*\[/.test(text));
  if (end < 0) end = lines.length;
  const keyOf = (text) => /^\s*((?:[\w-]+|"[^"]*")(?:\s*\.\s*(?:[\w-]+|"[^"]*"))*)\s*=/.exec(text)?.[1];
  const own = keyOf(lines[line] || "");
  return { table, key: own ? names(own) : [], used: lines.slice(start + 1, end).map(keyOf).filter(Boolean).map((text) => names(text)[0]) };
}

/** Say what the key at the caret means, and offer those that its table may have. */
function explain() {
  if (!schema.root) return;
  const { table, key, used } = where();
  const path = [...table, ...key], about = node(path).map((one) => one.description).filter(Boolean);
  const choices = node(path).flatMap((one) => one.enum || []).map((one) => JSON.stringify(one));
  $("help").textContent = path.length ? `${path.join(".")}: ${about[0] || (key.length ? "a name of your own." : "a table.")}${choices.length ? ` Choices: ${choices.join(", ")}.` : ""}` : "";
  const found = new Map(node(table).flatMap((one) => Object.entries(one.properties || {})));
  const free = [...found].filter(([name]) => !used.includes(name)).sort(([a], [b]) => (a < b ? -1 : 1));
  const title = table.length ? `a key of [${table.join(".")}]` : "a key or table";
  $("keys").replaceChildren(new Option(title, ""), ...free.map(([name, one]) => new Option(name, name, false, false)).map((option) => {
    option.title = node([...table, option.value]).map((one) => one.description).find(Boolean) || "";
    return option;
  }));
}

/** Put a key, or the head of a table, below the line of the caret. */
function insertKey(name) {
  const { table } = where(), area = $("text"), inside = node([...table, name]);
  const list = inside.some((one) => one.type === "array" && one.items?.type === "object");
  const isTable = !table.length && inside.some((one) => one.type === "object");
  const text = list && !table.length ? `\n[[${name}]]` : isTable ? `\n[${name}]` : `${name} = `;
  let at = area.value.indexOf("\n", area.selectionStart);
  if (at < 0 || text.startsWith("\n")) at = area.value.length;
  const lead = at > 0 ? "\n" : "";
  area.setRangeText(lead + text, at, at, "end");
  area.focus();
  typed();
  explain();
}

$("keys").addEventListener("change", () => { if ($("keys").value) insertKey($("keys").value); });
for (const kind of ["keyup", "click", "focus"]) $("text").addEventListener(kind, explain);
$("text").addEventListener("keydown", (event) => {
  if (event.ctrlKey && event.key === " ") { event.preventDefault(); explain(); $("keys").focus(); }
});

/* study */

let faulty = new Set();
const TOKEN = /(#.*)|("""[\s\S]*?"""|"(?:[^"\\\n]|\\.)*"?|'[^'\n]*'?)|(\b\d[\w.+-]*|\btrue\b|\bfalse\b)/g;

/** The text in colours, behind the one that is typed. */
function paint() {
  const out = [];
  const span = (text, kind) => out.push(made("span", text, { className: kind }));
  for (const line of $("text").value.split("\n")) {
    const head = /^(\s*\[{1,2}[^\]#]*\]{1,2})(.*)$/.exec(line), key = head ? null : /^(\s*[\w."' -]+?\s*)(=.*)$/.exec(line);
    if (head) span(head[1], "t");
    else if (key && !line.trimStart().startsWith("#")) span(key[1], "k");
    const rest = head ? head[2] : key && !line.trimStart().startsWith("#") ? key[2] : line;
    let end = 0;
    for (const found of rest.matchAll(TOKEN)) {
      out.push(rest.slice(end, found.index));
      span(found[0], found[1] ? "c" : found[2] ? "s" : "n");
      end = found.index + found[0].length;
    }
    out.push(rest.slice(end), "\n");
  }
  $("paint").replaceChildren(...out);
  scrolled();
}

function scrolled() {
  $("gutter").scrollTop = $("paint").scrollTop = $("text").scrollTop;
  $("paint").scrollLeft = $("text").scrollLeft;
}

function draw() {
  const lines = $("text").value.split("\n").length;
  const parts = [];
  for (let line = 1; line <= lines; line += 1) {
    parts.push(faulty.has(line) ? made("b", String(line)) : document.createTextNode(String(line)));
    parts.push(document.createTextNode("\n"));
  }
  $("gutter").replaceChildren(...parts);
  paint();
}

function typed() {
  $("saved").textContent = "not saved yet";
  draw();
  clearTimeout(state.timer);
  state.timer = setTimeout(save, SAVE_AFTER);
  clearTimeout(state.reading);
  state.reading = setTimeout(glance, READ_AFTER);
}

/** Faults of the text as it is typed, long before the geometry is looked at, and the form that it makes. */
async function glance() {
  clearTimeout(state.reading);
  const text = $("text").value;
  let found;
  try {
    found = await ask("POST", "read", {}, JSON.stringify({ text }));
  } catch { return; }
  if (text !== $("text").value) return; // a later one is under way
  form.draw(found.form);
  if (text !== state.saved) {
    state.unsure = true;
    faults(found.findings);
  } else if (state.unsure) { // typed and taken back within the time after which it is saved
    faults(found.findings);
    check();
  }
}

const form = mountForm({
  text: () => $("text").value,
  put: async (text) => {
    const area = $("text"), top = area.scrollTop;
    area.value = text;
    area.scrollTop = top;
    typed();
    await glance();
  },
  look: bring,
});

function faults(found) {
  state.faults = found.length;
  faulty = new Set(found.map((one) => one.line).filter(Boolean));
  $("faults").replaceChildren(...found.map(finding));
  form.mark(found);
  draw();
  steps();
}

async function save() {
  clearTimeout(state.timer);
  const text = $("text").value;
  if (text === state.saved) {
    $("saved").textContent = "";
    return;
  }
  try {
    await ask("PUT", "study", {}, JSON.stringify({ text, before: state.saved }));
    state.saved = text;
    $("saved").textContent = "saved";
    if (state.project) state.project.text = text;
    await check();
  } catch (fault) {
    $("saved").textContent = fault.message;
  }
}

async function check() {
  const number = (state.checks += 1);
  state.unsure = false;
  if (!state.saved) return;
  $("check-hint").textContent = "checking …";
  let found;
  try {
    found = (await ask("GET", "check")).findings;
  } catch (fault) {
    found = [{ level: "fault", text: fault.message, line: null }];
  }
  if (number !== state.checks) return; // a later one is under way
  const bad = found.filter((one) => one.level === "fault");
  $("check-hint").textContent = bad.length ? `${bad.length} fault${bad.length > 1 ? "s" : ""}` : "no fault";
  $("findings").replaceChildren(...found.map(finding));
  faults(bad);
}

function finding(one) {
  const item = made("li", "", { className: one.level === "fault" ? "fault-line" : one.level });
  if (one.line) {
    const button = made("button", `line ${one.line}`, { type: "button" });
    button.addEventListener("click", () => reach(one.line));
    item.append(button, ": ");
  }
  item.append(one.text);
  return item;
}

function reach(line) {
  const area = $("text");
  const start = area.value.split("\n").slice(0, line - 1).reduce((sum, text) => sum + text.length + 1, 0);
  const end = area.value.indexOf("\n", start);
  area.focus();
  area.setSelectionRange(start, end < 0 ? area.value.length : end);
  bring(line);
}

/** Bring a line of the text into sight, where it is not. */
function bring(line) {
  const area = $("text"), height = area.scrollHeight / area.value.split("\n").length, at = height * ((line || 1) - 1);
  if (line && (at < area.scrollTop || at + 2 * height > area.scrollTop + area.clientHeight)) area.scrollTop = at - area.clientHeight / 2;
}

$("text").addEventListener("input", typed);
$("text").addEventListener("scroll", scrolled);
addEventListener("beforeunload", (event) => { if ($("text").value !== state.saved) event.preventDefault(); });
addEventListener("keydown", (event) => {
  if ((event.ctrlKey || event.metaKey) && event.key === "s") { event.preventDefault(); save(); }
});

/* run */

const duration = (seconds) => (seconds < 120 ? `${Math.round(seconds)} s` : `${Math.round(seconds / 60)} min`);

/** What a command needs of the study beyond a run. */
function needs() {
  const text = $("text").value, wanted = $("command").value;
  const lacks = wanted === "identify" && !/^\s*\[test\]/m.test(text) ? "Needs [test]: measured frequencies, one list for each preload, and where they were measured."
    : wanted === "backbone" && !/^\s*\[backbone\]|^\s*friction\s*=/m.test(text) ? "Needs friction, in [[joint]] or in [backbone]: without it nothing slips." : "";
  $("needs").textContent = lacks || (wanted === "run" ? "" : "Works before any run of the study.");
}
$("command").addEventListener("change", needs);

$("start").addEventListener("click", async () => {
  await save();
  try {
    job(await ask("POST", "job", { command: $("command").value }));
    follow();
  } catch (fault) {
    $("job").hidden = false;
    $("job-line").textContent = fault.message;
  }
});
$("cancel").addEventListener("click", async () => job(await ask("DELETE", "job")));

function job(found) {
  const before = state.job;
  state.job = found;
  if (!found.command) return;
  $("job").hidden = false;
  const left = found.running && found.left_s !== null && found.left_s !== undefined ? `, ${duration(found.left_s)} left` : "";
  const steps = found.total ? ` (${found.done} of ${found.total})` : "";
  const line = found.running
    ? `${found.stage}${steps}, ${duration(found.seconds)}${left}`
    : `${found.command}: ${found.end} after ${duration(found.seconds)}`;
  $("job-line").textContent = line;
  $("status").textContent = found.running ? line : found.end === "failed" ? "failed" : "";
  if (found.running && !found.total) $("job-bar").removeAttribute("value");
  else $("job-bar").value = found.end === "done" ? 1 : found.total ? found.done / found.total : 0;
  $("words").textContent = found.words.join("\n");
  $("start").disabled = found.running;
  $("cancel").disabled = !found.running;
  if (!found.running && before?.running) ended(found);
}

async function follow() {
  while (state.job?.running) {
    await new Promise((done) => setTimeout(done, POLL));
    try {
      job(await ask("GET", "job"));
    } catch { /* it is said; go on trying */ }
  }
}

async function ended(found) {
  await look();
  if (found.end === "done") {
    state.shownResult = "";
    open("result");
  }
}

/* result */

async function showResult() {
  const names = state.project?.results || [];
  $("result-hint").hidden = names.length > 0;
  $("links").replaceChildren(...names.map((name) => made("a", name, { href: `results/${encodeURIComponent(name)}`,
    target: "_blank", rel: "noopener" })));
  const mark = `${names.join()} ${state.job?.started} ${state.job?.end}`;
  if (mark === state.shownResult) return;
  state.shownResult = mark;
  $("pictures").replaceChildren(...PICTURES.filter((name) => names.includes(name)).map((name) => {
    const figure = made("figure");
    figure.append(made("img", "", { alt: name, src: `results/${name}` }));
    return figure;
  }));
  showRuns();
  $("report").hidden = !names.includes("report.html");
  if (!$("report").hidden) $("report").src = "results/report.html";
}

/* begin */

look().then((project) => {
  $("text").readOnly = false; // what is typed before the study is there would stand against it
  if (project.text === null) glance(); // the form of an empty study
  const running = project.job?.running;
  const first = running ? "run" : project.results.length ? "result" : $("shapes").value ? "structure" : $("scans").value ? "surface" : "steps";
  open(state.tab || first); // a view that the user has chosen meanwhile stays
  if (running) follow();
});
ask("GET", "schema").then((found) => { schema.root = found; explain(); }, () => {});
