// @ts-check
// The jobs of this client: submitted, followed by their events, cancelled, opened, run again.

import { button, debounced, h, inLine, labelled, note, region, table } from "../draw/dom.js";
import { filesOf, saveFile } from "../draw/files.js";
import { read } from "../draw/inputs.js";
import { Panel } from "./panel.js";
import { checked, follow, hasEnded, isAborted, json, post, ProblemError, request } from "../state/api.js";
import { differences, nameOf, told } from "../state/design.js";
import { number } from "../state/numbers.js";
import { fileOfDesign } from "../state/tables.js";
import { submitted } from "../state/work.js";

/** @import { Design } from "../state/design.js" */
/** @import { AskedStudy, Job, Open, StudyState, Submission } from "../state/documents.js" */
/** @import { Form } from "../views/form.js" */

const SHOWN = 20;
/** So many are followed at a time; a client may have few streams. */
const FOLLOWED = 3;

/** The files that a row offers at once. */
const IN_ROW = [
  ["JSON", "results.json"],
  ["CSV", "ste.csv"],
  ["SVG", "ste.svg"],
  ["VTU", "fields.vtu"],
];

/** The documents of so many jobs are kept: what was asked never changes. */
const DOCUMENTS = 200;
/** So many fields of a job are named in which it differs. */
const FIELDS = 4;
const REST = 300;

/** The jobs of this client, and its studies. */
export class Jobs extends Panel {
  /** @type {Map<string, HTMLTableRowElement>} */
  #rows = new Map();
  /** @type {Map<string, AbortController>} */
  #followed = new Map();
  /** @type {Map<string, Submission>} */
  #documents = new Map();
  /**
   * The design as it is, with every default filled in as the documents of jobs are; null where it is none.
   *
   * @type {Submission | null}
   */
  #live = null;
  #telling = 0;

