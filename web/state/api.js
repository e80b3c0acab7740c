// @ts-check
// The service: requests with the key, and problems as errors.

/** @import { AnswerAt, Job, Problem, Submission } from "./documents.js" */

/**
 * `quiet` requests ask nobody for a key.
 *
 * @typedef {{ method?: string, body?: unknown, headers?: Record<string, string>, signal?: AbortSignal,
 *   keepalive?: boolean, quiet?: boolean }} Options
 */
const KEY = "meshwright-key";
/** @type {Set<(problem: Problem) => void>} */
const listeners = new Set();
/** @type {string | null} */
let known = null;
/** Whether the key that is known has been accepted. */
let accepted = false;
const key = () => (known ??= sessionStorage.getItem(KEY) ?? "");

/** So long it takes until a service that did not answer, or had no room, is asked again, in milliseconds. */
const AGAIN = 1500;

/**
 * A problem document (RFC 9457) that the service answered with, and after how many milliseconds it may be asked again.
 */
export class ProblemError extends Error {
  /** @param {Problem} problem */
  constructor(problem, after = AGAIN) {
    super(problem.detail ?? problem.title ?? "The service gave no reason.");
    this.problem = problem;
    this.after = after;
  }

  /** What is wrong: with the first of the fields, where it is told of fields. */
  get reason() {
    return this.problem.errors?.[0]?.detail ?? this.message;
  }
}

/**
 * What a request or an answer that broke off is told as; one that was given up stays that.
 *
 * @type {(error: Error) => Error}
 */
const broken = (error) =>
  isAborted(error)
    ? error
    : new ProblemError({
        code: "unreachable",
        title: "No answer",
        detail: "The service does not answer. The page asks again until it does.",
      });

/**
 * Whether an error only says that a request was given up.
 *
 * @type {(error: unknown) => boolean}
 */
export const isAborted = (error) => error instanceof Error && error.name === "AbortError";

/**
 * Calls `listener` when a request was refused for want of a key.
 *
 * @type {(listener: (problem: Problem) => void) => void}
 */
export function onKeyNeeded(listener) {
  listeners.add(listener);
}

export function hasKey() {
  return key() !== "";
}

/** What is wrong with the key that was refused: words of the service, where it was a good one before. */
export const wordsOfRefusedKey = (/** @type {string | undefined} */ detail) =>
  accepted ? (detail ?? "") : "This key is not known.";

/** @param {string} given */
export function setKey(given) {
  known = given.trim();
  accepted = false;
  if (known) sessionStorage.setItem(KEY, known);
  else sessionStorage.removeItem(KEY);
}

/**
 * The answer to a request at `path`, relative to the page; throws a [`ProblemError`] for a refusal.
 *
 * @type {(path: string, options?: Options) => Promise<Response>}
 */
export async function request(path, { method = "GET", body, headers = {}, signal, keepalive, quiet } = {}) {
  /** @type {Record<string, string>} */
  const all = { ...headers };
  if (key()) all.authorization = `Bearer ${key()}`;
  if (body !== undefined) all["content-type"] ??= "application/json";
  /** @type {RequestInit} */
  const init = { method, headers: all, signal, keepalive, cache: "no-cache", credentials: "same-origin" };
  if (body !== undefined) init.body = typeof body === "string" || body instanceof Blob ? body : JSON.stringify(body);
  const response = await fetch(new URL(path, document.baseURI), init).catch((error) => {
    throw broken(error);
  });
  if (response.ok) {
    if (all.authorization) accepted = true;
    return response;
  }
  const problem = await response
    .json()
    .catch(() => ({ status: response.status, title: response.statusText, code: "unknown" }));
  if (response.status === 401 && !quiet) for (const listener of listeners) listener(problem);
  throw new ProblemError(problem, pauseOf(response));
}

/**
 * The milliseconds after which a service that asks to be asked again is.
 *
 * @type {(response: Response) => number}
 */
const pauseOf = (response) => Math.max(AGAIN, 1000 * Number(response.headers.get("retry-after")));

/**
 * Whether an error goes away by itself: the service does not answer, starts, or has too much to do.
 *
 * @type {(error: unknown) => error is ProblemError}
 */
export const isPassing = (error) =>
  error instanceof ProblemError &&
  (error.problem.code === "unreachable" || [429, 502, 503, 504].includes(error.problem.status ?? 0));

/** @type {(milliseconds: number) => Promise<void>} */
const rest = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/**
 * What `work` gives once the service answers; until then `told` hears why it does not.
 *
 * @template T
 * @param {() => Promise<T>} work
 * @param {(problem: Problem) => void} told
 * @returns {Promise<T>}
 */
export async function patiently(work, told = () => {}) {
  for (;;) {
    try {
      return await work();
    } catch (error) {
      if (!isPassing(error)) throw error;
      told(error.problem);
      await rest(error.after);
    }
  }
}

