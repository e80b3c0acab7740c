// The service: requests with the key, and problems as errors.

const KEY = "meshwright-key";
const listeners = new Set();
let key = sessionStorage.getItem(KEY) ?? "";

/** A problem document (RFC 9457) that the service answered with. */
export class ProblemError extends Error {
  constructor(problem) {
    super(problem.detail ?? problem.title ?? "The service gave no reason.");
    this.problem = problem;
  }
}

/** Calls `listener` when a request was refused for want of a key. */
export function onKeyNeeded(listener) {
  listeners.add(listener);
}

export function hasKey() {
  return key !== "";
}

export function setKey(given) {
  key = given.trim();
  if (key) sessionStorage.setItem(KEY, key);
  else sessionStorage.removeItem(KEY);
}

/** The answer to a request at `path`, relative to the page; throws a [`ProblemError`] for a refusal. */
export async function request(path, { method = "GET", body, headers = {}, signal } = {}) {
  const all = { ...headers };
  if (key) all.authorization = `Bearer ${key}`;
  if (body !== undefined) all["content-type"] = "application/json";
  const init = { method, headers: all, signal, cache: "no-cache", credentials: "same-origin" };
  if (body !== undefined) init.body = JSON.stringify(body);
  let response;
  try {
    response = await fetch(new URL(path, document.baseURI), init);
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new ProblemError({ code: "unreachable", title: "No answer", detail: "The service does not answer. The page tries again when you change something." });
  }
  if (response.ok) return response;
  const problem = await response.json().catch(() => ({ status: response.status, title: response.statusText, code: "unknown" }));
  if (response.status === 401) for (const listener of listeners) listener(problem);
  throw new ProblemError(problem);
}

/** The JSON of an answer. */
export async function json(path, options) {
  return (await request(path, options)).json();
}

export const post = (path, body, options = {}) => json(path, { ...options, method: "POST", body });
