/* Two of the last runs next to each other: what differs in their studies, modes, joints, and both in one figure. */
import { $, ask, made, said, table } from "./base.js";

let shown = "";

function label(run) {
  const when = new Date(run.date).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "medium" });
  const what = run.changes.length ? run.changes.map(([key, , now]) => `${key} = ${now}`).slice(0, 2).join(", ") : run.laws.join(", ");
  return `${when} · ${what || run.title}`;
}

/** List the runs, the two newest chosen. */
export async function showRuns() {
  let runs;
  try {
    runs = (await ask("GET", "runs")).runs;
  } catch (fault) {
    $("two").hidden = false;
    return said("two-fault", fault);
  }
  const marks = runs.map((run) => run.id).join();
  $("two").hidden = runs.length < 2;
  if (marks === shown) return;
  shown = marks;
  const options = () => runs.map((run) => new Option(label(run), run.id));
  $("run-first").replaceChildren(...options());
  $("run-second").replaceChildren(...options());
  $("run-first").selectedIndex = Math.min(1, runs.length - 1);
  $("run-second").selectedIndex = 0;
  if ($("two").open) compare();
  else $("two-found").replaceChildren();
}

async function compare() {
  const pair = { first: $("run-first").value, second: $("run-second").value };
  if ($("run-load").value) pair.preload = $("run-load").value;
  $("two-found").replaceChildren(made("p", "comparing …", { className: "hint" }));
  let found;
  try {
    found = await ask("GET", "compare", pair);
    said("two-fault", null);
  } catch (fault) {
    $("two-found").replaceChildren();
    return said("two-fault", fault);
  }
  if (pair.first !== $("run-first").value || pair.second !== $("run-second").value) return; // a later one is under way
  $("run-load").replaceChildren(...found.shared.map((load) => new Option(load, load, false, load === found.preloads[0])));
  $("run-load").parentElement.hidden = found.shared.length < 2;
  const part = (title, ...inner) => [made("h3", title), ...inner];
  const scrolled = (rows) => {
    const out = made("div", "", { className: "scroll" });
    out.append(table(rows));
    return out;
  };
  const figure = made("figure");
  const what = "Both runs: change of each frequency with its interval, loss factors, and the area of the joints that carries a pressure or more";
  figure.append(made("img", "", { alt: what, src: `data:image/svg+xml;base64,${found.picture}` }),
    made("figcaption", `${what}. Bars: 5 to 95 %. Preload ${found.preloads.join(" and ")}.`, { className: "hint" }));
  const same = made("p", "The studies say the same.", { className: "hint" });
  $("two-found").replaceChildren(
    ...found.notes.map((note) => made("p", note, { className: "note-line" })),
    ...part("Studies", found.changes.length ? scrolled([["key", "first", "second"], ...found.changes]) : same),
    ...part("Modes", scrolled(found.modes)), ...part("Joints", scrolled(found.joints)), figure);
}

for (const name of ["run-first", "run-second"]) $(name).addEventListener("change", () => { $("run-load").replaceChildren(); compare(); });
$("run-load").addEventListener("change", compare);
$("two").addEventListener("toggle", () => { if ($("two").open && !$("two-found").childElementCount) compare(); });