/**
 * The answer to a GET. A file that is not made yet (202) is asked for again until it is.
 *
 * @type {(path: string, options?: Options) => Promise<Response>}
 */
export async function made(path, options) {
  for (;;) {
    const response = await request(path, options);
    if (response.status !== 202) return response;
    await rest(pauseOf(response));
    options?.signal?.throwIfAborted();
  }
}

/**
 * The JSON of an answer.
 *
 * @template {string} P
 * @param {P} path
 * @param {Options} [options]
 * @returns {Promise<AnswerAt<P, "get">>}
 */
export async function json(path, options) {
  return (await made(path, options)).json();
}

/**
 * The JSON of the answer to a document.
 *
 * @template {string} P
 * @param {P} path
 * @param {unknown} body
 * @param {Options} [options]
 * @returns {Promise<AnswerAt<P, "post">>}
 */
export async function post(path, body, options = {}) {
  return (await request(path, { ...options, method: "POST", body })).json();
}

/**
 * A submission as it would be computed, and what that costs.
 *
 * @param {unknown} submission
 * @param {Options} [options]
 */
export async function checked(submission, options = {}) {
  const answer = await post("v1/validate", submission, options);
  return /** @type {import("./documents.js").Schemas["Validation"]} */ (answer);
}

/**
 * What a study, a population or a search would cost.
 *
 * @param {unknown} study
 * @param {Options} [options]
 */
export async function foreseen(study, options = {}) {
  const answer = await post("v1/validate", study, options);
  return /** @type {import("./documents.js").Schemas["StudyValidation"]} */ (answer);
}

/**
 * The pieces of an answer that end with `end`, as far as somebody reads them.
 *
 * @param {Response} response
 * @param {string} end
 */
async function* pieces(response, end) {
  const { body } = response;
  if (!body) return;
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  try {
    for (;;) {
      const { value, done } = await reader.read().catch((error) => {
        throw broken(error);
      });
      if (done) return;
      const found = (text + value.replace(/\r/g, "")).split(end);
      text = found.pop() ?? "";
      yield* found;
    }
  } finally {
    reader.cancel().catch(() => {});
  }
}

/**
 * The events of a stream that the service sends, each `{ event, data }`, until it ends; `EventSource` cannot send a
 * key.
 *
 * @param {string} path
 * @param {AbortSignal} [signal]
 */
export async function* events(path, signal) {
  const response = await request(path, { headers: { accept: "text/event-stream" }, signal });
  for await (const piece of pieces(response, "\n\n")) {
    const lines = piece.split("\n");
    /** @type {(name: string) => string} */
    const of = (name) =>
      lines
        .filter((line) => line.startsWith(`${name}:`))
        .map((line) => line.slice(name.length + 1).trimStart())
        .join("\n");
    if (of("data")) yield { event: of("event") || "message", data: JSON.parse(of("data")) };
  }
}

/** @type {string[]} */
const ENDED = ["successful", "failed", "dismissed"];

/**
 * Whether a job or a study with this status changes no more.
 *
 * @type {(status: string) => boolean}
 */
export const hasEnded = (status) => ENDED.includes(status);

/**
 * Follows a job or a study at `path` by its events until it has ended, and gives how it stands then. `told` is called
 * with each event; a stream that breaks off is taken up again; while the service does not answer the event is `away`.
 *
 * @param {string} path
 * @param {(event: string, data: any) => void} told the data of an event is what the contract says of its name
 * @param {AbortSignal} [signal]
 */
export async function follow(path, told = () => {}, signal = undefined) {
  for (;;) {
    const state = await patiently(
      async () => {
        for await (const { event, data } of events(`${path}/events`, signal)) told(event, data);
        return json(path, { signal });
      },
      () => told("away", {}),
    );
    if (hasEnded(state.status)) return state;
    await rest(AGAIN);
  }
}

/** @type {Map<string, Job>} */
const jobs = new Map();

/**
 * A job of `submission` that has succeeded: one that is known, or a new one that is followed until it ends. `told`
 * hears of its events, and of the job first.
 *
 * @param {Submission} submission
 * @param {{ told?: (event: string, data: any) => void, signal?: AbortSignal }} [how]
 * @returns {Promise<Job>}
 */
export async function solved(submission, { told = () => {}, signal } = {}) {
  const name = JSON.stringify(submission);
  const before = jobs.get(name);
  if (before) return before;
  // A job that was asked for is known, so that it can be cancelled: the request itself is not given up.
  const made = await post("v1/jobs", submission);
  told("status", made);
  signal?.throwIfAborted();
  const job = hasEnded(made.status) ? made : await follow(`v1/jobs/${made.id}`, told, signal);
  if (job.status !== "successful")
    throw new ProblemError(job.problem ?? { code: job.status, title: "Cancelled", detail: "The job was cancelled." });
  jobs.set(name, job);
  return job;
}
