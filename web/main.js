// @ts-check
// The page: one design, drawn and computed while it changes, and the views that show it.

import { Brush } from "./draw/brush.js";
import { Charts } from "./draw/charts.js";
import { Deformation } from "./draw/deformed.js";
import { byId, debounced, h } from "./draw/dom.js";
import { copied, save } from "./draw/download.js";
import { Drawing, indexAt } from "./draw/drawing.js";
import { cured, wordsOfCure } from "./draw/face.js";
import { fileOf, pictureOf } from "./draw/figure.js";
import { jobs } from "./panels/jobs.js";
import { population } from "./panels/population.js";
import { study } from "./panels/study.js";
import { isSweep, sweep } from "./panels/sweep.js";
import { hasKey, json, onKeyNeeded, patiently, post, ProblemError, setKey } from "./state/api.js";
import { Design, fromFragment, nameOf, same, toFragment } from "./state/design.js";
import { isSolid, needsSolid } from "./state/dimensions.js";
import { remember, remembered } from "./state/kept.js";
import { fixed, number, remaining, timeOf } from "./state/numbers.js";
import { alike, Follower, resultsOf } from "./state/preview.js";
import { fetchQuantities } from "./state/quantities.js";
import { bare, openapi, usualAt } from "./state/schema.js";
import { stresses } from "./state/series.js";
import { fileOfDesign } from "./state/tables.js";
import { Compare } from "./views/compare.js";
import { exporting } from "./views/export.js";
import { Form } from "./views/form.js";
import { Geometry } from "./views/geometry.js";
import { Headline } from "./views/headline.js";
import { Pattern } from "./views/pattern.js";
import { RunUp } from "./views/runup.js";
import { sheetOf } from "./views/sheet.js";

const FIRST_EXAMPLE = "test-case-2";
const NEW_PAIR = "new pair";
const METHODS = ["flexible", "decomposition", "projected_decomposition", "load_distribution"];
const THEME = "meshwright-theme";
/** What is wrong while somebody types is told so many milliseconds after the last key. */
const HALF_TYPED = 500;
/**
 * Numbers of another design than the one in the form are gray after so many milliseconds, and what was wrong with
 * another one is told no more.
 */
const OTHER = 300;
/** So long a notice is shown, in milliseconds, once it offers no way back. */
const NOTICE = 12_000;
/** A mesh period takes so long when the gears turn by themselves, in milliseconds. */
const PERIOD = 2000;

/** What no drawing leaves out, and nothing else. */
function newPair() {
  const gear = (tooth_count, bore_radius_mm) => ({
    tooth_count,
    module_mm: 2,
    face_width_mm: 20,
    blank: { bore_radius_mm },
  });
  return {
    method: "flexible",
    pair: { center_distance_mm: 75.2, driving: gear(25, 10), driven: gear(50, 16) },
    output_torques_n_m: [100],
  };
}

const design = new Design();
/**
 * What is shown: the results of the design as it is, or those that the hand has passed through. `live` are never a
 * draft.
 */
let shown = null;
let live = null;
/** What is wrong with the design as it stands, and the last one that could be computed. */
let problem = null;
let computed = null;
let position = 0;
let against = null;
/** When each design that was worked on was left for another one. */
const left = new WeakMap();
let worked = null;
let form = null;
let panels = {};
let tab = "curves";

const drawing = new Drawing(byId("drawing"), design, { onTurn: (to) => turn(to) });
const brush = new Brush(byId("brush"), (range) => charts.zoom(range));
const charts = new Charts(byId("charts"), {
  onPosition: (to) => turn(to),
  onRange: (range) => brush.setRange(range),
  onEveryPosition: () => design.set("/face_load", "positions", "mend"),
});
const pattern = new Pattern(byId("pattern"), { live: current });
const headline = new Headline(byId("headline"));
const geometry = new Geometry(byId("geometry"), { onPrint: print, onPicture: picture });
const compare = new Compare(byId("compare"), {
  onKept: changeKept,
  onOpen: ({ submission, results, asked }) => open(submission, results, asked),
  onMethods: compareMethods,
  named: (pointer) => form?.named(pointer) ?? pointer,
  usual: (submission, pointer) => (form ? usualAt(form.api, submission, pointer) : undefined),
});
const follower = new Follower({ onResults, onOutline, onProblem, onValid, onExpect, onBusy, onProgress });