  /**
   * The jobs and studies in `place`; `form` names fields, the results of a finished job are opened by `onOpen`, and a
   * study that is given by its id and document by `onStudy`.
   *
   * @param {HTMLElement} place
   * @param {Design} design
   * @param {Form} form
   * @param {Open} onOpen
   * @param {(id: string, study: AskedStudy) => void} onStudy
   */
  constructor(place, design, form, onOpen, onStudy) {
    super(place);
    this.design = design;
    this.form = form;
    this.onOpen = onOpen;
    this.onStudy = onStudy;
    this.state = h("p", { className: "note", role: "status" });
    this.tags = h("input", {
      type: "text",
      id: "jobs-tags",
      maxLength: 200,
      spellcheck: false,
      on: { change: ({ target }) => design.set("/tags", read(target, { kind: "texts" }), "mend") },
    });
    this.ofStudies = h("input", { type: "checkbox", id: "jobs-of-studies", on: { change: () => this.refresh() } });
    /** @type {Listing<Job>} */
    this.jobs = new Listing({
      address: "v1/jobs",
      only: () => (this.ofStudies.checked ? "" : "&study=none"),
      id: "jobs-list",
      title: "Jobs",
      names: ["Submitted", "Design, and what differs from the one on the page", "State", "Actions"],
      rowOf: (job) => this.#rowOf(job),
      none: "There are no jobs yet.",
      older: button("Older jobs", () => this.#moreJobs()),
    });
    /** @type {Listing<StudyState>} */
    this.studies = new Listing({
      address: "v1/studies",
      id: "studies",
      title: "Sweeps, studies, searches and populations",
      names: ["Submitted", "What", "State", "Actions"],
      rowOf: (study) => this.#studyRow(study),
      none: "There are none yet.",
      older: button("Older ones", () => this.#attempt(() => this.studies.more())),
    });
    place.replaceChildren(
      note(
        "A job is kept: its results can be fetched and linked to for weeks. What the page shows while you change numbers is not. A design that is too large to follow the hand is submitted by itself when the hand rests.",
      ),
      inLine(
        button("Submit this design as a job", () => this.#act(() => send(design.submission)), { className: "primary" }),
        ...labelled("with the tags", this.tags),
      ),
      inLine(
        button("Look again", () => this.refresh()),
        h("label", {}, this.ofStudies, " those of studies too"),
      ),
      this.state,
      ...this.jobs.elements,
      h("h3", {}, "Sweeps, studies, searches and populations"),
      ...this.studies.elements,
    );
    design.onChange(
      debounced(REST, () => {
        if (!place.hidden) void this.#tell();
      }),
    );
  }

  async refresh() {
    this.tags.value = (this.design.get("/tags") ?? []).join(", ");
    this.#telling += 1;
    for (const each of [this.jobs, this.studies]) each.clear();
    await Promise.all([this.#moreJobs(), this.#attempt(() => this.studies.more())]);
  }

  /** Follows nothing while nobody looks. */
  leave() {
    for (const stop of this.#followed.values()) stop.abort();
  }

  /**
   * Says of each job which design it is of. The list does not say it: each document is asked for once, the newest
   * first.
   */
  async #tell() {
    this.#telling += 1;
    const turn = this.#telling;
    const documents = this.#documents;
    const filled = await checked(this.design.submission).then(
      ({ submission }) => submission,
      () => null,
    );
    if (turn !== this.#telling) return;
    this.#live = filled;
    for (const job of this.jobs.items) {
      const { id } = job;
      if (!documents.has(id)) {
        const whole = await json(`v1/jobs/${id}`).catch(() => null);
        if (whole) documents.set(id, whole.submission);
        if (documents.size > DOCUMENTS) documents.delete([...documents.keys()][0]);
      }
      if (turn !== this.#telling || this.place.hidden) return;
      this.#rows.get(id)?.querySelector(".of-design")?.replaceWith(this.#designOf(job));
    }
  }

  /**
   * Which design a job is of: its tags, its name, and in which fields it differs from the design on the page.
   *
   * @param {Job} job
   */
  #designOf({ id, tags: given, method }) {
    const submission = this.#documents.get(id);
    const live = this.#live;
    const cell = h(
      "td",
      { className: "of-design" },
      ...(given.length ? [h("strong", {}, given.join(", ")), " "] : []),
      submission ? nameOf(submission) : "",
      h("small", {}, ` ${method.replace(/_/g, " ")}`),
    );
    if (!submission || !live) return cell;
    const all = differences([live, submission]).filter(({ pointer }) => pointer !== "/tags");
    // The true period is filled in too: it goes with what has been changed.
    const others = all.length > 1 ? all.filter(({ pointer }) => pointer !== "/resolution/span_mesh_periods") : all;
    const shown = others
      .slice(0, FIELDS)
      .map(({ pointer, values: [, value] }) => `${this.form.names.named(pointer)} ${told(value)}`);
    const rest = others.length - shown.length;
    cell.append(
      h(
        "small",
        { className: "differs" },
        others.length ? `${shown.join("; ")}${rest ? `; and ${rest} more` : ""}` : "the design on the page",
      ),
    );
    return cell;
  }

  /**
   * Does something, and says why where it was refused.
   *
   * @param {() => unknown} work
   */
  async #attempt(work) {
    try {
      await work();
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      this.state.textContent = error.reason;
    }
  }

  /**
   * Does something to a job or a study, then shows how they stand.
   *
   * @param {() => unknown} work
   */
  async #act(work) {
    this.state.textContent = "";
    await this.#attempt(work);
    await this.refresh();
  }

  /** The next page of the list of jobs, of which those that go on are followed. */
  #moreJobs() {
    return this.#attempt(async () => {
      const came = await this.jobs.more();
      void this.#tell();
      for (const job of came.filter(({ status }) => !hasEnded(status)).slice(-FOLLOWED)) void this.#watch(job);
    });
  }

  /** @param {StudyState} study */
  #studyRow({ id, name, status, done, total, submitted_at: at }) {
    const what = name ?? `study ${id.slice(-6)}`;
    const show = async () => this.onStudy(id, await json(`v1/studies/${id}/document`));
    const cancel = () => request(`v1/studies/${id}/cancel`, { method: "POST" });
    return h(
      "tr",
      {},
      h("th", { scope: "row" }, new Date(at).toLocaleString()),
      h("td", { className: "of-design" }, what),
      h("td", {}, `${status}, ${done} of ${total}`),
      h(
        "td",
        { className: "actions" },
        button("Go to it", () => this.#attempt(show), { ariaLabel: `Go to it ${what}` }),
        hasEnded(status) ? null : button("Cancel", () => this.#act(cancel), { ariaLabel: `Cancel ${what}` }),
      ),
    );
  }

  /**
   * Shows what becomes of a job as the service tells it.
   *
   * @param {Job} job
   */
  async #watch(job) {
    const followed = this.#followed;
    if (followed.has(job.id) || this.place.hidden) return;
    const stop = new AbortController();
    followed.set(job.id, stop);
    let known = job;
    /** @type {(event: string, data: Partial<Job>) => void} */
    const told = (event, data) => {
      known = { ...known, ...data };
      this.#rows.get(job.id)?.replaceWith(this.#rowOf(known));
    };
    try {
      told("status", await follow(`v1/jobs/${job.id}`, told, stop.signal));
    } catch (error) {
      if (!(error instanceof ProblemError) && !isAborted(error)) throw error;
    } finally {
      followed.delete(job.id);
      if (!stop.signal.aborted) void this.refresh();
    }
  }

  /**
   * @param {Job} job
   * @returns {HTMLTableRowElement}
   */
  #rowOf(job) {
    const address = `v1/jobs/${job.id}`;
    /** @type {(name: string, work: () => unknown) => HTMLButtonElement} */
    const doing = (name, work) => button(name, () => this.#act(work), { ariaLabel: `${name} ${job.id.slice(-6)}` });
    // A file changes no job: the rows stay as they are under the pointer.
    /** @type {(words: string, name: string) => HTMLButtonElement} */
    const file = (words, name) =>
      button(
        words,
        () =>
          this.#attempt(() => {
            const asked = this.#documents.get(job.id);
            return saveFile(job.id, name, fileOfDesign(asked ? nameOf(asked) : "", `${job.id.slice(-6)}-`));
          }),
        { ariaLabel: `${words} ${job.id.slice(-6)}` },
      );
    const open = async () =>
      this.onOpen(
        (await json(address)).submission,
        job.status === "successful" ? await json(`${address}/results`) : null,
      );
    // What else there is depends on what was asked for.
    /** @type {HTMLButtonElement} */
    const more = button(
      "More files",
      () =>
        this.#attempt(async () => {
          const files = filesOf((await json(address)).submission).filter(
            ({ name }) => !IN_ROW.some(([, shown]) => shown === name),
          );
          more.replaceWith(...files.map(({ name, title }) => file(title, name)));
        }),
      { ariaLabel: `More files of ${job.id.slice(-6)}` },
    );
    const buttons = [doing("Open", open)];
    if (!hasEnded(job.status)) buttons.push(doing("Cancel", () => request(`${address}/cancel`, { method: "POST" })));
    else buttons.push(doing("Run again", async () => send((await json(address)).submission)));
    if (job.status === "successful") buttons.push(...IN_ROW.map(([words, name]) => file(words, name)), more);
    const took = job.links.same_as
      ? h("small", {}, " as computed before")
      : (job.wall_time_seconds ?? null) === null
        ? null
        : h("small", {}, ` in ${number(job.wall_time_seconds, 2)} s`);
    const progress = hasEnded(job.status)
      ? job.status
      : h(
          "span",
          {},
          `${job.status} `,
          h("progress", { max: 100, value: job.progress_percent, ariaLabel: "Progress" }),
          ` ${job.progress_percent} %`,
        );
    const why = job.problem ? h("small", {}, ` ${job.problem.detail}`) : null;
    const row = h(
      "tr",
      {},
      h("th", { scope: "row" }, new Date(job.submitted_at).toLocaleString()),
      this.#designOf(job),
      h("td", {}, progress, took, why),
      h("td", { className: "actions" }, ...buttons),
    );
    this.#rows.set(job.id, row);
    return row;
  }
}

