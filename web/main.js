// @ts-check
// The page: one design, drawn and computed while it changes, and the views that show it.

import { Brush } from "./draw/brush.js";
import { Charts } from "./draw/charts.js";
import { Deformation } from "./draw/deformed.js";
import { byId, debounced, h, within } from "./draw/dom.js";
import { copied, save } from "./draw/download.js";
import { Drawing, indexAt } from "./draw/drawing.js";
import { fileOf, pictureOf } from "./draw/figure.js";
import { Jobs } from "./panels/jobs.js";
import { Population } from "./panels/population.js";
import { RunUp } from "./panels/runup.js";
import { Sensitivity } from "./panels/sensitivity.js";
import { StudyOfAxes } from "./panels/study.js";
import { Sweep } from "./panels/sweep.js";
import { json, patiently, ProblemError } from "./state/api.js";
import { Design, fromFragment, nameOf, same, toFragment } from "./state/design.js";
import { isSolid, learnDimensions, needsSolid } from "./state/dimensions.js";
import { remember, remembered } from "./state/kept.js";
import { fetchMaterials } from "./state/materials.js";
import { fixed, number } from "./state/numbers.js";
import { alike, Follower, resultsOf } from "./state/preview.js";
import { fetchQuantities } from "./state/quantities.js";
import { bare, beyondPlane, openapi, usualAt } from "./state/schema.js";
import { wordsAt } from "./state/series.js";
import { fileOfDesign } from "./state/tables.js";
import { kindOf } from "./state/work.js";
import { Compare } from "./views/compare.js";
import { Dial } from "./views/dial.js";
import { exporting } from "./views/export.js";
import { Form } from "./views/form.js";
import { Geometry } from "./views/geometry.js";
import { Headline } from "./views/headline.js";
import { Notice } from "./views/notice.js";
import { setUpPaste } from "./views/paste.js";
import { Pattern } from "./views/pattern.js";
import { ProblemBox } from "./views/problem.js";
import { Progress } from "./views/progress.js";
import { Project } from "./views/project.js";
import { nameFoot, reportOf } from "./views/report.js";
import { setUpKey, setUpLayout, setUpTheme } from "./views/settings.js";
import { sheetOf } from "./views/sheet.js";
import { FIRST_EXAMPLE, setUpFiles, setUpStart } from "./views/start.js";
import { Tabs } from "./views/tabs.js";
import { Tray } from "./views/tray.js";
import { Warnings } from "./views/warnings.js";

/** @import { Space } from "./draw/space.js" */
/** @import { Cause } from "./state/design.js" */
/** @import { AskedStudy, Curve, Limits, Method, NamedDesign, Open, Pair, PairOutline } from "./state/documents.js" */
/** @import { Problem, Results, Submission } from "./state/documents.js" */
/** @import { How } from "./state/preview.js" */
/** @import { Submitted } from "./state/work.js" */
/** @import { TabPanel } from "./views/tabs.js" */

const METHODS = /** @type {Method[]} */ (["flexible", "decomposition", "projected_decomposition", "load_distribution"]);
/** What is wrong while somebody types is told so many milliseconds after the last key. */
const HALF_TYPED = 500;
/**
 * Numbers of another design than the one in the form are gray after so many milliseconds, and what was wrong with
 * another one is told no more.
 */
const OTHER = 300;
/** A mesh period takes so long when the gears turn by themselves, in milliseconds. */
const PERIOD = 2000;
/** The address and the store follow a change so much later, in milliseconds. */
const REST = 250;

/** Why nothing is made of a design. */
const NOT_COMPUTED = "This design cannot be computed, so";

