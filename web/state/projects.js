// @ts-check
// Where projects are kept: in the service, or in the browser where no key may write. Of two writers the second one is
// told, by the tag of what it has read.

import { hasKey, json, ProblemError, request } from "./api.js";

/** @typedef {"service" | "browser"} Place */

/**
 * A project in a list.
 *
 * @typedef {{ id: string, name: string, updated_at: string, bytes: number, place: Place }} Listed
 */

/**
 * A project that was read or written: `tag` stands for its state.
 *
 * @typedef {{ id: string, name: string, updated_at: string, place: Place, tag: string }} Known
 */

/** Somebody else has changed or deleted the project since it was read. */
export class ChangedMeanwhile extends Error {}

const DATABASE = "meshwright-projects";
const PROJECTS = "projects";

/**
 * @template T
 * @param {IDBRequest<T>} asked
 * @returns {Promise<T>}
 */
const done = (asked) =>
  new Promise((resolve, reject) => {
    asked.onsuccess = () => resolve(asked.result);
    asked.onerror = () => reject(asked.error);
  });

/** @type {Promise<IDBDatabase> | null} */
let opened = null;

/** @type {(mode: IDBTransactionMode) => Promise<IDBObjectStore>} */
async function browser(mode) {
  if (!opened) {
    const asked = indexedDB.open(DATABASE, 1);
    asked.onupgradeneeded = () => asked.result.createObjectStore(PROJECTS, { keyPath: "id" });
    opened = done(asked);
  }
  return (await opened).transaction(PROJECTS, mode).objectStore(PROJECTS);
}

/** @typedef {{ id: string, name: string, updated_at: string, tag: string, document: object }} Stored */

/** @type {(error: unknown) => boolean} */
const mayNot = (error) =>
  error instanceof ProblemError && ["unauthorized", "forbidden"].includes(error.problem.code ?? "");

/** @type {(error: unknown, ...codes: string[]) => boolean} */
const isRefused = (error, ...codes) => error instanceof ProblemError && codes.includes(error.problem.code ?? "");

/** @type {(path: string, method: string, body: unknown, headers?: Record<string, string>) => Promise<Known>} */
async function sent(path, method, body, headers = {}) {
  const answer = await request(path, { method, body, headers, quiet: true });
  const { id, name, updated_at } = await answer.json();
  return { id, name, updated_at, place: "service", tag: answer.headers.get("etag") ?? "" };
}

/** Whether all who call the service share its list: it asks for no key. */
export const isShared = () => !hasKey();

/**
 * All projects, those that were changed last first; `refused` says whether the service shows none of its own.
 *
 * @returns {Promise<{ items: Listed[], refused: boolean }>}
 */
export async function list() {
  /** @type {Listed[]} */
  const items = [];
  let refused = false;
  try {
    for (let cursor = ""; ; ) {
      const page = await json(`v1/projects?limit=200${cursor}`, { quiet: true });
      for (const { id, name, updated_at, bytes } of page.items)
        items.push({ id, name, updated_at, bytes, place: "service" });
      if (!page.next) break;
      cursor = `&cursor=${encodeURIComponent(page.next)}`;
    }
  } catch (error) {
    if (!mayNot(error)) throw error;
    refused = true;
  }
  const own = await browser("readonly")
    .then((store) => /** @type {Promise<Stored[]>} */ (done(store.getAll())))
    .catch(() => /** @type {Stored[]} */ ([]));
  for (const { id, name, updated_at, document } of own)
    items.push({ id, name, updated_at, bytes: JSON.stringify(document).length, place: "browser" });
  return { items: items.sort((a, b) => b.updated_at.localeCompare(a.updated_at)), refused };
}

/**
 * Keeps a new project: in the service, or in the browser where it may not be kept there.
 *
 * @type {(name: string, document: object) => Promise<Known>}
 */
export async function add(name, document) {
  try {
    return await sent("v1/projects", "POST", { name, document });
  } catch (error) {
    if (!mayNot(error)) throw error;
    const id = `browser-${crypto.getRandomValues(new Uint32Array(4)).join("-")}`;
    return put(await browser("readwrite"), { id, name, document });
  }
}

/** @type {(store: IDBObjectStore, project: { id: string, name: string, document: object }) => Promise<Known>} */
async function put(store, { id, name, document }) {
  const tag = crypto.getRandomValues(new Uint32Array(2)).join("-");
  const stored = { id, name, document, tag, updated_at: new Date().toISOString() };
  await done(store.put(stored));
  return { id, name, updated_at: stored.updated_at, place: "browser", tag };
}

/**
 * Writes a project over what was read of it.
 *
 * @type {(known: Known, name: string, document: object) => Promise<Known>}
 * @throws {ChangedMeanwhile}
 */
export async function change({ id, place, tag }, name, document) {
  if (place === "service") {
    try {
      return await sent(`v1/projects/${id}`, "PUT", { name, document }, { "if-match": tag });
    } catch (error) {
      if (isRefused(error, "precondition_failed", "project_not_found")) throw new ChangedMeanwhile();
      throw error;
    }
  }
  // Reading and writing are one transaction, which other tabs wait for.
  const store = await browser("readwrite");
  const stored = /** @type {Stored | undefined} */ (await done(store.get(id)));
  if (stored?.tag !== tag) throw new ChangedMeanwhile();
  return put(store, { id, name, document });
}

/**
 * A project with its document; null where there is none any more.
 *
 * @type {(known: { id: string, place: Place }) => Promise<{ known: Known, document: unknown } | null>}
 */
export async function read({ id, place }) {
  if (place === "browser") {
    const stored = /** @type {Stored | undefined} */ (await done((await browser("readonly")).get(id)));
    if (!stored) return null;
    const { name, updated_at, tag, document } = stored;
    return { known: { id, name, updated_at, place, tag }, document };
  }
  try {
    const answer = await request(`v1/projects/${id}`);
    const { name, updated_at, document } = await answer.json();
    return { known: { id, name, updated_at, place, tag: answer.headers.get("etag") ?? "" }, document };
  } catch (error) {
    if (isRefused(error, "project_not_found")) return null;
    throw error;
  }
}

/**
 * Deletes a project, whoever has changed it meanwhile.
 *
 * @type {(known: { id: string, place: Place }) => Promise<void>}
 */
export async function remove({ id, place }) {
  if (place === "browser") {
    await done((await browser("readwrite")).delete(id));
    return;
  }
  try {
    await request(`v1/projects/${id}`, { method: "DELETE", headers: { "if-match": "*" } });
  } catch (error) {
    if (!isRefused(error, "project_not_found")) throw error;
  }
}