const deformation = new Deformation({
  drawing,
  button: byId("deformed"),
  note: byId("deformed-note"),
  position: () => position,
  live: async () => {
    await follower.settled();
    return live;
  },
});

/** The pair in space, once it has been asked for: its modules are fetched then. */
let space = null;
let outline = null;
/** The pair that is drawn. */
let drawn = null;

function onOutline(made, { pair }) {
  outline = made;
  drawing.setOutline(made);
  draw(pair);
}

/**
 * Draws a pair with the loads that are shown, if they are its own, or if a hand moves it and the next ones come at
 * once.
 */
function draw(pair) {
  drawn = pair;
  const curve = shown && (design.by === "drag" || same(shown.submission.pair, pair)) ? shown.results.curves[0] : null;
  drawing.setCurve(curve);
  if (outline) space?.setPair(outline, pair);
  space?.setCurve(curve);
}

/** Shows the pair in space in place of its drawing, or takes it away. */
async function showSpace(on) {
  drawing.element.toggleAttribute("hidden", on);
  if (!on) return space?.hide();
  const { Space } = await import("./draw/space.js");
  if (!space) {
    space = new Space(byId("drawing"), { live: current });
    if (drawn) draw(drawn);
    space.setPosition(position);
  }
  if (document.querySelector('[data-view="space"]').getAttribute("aria-pressed") === "true") space.show();
}

/** The results of the design as it is, when nothing is a draft any more; null where it cannot be computed. */
async function current() {
  await follower.settled();
  return live && !problem && same(live.submission, design.submission) ? live : null;
}

/**
 * Says of everything on the page whether it is of the design in the form: numbers of another one are gray, and what was
 * wrong with another one is told no more.
 */
function look() {
  clearTimeout(look.timer);
  const waits = (one, isIts) =>
    one && !isIts(one.submission)
      ? Math.max(0, OTHER - (performance.now() - (left.get(one.submission) ?? performance.now())))
      : null;
  const isLike = (submission) => alike(submission, design.submission);
  const [other, unsettled, wrong] = [
    waits(shown, isLike),
    waits(live, isLike),
    waits(problem, (submission) => submission === design.submission),
  ];
  document.body.classList.toggle("other", other === 0);
  document.body.classList.toggle("unsettled", unsettled === 0);
  if (wrong === 0) {
    problem = null;
    showProblem();
  }
  const next = [other, unsettled, wrong].filter((wait) => wait > 0);
  if (next.length) look.timer = setTimeout(look, Math.min(...next));
}

/** Nothing is wrong with the design. */
function onValid(submission) {
  if (submission !== design.submission || !problem) return;
  problem = null;
  showProblem();
}

/**
 * How long the design takes that is computed now, `{ seconds, since, rests }`, told as a clock where it is more than a
 * moment.
 */
function onExpect(expected) {
  clearTimeout(onExpect.timer);
  if (!expected || expected.seconds < (2 * OTHER) / 1000) return;
  const whole = timeOf(1000 * expected.seconds);
  const tick = () => {
    if (!byId("progress").hidden) return;
    const over = 1000 * expected.seconds - (performance.now() - expected.since);
    byId("state").textContent = expected.rests
      ? `It takes about ${whole}: computed when you rest, or at once with Enter.`
      : over > 0
        ? `Computing, about ${timeOf(over)} more`
        : `Computing, longer than the ${whole} that were expected`;
    onExpect.timer = setTimeout(tick, 1000);
  };
  onExpect.timer = setTimeout(tick, expected.rests ? 0 : Math.max(0, OTHER - (performance.now() - expected.since)));
}

/** Where the curves and the gears stand. */
function turn(to) {
  const period = shown?.results.pair.period_mesh_periods ?? 1;
  const before = position;
  position = ((to % period) + period) % period;
  if (position !== before) deformation.moved();
  drawing.setPosition(position);
  space?.setPosition(position);
  charts.setPosition(position);
  byId("position").value = position;
  showReadout();
}