/**
 * Submits a job that the project keeps.
 *
 * @param {Submission} submission
 */
async function send(submission) {
  const { id, submitted_at: at } = await post("v1/jobs", submission);
  submitted({ id, kind: "job", name: nameOf(submission), at });
}

/**
 * A list of the service, page by page.
 *
 * @template T what it lists
 */
class Listing {
  /** @type {T[]} */
  items = [];
  /** @type {string | null} */
  #next = null;

  /**
   * @param {{ address: string, only?: () => string, id: string, title: string, names: string[],
   *   rowOf: (item: T) => HTMLTableRowElement, none: string, older: HTMLButtonElement }} how `only` is the query for a
   *   part of the list
   */
  constructor({ address, only = () => "", id, title, names, rowOf, none, older }) {
    this.address = address;
    this.only = only;
    this.names = names;
    this.rowOf = rowOf;
    this.none = none;
    this.older = older;
    older.hidden = true;
    this.out = Object.assign(region(title), { id });
  }

  get elements() {
    return [this.out, this.older];
  }

  clear() {
    [this.items, this.#next] = [[], null];
  }

  /**
   * Shows the next page too.
   *
   * @returns {Promise<T[]>} what it lists
   */
  async more() {
    const cursor = this.#next ? `&cursor=${encodeURIComponent(this.#next)}` : "";
    const page = await json(`${this.address}?limit=${SHOWN}${this.only()}${cursor}`);
    this.items = [...this.items, ...page.items];
    this.#next = page.next;
    this.older.hidden = !page.next;
    this.out.replaceChildren(this.items.length ? table(this.names, this.items.map(this.rowOf)) : note(this.none));
    return page.items;
  }
}
