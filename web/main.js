// @ts-check
// The page: one design, drawn and computed while it changes, and the views that show it.

import { Brush } from "./draw/brush.js";
import { Charts } from "./draw/charts.js";
import { byId, debounced, h } from "./draw/dom.js";
import { copied } from "./draw/download.js";
import { Jobs } from "./panels/jobs.js";
import { Population } from "./panels/population.js";
import { RunUp } from "./panels/runup.js";
import { Sensitivity } from "./panels/sensitivity.js";
import { StudyOfAxes } from "./panels/study.js";
import { Sweep } from "./panels/sweep.js";
import { json, patiently, ProblemError } from "./state/api.js";
import { fromFragment, nameOf, same, toFragment } from "./state/design.js";
import { isSolid, learnDimensions, needsSolid } from "./state/dimensions.js";
import { remember, remembered } from "./state/kept.js";
import { fetchMaterials } from "./state/materials.js";
import { number } from "./state/numbers.js";
import { Follower, resultsOf } from "./state/preview.js";
import { fetchQuantities } from "./state/quantities.js";
import { bare, beyondPlane, openapi, usualAt } from "./state/schema.js";
import { Store } from "./state/store.js";
import { kindOf } from "./state/work.js";
import { Compare } from "./views/compare.js";
import { Dial } from "./views/dial.js";
import { exporting } from "./views/export.js";
import { Form } from "./views/form.js";
import { Geometry } from "./views/geometry.js";
import { Headline } from "./views/headline.js";
import { Notice } from "./views/notice.js";
import { setUpPaste } from "./views/paste.js";
import { Paper } from "./views/paper.js";
import { Pattern } from "./views/pattern.js";
import { ProblemBox } from "./views/problem.js";
import { Progress } from "./views/progress.js";
import { Project } from "./views/project.js";
import { setUpKey, setUpLayout, setUpTheme } from "./views/settings.js";
import { Stage } from "./views/stage.js";
import { FIRST_EXAMPLE, setUpFiles, setUpStart } from "./views/start.js";
import { Tabs } from "./views/tabs.js";
import { Tray } from "./views/tray.js";
import { Warnings } from "./views/warnings.js";

/** @import { Cause } from "./state/design.js" */
/** @import { AskedStudy, Curve, Limits, Method, NamedDesign, Open, Pair, PairOutline } from "./state/documents.js" */
/** @import { Problem, Results, Submission } from "./state/documents.js" */
/** @import { How } from "./state/preview.js" */
/** @import { Submitted } from "./state/work.js" */
/** @import { TabPanel } from "./views/tabs.js" */

const METHODS = /** @type {Method[]} */ (["flexible", "decomposition", "projected_decomposition", "load_distribution"]);
/** What is wrong while somebody types is told so many milliseconds after the last key. */
const HALF_TYPED = 500;
/** The address and the store follow a change so much later, in milliseconds. */
const REST = 250;

/** Why nothing is made of a design. */
const NOT_COMPUTED = "This design cannot be computed, so";

class Page {
  #store = new Store();
  /**
   * There is none before the schema has come.
   *
   * @type {Form | null}
   */
  #form = null;
  /**
   * There is none before the schema has come.
   *
   * @type {Paper | null}
   */
  #paper = null;
  /** @type {Record<string, TabPanel & { resume?: (id: string, study: AskedStudy) => unknown }>} */
  #panels = {};
  #isSheet = false;
  /** @type {number | undefined} */
  #looking;
  /** @type {number | undefined} */
  #telling;