class Page {
  /**
   * What is shown: the results of the design as it is, or those that the hand has passed through.
   *
   * @type {NamedDesign | null}
   */
  #shown = null;
  /**
   * The last results that are no draft.
   *
   * @type {NamedDesign | null}
   */
  #live = null;
  /**
   * What is wrong with the design as it stands.
   *
   * @type {(Problem & { submission?: Submission }) | null}
   */
  #problem = null;
  /**
   * The last design that could be computed.
   *
   * @type {Submission | null}
   */
  #computed = null;
  #position = 0;
  /**
   * The kept design that the answers are compared with.
   *
   * @type {NamedDesign | null}
   */
  #against = null;
  /**
   * When each design that was worked on was left for another one.
   *
   * @type {WeakMap<Submission, number>}
   */
  #left = new WeakMap();
  /** @type {Submission | null} */
  #worked = null;
  /**
   * There is none before the schema has come.
   *
   * @type {Form | null}
   */
  #form = null;
  /** @type {Record<string, TabPanel & { resume?: (id: string, study: AskedStudy) => unknown }>} */
  #panels = {};
  /**
   * The pair in space, once it has been asked for: its modules are fetched then.
   *
   * @type {Space | null}
   */
  #space = null;
  /** @type {PairOutline | null} */
  #outline = null;
  /**
   * The pair that is drawn.
   *
   * @type {Pair | null}
   */
  #drawn = null;
  #isSheet = false;
  /** True while the one page of the design is printed in place of the report of the project. */
  #printsOnePage = false;
  /** @type {number | undefined} */
  #looking;
  /** @type {number | undefined} */
  #telling;