function showReadout() {
  byId("position-value").textContent = `${fixed(position, 3)} periods`;
  if (!shown) return;
  const curve = shown.results.curves[0];
  const i = indexAt(curve, position);
  const pressure = curve.peak_contact_pressure_mpa[i];
  const pairs = curve.pairs_in_contact[i];
  byId("position").setAttribute(
    "aria-valuetext",
    `${fixed(position, 2)} mesh periods, transmission error ${fixed(curve.transmission_error_um[i], 2)} micrometers`,
  );
  byId("readout").textContent =
    `Transmission error ${fixed(curve.transmission_error_um[i], 3)} µm, stiffness ${fixed(curve.mesh_stiffness_tangent_n_per_m[i] * 1e-6, 1)} N/µm, ${pairs} ${pairs === 1 ? "pair" : "pairs"} in contact, ${pressure === null ? "a tip corner carries" : `${fixed(pressure, 0)} MPa`}.${stresses(
      curve,
    )
      .map(
        ({ name, values }, j) =>
          `${j ? "," : " Stress in MPa:"} ${fixed(values[i], 1)} at a ${name.replace(",", " of the")}`,
      )
      .join("")}${curve.stress ? "." : ""}`;
}

function onResults(results, submission, { took, since, draft, asked }) {
  problem = null;
  computed = submission;
  shown = { name: nameOf(submission), results, submission, asked, teeth: submission.pair.driven.tooth_count, look: 0 };
  if (!draft) live = shown;
  document.body.classList.remove("empty");
  byId("position").max = results.pair.period_mesh_periods;
  draw(submission.pair);
  showDesigns(draft);
  showProblem();
  clearTimeout(onExpect.timer);
  byId("state").textContent =
    `${results.curves[0].mesh_position.length} positions ${took === null ? "as computed before" : took < 2000 ? `in ${fixed(took, 0)} ms` : `in ${fixed(took / 1000, 1)} s`}${results.curves.length > 1 ? `; answers at ${number(results.curves[0].output_torque_n_m)} N m` : ""}${draft ? ", a draft under the hand" : ""}`;
  byId("projected").hidden = draft || asked.method === submission.method;
  // A draft has few positions of its own accord.
  showWarnings(draft ? results.warnings.filter(({ code }) => code !== "few_positions") : results.warnings);
  if (!draft) showCure(results.curves[0]);
  turn(position);
  look();
  // For those who measure: the curve of a change is on the screen.
  requestAnimationFrame(() =>
    document.dispatchEvent(
      new CustomEvent("drawn", { detail: { submission, draft, milliseconds: performance.now() - since } }),
    ),
  );
}

/** Which lead would even the load along the face, and the button that gives it to the design. */
function showCure({ face }) {
  const place = byId("cure");
  const words = face && wordsOfCure(face);
  place.hidden = !words;
  if (!words) return place.replaceChildren();
  const leads = "/pair/driving/lead_modifications";
  place.replaceChildren(
    words,
    " ",
    h(
      "button",
      { type: "button", on: { click: () => design.set(leads, cured(design.get(leads), face.cure), "mend") } },
      "Apply",
    ),
  );
}

