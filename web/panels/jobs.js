// @ts-check
// The jobs of this client: submitted, followed by their events, cancelled, opened, run again.

import { button, debounced, h, inLine, labelled, note, table } from "../draw/dom.js";
import { filesOf, saveFile } from "../draw/files.js";
import { read } from "../draw/inputs.js";
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
export function jobs(place, design, form, onOpen, onStudy) {
  const out = h("div", { className: "scroll", id: "jobs-list", tabIndex: 0, role: "region", ariaLabel: "Jobs" });
  const state = h("p", { className: "note", role: "status" });
  const tags = h("input", {
    type: "text",
    id: "jobs-tags",
    maxLength: 200,
    spellcheck: false,
    on: { change: ({ target }) => design.set("/tags", read(target, { kind: "texts" }), "mend") },
  });
  const submit = button("Submit this design as a job", () => act(() => send(design.submission)), {
    className: "primary",
  });
  const ofStudies = h("input", { type: "checkbox", id: "jobs-of-studies", on: { change: () => refresh() } });
  const look = button("Look again", () => refresh());
  const older = button("Older jobs", () => more(), { hidden: true });
  const studies = h("div", {
    className: "scroll",
    id: "studies",
    tabIndex: 0,
    role: "region",
    ariaLabel: "Sweeps, studies, searches and populations",
  });
  const olderStudies = button("Older ones", () => moreStudies(), { hidden: true });
  place.replaceChildren(
    note(
      "A job is kept: its results can be fetched and linked to for weeks. What the page shows while you change numbers is not. A design that is too large to follow the hand is submitted by itself when the hand rests.",
    ),
    inLine(submit, ...labelled("with the tags", tags)),
    inLine(look, h("label", {}, ofStudies, " those of studies too")),
    state,
    out,
    older,
    h("h3", {}, "Sweeps, studies, searches and populations"),
    studies,
    olderStudies,
  );
  /** @type {Map<string, HTMLTableRowElement>} */
  const rows = new Map();
  /** @type {Map<string, AbortController>} */
  const followed = new Map();
  /** @type {Map<string, Submission>} */
  const documents = new Map();
  /** @type {Job[]} */
  let listed = [];
  /** @type {string | null} */
  let next = null;
  /** @type {StudyState[]} */
  let listedStudies = [];
  /** @type {string | null} */
  let nextStudies = null;
  /**
   * The design as it is, with every default filled in as the documents of jobs are; null where it is none.
   *
   * @type {Submission | null}
   */
  let live = null;
  let telling = 0;

  design.onChange(
    debounced(REST, () => {
      if (!place.hidden) tell();
    }),
  );

  /**
   * Says of each job which design it is of. The list does not say it: each document is asked for once, the newest
   * first.
   */
  async function tell() {
    telling += 1;
    const turn = telling;
    const filled = await checked(design.submission).then(
      ({ submission }) => submission,
      () => null,
    );
    if (turn !== telling) return;
    live = filled;
    for (const job of listed) {
      const { id } = job;
      if (!documents.has(id)) {
        const whole = await json(`v1/jobs/${id}`).catch(() => null);
        if (whole) documents.set(id, whole.submission);
        if (documents.size > DOCUMENTS) documents.delete([...documents.keys()][0]);
      }
      if (turn !== telling || place.hidden) return;
      rows.get(id)?.querySelector(".of-design")?.replaceWith(designOf(job));
    }
  }

  /**
   * Which design a job is of: its tags, its name, and in which fields it differs from the design on the page.
   *
   * @param {Job} job
   */
  function designOf({ id, tags: given, method }) {
    const submission = documents.get(id);
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
      .map(({ pointer, values: [, value] }) => `${form.named(pointer)} ${told(value)}`);
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
  async function attempt(work) {
    try {
      state.textContent = "";
      await work();
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      state.textContent = error.reason;
    }
  }

  /**
   * Does something to a job, then shows how the jobs stand.
   *
   * @param {() => unknown} work
   */
  async function act(work) {
    await attempt(work);
    await refresh();
  }

  async function refresh() {
    tags.value = (design.get("/tags") ?? []).join(", ");
    telling += 1;
    [listed, next] = [[], null];
    [listedStudies, nextStudies] = [[], null];
    await Promise.all([more(), moreStudies()]);
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

  /** The next page of the list of studies, each with the way back to it. */
  async function moreStudies() {
    await attempt(async () => {
      const page = await json(
        `v1/studies?limit=${SHOWN}${nextStudies ? `&cursor=${encodeURIComponent(nextStudies)}` : ""}`,
      );
      listedStudies = [...listedStudies, ...page.items];
      nextStudies = page.next;
      olderStudies.hidden = !nextStudies;
      studies.replaceChildren(
        listedStudies.length
          ? table(["Submitted", "What", "State", "Actions"], listedStudies.map(studyRow))
          : note("There are none yet."),
      );
    });
  }

  /** @param {StudyState} study */
  function studyRow({ id, name, status, done, total, submitted_at: at }) {
    const what = name ?? `study ${id.slice(-6)}`;
    /** @type {(words: string, work: () => unknown) => HTMLButtonElement} */
    const doing = (words, work) => button(words, () => attempt(work), { ariaLabel: `${words} ${what}` });
    const buttons = [doing("Go to it", async () => onStudy(id, await json(`v1/studies/${id}/document`)))];
    if (!hasEnded(status))
      buttons.push(
        doing("Cancel", async () => {
          await request(`v1/studies/${id}/cancel`, { method: "POST" });
          await refresh();
        }),
      );
    return h(
      "tr",
      {},
      h("th", { scope: "row" }, new Date(at).toLocaleString()),
      h("td", { className: "of-design" }, what),
      h("td", {}, `${status}, ${done} of ${total}`),
      h("td", { className: "actions" }, ...buttons),
    );
  }

  /** The next page of the list. */
  async function more() {
    try {
      const page = await json(
        `v1/jobs?limit=${SHOWN}${ofStudies.checked ? "" : "&study=none"}${next ? `&cursor=${encodeURIComponent(next)}` : ""}`,
      );
      listed = [...listed, ...page.items];
      next = page.next;
      older.hidden = !next;
      /** @type {{ items: Job[] }} */
      const { items } = page;
      out.replaceChildren(listed.length ? tableOf(listed) : note("There are no jobs yet."));
      tell();
      for (const job of items.filter(({ status }) => !hasEnded(status)).slice(-FOLLOWED)) watch(job);
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      state.textContent = error.message;
    }
  }

  /**
   * Shows what becomes of a job as the service tells it.
   *
   * @param {Job} job
   */
  async function watch(job) {
    if (followed.has(job.id) || place.hidden) return;
    const stop = new AbortController();
    followed.set(job.id, stop);
    let known = job;
    /** @type {(event: string, data: Partial<Job>) => void} */
    const told = (event, data) => {
      known = { ...known, ...data };
      rows.get(job.id)?.replaceWith(rowOf(known));
    };
    try {
      told("status", await follow(`v1/jobs/${job.id}`, told, stop.signal));
    } catch (error) {
      if (!(error instanceof ProblemError) && !isAborted(error)) throw error;
    } finally {
      followed.delete(job.id);
      if (!stop.signal.aborted) refresh();
    }
  }

  /** @param {Job[]} items */
  function tableOf(items) {
    const names = ["Submitted", "Design, and what differs from the one on the page", "State", "Actions"];
    return table(names, items.map(rowOf));
  }

  /**
   * @param {Job} job
   * @returns {HTMLTableRowElement}
   */
  function rowOf(job) {
    const address = `v1/jobs/${job.id}`;
    /** @type {(name: string, work: () => unknown) => HTMLButtonElement} */
    const doing = (name, work) => button(name, () => act(work), { ariaLabel: `${name} ${job.id.slice(-6)}` });
    // A file changes no job: the rows stay as they are under the pointer.
    /** @type {(words: string, name: string) => HTMLButtonElement} */
    const file = (words, name) =>
      button(
        words,
        () =>
          attempt(() => {
            const asked = documents.get(job.id);
            return saveFile(job.id, name, fileOfDesign(asked ? nameOf(asked) : "", `${job.id.slice(-6)}-`));
          }),
        { ariaLabel: `${words} ${job.id.slice(-6)}` },
      );
    const open = async () =>
      onOpen((await json(address)).submission, job.status === "successful" ? await json(`${address}/results`) : null);
    // What else there is depends on what was asked for.
    /** @type {HTMLButtonElement} */
    const more = button(
      "More files",
      () =>
        attempt(async () => {
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
      designOf(job),
      h("td", {}, progress, took, why),
      h("td", { className: "actions" }, ...buttons),
    );
    rows.set(job.id, row);
    return row;
  }

  /** Follows nothing while nobody looks. */
  function leave() {
    for (const stop of followed.values()) stop.abort();
  }

  return { refresh, leave };
}
