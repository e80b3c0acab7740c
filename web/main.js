// The page: one design, drawn and computed while it changes.

import { hasKey, json, onKeyNeeded, ProblemError, setKey } from "./api.js";
import { byId, debounced, fixed, h } from "./dom.js";
import { Charts, looks, stresses } from "./charts.js";
import { Design, fromFragment, nameOf, toFragment } from "./design.js";
import { Deformation } from "./deformed.js";
import { chartsPicture, csv, drawingFile, save } from "./download.js";
import { Drawing, indexAt } from "./drawing.js";
import { Form } from "./form.js";
import { jobs } from "./jobs.js";
import { Follower, preview } from "./preview.js";
import { openapi } from "./schema.js";
import { study } from "./study.js";
import { sweep } from "./sweep.js";
import { table } from "./table.js";

const FIRST_EXAMPLE = "test-case-2";
const METHODS = ["flexible", "decomposition", "projected_decomposition", "load_distribution"];
const THEME = "meshwright-theme";

const design = new Design();
const kept = [];
let live = null;
let position = 0;
let form = null;
let problem = null;

const drawing = new Drawing(byId("drawing"), design, { onTurn: (to) => turn(to) });
const charts = new Charts(byId("charts"), { onPosition: (to) => turn(to) });
const follower = new Follower({ onResults, onOutline: (outline) => drawing.setOutline(outline), onProblem, onBusy });

const deformation = new Deformation({
  drawing, button: byId("deformed"), note: byId("deformed-note"), position: () => position,
  live: async () => {
    await follower.settled();
    return live;
  },
});

/** Where the curves and the gears stand. */
function turn(to) {
  const period = live?.results.pair.period_mesh_periods ?? 1;
  const before = position;
  position = ((to % period) + period) % period;
  if (position !== before) deformation.moved();
  drawing.setPosition(position);
  charts.setPosition(position);
  byId("position").value = position;
  showReadout();
}

function showReadout() {
  byId("position-value").textContent = `${fixed(position, 3)} periods`;
  if (!live) return;
  const curve = live.results.curves[0];
  const i = indexAt(curve, position);
  const pressure = curve.peak_contact_pressure_mpa[i];
  const pairs = curve.pairs_in_contact[i];
  byId("position").setAttribute("aria-valuetext", `${fixed(position, 2)} mesh periods, transmission error ${fixed(curve.transmission_error_um[i], 2)} micrometers`);
  byId("readout").textContent = `Transmission error ${fixed(curve.transmission_error_um[i], 3)} µm, stiffness ${fixed(curve.mesh_stiffness_tangent_n_per_m[i] * 1e-6, 1)} N/µm, ${pairs} ${pairs === 1 ? "pair" : "pairs"} in contact, ${pressure === null ? "a tip corner carries" : `${fixed(pressure, 0)} MPa`}.${stresses(curve).map(({ name, values }, j) => `${j ? "," : " Stress in MPa:"} ${fixed(values[i], 1)} at a ${name.replace(",", " of the")}`).join("")}${curve.stress ? "." : ""}`;
}

function onResults(results, submission, { took, since, draft }) {
  problem = null;
  const name = nameOf(submission);
  live = { name, results, submission, teeth: submission.pair.driven.tooth_count, color: looks().series[0] };
  byId("position").max = results.pair.period_mesh_periods;
  drawing.setCurve(results.curves[0]);
  showDesigns(draft);
  showProblem();
  byId("state").textContent = `${results.curves[0].mesh_position.length} positions in ${fixed(took, 0)} ms${draft ? ", under the hand" : ""}`;
  byId("warnings").replaceChildren(...results.warnings.map(({ detail }) => h("li", {}, detail)));
  turn(position);
  // For those who measure: the curve of a change is on the screen.
  requestAnimationFrame(() => document.dispatchEvent(new CustomEvent("drawn", { detail: { submission, draft, milliseconds: performance.now() - since } })));
}

function onProblem(found) {
  problem = found;
  showProblem();
}

function onBusy(busy) {
  document.body.classList.toggle("busy", busy);
  if (busy && !live) byId("state").textContent = "Computing";
}