function showWarnings(warnings) {
  const button = byId("warned");
  button.hidden = warnings.length === 0;
  button.textContent = `${warnings.length} ${warnings.length === 1 ? "warning" : "warnings"}`;
  const guide = (path) => (path ? [" ", h("a", { href: path.replace(/^\//, "") }, "The guide says why")] : []);
  const solid = (code) =>
    code === "web_outside_plane_model"
      ? [
          " ",
          h("button", { type: "button", on: { click: () => form?.compute(true) } }, "Compute it in three dimensions"),
        ]
      : [];
  // What would mend it, by the pointers of the fields.
  const change = (changes = {}) =>
    Object.keys(changes).length
      ? [
          " ",
          h(
            "button",
            { type: "button", on: { click: () => form?.take(changes) } },
            `Use ${Object.entries(changes)
              .map(([pointer, value]) => `${form?.named(pointer) ?? pointer} ${number(value, 7)}`)
              .join(", ")}`,
          ),
        ]
      : [];
  byId("warnings").replaceChildren(
    ...warnings.map(({ code, detail, guide: path, changes }) =>
      h("li", {}, form?.inWords(detail) ?? detail, ...guide(path), ...solid(code), ...change(changes)),
    ),
  );
  if (!warnings.length) showWarned(false);
}

function showWarned(open) {
  byId("warned").setAttribute("aria-expanded", String(open));
  byId("warnings").hidden = !open;
}

function onProblem(found, submission) {
  problem = { ...found, submission };
  look();
  // What is half typed is no mistake: it is told once the hand rests, unless something else has come.
  clearTimeout(onProblem.timer);
  if (design.by !== "form" || !byId("problem").hidden) return showProblem();
  onProblem.timer = setTimeout(() => {
    if (problem?.submission === submission) showProblem();
  }, HALF_TYPED);
}

function onBusy(busy) {
  document.body.classList.toggle("busy", busy);
  if (busy && !shown) byId("state").textContent = "Computing";
}

/** How far the job is that computes a design too large for a preview. */
function onProgress(job) {
  clearInterval(onProgress.timer);
  byId("progress").hidden = !job;
  byId("stop").hidden = !job;
  if (!job) return;
  byId("progress").value = job.progress_percent ?? 0;
  byId("stop").onclick = job.cancel;
  const { id, progress_percent: done = 0, begun, expected, status, away } = job;
  if (onProgress.id !== id) onProgress.left = remaining(expected, () => performance.now() - begun);
  onProgress.id = id;
  // Between two events time goes on.
  const tick = () => {
    byId("state").textContent = away
      ? "The service does not answer; a job goes on."
      : status === "accepted"
        ? "A job waits for its turn."
        : done < 100
          ? `A job: ${done} %${onProgress.left(done, 100)}.`
          : "A job: every position is solved, and the results are put together.";
  };
  tick();
  onProgress.timer = setInterval(tick, 1000);
}

/** The last good curve stays; what is wrong stands above it and at its field. */
function showProblem() {
  const errors = problem?.errors ?? [];
  const place = byId("problem");
  if (!problem && place.hidden) return;
  form?.showErrors(errors);
  drawing.refreshHoles(errors.map(({ pointer }) => pointer));
  place.hidden = !problem;
  if (!problem) return place.replaceChildren();
  const entries = errors
    .slice(0, 4)
    .map((error) =>
      h(
        "li",
        {},
        form?.inWords(error.detail) ?? error.detail,
        " ",
        h(
          "button",
          { type: "button", className: "mend", on: { click: () => form?.focus(error.pointer) } },
          "Show the field",
        ),
      ),
    );
  const codes = new Set(errors.map(({ code }) => code));
  const turn = (inSolid, words) => h("button", { type: "button", on: { click: () => form?.compute(inSolid) } }, words);
  const dimensions = codes.has("needs_three_dimensions")
    ? [
        h(
          "p",
          {},
          turn(true, "Compute it in three dimensions"),
          " ",
          turn(false, "Leave out what has an extent along the axis"),
        ),
      ]
    : codes.has("not_in_three_dimensions")
      ? [
          h(
            "p",
            {},
            turn(true, "Leave out what three dimensions do not know"),
            " ",
            turn(false, "Compute it in the plane"),
          ),
        ]
      : [];
  const back =
    computed && !same(computed, design.submission)
      ? h("button", { type: "button", on: { click: () => design.replace(computed, "open") } }, "Go back to it")
      : null;
  place.replaceChildren(
    h(
      "p",
      {},
      h("strong", {}, problem.title),
      ...(shown
        ? [". Curves and numbers are those of the last design that could be computed; nothing is exported. ", back]
        : []),
    ),
    entries.length ? h("ul", {}, ...entries) : h("p", {}, problem.detail),
    ...dimensions,
  );
  byId("state").textContent = "";
}

function showDesigns(moving = false) {
  const designs = besideKept(shown);
  if (!design.kept.includes(against)) against = design.kept[0] ?? null;
  const seen = designs.filter(({ hidden }) => !hidden);
  charts.show(
    seen.map((each) => ({ ...each, name: legendOf(each, seen) })),
    moving,
  );
  const [curve] = shown.results.curves;
  headline.show(curve, against && { name: against.name, curve: atTorqueOf(curve, against.results) }, moving);
  // Numbers that change with every move cannot be read, and a new table lays the page out.
  if (moving) return;
  brush.show(seen);
  pattern.show(shown);
  compare.show(designs);
  geometry.show(shown);
  const choice = byId("against");
  choice.replaceChildren(
    ...design.kept.map((each, i) => h("option", { value: i, selected: each === against }, nameBeside(curve, each))),
  );
  byId("against-label").hidden = design.kept.length === 0;
  if (["export", "run-up", "population"].includes(tab)) panels[tab]?.refresh();
}

/** `one` and the kept designs; it is told from one that is called the same. */
function besideKept(one) {
  const name = design.kept.some((each) => each.name === one.name) ? `${one.name} (now)` : one.name;
  return [{ ...one, name }, ...design.kept];
}

/** The curve of `results` at the torque of another one; the first where there is none. */
const atTorqueOf = ({ output_torque_n_m: torque }, { curves }) =>
  curves.find((each) => each.output_torque_n_m === torque) ?? curves[0];

/** What a kept design is called beside `curve`: with its torque, where that is another one. */
function nameBeside(curve, { name, results }) {
  const { output_torque_n_m: torque } = atTorqueOf(curve, results);
  return torque === curve.output_torque_n_m ? name : `${name}, at ${number(torque)} N m`;
}

/** What a design is called beside others: by its method too, where they differ in it. */
function legendOf({ name, results }, designs) {
  const differ = designs.some((other) => other.results.method !== results.method);
  return differ ? `${name} ${results.method.replace(/_/g, " ")}` : name;
}

/**
 * The address carries the design, and which change of it that is: packing takes a while, and a newer one may be done
 * before.
 */
async function address() {
  const { changes, submission } = design;
  const fragment = await toFragment(submission);
  if (design.changes === changes) history.replaceState({ changes }, "", fragment);
}

const carry = debounced(250, address);
const keepState = debounced(250, () => remember(design.state));

design.onChange((by) => {
  // The way back that a notice offers is from the change that it tells of.
  if (byId("notice").querySelector(".undo")) fade();
  byId("notice").querySelector(".undo")?.remove();
  byId("undo").disabled = !design.canUndo;
  byId("redo").disabled = !design.canRedo;
  keepState();
  if (by === "kept") return shown && showDesigns();
  if (by === "confirm") return form?.refresh();
  // For those who test: the address carries this change once its state has the number.
  document.body.dataset.changes = design.changes;
  if (by === "undo" && shown && same(shown.submission, design.submission) && !problem) showDesigns();
  deformation.off();
  form?.refresh();
  drawing.refreshHoles();
  if (worked !== design.submission) left.set(worked ?? {}, performance.now());
  left.delete((worked = design.submission));
  look();
  follower.follow(design.submission, by, by === "drag" && shown ? shown.results.pair.period_mesh_periods : null);
  carry();
});

// A hand that lets go of what cannot be made leaves the last design that could.
design.onRest(async () => {
  const released = design.submission;
  await follower.settled();
  if (design.submission !== released || !problem || !computed || same(computed, released)) return;
  const why = problem.errors?.[0]?.detail ?? problem.detail;
  design.snapBack(computed);
  notify(`Back to what can be made. ${why}`, false);
});

/** Says what else has happened, with a way back. */
function notify(text, undoable = true) {
  const place = byId("notice");
  place.replaceChildren(
    text,
    " ",
    ...(undoable
      ? [
          h(
            "button",
            {
              type: "button",
              className: "undo",
              on: {
                click: () => {
                  design.undo();
                  place.hidden = true;
                },
              },
            },
            "Undo",
          ),
        ]
      : []),
    h(
      "button",
      {
        type: "button",
        ariaLabel: "Close the notice",
        on: {
          click: () => {
            place.hidden = true;
          },
        },
      },
      "×",
    ),
  );
  place.hidden = false;
  if (undoable) clearTimeout(fade.timer);
  else fade();
}

/** What a notice tells of stays until something else has been changed, and a while longer. */
function fade() {
  clearTimeout(fade.timer);
  fade.timer = setTimeout(() => {
    byId("notice").hidden = true;
  }, NOTICE);
}

/** Takes a design whose results are known, so that they are shown and not computed again. */
function open(submission, results, asked = submission) {
  if (results) follower.know(submission, results, asked);
  design.replace(submission, "open");
}

/** Goes to the panel of a study that was asked for before. */
function resume(id, study) {
  const name = study.population ? "population" : isSweep(study) ? "sweep" : "study";
  byId(`tab-${name}`).click();
  panels[name].resume(id, study);
}

/**
 * Takes the design of a job or a study, where every default is filled in: without them, so that it is compared with
 * others by what somebody has chosen.
 */
async function openFilled(submission, results) {
  try {
    open(await bare(await openapi(), submission), results);
  } catch (error) {
    if (!(error instanceof ProblemError)) throw error;
    // What is refused is told at its fields.
    open(submission, results);
  }
}

function keep(entry) {
  const taken = design.kept.map(({ look }) => look);
  const look = Array.from({ length: taken.length + 1 }, (_, i) => i + 1).find((each) => !taken.includes(each));
  const names = design.kept.map(({ name }) => name);
  const name = [entry.name, ...Array.from({ length: 99 }, (_, i) => `${entry.name} (${i + 2})`)].find(
    (each) => !names.includes(each),
  );
  design.keep([...design.kept, { ...entry, name, look }]);
}

/** Changes a kept design, or takes it away. */
function changeKept(index, change) {
  const before = design.kept[index];
  const next = change && { ...before, ...change };
  if (before === against) against = next;
  design.keep(design.kept.flatMap((each, i) => (i !== index ? [each] : next ? [next] : [])));
}

async function compareMethods() {
  const base = await current();
  if (!base) return;
  for (const method of METHODS.filter((each) => each !== base.submission.method)) {
    if (isSolid(base.submission.method) && needsSolid(design))
      return notify(
        "Plane methods do not know what this pair has along its axis, so there is nothing to compare.",
        false,
      );
    try {
      const asked = { ...base.submission, method };
      keep({ name: nameOf(asked), results: await resultsOf(asked), submission: asked, asked, teeth: base.teeth });
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      notify(error.reason, false);
    }
  }
}

const sheet = (one) => sheetOf({ live: one, drawing: drawing.element, charts, form });

async function report() {
  const base = await current();
  if (!base) notify("This design cannot be computed, so there is no report of it.", false);
  return base && sheet(base);
}

async function print() {
  const page = await report();
  if (!page) return;
  byId("sheet").replaceChildren(page);
  window.print();
}

// However somebody prints, a report comes of it: of the design, or where that is not computed yet of the one before,
// under its name.
addEventListener("beforeprint", () => {
  if (live && form) byId("sheet").replaceChildren(sheet(live));
});

async function picture(kind) {
  const page = await report();
  if (!page) return;
  if (kind === "svg") save(fileOfDesign(live.name, "report.svg"), "image/svg+xml", fileOf(page));
  else save(fileOfDesign(live.name, "report.png"), "image/png", await pictureOf(page));
}

async function share() {
  const button = byId("share");
  await address();
  const done = await copied(location.href);
  button.textContent = done ? "Link copied" : "Copy it from the address bar";
  setTimeout(
    () => {
      button.textContent = "Copy link";
    },
    done ? 2000 : 6000,
  );
}

function setUpButtons() {
  byId("position").addEventListener("input", (event) => turn(Number(event.target.value)));
  byId("pin").addEventListener("click", async () => {
    const kept = await current();
    if (kept) keep({ ...kept });
    else notify("This design cannot be computed, so it is not kept.", false);
  });
  byId("share").addEventListener("click", share);
  byId("whole").addEventListener("click", () => follower.whole(design.submission));
  byId("form").addEventListener("keydown", (event) => {
    if (event.key === "Enter") follower.hurry();
  });
  byId("undo").addEventListener("click", () => design.undo());
  byId("redo").addEventListener("click", () => design.redo());
  byId("open-file").addEventListener("change", async (event) => {
    const [file] = event.target.files;
    if (file) await openFile(file);
    // The same file may be opened again.
    event.target.value = "";
  });
  byId("warned").addEventListener("click", () => showWarned(byId("warnings").hidden));
  byId("against").addEventListener("change", (event) => {
    against = design.kept[Number(event.target.value)];
    showDesigns();
  });
  for (const button of document.querySelectorAll("button[data-view]")) {
    button.addEventListener("click", () => {
      for (const other of document.querySelectorAll("button[data-view]"))
        other.setAttribute("aria-pressed", String(other === button));
      const inSpace = button.dataset.view === "space";
      // What lies inside is drawn in the plane alone.
      if (inSpace) deformation.off();
      else drawing.setView(button.dataset.view);
      showSpace(inSpace);
    });
  }
  byId("deformed").addEventListener("click", () => {
    if (space?.isShown) document.querySelector('button[data-view="pair"]').click();
  });
  byId("play").addEventListener("click", (event) => play(event.currentTarget));
  addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.target.closest("textarea, dialog")) return;
    const key = event.key.toLowerCase();
    if (key === "p" && live && form) {
      event.preventDefault();
      return void print();
    }
    const work = key === "z" ? (event.shiftKey ? "redo" : "undo") : key === "y" ? "redo" : null;
    if (!work) return;
    event.preventDefault();
    design[work]();
  });
}

/** Turns the gears until it is told to stop; by steps where motion is unwanted. */
function play(button) {
  const on = button.getAttribute("aria-pressed") !== "true";
  button.setAttribute("aria-pressed", String(on));
  const steps = matchMedia("(prefers-reduced-motion: reduce)").matches;
  let last = performance.now();
  const step = (now) => {
    if (button.getAttribute("aria-pressed") !== "true") return;
    if (!steps || now - last >= PERIOD / 4) {
      turn(position + (steps ? 0.1 : (now - last) / PERIOD));
      last = now;
    }
    requestAnimationFrame(step);
  };
  if (on) requestAnimationFrame(step);
}

function setUpTheme() {
  const apply = (theme) => {
    if (theme) document.documentElement.dataset.theme = theme;
    charts.restyle();
    space?.restyle();
    if (shown) showDesigns();
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
    if (design.submission) follower.follow(design.submission, "open");
  });
}

function setUpTabs() {
  const tabs = [...document.querySelectorAll("[role=tab]")];
  // Where there is room for it the geometry stands under the drawing, and every section of the design is open.
  const large = matchMedia("(min-width: 150rem) and (min-height: 60rem)");
  const lay = () => {
    const [sheet, own] = [byId("geometry"), byId("tab-geometry")];
    own.hidden = large.matches;
    if (large.matches) {
      if (tab === "geometry") choose(tabs[0]);
      document.querySelector(".drawing-panel").append(sheet);
      sheet.setAttribute("role", "region");
      sheet.hidden = false;
    } else {
      byId("curves").after(sheet);
      sheet.setAttribute("role", "tabpanel");
      sheet.hidden = tab !== "geometry";
    }
    form?.unfold(large.matches);
  };
  large.addEventListener("change", lay);
  const choose = (chosen) => {
    for (const other of tabs) {
      other.setAttribute("aria-selected", String(other === chosen));
      other.tabIndex = other === chosen ? 0 : -1;
      if (!other.hidden) byId(other.getAttribute("aria-controls")).hidden = other !== chosen;
    }
    panels[tab]?.leave?.();
    tab = chosen.getAttribute("aria-controls");
    // Tables want the room that curves leave to the drawing.
    document.body.classList.toggle("tabled", !["curves", "run-up"].includes(tab));
    panels[tab]?.refresh?.();
  };
  for (const each of tabs) {
    each.addEventListener("click", () => choose(each));
    each.addEventListener("keydown", (event) => {
      const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!by) return;
      const seen = tabs.filter(({ hidden }) => !hidden);
      const next = seen[(seen.indexOf(each) + by + seen.length) % seen.length];
      next.focus();
      choose(next);
    });
  }
  lay();
  return lay;
}

