/* What a report does when a browser runs scripts: the view, tables linked with it, curves that zoom. */
const read = (name) => JSON.parse(document.getElementById(name).textContent);
const stage = document.getElementById("stage");

/** Text of a cell as a button. */
function link(cell, act) {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "link";
  button.append(...cell.childNodes);
  button.addEventListener("click", () => {
    act();
    stage.scrollIntoView({ block: "nearest" });
  });
  cell.append(button);
}

function rowsOf(name) {
  return [...document.querySelectorAll(`[data-table="${name}"] tr`)].slice(1);
}

/** Rows of modes and of joints lead to what the view shows, and show what it shows. */
function linked(view, scene) {
  const modes = rowsOf("modes"), joints = rowsOf("joints"), count = Math.max(1, scene.joints.length);
  modes.forEach((row, mode) =>
    [...row.cells].forEach((cell, column) => {
      const load = column - 2;
      if (column !== 0 && !(load >= 0 && load < scene.loads.length)) return;
      link(cell, () => view.show({ mode, field: "motion", ...(column === 0 ? {} : { load }) }));
    }),
  );
  joints.forEach((row, k) => {
    const joint = scene.joints[k % count], load = Math.floor(k / count);
    if (!joint) return;
    link(row.cells[1], async () => {
      view.joint(joint.name, { look: true });
      await view.show({ load, mode: null, field: "pressure" in scene.fields ? "pressure" : "parts" });
    });
  });
  return (state) => {
    modes.forEach((row, mode) => row.classList.toggle("now", mode === state.mode));
    joints.forEach((row, k) => row.classList.toggle("now", state.field in scene.fields && Math.floor(k / count) === state.load));
  };
}

/** Size and phase of complex curves over frequency, one pair of charts a group. */
async function curves(place, groups) {
  for (const { title, label, names, frequencies, values: given } of groups) {
    const x = await unpacked(frequencies), values = await unpacked(given), lines = x.length;
    const head = document.createElement("h3");
    head.textContent = title;
    place.append(head);
    const of = (measure) => names.map((name, curve) => {
      const begin = 2 * curve * lines;
      return { name, y: Float64Array.from(x, (_, k) => measure(values[begin + k], values[begin + lines + k])), wraps: 180 };
    });
    const both = [];
    const common = { x, xlabel: "frequency [Hz]", onRange: (range) => both.forEach((one) => one.show(range)) };
    both.push(chart(place, { ...common, title: `Amplitude, ${title}`, series: of(Math.hypot).map(({ name, y }) => ({ name, y })), ylabel: label, log: true }));
    both.push(chart(place, { ...common, title: `Phase, ${title}`, series: of((re, im) => (180 / Math.PI) * Math.atan2(im, re)), ylabel: "phase [°]", height: 160, limits: [-190, 190] }));
  }
}

/** Frequency and damping of a mode over its amplitude; each curve has amplitudes of its own, so all are put on one grid. */
async function backbones(place, { title, names, marked, acceleration, frequency, damping }) {
  const x = await unpacked(acceleration), of = async (given) => {
    const y = await unpacked(given);
    return names.map((name, curve) => ({ name, marks: name === marked, y: y.subarray(curve * x.length, (curve + 1) * x.length) }));
  };
  const both = [], common = { x, logX: true, xlabel: title, onRange: (range) => both.forEach((one) => one.show(range)) };
  both.push(chart(place, { ...common, title: "Frequency over amplitude", series: await of(frequency), ylabel: "frequency [Hz]" }));
  both.push(chart(place, { ...common, title: "Damping over amplitude", series: await of(damping), ylabel: "damping ratio [%]", log: true }));
}

try {
  const scene = read("scene");
  let follow = null;
  const view = await mount(stage, scene, { wheel: "focus", onShow: (state) => follow?.(state) });
  follow = linked(view, scene);
  follow(view.state);
  window.view = view;
  document.body.classList.add("live");
} catch (fault) {
  document.body.classList.add("still");
  document.getElementById("why").textContent = `This browser cannot show the moving view (${fault.message}); the pictures below replace it.`;
}
for (const place of document.querySelectorAll("[data-curves]")) {
  await (place.dataset.curves === "backbones" ? backbones : curves)(place, read(place.dataset.curves));
  document.body.classList.add(`has-${place.dataset.curves}`);
}
window.ready = true;
