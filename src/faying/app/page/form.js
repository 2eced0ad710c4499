/* The study as a form. The text is the truth: the server makes the form from it, and writes one key of it where a field
 * was changed. */
import { $, ask, made, said } from "./base.js";

const UNDONE = 50; // texts that are remembered

/** Keep the form in #groups in step with a text: `host.text()` gives it, `await host.put(text)` replaces it, and
 * `host.look(line)` brings a line of it into sight. */
export function mountForm(host) {
  let shape = "", lines = new Map(), fields = new Map(), groups = new Map(), queue = Promise.resolve(), faults = [];
  const before = [];

  const id = (name) => `field-${name}`;

  /** Ask the server for the changed text, again where the text was changed meanwhile. */
  function change(body, after = () => {}) {
    queue = queue.catch(() => {}).then(async () => {
      try {
        for (let done = false; !done;) {
          const text = host.text();
          const found = (await ask("POST", "edit", {}, JSON.stringify({ text, ...body }))).text;
          done = host.text() === text;
          if (done && found !== text) {
            before.push({ text, after: found });
            before.splice(0, before.length - UNDONE);
            await host.put(found);
          }
        }
        said("form-fault", null);
      } catch (fault) {
        said("form-fault", fault);
      }
      after();
    });
    return queue;
  }

  $("form-undo").addEventListener("click", async () => {
    if (undoable()) await host.put(before.pop().text);
  });

  /** Whether the text is as the form left it: what was typed since is not taken back. */
  const undoable = () => before.at(-1)?.after === host.text();

  function control(field) {
    const limits = field.shape === "choice" ? field.choices : field.shape === "truth" ? ["true", "false"] : null;
    const out = made(limits ? "select" : "input", "", { id: id(field.name) });
    if (limits) {
      const none = field.default ? `default: ${field.default}` : field.needed ? "choose" : "not given";
      out.append(new Option(none, ""), ...limits.map((one) => new Option(one, one)));
    } else {
      out.autocomplete = "off";
      out.spellcheck = false;
      out.placeholder = field.default || (field.needed ? "needed" : "");
    }
    if (!limits && field.suggestions.length) out.setAttribute("list", `${out.id}-list`);
    out.addEventListener("change", () => change({ path: field.path, value: out.value }));
    out.addEventListener("focus", () => host.look(lines.get(field.name)));
    return out;
  }

  function show(field, value) {
    const out = field.control;
    if (out === document.activeElement && out.value !== field.shown) return; // is being typed
    if (out.tagName === "SELECT" && value && ![...out.options].some((one) => one.value === value)) out.append(new Option(value, value));
    out.value = field.shown = value;
  }

  function row(field) {
    const out = made("div", "", { className: "field" }), input = control(field);
    const words = made("span", field.says + (field.unit ? ` [${field.unit}]` : ""), { id: `${input.id}-says`, className: "says" });
    const fault = made("p", "", { id: `${input.id}-fault`, className: "field-fault", hidden: true });
    const label = made("label", field.label, { htmlFor: input.id });
    input.setAttribute("aria-describedby", `${words.id} ${fault.id}`);
    const list = input.getAttribute("list") && made("datalist", "", { id: input.getAttribute("list") });
    if (list) list.append(...field.suggestions.map((one) => new Option(one, one)));
    out.append(label, input, words, ...(list ? [list] : []), fault);
    Object.assign(field, { control: input, fault, shown: "" });
    fields.set(field.name, field);
    return out;
  }

  /** A row to add a table or a key to a group. */
  function adder(group) {
    const out = made("div", "", { className: "row add-row" }), key = `add-${group.name || "study"}`;
    const pick = made("select", "", { id: key }), name = made("input", "", { size: 18, placeholder: "its name" });
    const value = made("input", "", { size: 14, placeholder: "its value" }), list = made("datalist", "", { id: `${key}-names` });
    const button = made("button", "Add", { type: "button" });
    pick.append(...group.additions.map((one, k) => new Option(one.label, String(k))));
    name.setAttribute("list", list.id);
    name.setAttribute("aria-label", `Name of what is added to ${group.name || "the study"}`);
    value.setAttribute("aria-label", `Value of what is added to ${group.name || "the study"}`);
    const chosen = () => group.additions[Number(pick.value)];
    const drawn = () => {
      const one = chosen();
      name.hidden = !one.named;
      value.hidden = !one.is_key;
      list.replaceChildren(...one.suggestions.map((text) => new Option(text, text)));
      pick.title = one.says;
    };
    pick.addEventListener("change", drawn);
    button.addEventListener("click", () => {
      const one = chosen(), path = one.named ? [...one.path, name.value.trim()] : one.path;
      if (one.named && !name.value.trim()) return name.focus();
      if (one.is_key && !value.value.trim()) return value.focus();
      return change(one.is_key ? { path, value: value.value } : { path, action: "add" }, () => reach(path));
    });
    for (const input of [name, value]) input.addEventListener("keydown", (event) => { if (event.key === "Enter") button.click(); });
    const label = made("label", group.name ? "Add " : "Add to the study ");
    label.append(pick);
    out.append(label, name, value, list, button);
    drawn();
    return out;
  }

  /** Put the caret into the first field of a path. */
  function reach(path) {
    const start = JSON.stringify(path).slice(0, -1);
    const field = [...fields.values()].find((one) => JSON.stringify(one.path).startsWith(start));
    field?.control.focus();
  }

  function block(group) {
    const out = made("fieldset"), head = made("legend", group.name ? title(group) : "Study");
    const first = group.fields.filter((one) => one.first), rest = group.fields.filter((one) => !one.first);
    out.append(head);
    if (group.name) out.append(made("p", group.says, { className: "hint" }));
    out.append(...first.map(row));
    if (rest.length) {
      const more = made("details");
      more.dataset.more = group.name;
      more.append(made("summary", `${rest.length} more key${rest.length > 1 ? "s" : ""}`), ...rest.map(row));
      out.append(more);
    }
    const fault = made("p", "", { className: "field-fault", hidden: true });
    out.append(fault);
    groups.set(group.name, fault);
    if (group.additions.length) out.append(adder(group));
    if (group.there && group.path.length && group.path[0] !== "geometry") {
      const remove = made("button", `Remove ${group.name}`, { type: "button", className: "remove" });
      remove.addEventListener("click", () => change({ path: group.path, action: "remove" }, () => $("form-undo").focus()));
      out.append(remove);
    }
    return out;
  }

  function title(group) {
    const name = group.fields.find((one) => one.label === "name")?.value;
    return name ? `${group.name}: ${name}` : group.name;
  }

  /** Draw the form anew where other fields stand in it; else change what they show. */
  function draw(form) {
    $("form-undo").disabled = !undoable();
    $("form-off").hidden = Boolean(form);
    $("groups").inert = !form;
    if (!form) return;
    const now = JSON.stringify(form, (key, value) => (["value", "first", "line"].includes(key) ? undefined : value));
    const every = form.flatMap((group) => group.fields);
    const values = new Map(every.map((one) => [one.name, one.value ?? ""]));
    lines = new Map(every.map((one) => [one.name, one.line]));
    if (now !== shape) {
      shape = now;
      const open = new Set([...document.querySelectorAll("#groups details[open]")].map((one) => one.dataset.more));
      const focused = document.activeElement?.id, typed = fields.get(focused?.replace(/^field-/, ""));
      const left = typed && typed.control.value !== typed.shown ? typed.control.value : null, top = $("form").scrollTop;
      fields = new Map();
      groups = new Map();
      $("groups").replaceChildren(...form.map(block));
      for (const one of document.querySelectorAll("#groups details")) one.open = open.has(one.dataset.more);
      for (const field of fields.values()) show(field, values.get(field.name));
      const again = focused && document.getElementById(focused);
      if (again && $("groups").contains(again)) {
        again.closest("details")?.setAttribute("open", "");
        again.focus();
        if (left !== null) again.value = left;
      }
      $("form").scrollTop = top;
    } else {
      for (const field of fields.values()) show(field, values.get(field.name) ?? "");
    }
    mark(faults);
  }

  const longest = (names, text) => [...names].filter((name) => name && text.startsWith(name) && !/[\w]/.test(text[name.length] || ""))
    .reduce((best, name) => (name.length > best.length ? name : best), "");

  /** Show each fault at its field, else at its table. */
  function mark(found) {
    faults = found;
    for (const fault of groups.values()) [fault.hidden, fault.textContent] = [true, ""];
    for (const { control: input, fault } of fields.values()) {
      [fault.hidden, fault.textContent] = [true, ""];
      input.removeAttribute("aria-invalid");
    }
    for (const one of found) {
      const text = one.key && !one.text.startsWith(one.key) ? one.key : one.text.replace(/^\[+/, "");
      const field = fields.get(longest(fields.keys(), text)), at = field ? field.fault : groups.get(longest(groups.keys(), text));
      if (!at) continue;
      at.hidden = false;
      at.textContent += `${at.textContent ? "\n" : ""}${one.text}`;
      field?.control.setAttribute("aria-invalid", "true");
      at.closest("details")?.setAttribute("open", "");
    }
  }

  return { draw, mark };
}