function setUpStart(examples, given) {
  const select = byId("start");
  const buildable = examples.filter(({ valid }) => valid);
  select.replaceChildren(
    h("option", { value: NEW_PAIR }, "a new pair, all by default"),
    ...buildable.map(({ name }) => h("option", { value: name }, name.replace(/-/g, " "))),
    h("option", { value: "" }, "Your own"),
  );
  const note = () => {
    byId("start-note").textContent =
      select.value === NEW_PAIR
        ? "Only what no drawing leaves out is given; everything else has its default."
        : (buildable.find(({ name }) => name === select.value)?.description ?? "");
  };
  select.addEventListener("change", () => {
    const example =
      select.value === NEW_PAIR ? { submission: newPair() } : buildable.find(({ name }) => name === select.value);
    note();
    if (example) design.replace(example.submission, "start");
  });
  design.onChange((by) => {
    if (by === "start" || by === "kept") return;
    select.value = "";
    note();
  });
  select.value = given ? "" : FIRST_EXAMPLE;
  note();
}

/** Takes the pair of a file: a model of a gearbox, a submission, or what the page itself has saved. */
async function openFile(file) {
  const note = byId("start-note");
  try {
    const text = await file.text();
    // What is a model, and of which kind, the service sees by its content.
    const document = text.trimStart().startsWith("{") ? JSON.parse(text) : null;
    if (document && !document.model) {
      design.replace(document.submission ?? document, "open");
      return;
    }
    const {
      submissions,
      not_read: left,
      assumed,
      refused,
    } = await post("v1/rexs", file, { headers: { "content-type": "application/octet-stream" } });
    const [submission] = submissions;
    if (!submission)
      throw new ProblemError({
        detail:
          refused.map(({ place, detail }) => `${place}: ${detail}`).join(" ") ||
          "The model has no pair of external gears.",
      });
    design.replace(submission, "open");
    const more = submissions.length > 1 ? [`The first of ${submissions.length} pairs.`] : [];
    note.replaceChildren(
      [
        ...more,
        ...assumed,
        ...(left.length
          ? [
              `Not read: ${left.map(({ component, attribute }) => [component, attribute].filter(Boolean).join(" ")).join(", ")}.`,
            ]
          : []),
      ].join(" "),
    );
  } catch (error) {
    if (!(error instanceof ProblemError || error instanceof SyntaxError)) throw error;
    const why =
      error instanceof SyntaxError
        ? `${file.name} is neither a model of a gearbox nor a submission: ${error.message}`
        : (error.reason);
    note.replaceChildren(h("span", { className: "field-error" }, why));
  }
}