  #choice = byId("against", HTMLSelectElement);
  #design = this.#store.design;
  #progress = new Progress();
  #notice = new Notice(byId("notice"), this.#design);
  #problems = new ProblemBox(() => this.#form);
  #warnings = new Warnings(this.#design, () => this.#form);
  #dial = new Dial(byId("dial"), this.#design);
  #brush = new Brush(byId("brush"), (range) => this.#charts.zoom(range));
  #charts = new Charts(byId("charts"), {
    onPosition: (to) => this.#stage.turn(to),
    onRange: (range) => this.#brush.setRange(range),
    onEveryPosition: () => this.#design.set("/face_load", "positions", "mend"),
  });
  #pattern = new Pattern(byId("pattern"), { live: () => this.#current() });
  #headline = new Headline(byId("headline"), (detail) => this.#form?.names.inWords(detail) ?? detail);
  #geometry = new Geometry(byId("geometry"), {
    onPrint: () => void this.#paper?.print(true),
    onReport: () => void this.#paper?.print(false),
    onPicture: (kind) => void this.#paper?.picture(kind),
  });
  #compare = new Compare(byId("compare"), {
    onKept: (index, change) => this.#store.changeKept(index, change),
    onOpen: ({ submission, results, asked }) => this.#open(submission, results, asked),
    onMethods: () => void this.#compareMethods(),
    named: (pointer) => this.#form?.names.named(pointer) ?? pointer,
    usual: (submission, pointer) => (this.#form ? usualAt(this.#form.api, submission, pointer) : undefined),
  });
  #follower = new Follower({
    onResults: (results, submission, how) => this.#onResults(results, submission, how),
    onOutline: (outline, { pair }) => this.#stage.setOutline(outline, pair),
    onProblem: (problem, submission) => this.#onProblem(problem, submission),
    onValid: (submission) => this.#onValid(submission),
    onExpect: (expected) => this.#progress.expect(expected),
    onBusy: (busy) => this.#onBusy(busy),
    onProgress: (job) => this.#progress.follow(job),
  });
  #stage = new Stage(this.#store, {
    live: async () => {
      await this.#follower.settled();
      return this.#store.answer.live;
    },
    current: () => this.#current(),
    onTurn: (position) => this.#charts.setPosition(position),
  });
  #carry = debounced(REST, () => void this.#address());
  #keepState = debounced(REST, () => void remember(this.#store.remembered));

  constructor() {
    this.#design.onChange((by) => this.#onChange(by));
    this.#design.onRest(() => void this.#onRest());
    this.#store.onProject(this.#keepState);
  }

  /** Fetches what the page needs, and shows the design of the address, the one before, or an example. */
  async begin() {
    this.#setUpButtons();
    this.#setUpKeys();
    new Project(this.#store, async ({ name, submission, asked, hidden }) => {
      const results = await resultsOf(asked);
      this.#store.keep({ name, results, submission, asked, teeth: submission.pair.driven.tooth_count, hidden });
    });
    setUpFiles(this.#design);
    setUpPaste(this.#design);
    setUpTheme(() => this.#restyle());
    setUpKey(() => this.#design.submission && this.#follower.follow(this.#design.submission, "open"));
    const tabs = new Tabs({
      panels: () => this.#panels,
      onLay: () => this.#unfold(),
      onQuestion: (question) => this.#ask(question),
    });
    this.tabs = tabs;
    /** @type {<T>(work: () => Promise<T>) => Promise<T>} */
    const fetched = (work) => patiently(work, (problem) => this.#onProblem(problem));
    const [given, before, { items: examples }] = await Promise.all([
      fromFragment(location.hash),
      remembered(),
      fetched(() => json("v1/examples")),
      fetched(fetchQuantities),
      fetched(fetchMaterials),
    ]);
    if (!given) this.#unreadable();
    setUpStart(this.#design, examples, given !== null);
    const first = given ?? (examples.find(({ name }) => name === FIRST_EXAMPLE) ?? examples[0]).submission;
    if (before?.project) this.#store.restore(before.project);
    if (before) this.#design.restore(first, before);
    else this.#design.replace(first, "start");
    const [api, limits] = await fetched(() => Promise.all([openapi(), json("v1/limits")]));
    learnDimensions(beyondPlane(api));
    const form = new Form(byId("form"), api, this.#design, {
      notify: (words) => this.#notice.say(words),
      limits,
      results: () => this.#store.answer.shown?.results,
    });
    this.#form = form;
    this.#paper = new Paper(this.#store, {
      form,
      charts: this.#charts,
      drawing: this.#stage.drawing.element,
      current: async () => {
        const live = await this.#current();
        if (!live) this.#notice.say(`${NOT_COMPUTED} there is no report of it.`, false);
        return live;
      },
    });
    tabs.lay();
    setUpLayout((isSheet) => {
      this.#isSheet = isSheet;
      this.#unfold();
    });
    this.#showProblem();
    this.#panels = this.#panelsOf(form, limits, tabs, this.#paper);
    tabs.refresh();
    addEventListener("hashchange", async () => {
      const other = await fromFragment(location.hash);
      if (!other) return this.#unreadable();
      if (!same(other, this.#design.submission)) this.#design.replace(other, "open");
    });
  }

  /** Opens every section of the form where there is room for them: on a data sheet, and beside a large drawing. */
  #unfold() {
    this.#form?.unfold(this.#isSheet || (this.tabs?.isLarge ?? false));
  }

  /**
   * Shows the numbers and the charts of a question.
   *
   * @param {string} question
   */
  #ask(question) {
    this.#headline.ask(question);
    this.#charts.ask(question);
    const { answers } = this.#charts;
    byId("no-stress").hidden = question !== "strength" || answers || !this.#store.answer.shown;
    // What moves the curves stands with curves alone.
    byId("brush").classList.toggle("idle", !answers);
  }

  /**
   * What was refused before there was a design.
   *
   * @param {Problem} problem
   */
  refuse(problem) {
    this.#onProblem(problem);
  }

  /**
   * @param {Form} form
   * @param {Limits} limits
   * @param {Tabs} tabs
   * @param {Paper} paper
   */
  #panelsOf(form, limits, tabs, paper) {
    const design = this.#design;
    /** @type {Open} */
    const open = (submission, results) => this.#openFilled(submission, results);
    // A study that was asked for before is shown in the panel that asks for such.
    const resume = (/** @type {string} */ id, /** @type {AskedStudy} */ study) => {
      const kind = kindOf(study);
      const name = kind === "search" ? "study" : kind;
      tabs.show(name);
      this.#panels[name].resume?.(id, study);
    };
    new Tray(this.#store, (work) => this.#showWork(work, open, resume));
    const designs = () => this.#store.designs;
    const runUp = new RunUp(byId("run-up"), {
      designs,
      ask: () => form.fields.begin("/dynamics"),
      asked: () => Boolean(design.get("/dynamics")),
      refused: () => {
        const { problem } = this.#store.answer;
        return problem && form.names.inWords(reasonOf(problem));
      },
      focus: () => form.focus("/dynamics/driving_speed_rpm"),
      stage: {
        turn: (by) => this.#stage.turn(this.#store.position + by),
        move: (factorAt) => this.#stage.drawing.setMotion(factorAt),
        rest: () => this.#stage.drawing.setMotion(null),
      },
    });
    return {
      "run-up": runUp,
      sweep: new Sweep(byId("sweep"), design, form),
      study: new StudyOfAxes(byId("study"), design, form, open),
      sensitivity: new Sensitivity(byId("sensitivity"), design, form, () => this.#current()),
      population: new Population(byId("population"), design, form, limits, open),
      jobs: new Jobs(byId("jobs"), design, form, open, resume),
      export: exporting(byId("export"), {
        current: () => this.#current(),
        designs,
        drawing: this.#stage.drawing,
        charts: this.#charts,
        position: () => this.#store.position,
        sheet: (live) => paper.sheet(live),
      }),
    };
  }

  /**
   * Shows a job or a study of the project: its design with its results, or its answer in the panel that asks for such.
   *
   * @param {Submitted} work
   * @param {Open} open
   * @param {(id: string, study: AskedStudy) => void} resume
   */
  async #showWork({ id, kind }, open, resume) {
    if (kind !== "job") return resume(id, await json(`v1/studies/${id}/document`));
    const { submission, status } = await json(`v1/jobs/${id}`);
    return open(submission, status === "successful" ? await json(`v1/jobs/${id}/results`) : null);
  }

  /** @param {Cause} by */
  #onChange(by) {
    const { submission, canUndo, canRedo, changes } = this.#design;
    byId("undo", HTMLButtonElement).disabled = !canUndo;
    byId("redo", HTMLButtonElement).disabled = !canRedo;
    const { shown, problem } = this.#store.answer;
    if (by === "kept") return shown && this.#showDesigns(shown);
    if (by === "confirm") return this.#form?.refresh();
    // For those who test: the address carries this change once its state has the number.
    document.body.dataset.changes = String(changes);
    if (by === "undo" && shown && same(shown.submission, submission) && !problem) this.#showDesigns(shown);
    this.#stage.deformation.off();
    this.#form?.refresh();
    this.#stage.drawing.refreshHoles();
    this.#look();
    this.#follower.follow(submission, by, by === "drag" && shown ? shown.results.pair.period_mesh_periods : null);
    this.#carry();
  }

  /** A hand that lets go of what cannot be made leaves the last design that could. */
  async #onRest() {
    const released = this.#design.submission;
    await this.#follower.settled();
    const { problem, computed } = this.#store.answer;
    if (this.#design.submission !== released || !problem || !computed || same(computed, released)) return;
    const why = reasonOf(problem);
    this.#design.snapBack(computed);
    this.#notice.say(`Back to what can be made. ${why}`, false);
  }

  /**
   * @param {Results} results
   * @param {Submission} submission
   * @param {How} how
   */
  #onResults(results, submission, how) {
    const { since, draft, asked } = how;
    const shown = this.#store.came(results, submission, how);
    document.body.classList.remove("empty");
    this.#stage.draw(submission.pair);
    this.#showDesigns(shown, draft);
    this.#showProblem();
    this.#progress.came(results, how);
    byId("projected").hidden = draft || asked.method === submission.method;
    // A draft has few positions of its own accord.
    this.#warnings.show(results.warnings.filter(({ code }) => !draft || code !== "few_positions"));
    if (!draft) this.#warnings.showCure(results.curves[0]);
    this.#stage.renew();
    this.#look();
    // For those who measure: the curve of a change is on the screen.
    requestAnimationFrame(() => {
      const detail = { submission, draft, milliseconds: performance.now() - since };
      document.dispatchEvent(new CustomEvent("drawn", { detail }));
    });
  }

  /**
   * @param {Problem} found
   * @param {Submission} [submission]
   */
  #onProblem(found, submission) {
    this.#store.refuse(found, submission);
    this.#look();
    // What is half typed is no mistake: it is told once the hand rests, unless something else has come.
    clearTimeout(this.#telling);
    if (this.#design.by !== "form" || this.#problems.isShown) return this.#showProblem();
    this.#telling = setTimeout(() => {
      if (this.#store.answer.problem?.submission === submission) this.#showProblem();
    }, HALF_TYPED);
  }

  /**
   * Nothing is wrong with the design.
   *
   * @param {Submission} submission
   */
  #onValid(submission) {
    if (submission !== this.#design.submission || !this.#store.answer.problem) return;
    this.#store.pardon();
    this.#showProblem();
  }

  /** @param {boolean} busy */
  #onBusy(busy) {
    document.body.classList.toggle("busy", busy);
    if (busy && !this.#store.answer.shown) this.#progress.say("Computing");
  }

  /** The results of the design as it is, when nothing is a draft any more; null where it cannot be computed. */
  async #current() {
    await this.#follower.settled();
    return this.#store.current;
  }

  /**
   * Says of everything on the page whether it is of the design in the form: numbers of another one are gray, and what
   * was wrong with another one is told no more.
   */
  #look() {
    clearTimeout(this.#looking);
    const { shown, live, problem, again } = this.#store.others;
    document.body.classList.toggle("other", shown);
    document.body.classList.toggle("unsettled", live);
    if (problem) {
      this.#store.pardon();
      this.#showProblem();
    }
    if (again !== null) this.#looking = setTimeout(() => this.#look(), again);
  }

  /** The last good curve stays; what is wrong stands above it and at its field. */
  #showProblem() {
    const { problem, computed } = this.#store.answer;
    if (!problem && !this.#problems.isShown) return;
    this.#stage.drawing.refreshHoles((problem?.errors ?? []).map(({ pointer }) => pointer));
    if (this.tabs?.shows("run-up")) this.#panels["run-up"]?.refresh?.();
    if (!problem) return this.#problems.hide();
    const isAnother = computed && !same(computed, this.#design.submission);
    const back = isAnother ? () => this.#design.replace(computed, "open") : null;
    this.#problems.show(problem, { behind: this.#store.answer.shown !== null, back });
    this.#progress.say("");
  }

  /** @param {NamedDesign} shown */
  #showDesigns(shown, moving = false) {
    const designs = this.#store.besideKept(shown);
    const { against } = this.#store;
    const { kept } = this.#design;
    const seen = designs.filter(({ hidden }) => !hidden);
    const named = seen.map((each) => ({ ...each, name: legendOf(each, seen) }));
    this.#charts.show(named, moving);
    const [curve] = shown.results.curves;
    const other = against && {
      name: against.name,
      curve: atTorqueOf(curve, against.results),
      warnings: against.results.warnings,
    };
    this.#headline.show({ curve, warnings: shown.results.warnings, other, draft: moving });
    // Numbers that change with every move cannot be read, and a new table lays the page out.
    if (moving) return;
    this.#brush.show(seen);
    this.#pattern.show(shown);
    this.#compare.show(designs);
    this.#geometry.show(shown);
    this.#dial.show(shown);
    this.#choice.replaceChildren(
      ...kept.map((each, i) => h("option", { value: i, selected: each === against }, nameBeside(curve, each))),
    );
    byId("against-label").hidden = kept.length === 0;
    const { tabs } = this;
    if (!tabs) return;
    this.#ask(tabs.question);
    if (["export", "run-up", "population", "sweep"].some((id) => tabs.shows(id))) tabs.refresh();
  }

  #showAgain() {
    const { shown } = this.#store.answer;
    if (shown) this.#showDesigns(shown);
  }

  #restyle() {
    this.#charts.restyle();
    this.#stage.restyle();
    this.#showAgain();
  }

  /**
   * Takes a design whose results are known, so that they are shown and not computed again.
   *
   * @param {Submission} submission
   * @param {Results | null} results
   */
  #open(submission, results, asked = submission) {
    if (results) this.#follower.know(submission, results, asked);
    this.#design.replace(submission, "open");
  }

  /**
   * Takes the design of a job or a study, where every default is filled in: without them, so that it is compared with
   * others by what somebody has chosen.
   *
   * @param {Submission} submission
   * @param {Results | null} results
   */
  async #openFilled(submission, results) {
    try {
      this.#open(await bare(await openapi(), submission), results);
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      // What is refused is told at its fields.
      this.#open(submission, results);
    }
  }

  /** Keeps the design as each of the methods in the plane computes it. */
  async #compareMethods() {
    const base = await this.#current();
    if (!base) return;
    if (isSolid(base.submission.method) && needsSolid(this.#design)) {
      const why = "Plane methods do not know what this pair has along its axis, so there is nothing to compare.";
      return this.#notice.say(why, false);
    }
    for (const method of METHODS.filter((each) => each !== base.submission.method)) {
      try {
        const asked = { ...base.submission, method };
        const results = await resultsOf(asked);
        this.#store.keep({ name: nameOf(asked), results, submission: asked, asked, teeth: base.teeth });
      } catch (error) {
        if (!(error instanceof ProblemError)) throw error;
        this.#notice.say(error.reason, false);
      }
    }
  }

  /**
   * The address carries the design, and which change of it that is: packing takes a while, and a newer one may be done
   * before.
   */
  async #address() {
    const { changes, submission } = this.#design;
    const fragment = await toFragment(submission);
    if (this.#design.changes === changes) history.replaceState({ changes }, "", fragment);
  }

  /**
   * An address that carries no design, because it is cut or leads to a place of the page, carries the one that is shown
   * from now on.
   */
  #unreadable() {
    if (/^#design/.test(location.hash))
      this.#notice.say("The address carries a design that cannot be read: it may have been cut.", false);
    this.#carry();
  }

  async #share() {
    const button = byId("share");
    await this.#address();
    const done = await copied(location.href);
    button.textContent = done ? "Link copied" : "Copy it from the address bar";
    const rest = () => {
      button.textContent = "Copy link";
    };
    setTimeout(rest, done ? 2000 : 6000);
  }

  async #pin() {
    const live = await this.#current();
    if (live) this.#store.keep(live);
    else this.#notice.say(`${NOT_COMPUTED} it is not kept.`, false);
  }

  #setUpButtons() {
    /** @type {(id: string, work: () => unknown) => void} */
    const press = (id, work) => byId(id).addEventListener("click", () => void work());
    press("pin", () => this.#pin());
    press("share", () => this.#share());
    press("to-study", () => byId("study").scrollIntoView());
    press("ask-stress", () => this.#design.set("/stress", true, "mend"));
    press("whole", () => this.#follower.whole(this.#design.submission));
    press("undo", () => this.#design.undo());
    press("redo", () => this.#design.redo());
    this.#choice.addEventListener("change", () => {
      this.#store.compareWith(Number(this.#choice.value));
      this.#showAgain();
    });
  }

  #setUpKeys() {
    byId("form").addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.#follower.hurry();
    });
    addEventListener("keydown", (event) => {
      const isCommand = (event.ctrlKey || event.metaKey) && !event.altKey;
      if (!isCommand || (event.target instanceof Element && event.target.closest("textarea, dialog"))) return;
      const key = event.key.toLowerCase();
      const work =
        key === "p" && this.#paper && this.#store.answer.live
          ? () => void this.#paper?.print(false)
          : key === "y" || (key === "z" && event.shiftKey)
            ? () => this.#design.redo()
            : key === "z"
              ? () => this.#design.undo()
              : null;
      if (!work) return;
      event.preventDefault();
      work();
    });
  }
}