/** The last good curve stays; what is wrong stands above it and at its field. */
function showProblem() {
  const errors = problem?.errors ?? [];
  const place = byId("problem");
  if (!problem && place.hidden) return;
  form?.showErrors(errors);
  drawing.refreshHoles(errors.map(({ pointer }) => pointer));
  place.hidden = !problem;
  byId("charts").classList.toggle("stale", Boolean(problem) && Boolean(live));
  if (!problem) return place.replaceChildren();
  const entries = errors.slice(0, 4).map((error) => h("li", {}, error.detail, " ", h("button", { type: "button", className: "mend", on: { click: () => form?.focus(error.pointer) } }, "Show the field")));
  place.replaceChildren(h("p", {}, h("strong", {}, problem.title), live ? ". The curves are those of the last design that could be computed." : ""), entries.length ? h("ul", {}, ...entries) : h("p", {}, problem.detail));
  byId("state").textContent = "";
}

function showDesigns(moving = false) {
  const colors = looks().series;
  live.color = colors[0];
  kept.forEach((each, i) => { each.color = colors[(i % 6) + 1]; });
  const designs = [live, ...kept];
  charts.show(designs.map((each) => ({ ...each, name: legendOf(each, designs) })), moving);
  // Numbers that change with every move cannot be read, and a new table lays the page out.
  if (moving) return;
  byId("table").replaceChildren(table(designs, {
    onRemove: (gone) => { kept.splice(kept.indexOf(gone), 1); showDesigns(); },
    onOpen: ({ submission }) => design.replace(submission, "open"),
  }));
}

/** What a design is called beside others: by its method too, where they differ in it. */
function legendOf({ name, results }, designs) {
  const differ = designs.some((other) => other.results.method !== results.method);
  return differ ? `${name} ${results.method.replace(/_/g, " ")}` : name;
}

const carry = debounced(250, async () => {
  history.replaceState(null, "", await toFragment(design.submission));
});

design.onChange((by) => {
  design.by = by;
  deformation.off();
  form?.refresh();
  drawing.refreshHoles();
  follower.follow(design.submission, by === "drag" && live ? live.results.pair.period_mesh_periods : null);
  carry();
});

function keep(entry) {
  kept.push(entry);
  showDesigns();
}

async function compareMethods() {
  if (!live) return;
  const { submission } = live;
  for (const method of METHODS.filter((each) => each !== submission.method)) {
    try {
      const asked = { ...submission, method };
      keep({ name: nameOf(asked), results: await preview(asked), submission: asked, teeth: live.teeth });
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      onProblem(error.problem);
    }
  }
}

async function download(kind) {
  await follower.settled();
  if (!live) return;
  if (kind === "json") save("meshwright.json", "application/json", JSON.stringify({ submission: live.submission, results: live.results }, null, 1));
  if (kind === "csv") save("meshwright.csv", "text/csv", csv(live.results));
  if (kind === "svg") save("meshwright-pair.svg", "image/svg+xml", drawingFile(drawing.element));
  if (kind === "png") {
    const canvases = ["ste", "stiffness", "share", "pressure", "spectrum"].map((id) => charts.canvasOf(id));
    save("meshwright-curves.png", "image/png", await chartsPicture(canvases, getComputedStyle(document.body).backgroundColor));
  }
}

function setUpButtons() {
  byId("position").addEventListener("input", (event) => turn(Number(event.target.value)));
  byId("pin").addEventListener("click", async () => {
    await follower.settled();
    if (live) keep({ ...live });
  });
  byId("methods").addEventListener("click", compareMethods);
  byId("share").addEventListener("click", async () => {
    history.replaceState(null, "", await toFragment(design.submission));
    await navigator.clipboard?.writeText(location.href).catch(() => {});
    byId("share").textContent = "Link copied";
    setTimeout(() => { byId("share").textContent = "Copy link"; }, 2000);
  });
  for (const button of document.querySelectorAll("[data-download]")) button.addEventListener("click", () => download(button.dataset.download));
  for (const button of document.querySelectorAll("[data-view]")) {
    button.addEventListener("click", () => {
      for (const other of document.querySelectorAll("[data-view]")) other.setAttribute("aria-pressed", String(other === button));
      drawing.setView(button.dataset.view);
    });
  }
  byId("play").addEventListener("click", (event) => play(event.currentTarget));
}