/**
 * An address that carries no design, because it is cut or leads to a place of the page, carries the one that is shown
 * from now on.
 */
function unreadable() {
  if (/^#design/.test(location.hash))
    notify("The address carries a design that cannot be read: it may have been cut.", false);
  carry();
}

async function begin() {
  setUpButtons();
  setUpTheme();
  setUpKey();
  const lay = setUpTabs();
  const fetched = (work) => patiently(work, onProblem);
  const [given, before, { items: examples }] = await Promise.all([
    fromFragment(location.hash),
    remembered(),
    fetched(() => json("v1/examples")),
    fetched(fetchQuantities),
  ]);
  if (!given) unreadable();
  setUpStart(examples, given);
  const first = given ?? examples.find(({ name }) => name === FIRST_EXAMPLE).submission;
  if (before) design.restore(first, before);
  else design.replace(first, "start");
  const [api, limits] = await fetched(() => Promise.all([openapi(), json("v1/limits")]));
  form = new Form(byId("form"), api, design, { notify, limits, results: () => shown?.results });
  lay();
  showProblem();
  const runUp = new RunUp(byId("run-up"), {
    designs: () => (live ? besideKept(live) : []),
    ask: () => form.begin("/dynamics"),
    asked: () => Boolean(design.get("/dynamics")) && !problem,
    focus: () => form.focus("/dynamics/driving_speed_rpm"),
    stage: {
      turn: (by) => turn(position + by),
      move: (factorAt) => drawing.setMotion(factorAt),
      rest: () => drawing.setMotion(null),
    },
  });
  panels = {
    "run-up": runUp,
    sweep: sweep(byId("sweep"), design),
    study: study(byId("study"), design, form, openFilled),
    population: population(byId("population"), design, form, limits, openFilled),
    jobs: jobs(byId("jobs"), design, form, openFilled, resume),
    export: exporting(byId("export"), {
      current,
      designs: () => besideKept(live),
      drawing,
      charts,
      position: () => position,
      sheet,
    }),
  };
  addEventListener("hashchange", async () => {
    const other = await fromFragment(location.hash);
    if (!other) return unreadable();
    if (!same(other, design.submission)) design.replace(other, "open");
  });
}

begin().catch((error) => {
  if (!(error instanceof ProblemError)) throw error;
  onProblem(error.problem);
});
