// @ts-check
// The work that runs for the project: everything that is computed and takes more than a moment, whoever on the page has
// asked for it, with how far it is, what it costs and what stops it.

/** @import { Job, Submission } from "./documents.js" */

/** @typedef {"job" | "sweep" | "sensitivity" | "study" | "search" | "population"} Kind */

/**
 * The parts of a study that tell its kind.
 *
 * @typedef {{ name?: string | null, population?: unknown, search?: unknown, designs?: { label: string }[] | null,
 *   axes?: { path: string, values: unknown[] }[] | null }} Asked
 */

/**
 * A job or a study that belongs to the project: its id in the service, its kind and name, and when it was submitted.
 *
 * @typedef {{ id: string, kind: Kind, name: string, at: string }} Submitted
 */

/**
 * Work that runs: `id` is that of its job or study, once there is one; `seconds` is its cost on one core by the
 * estimate of the service, null while nobody knows it; `share` is the part that is done, null where nothing tells it;
 * `said` tells how far it is.
 *
 * @typedef {{ name: string, id: string | null, since: number, seconds: number | null, share: number | null,
 *   said: string, stop: () => void }} Running
 */

/**
 * The handle of work that the page does: `tell` says what is new of it, `end` that it is over, and how.
 *
 * @typedef {{ tell: (news: Partial<Running>) => void, end: (status?: string) => void }} Handle
 */

/** @type {Set<Running>} */
const all = new Set();
/** @type {Set<(ended?: { id: string, status: string }) => void>} */
const watching = new Set();
/** @type {Set<(submitted: Submitted) => void>} */
const keeping = new Set();

/** @type {(ended?: { id: string, status: string }) => void} */
const told = (ended) => {
  for (const listener of watching) listener(ended);
};

/** All that runs, the oldest first. */
export const running = () => [...all];

/**
 * Calls `listener` when something of the work has changed, with the id and the status of a job or study that has ended.
 *
 * @param {(ended?: { id: string, status: string }) => void} listener
 */
export function onWork(listener) {
  watching.add(listener);
}

/**
 * Calls `listener` with each job and study that is submitted for the project.
 *
 * @param {(submitted: Submitted) => void} listener
 */
export function onSubmitted(listener) {
  keeping.add(listener);
}

/**
 * A job or a study was submitted that the project keeps.
 *
 * @param {Submitted} submitted
 */
export function submitted(submitted) {
  for (const listener of keeping) listener(submitted);
}

/**
 * Work called `name` begins, which `stop` stops.
 *
 * @type {(name: string, stop: () => void, known?: Partial<Running>) => Handle}
 */
export function begin(name, stop, known = {}) {
  /** @type {Running} */
  const entry = { name, id: null, since: performance.now(), seconds: null, share: null, said: "", ...known, stop };
  all.add(entry);
  told();
  return {
    tell: (news) => {
      if (!all.has(entry)) return;
      Object.assign(entry, news);
      told();
    },
    end: (status) => {
      if (!all.delete(entry)) return;
      told(entry.id && status ? { id: entry.id, status } : undefined);
    },
  };
}

/**
 * A listener to the events of a job that tells them as the progress of the work.
 *
 * @type {(work: Handle) => (event: string, data: Partial<Job>) => void}
 */
export const tellsOf = (work) => {
  let share = 0;
  return (event, data) => {
    if (event === "away") return work.tell({ said: "The service does not answer; the job goes on" });
    share = (data.progress_percent ?? 100 * share) / 100;
    const said = data.status === "accepted" ? "waits for its turn" : `${Math.round(100 * share)} %`;
    return work.tell({ ...(data.id ? { id: data.id } : {}), share, said });
  };
};

const TORQUE = "/output_torques_n_m";

/** The designs of a study of what a design is sensitive to: each is called by what changes, and which way. */
const SENSITIVE = /^(as it is|(torque|center distance|misalignment (in|out of) plane) [+-])$/;

/**
 * The kind of a study, by its document.
 *
 * @type {(study: Asked) => Exclude<Kind, "job">}
 */
export function kindOf({ population, search, axes, designs }) {
  if (population) return "population";
  if (search) return "search";
  const isSweep =
    axes?.length === 1 &&
    axes[0].path === TORQUE &&
    axes[0].values.every((each) => Array.isArray(each) && each.length === 1);
  if (isSweep) return "sweep";
  return designs?.length && designs.every(({ label }) => SENSITIVE.test(label)) ? "sensitivity" : "study";
}

/**
 * The name of what is computed of a submission.
 *
 * @type {(submission: Submission) => string}
 */
export const methodOf = ({ method }) => method.replace(/_/g, " ");