/**
 * The curve of `results` at the torque of another one; the first where there is none.
 *
 * @type {(curve: Curve, results: Results) => Curve}
 */
const atTorqueOf = ({ output_torque_n_m: torque }, { curves }) =>
  curves.find((each) => each.output_torque_n_m === torque) ?? curves[0];

/**
 * What a kept design is called beside `curve`: with its torque, where that is another one.
 *
 * @type {(curve: Curve, design: NamedDesign) => string}
 */
function nameBeside(curve, { name, results }) {
  const { output_torque_n_m: torque } = atTorqueOf(curve, results);
  return torque === curve.output_torque_n_m ? name : `${name}, at ${number(torque)} N m`;
}

/**
 * What a design is called beside others: by its method too, where they differ in it.
 *
 * @type {(design: NamedDesign, designs: NamedDesign[]) => string}
 */
function legendOf({ name, results }, designs) {
  const differ = designs.some((other) => other.results.method !== results.method);
  return differ ? `${name} ${results.method.replace(/_/g, " ")}` : name;
}

/**
 * What is wrong, in one sentence.
 *
 * @type {(problem: Problem) => string}
 */
const reasonOf = ({ errors, detail, title }) => errors?.[0]?.detail ?? detail ?? title ?? "";

const page = new Page();
page.begin().catch((error) => {
  if (!(error instanceof ProblemError)) throw error;
  page.refuse(error.problem);
});