  #slider = byId("position", HTMLInputElement);
  #choice = byId("against", HTMLSelectElement);
  #design = new Design();
  #progress = new Progress();
  #notice = new Notice(byId("notice"), this.#design);
  #problems = new ProblemBox(() => this.#form);
  #warnings = new Warnings(this.#design, () => this.#form);
  #drawing = new Drawing(byId("drawing"), this.#design, { onTurn: (to) => this.#turn(to) });
  #dial = new Dial(byId("dial"), this.#design);
  #brush = new Brush(byId("brush"), (range) => this.#charts.zoom(range));
  #charts = new Charts(byId("charts"), {
    onPosition: (to) => this.#turn(to),
    onRange: (range) => this.#brush.setRange(range),
    onEveryPosition: () => this.#design.set("/face_load", "positions", "mend"),
  });
  #pattern = new Pattern(byId("pattern"), { live: () => this.#current() });
  #headline = new Headline(byId("headline"), (detail) => this.#form?.inWords(detail) ?? detail);
  #geometry = new Geometry(byId("geometry"), {
    onPrint: () => void this.#print(true),
    onReport: () => void this.#print(false),
    onPicture: (kind) => void this.#picture(kind),
  });
  #compare = new Compare(byId("compare"), {
    onKept: (index, change) => this.#changeKept(index, change),
    onOpen: ({ submission, results, asked }) => this.#open(submission, results, asked),
    onMethods: () => void this.#compareMethods(),
    named: (pointer) => this.#form?.named(pointer) ?? pointer,
    usual: (submission, pointer) => (this.#form ? usualAt(this.#form.api, submission, pointer) : undefined),
  });
  #project = new Project(this.#design, {
    onChange: () => this.#keepState(),
    onWork: () => this.#tray?.renew(),
    compute: async ({ name, submission, asked, hidden }) => {
      const results = await resultsOf(asked);
      this.#keep({ name, results, submission, asked, teeth: submission.pair.driven.tooth_count, hidden });
    },
  });
  /**
   * There is none before the page has begun.
   *
   * @type {Tray | null}
   */
  #tray = null;
  #follower = new Follower({
    onResults: (results, submission, how) => this.#onResults(results, submission, how),
    onOutline: (outline, submission) => this.#onOutline(outline, submission),
    onProblem: (problem, submission) => this.#onProblem(problem, submission),
    onValid: (submission) => this.#onValid(submission),
    onExpect: (expected) => this.#progress.expect(expected),
    onBusy: (busy) => this.#onBusy(busy),
    onProgress: (job) => this.#progress.follow(job),
  });
  #deformation = new Deformation({
    drawing: this.#drawing,
    button: byId("deformed"),
    note: byId("deformed-note"),
    position: () => this.#position,
    live: async () => {
      await this.#follower.settled();
      return this.#live;
    },
  });
  #carry = debounced(REST, () => void this.#address());
  #keepState = debounced(REST, () => void remember({ ...this.#design.state, project: this.#project.state }));

  constructor() {
    this.#design.onChange((by) => this.#onChange(by));
    this.#design.onRest(() => void this.#onRest());
  }

  /** Fetches what the page needs, and shows the design of the address, the one before, or an example. */
  async begin() {
    this.#setUpButtons();
    this.#setUpKeys();
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
    if (before?.project) this.#project.restore(before.project);
    if (before) this.#design.restore(first, before);
    else this.#design.replace(first, "start");
    const [api, limits] = await fetched(() => Promise.all([openapi(), json("v1/limits")]));
    learnDimensions(beyondPlane(api));
    const form = new Form(byId("form"), api, this.#design, {
      notify: (words) => this.#notice.say(words),
      limits,
      results: () => this.#shown?.results,
    });
    this.#form = form;
    tabs.lay();
    setUpLayout((isSheet) => {
      this.#isSheet = isSheet;
      this.#unfold();
    });
    this.#showProblem();
    this.#panels = this.#panelsOf(form, limits, tabs);
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
    byId("no-stress").hidden = question !== "strength" || answers || !this.#shown;
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
   */
  #panelsOf(form, limits, tabs) {
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
    this.#tray = new Tray({
      kept: () => this.#project.work,
      onShow: (work) => this.#showWork(work, open, resume),
      onForget: (id) => this.#project.forget(id),
    });
    const designs = () => (this.#live ? this.#besideKept(this.#live) : []);
    const runUp = new RunUp(byId("run-up"), {
      designs,
      ask: () => form.begin("/dynamics"),
      asked: () => Boolean(design.get("/dynamics")),
      refused: () => this.#problem && form.inWords(reasonOf(this.#problem)),
      focus: () => form.focus("/dynamics/driving_speed_rpm"),
      stage: {
        turn: (by) => this.#turn(this.#position + by),
        move: (factorAt) => this.#drawing.setMotion(factorAt),
        rest: () => this.#drawing.setMotion(null),
      },
    });
    return {
      "run-up": runUp,
      sweep: new Sweep(byId("sweep"), design),
      study: new StudyOfAxes(byId("study"), design, form, open),
      sensitivity: new Sensitivity(byId("sensitivity"), design, form, () => this.#current()),
      population: new Population(byId("population"), design, form, limits, open),
      jobs: new Jobs(byId("jobs"), design, form, open, resume),
      export: exporting(byId("export"), {
        current: () => this.#current(),
        designs,
        drawing: this.#drawing,
        charts: this.#charts,
        position: () => this.#position,
        sheet: (live) => this.#sheet(live, form),
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
    this.#project.changed();
    if (by === "kept") return this.#shown && this.#showDesigns(this.#shown);
    if (by === "confirm") return this.#form?.refresh();
    // For those who test: the address carries this change once its state has the number.
    document.body.dataset.changes = String(changes);
    const shown = this.#shown;
    if (by === "undo" && shown && same(shown.submission, submission) && !this.#problem) this.#showDesigns(shown);
    this.#deformation.off();
    this.#form?.refresh();
    this.#drawing.refreshHoles();
    if (this.#worked && this.#worked !== submission) this.#left.set(this.#worked, performance.now());
    this.#worked = submission;
    this.#left.delete(submission);
    this.#look();
    this.#follower.follow(submission, by, by === "drag" && shown ? shown.results.pair.period_mesh_periods : null);
    this.#carry();
  }

  /** A hand that lets go of what cannot be made leaves the last design that could. */
  async #onRest() {
    const released = this.#design.submission;
    await this.#follower.settled();
    const [problem, computed] = [this.#problem, this.#computed];
    if (this.#design.submission !== released || !problem || !computed || same(computed, released)) return;
    const why = reasonOf(problem);
    this.#design.snapBack(computed);
    this.#notice.say(`Back to what can be made. ${why}`, false);
  }

  /**
   * @param {PairOutline} outline
   * @param {Submission} submission
   */
  #onOutline(outline, { pair }) {
    this.#outline = outline;
    this.#drawing.setOutline(outline);
    this.#draw(pair);
  }

  /**
   * @param {Results} results
   * @param {Submission} submission
   * @param {How} how
   */
  #onResults(results, submission, how) {
    const { since, draft, asked } = how;
    const { tooth_count: teeth } = submission.pair.driven;
    const shown = { name: nameOf(submission), results, submission, asked, teeth, look: 0 };
    this.#problem = null;
    this.#computed = submission;
    this.#shown = shown;
    if (!draft) this.#live = shown;
    document.body.classList.remove("empty");
    this.#slider.max = String(results.pair.period_mesh_periods);
    this.#draw(submission.pair);
    this.#showDesigns(shown, draft);
    this.#showProblem();
    this.#progress.came(results, how);
    byId("projected").hidden = draft || asked.method === submission.method;
    // A draft has few positions of its own accord.
    this.#warnings.show(results.warnings.filter(({ code }) => !draft || code !== "few_positions"));
    if (!draft) this.#warnings.showCure(results.curves[0]);
    this.#turn(this.#position);
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
    this.#problem = { ...found, submission };
    this.#look();
    // What is half typed is no mistake: it is told once the hand rests, unless something else has come.
    clearTimeout(this.#telling);
    if (this.#design.by !== "form" || this.#problems.isShown) return this.#showProblem();
    this.#telling = setTimeout(() => {
      if (this.#problem?.submission === submission) this.#showProblem();
    }, HALF_TYPED);
  }

  /**
   * Nothing is wrong with the design.
   *
   * @param {Submission} submission
   */
  #onValid(submission) {
    if (submission !== this.#design.submission || !this.#problem) return;
    this.#problem = null;
    this.#showProblem();
  }

  /** @param {boolean} busy */
  #onBusy(busy) {
    document.body.classList.toggle("busy", busy);
    if (busy && !this.#shown) this.#progress.say("Computing");
  }

  /** The results of the design as it is, when nothing is a draft any more; null where it cannot be computed. */
  async #current() {
    await this.#follower.settled();
    const live = this.#live;
    return live && !this.#problem && same(live.submission, this.#design.submission) ? live : null;
  }

  /**
   * Says of everything on the page whether it is of the design in the form: numbers of another one are gray, and what
   * was wrong with another one is told no more.
   */
  #look() {
    clearTimeout(this.#looking);
    const { submission: now } = this.#design;
    /** @type {(of: Submission | undefined, isIts: (submission: Submission) => boolean) => number | null} */
    const waits = (of, isIts) => {
      if (!of || isIts(of)) return null;
      return Math.max(0, OTHER - (performance.now() - (this.#left.get(of) ?? performance.now())));
    };
    const isLike = (/** @type {Submission} */ submission) => alike(submission, now);
    const all = [
      waits(this.#shown?.submission, isLike),
      waits(this.#live?.submission, isLike),
      waits(this.#problem?.submission, (submission) => submission === now),
    ];
    const [other, unsettled, wrong] = all;
    document.body.classList.toggle("other", other === 0);
    document.body.classList.toggle("unsettled", unsettled === 0);
    if (wrong === 0) {
      this.#problem = null;
      this.#showProblem();
    }
    const next = all.flatMap((wait) => (wait ? [wait] : []));
    if (next.length) this.#looking = setTimeout(() => this.#look(), Math.min(...next));
  }

  /** The last good curve stays; what is wrong stands above it and at its field. */
  #showProblem() {
    const [problem, computed] = [this.#problem, this.#computed];
    if (!problem && !this.#problems.isShown) return;
    this.#drawing.refreshHoles((problem?.errors ?? []).map(({ pointer }) => pointer));
    if (this.tabs?.shows("run-up")) this.#panels["run-up"]?.refresh?.();
    if (!problem) return this.#problems.hide();
    const isAnother = computed && !same(computed, this.#design.submission);
    const back = isAnother ? () => this.#design.replace(computed, "open") : null;
    this.#problems.show(problem, { behind: this.#shown !== null, back });
    this.#progress.say("");
  }

  /**
   * Draws a pair with the loads that are shown, if they are its own, or if a hand moves it and the next ones come at
   * once.
   *
   * @param {Pair} pair
   */
  #draw(pair) {
    this.#drawn = pair;
    const shown = this.#shown;
    const isIts = shown && (this.#design.by === "drag" || same(shown.submission.pair, pair));
    const curve = isIts ? shown.results.curves[0] : null;
    this.#drawing.setCurve(curve);
    if (this.#outline) this.#space?.setPair(this.#outline, pair);
    this.#space?.setCurve(curve);
  }

  /**
   * Shows the pair in space in place of its drawing, or takes it away.
   *
   * @param {boolean} on
   */
  async #showSpace(on) {
    this.#drawing.element.toggleAttribute("hidden", on);
    if (!on) return this.#space?.hide();
    const { Space } = await import("./draw/space.js");
    if (!this.#space) {
      this.#space = new Space(byId("drawing"), { live: () => this.#current() });
      if (this.#drawn) this.#draw(this.#drawn);
      this.#space.setPosition(this.#position);
    }
    const button = within(document, '[data-view="space"]', HTMLElement);
    if (button.getAttribute("aria-pressed") === "true") this.#space.show();
  }

  /**
   * Where the curves and the gears stand.
   *
   * @param {number} to
   */
  #turn(to) {
    const period = this.#shown?.results.pair.period_mesh_periods ?? 1;
    const before = this.#position;
    this.#position = ((to % period) + period) % period;
    if (this.#position !== before) this.#deformation.moved();
    this.#drawing.setPosition(this.#position);
    this.#space?.setPosition(this.#position);
    this.#charts.setPosition(this.#position);
    this.#slider.value = String(this.#position);
    byId("position-value").textContent = `${fixed(this.#position, 3)} periods`;
    const curve = this.#shown?.results.curves[0];
    if (!curve) return;
    const i = indexAt(curve, this.#position);
    byId("readout").textContent = wordsAt(curve, i);
    const error = `transmission error ${fixed(curve.transmission_error_um[i], 2)} micrometers`;
    this.#slider.setAttribute("aria-valuetext", `${fixed(this.#position, 2)} mesh periods, ${error}`);
  }

  /** @param {NamedDesign} shown */
  #showDesigns(shown, moving = false) {
    const designs = this.#besideKept(shown);
    const { kept } = this.#design;
    if (!this.#against || !kept.includes(this.#against)) this.#against = kept[0] ?? null;
    const against = this.#against;
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
    if (["export", "run-up", "population"].some((id) => tabs.shows(id))) tabs.refresh();
  }

  #restyle() {
    this.#charts.restyle();
    this.#space?.restyle();
    if (this.#shown) this.#showDesigns(this.#shown);
  }

  /**
   * `one` and the kept designs; it is told from one that is called the same.
   *
   * @param {NamedDesign} one
   */
  #besideKept(one) {
    const { kept } = this.#design;
    const name = kept.some((each) => each.name === one.name) ? `${one.name} (now)` : one.name;
    return [{ ...one, name }, ...kept];
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

  /**
   * Keeps a design, under a name and with a look that no other has.
   *
   * @param {Omit<NamedDesign, "look">} entry
   */
  #keep(entry) {
    const { kept } = this.#design;
    const looks = Array.from({ length: kept.length + 1 }, (_, i) => i + 1);
    const look = looks.find((each) => kept.every((other) => other.look !== each)) ?? 1;
    const names = [entry.name, ...Array.from({ length: 99 }, (_, i) => `${entry.name} (${i + 2})`)];
    const name = names.find((each) => kept.every((other) => other.name !== each)) ?? entry.name;
    this.#design.keep([...kept, { ...entry, name, look }]);
  }

  /**
   * Changes a kept design, or takes it away.
   *
   * @param {number} index
   * @param {Partial<NamedDesign> | null} change
   */
  #changeKept(index, change) {
    const { kept } = this.#design;
    const before = kept[index];
    const next = change && { ...before, ...change };
    if (before === this.#against) this.#against = next;
    this.#design.keep(kept.flatMap((each, i) => (i !== index ? [each] : next ? [next] : [])));
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
        this.#keep({ name: nameOf(asked), results, submission: asked, asked, teeth: base.teeth });
      } catch (error) {
        if (!(error instanceof ProblemError)) throw error;
        this.#notice.say(error.reason, false);
      }
    }
  }

  /**
   * The report of a design.
   *
   * @param {NamedDesign} live
   * @param {Form} form
   */
  #sheet(live, form) {
    return sheetOf({ live, drawing: this.#drawing.element, charts: this.#charts, form });
  }

  /** The report of the design as it is, and what it is called; null where it cannot be computed. */
  async #report() {
    const base = await this.#current();
    if (!base) this.#notice.say(`${NOT_COMPUTED} there is no report of it.`, false);
    return base && this.#form && { name: base.name, page: this.#sheet(base, this.#form) };
  }

  /**
   * Prints the one page of the design, or the report of the project.
   *
   * @param {boolean} isOnePage
   */
  async #print(isOnePage) {
    if (!(await this.#report())) return;
    this.#printsOnePage = isOnePage;
    this.#paper();
    window.print();
  }

  /** Puts onto paper what is printed, of the design that was computed last. */
  #paper() {
    const [live, form] = [this.#live, this.#form];
    if (!live || !form) return;
    const sheet = byId("sheet");
    sheet.classList.toggle("one", this.#printsOnePage);
    const { title } = this.#project;
    if (this.#printsOnePage) return sheet.replaceChildren(this.#sheet(live, form));
    nameFoot({ ...title, name: title.name || live.name });
    /** @type {(title: string, id: string) => import("./views/report.js").Answer} */
    const answer = (words, id) => {
      const place = within(byId(id), ".out", HTMLElement);
      return { title: words, place, isOutdated: !within(byId(id), ".outdated", HTMLElement).hidden };
    };
    return sheet.replaceChildren(
      ...reportOf({
        title,
        live,
        designs: this.#besideKept(live),
        drawing: this.#drawing.element,
        charts: this.#charts,
        form,
        usual: (submission, pointer) => usualAt(form.api, submission, pointer),
        contact: byId("pattern"),
        answers: [answer("Sensitivity", "sensitivity"), answer("As made", "population")],
      }),
    );
  }

  /** @param {"svg" | "png"} kind */
  async #picture(kind) {
    const report = await this.#report();
    if (!report) return;
    const { name, page } = report;
    if (kind === "svg") save(fileOfDesign(name, "report.svg"), "image/svg+xml", fileOf(page));
    else save(fileOfDesign(name, "report.png"), "image/png", await pictureOf(page));
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
    if (live) this.#keep(live);
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
    press("play", () => this.#play(byId("play")));
    this.#slider.addEventListener("input", () => this.#turn(Number(this.#slider.value)));
    this.#choice.addEventListener("change", () => {
      this.#against = this.#design.kept[Number(this.#choice.value)];
      if (this.#shown) this.#showDesigns(this.#shown);
    });
    const views = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("button[data-view]")]);
    for (const button of views) {
      button.addEventListener("click", () => {
        for (const other of views) other.setAttribute("aria-pressed", String(other === button));
        const { view = "pair" } = button.dataset;
        // What lies inside is drawn in the plane alone.
        if (view === "space") this.#deformation.off();
        else this.#drawing.setView(view);
        void this.#showSpace(view === "space");
      });
    }
    press("deformed", () => this.#space?.isShown && views[0].click());
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
        key === "p" && this.#live && this.#form
          ? () => void this.#print(false)
          : key === "y" || (key === "z" && event.shiftKey)
            ? () => this.#design.redo()
            : key === "z"
              ? () => this.#design.undo()
              : null;
      if (!work) return;
      event.preventDefault();
      work();
    });
    // However somebody prints, a report comes of it: of the design, or where that is not computed yet of the one
    // before, under its name.
    addEventListener("beforeprint", () => this.#paper());
    addEventListener("afterprint", () => {
      this.#printsOnePage = false;
    });
  }

  /**
   * Turns the gears until it is told to stop; by steps where motion is unwanted.
   *
   * @param {HTMLElement} button
   */
  #play(button) {
    const isOn = () => button.getAttribute("aria-pressed") === "true";
    button.setAttribute("aria-pressed", String(!isOn()));
    const steps = matchMedia("(prefers-reduced-motion: reduce)").matches;
    let last = performance.now();
    /** @type {FrameRequestCallback} */
    const step = (now) => {
      if (!isOn()) return;
      if (!steps || now - last >= PERIOD / 4) {
        this.#turn(this.#position + (steps ? 0.1 : (now - last) / PERIOD));
        last = now;
      }
      requestAnimationFrame(step);
    };
    if (isOn()) requestAnimationFrame(step);
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