/** Turns the gears until it is told to stop: a mesh period in two seconds. */
function play(button) {
  const on = button.getAttribute("aria-pressed") !== "true";
  button.setAttribute("aria-pressed", String(on));
  let last = performance.now();
  const step = (now) => {
    if (button.getAttribute("aria-pressed") !== "true") return;
    turn(position + (now - last) / 2000);
    last = now;
    requestAnimationFrame(step);
  };
  if (on) requestAnimationFrame(step);
}

function setUpTheme() {
  const apply = (theme) => {
    if (theme) document.documentElement.dataset.theme = theme;
    charts.restyle();
    if (live) showDesigns();
  };
  apply(localStorage.getItem(THEME));
  byId("theme-button").addEventListener("click", () => {
    const dark = getComputedStyle(document.documentElement).colorScheme === "dark";
    localStorage.setItem(THEME, dark ? "light" : "dark");
    apply(dark ? "light" : "dark");
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => apply(null));
}

function setUpKey() {
  const dialog = byId("key-dialog");
  const ask = (words = "") => {
    byId("key-error").textContent = words;
    if (!dialog.open) dialog.showModal();
  };
  byId("key-button").addEventListener("click", () => ask());
  onKeyNeeded(({ detail }) => ask(hasKey() ? detail : ""));
  byId("key-form").addEventListener("submit", (event) => {
    if (event.submitter?.value !== "use") return;
    setKey(byId("key").value);
    byId("key").value = "";
    if (design.submission) follower.follow(design.submission);
  });
}

function setUpTabs(shown) {
  const tabs = [...document.querySelectorAll("[role=tab]")];
  const choose = (tab) => {
    for (const other of tabs) {
      other.setAttribute("aria-selected", String(other === tab));
      other.tabIndex = other === tab ? 0 : -1;
      byId(other.getAttribute("aria-controls")).hidden = other !== tab;
    }
    shown(tab.getAttribute("aria-controls"));
  };
  for (const tab of tabs) {
    tab.addEventListener("click", () => choose(tab));
    tab.addEventListener("keydown", (event) => {
      const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!by) return;
      const next = tabs[(tabs.indexOf(tab) + by + tabs.length) % tabs.length];
      next.focus();
      choose(next);
    });
  }
}

async function setUpStart(examples, given) {
  const select = byId("start");
  const own = h("option", { value: "" }, "Your own");
  const buildable = examples.filter(({ valid }) => valid);
  select.replaceChildren(...buildable.map(({ name }) => h("option", { value: name }, name.replace(/-/g, " "))), own);
  const note = () => { byId("start-note").textContent = buildable.find(({ name }) => name === select.value)?.description ?? ""; };
  select.addEventListener("change", () => {
    const example = buildable.find(({ name }) => name === select.value);
    note();
    if (example) design.replace(example.submission, "start");
  });
  design.onChange((by) => {
    if (by === "start") return;
    select.value = "";
    note();
  });
  select.value = given ? "" : FIRST_EXAMPLE;
  note();
}

async function begin() {
  setUpButtons();
  setUpTheme();
  setUpKey();
  const [given, { items: examples }] = await Promise.all([fromFragment(location.hash), json("v1/examples")]);
  setUpStart(examples, given);
  design.replace(given ?? examples.find(({ name }) => name === FIRST_EXAMPLE).submission, "start");
  const [api, limits] = await Promise.all([openapi(), json("v1/limits")]);
  form = new Form(byId("form"), api, design);
  showProblem();
  const positions = () => live?.results.curves[0].mesh_position.length ?? 200;
  const panels = { sweep: sweep(byId("sweep"), design, limits, positions), study: study(byId("study"), design), jobs: jobs(byId("jobs"), design) };
  setUpTabs((name) => panels[name]?.refresh?.());
  addEventListener("hashchange", async () => {
    const other = await fromFragment(location.hash);
    if (other && JSON.stringify(other) !== JSON.stringify(design.submission)) design.replace(other, "open");
  });
}

begin().catch((error) => {
  if (!(error instanceof ProblemError)) throw error;
  onProblem(error.problem);
});
