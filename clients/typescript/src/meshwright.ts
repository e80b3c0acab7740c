/** A client of a Meshwright service. All types come from its OpenAPI document. */

import type { components } from "./schema.js";

type Schemas = components["schemas"];
export type Submission = Schemas["Submission"];
export type Results = Schemas["Results"];
export type Job = Schemas["Job"];
export type Problem = Schemas["Problem"];
/** The base may lack what every design gives. */
export type Study = Schemas["Study"];
export type SubmittedStudy = Schemas["SubmittedStudy"];
export type StudyResults = Schemas["StudyResults"];
export type Validation = Schemas["Validation"];
export type PairOutline = Schemas["PairOutline"];

/** A refusal of the service, or why a job failed. `problem.errors` names the fields. */
export class ProblemError extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail);
  }
}

export interface Options {
  /** Where the service is; the origin of the page by default. */
  url?: string;
  /** The key, where the service asks for one. */
  key?: string;
  /** The user of the key's client on whose behalf the calls come: users take turns, and jobs say who submitted them. */
  user?: string;
}

/** What is told of a job or study while it is computed. */
export type Report = (done: number, total: number) => void;

const ENDED = ["successful", "failed", "dismissed"];

export class Client {
  readonly #url: string;
  readonly #headers: Record<string, string>;

  constructor({ url = globalThis.location?.origin ?? "http://127.0.0.1:8080", key, user }: Options = {}) {
    this.#url = url.replace(/\/$/, "");
    this.#headers = { ...(key && { authorization: `Bearer ${key}` }), ...(user && { "meshwright-user": user }) };
  }

  /** Submits a job and gives its results when it has ended. */
  async solve(submission: Submission, report: Report = () => {}): Promise<Results> {
    let job = await this.submit(submission);
    while (!ENDED.includes(job.status)) {
      report(job.positions_done, job.positions_total);
      // The service answers when the job has ended, or after two seconds.
      job = await this.#call<Job>(`/v1/jobs/${job.id}`, { headers: { prefer: "wait=2" } });
    }
    report(job.positions_done, job.positions_total);
    if (job.status !== "successful") {
      throw new ProblemError(job.problem ?? { type: "about:blank", title: "Dismissed", status: 409, code: "job_dismissed", detail: `The job was ${job.status}.` });
    }
    return this.results(job.id);
  }

  /** The results at once; the service keeps nothing. */
  preview(submission: Submission, signal?: AbortSignal): Promise<Results> {
    return this.#post("/v1/preview", submission, signal);
  }

  validate(submission: Submission): Promise<Validation> {
    return this.#post("/v1/validate", submission);
  }

  /** The true profile of both gears, their holes, and the line of action. */
  outline(submission: Submission): Promise<PairOutline> {
    return this.#post("/v1/outline", submission);
  }

  submit(submission: Submission): Promise<Job> {
    return this.#post("/v1/jobs", submission);
  }

  job(id: string): Promise<Job> {
    return this.#call(`/v1/jobs/${id}`);
  }

  cancel(id: string): Promise<Job> {
    return this.#post(`/v1/jobs/${id}/cancel`);
  }

  results(id: string, between = false): Promise<Results> {
    return this.#call(`/v1/jobs/${id}/results${between ? "?between=true" : ""}`);
  }

  /** Submits a study and gives its table when all designs have ended. */
  async study(study: Study, report: Report = () => {}): Promise<StudyResults> {
    let state = await this.#post<SubmittedStudy>("/v1/studies", study);
    for (let pause = 100; !ENDED.includes(state.status); pause = Math.min(2 * pause, 2000)) {
      report(state.done, state.total);
      await new Promise((resolve) => setTimeout(resolve, pause));
      state = await this.#call<SubmittedStudy>(`/v1/studies/${state.id}`);
    }
    report(state.done, state.total);
    return this.#call(`/v1/studies/${state.id}/results`);
  }

  /** A submission that ships with the service. */
  async example(name: string): Promise<Submission> {
    const { items } = await this.#call<Schemas["Examples"]>("/v1/examples");
    const found = items.find((each) => each.name === name);
    if (!found) throw new Error(`there is no example ${name}; there are ${items.map((each) => each.name).join(", ")}`);
    return found.submission;
  }

  #post<T>(path: string, body?: unknown, signal?: AbortSignal): Promise<T> {
    const init: RequestInit = { method: "POST", headers: { "content-type": "application/json" } };
    if (body !== undefined) init.body = JSON.stringify(body);
    if (signal) init.signal = signal;
    return this.#call(path, init);
  }

  async #call<T>(path: string, init: RequestInit = {}): Promise<T> {
    const headers = { ...this.#headers, ...(init.headers as Record<string, string> | undefined) };
    const response = await fetch(this.#url + path, { ...init, headers });
    const document: unknown = await response.json();
    if (!response.ok) throw new ProblemError(document as Problem);
    return document as T;
  }
}
